// Where an isometric view stands on a page, with the floor and the scales: a grid below everything
// whose edges lie on round numbers, numbers in m along its two front edges and upwards at its left.
#pragma once

#include <span>
#include <vector>

#include "tools/io/space_view.h"
#include "tools/io/svg.h"

namespace sopt {

[[nodiscard]] Aabb3 joined(const Aabb3& a, const Aabb3& b);

class SpacePage {
 public:
  // `boxes` are all seen, with the floor below them. On the page the map is as wide as `room` and
  // as high as it needs to be, at most room.y(); its corner is at `corner`.
  SpacePage(const SpaceView& view, std::span<const Aabb3> boxes, const Vec2& corner,
            const Vec2& room);

  [[nodiscard]] Vec2 at(const Vec3& p) const { return at(view_.at(p)); }
  [[nodiscard]] std::vector<Vec2> at(std::span<const Vec3> points) const;
  [[nodiscard]] Vec2 at(const Vec2& seen) const { return origin_ + scale_ * seen; }
  [[nodiscard]] std::vector<Vec2> at(std::span<const Vec2> seen) const;
  [[nodiscard]] const SpaceView& view() const { return view_; }
  [[nodiscard]] const Vec2& corner() const { return corner_; }
  [[nodiscard]] const Vec2& size() const { return size_; }

  // The grid, and on it the shadow of a path in space.
  void draw_floor(std::span<const Vec3> path, Svg& svg) const;
  void draw_scales(Svg& svg) const;

 private:
  [[nodiscard]] Aabb2 seen_box(std::span<const Aabb3> boxes) const;
  // Of the floor: the nearest to the viewer, the one from there along an axis, the leftmost.
  [[nodiscard]] Vec3 front_corner() const { return corner_at(true, true); }
  [[nodiscard]] Vec3 corner_along(int axis) const { return corner_at(axis != 0, axis != 1); }
  [[nodiscard]] Vec3 left_corner() const;
  [[nodiscard]] Vec3 corner_at(bool near_x, bool near_y) const;
  // Of grid line i across an axis.
  [[nodiscard]] double value(int axis, int i) const { return (first_[axis] + i) * step_m_; }
  void draw_scale(const Vec3& from, int axis, const Vec2& aside, Svg& svg) const;

  const SpaceView view_;
  double step_m_ = 1.0;
  Eigen::Vector3i first_, num_cells_;  // of the grid, in steps
  double scale_ = 1.0;                 // pixels per m
  Vec2 corner_, size_, origin_;
};

}  // namespace sopt
