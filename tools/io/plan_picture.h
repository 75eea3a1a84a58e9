// One planning problem and its answer as a picture: obstacles, trees of the sampler (light), the
// sampler's path (dashed), the trajectory coloured by segment with the robot's swept area, start
// and goal with the robot to scale, scale bar, legend. Without a plan the same picture says why in
// red. World coordinates, y up; line widths and texts are relative to the picture, not to metres.
// Colours are Okabe and Ito's palette, which colour-blind people can tell apart.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "opt/planner.h"
#include "tools/io/scene_file.h"

namespace sopt {

struct PlanPicture {
  const Scene* scene = nullptr;
  std::string title;                     // name and outcome
  std::string details;                   // second line
  std::string failure;                   // third line, red; empty when there is a plan
  std::vector<Vec2> tree_from, tree_to;  // edge i joins tree_from[i] and tree_to[i]
  std::vector<Vec2> path;                // the sampler's, after shortcutting; may be empty
  std::vector<Vec2> waypoints;           // of the trajectory; empty without a plan
  std::vector<int> segment_ends;         // waypoint indices, increasing, the last is the horizon
  int i_culprit = kNoObstacle;           // obstacle the failure names
};

// Waypoint indices at which the windows of the odd parity end; W as in opt/splits.h.
[[nodiscard]] std::vector<int> segment_ends(std::span<const int> splits, int horizon);

// The whole SVG document.
[[nodiscard]] std::string draw(const PlanPicture& picture);

// The picture of what a planner did last; `times` stand beside it. Points into `scene`.
[[nodiscard]] PlanPicture picture_of(const Scene& scene, const Planner<Point2>& planner,
                                     const PlanResult<Point2>& result, const StageTimes& times);

}  // namespace sopt
