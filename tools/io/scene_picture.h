// The scene's part of a picture: the map from world to page, obstacles, bounds, start and goal,
// scale bar. World coordinates have y up, pages y down; widths of lines are in pixels.
#pragma once

#include <span>
#include <vector>

#include "tools/io/scene_file.h"
#include "tools/io/svg.h"

namespace sopt {

// The bounds, grown to show a start or goal that lies a little outside.
[[nodiscard]] Aabb2 view_of(const Scene& scene);

class SceneMap {
 public:
  // The largest map of `view` with its corner at the page's `corner` that fits into `room`.
  SceneMap(const Aabb2& view, const Vec2& corner, const Vec2& room);

  [[nodiscard]] Vec2 at(const Vec2& world) const {
    return {corner_.x() + scale_ * (world.x() - view_.lower.x()),
            corner_.y() + scale_ * (view_.upper.y() - world.y())};
  }
  // As `at`, moved onto the map's frame when it lies beyond.
  [[nodiscard]] Vec2 at_or_on_frame(const Vec2& world) const {
    return at(world.cwiseMax(view_.lower).cwiseMin(view_.upper));
  }
  [[nodiscard]] std::vector<Vec2> at(std::span<const Vec2> world) const;
  [[nodiscard]] bool is_beyond(const Vec2& world) const {
    return (world.array() < view_.lower.array()).any() ||
           (world.array() > view_.upper.array()).any();
  }
  [[nodiscard]] double px(double length_m) const { return scale_ * length_m; }
  [[nodiscard]] const Vec2& corner() const { return corner_; }
  [[nodiscard]] const Vec2& size() const { return size_; }

 private:
  Aabb2 view_;
  double scale_ = 1.0;  // pixels per metre
  Vec2 corner_, size_;
};

// Obstacle `i_culprit`, when there is one, in red.
void draw_obstacles(const World2& world, int i_culprit, const SceneMap& map, Svg& svg);
// In red when they are the culprit.
void draw_bounds(const World2& world, int i_culprit, const SceneMap& map, Svg& svg);
// Start: a disc with S, goal: a diamond with G; around it a disc of the given radius.
void draw_end(const Vec2& at, double radius_px, bool is_start, Svg& svg);
// Below the map.
void draw_scale_bar(const SceneMap& map, Svg& svg);

}  // namespace sopt
