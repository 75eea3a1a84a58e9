// Convex shapes of space as flat outlines: an isometric view, what is seen of a shape, and the
// order in which shapes are painted so that the nearer hides the farther. Two shapes apart have a
// plane between them, and the one on the viewer's side of it is painted later: exact for every
// pair; where pairs contradict each other (three shapes in a ring) the farthest is painted first.
// Pages have y down; lengths on the page are those of the view, in m. Cost O(n^2) clearances of
// pairs that overlap on the page.
#pragma once

#include <span>
#include <vector>

#include "models/plane/convex2.h"
#include "models/space/shape3.h"

namespace sopt {

class SpaceView {
 public:
  static constexpr int kNumCorners = 4;

  // From above one of the four corners: 0 lies towards +x +y, 1 -x +y, 2 -x -y, 3 +x -y.
  explicit SpaceView(int i_corner);

  [[nodiscard]] Vec2 at(const Vec3& p) const { return {right_.dot(p), -up_.dot(p)}; }
  [[nodiscard]] std::vector<Vec2> at(std::span<const Vec3> points) const;
  [[nodiscard]] double nearness(const Vec3& p) const { return toward_viewer_.dot(p); }
  [[nodiscard]] const Vec3& toward_viewer() const { return toward_viewer_; }
  [[nodiscard]] const Vec3& right() const { return right_; }
  [[nodiscard]] const Vec3& up() const { return up_; }

 private:
  Vec3 toward_viewer_, right_, up_;
};

// A part of the surface: faces of boxes and hulls, a cylinder's end, the highlight of what is
// round.
struct SeenFace {
  std::vector<Vec2> outline;
  double light = 0.0;  // 0 in the shade .. 1 full
};

struct SeenShape {
  std::vector<Vec2> silhouette;
  std::vector<SeenFace> faces;  // in the silhouette; do not hide each other
};

[[nodiscard]] SeenShape see(const Convex3& shape, const SpaceView& view);
// Around points of a page, without three in a line.
[[nodiscard]] std::vector<Vec2> convex_outline(std::vector<Vec2> points);

struct PaintItem {
  Convex3 shape;
  int group = 0;  // items of one group may be painted in any order, and together when possible
  int rank = 0;   // of two that overlap in space the higher is painted later
};

// Indices, the first to be painted first.
[[nodiscard]] std::vector<int> paint_order(std::span<const PaintItem> items, const SpaceView& view);

}  // namespace sopt
