// One planning problem of an arm and its answer as an isometric picture: obstacles, the arm at the
// start (green), at the goal (red) and at times between (blue, darker as time goes on), the tool's
// path (dotted where something hides it) and its shadow on the floor, a grid and a scale in m. Seen
// from the corner from which the least of the arm and its path is hidden. Without a plan the same
// picture says why in red. Drawn far obstacles first (space_view.h); obstacles let what they hide
// shine through. Obstacles much larger than the arm's surroundings are cut at the picture's frame.
#pragma once

#include <string>
#include <vector>

#include "opt/planner.h"
#include "tools/io/arm_shape.h"
#include "tools/io/robot_scene.h"

namespace sopt {

struct ArmPicture {
  const World3* world = nullptr;
  std::string title;    // name and outcome
  std::string details;  // second line
  std::string failure;  // third line, red; empty when there is a plan
  std::vector<PlacedCapsule> start, goal;
  std::vector<std::vector<PlacedCapsule>> between;  // in the order of time
  double duration_s = 0.0;
  std::vector<Vec3> tool_path;  // world; empty without a plan
  int i_culprit = kNoObstacle;  // obstacle the failure names
};

// The whole SVG document.
[[nodiscard]] std::string draw(const ArmPicture& picture);

// The picture of what a planner did last; `times` stand beside it. Points into `scene`.
template <int N>
[[nodiscard]] ArmPicture picture_of(const ArmScene<N>& scene, const PlanResult<Arm<N>>& result,
                                    const StageTimes& times);

}  // namespace sopt
