// How a trajectory is cut into windows, sweep by sweep: panels of one scene, each with a trajectory
// coloured window by window, the split points as dots and the waypoints that the sweep keeps fixed
// as rings around them; before the sweep it was the dashed line. Drawn like plan_picture.
#pragma once

#include <string>
#include <vector>

#include "tools/io/scene_file.h"

namespace sopt {

struct SegmentPanel {
  std::string title;
  std::vector<Vec2> waypoints;
  std::vector<Vec2> previous;    // waypoints before the sweep; may be empty
  std::vector<int> splits;       // waypoint indices W; may be empty
  std::vector<int> window_ends;  // waypoint indices, increasing; empty: one window
};

struct SegmentPicture {
  const Scene* scene = nullptr;
  std::string title;
  std::string details;  // second line; may be empty
  std::vector<SegmentPanel> panels;
  int columns = 2;  // >= 1
};

// The whole SVG document. Indices that name no waypoint between start and goal are
// ignored.
[[nodiscard]] std::string draw(const SegmentPicture& picture);

}  // namespace sopt
