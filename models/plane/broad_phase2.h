// Which boxes a thick segment may touch: a tree of boxes (box_tree.h) tested four at a time. Build:
// O(n log n), no heap, at setup or between requests. Query: never misses a box (conservative at box
// corners).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "models/box_tree.h"
#include "models/plane/convex2.h"
#include "models/simd.h"

namespace sopt {

class BroadPhase2 {
 public:
  BroadPhase2() noexcept = default;
  BroadPhase2(Arena& arena, int max_boxes) noexcept : tree_(arena, max_boxes) {}

  // Item i of a query is boxes[i]. False when there are more boxes than the capacity.
  [[nodiscard]] bool build(std::span<const Aabb2> boxes) noexcept;

  // Calls visit(i) -> bool for every box within `radius_m` of segment [p, q] (and possibly for
  // boxes a little further away), in an order that depends on the build alone; stops when visit
  // returns false. Returns false when it was stopped.
  template <class Visit>
  bool for_each_near(const Vec2& p, const Vec2& q, double radius_m, Visit&& visit) const {
    return tree_.for_each_near(ThickSegment(p, q, radius_m), static_cast<Visit&&>(visit));
  }

 private:
  static constexpr double kEmptyLane = -1e300;   // half extent of unused lanes
  static constexpr double kMaxRadius_m = 1e290;  // beyond it unused lanes would overlap

  struct Node {
    double center_x[kTreeFanOut] = {}, center_y[kTreeFanOut] = {};
    double half_x[kTreeFanOut] = {}, half_y[kTreeFanOut] = {};
    std::int32_t child[kTreeFanOut] = {};

    Node() noexcept {
      std::fill_n(half_x, kTreeFanOut, kEmptyLane);
      std::fill_n(half_y, kTreeFanOut, kEmptyLane);
    }
    void set_box(int lane, const Aabb2& box) noexcept;
  };

  struct ThickSegment {
    double mid_x, mid_y;  // of the segment
    double radius;
    double half_x, half_y;  // half extents of the segment grown by the radius
    double dir_x, dir_y;    // unit direction; zero for a point

    ThickSegment(const Vec2& p, const Vec2& q, double radius_m) noexcept
        : mid_x(0.5 * (p.x() + q.x())),
          mid_y(0.5 * (p.y() + q.y())),
          radius(std::min(radius_m, kMaxRadius_m)) {
      half_x = 0.5 * std::abs(q.x() - p.x()) + radius;
      half_y = 0.5 * std::abs(q.y() - p.y()) + radius;
      const double length2 = (q - p).squaredNorm();
      const double inv = length2 > 0.0 ? 1.0 / std::sqrt(length2) : 0.0;
      dir_x = (q.x() - p.x()) * inv;
      dir_y = (q.y() - p.y()) * inv;
    }

    // Separating axes: the box's two and the segment's normal.
    [[nodiscard]] unsigned overlapping_lanes(const Node& node) const noexcept {
      unsigned lanes = 0;
      for (int i = 0; i < kTreeFanOut; i += kLanesDouble) {
        const V4d dx = load4(node.center_x + i) - mid_x;
        const V4d dy = load4(node.center_y + i) - mid_y;
        const V4d hx = load4(node.half_x + i);
        const V4d hy = load4(node.half_y + i);
        const V4d side = abs4(dir_x * dy - dir_y * dx);
        const V4d reach = hx * std::abs(dir_y) + hy * std::abs(dir_x) + radius;
        const V4d gap = max4(max4(abs4(dx) - hx - half_x, abs4(dy) - hy - half_y), side - reach);
        lanes |= lane_mask4(gap <= splat4(0.0)) << i;
      }
      return lanes;
    }
  };

  BoxTree<Aabb2, Node> tree_;
};

}  // namespace sopt
