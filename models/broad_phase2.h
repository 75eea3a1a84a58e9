// Which boxes a thick segment may touch. A bounding-volume tree with eight children per node whose
// boxes are tested four at a time; up to eight boxes are one node, so a handful of obstacles costs
// no more than a plain scan, and thousands cost what is near. Packed bottom-up by
// sort-tile-recursive order [Leutenegger, Lopez, Edgington 1997]. Build: O(n log n), no heap, at
// setup or between requests. Query: never misses a box (conservative at box corners).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "alloc/fixed_vector.h"
#include "models/convex2.h"
#include "models/simd.h"
#include "rt/annotations.h"

namespace sopt {

class BroadPhase2 {
 public:
  BroadPhase2() noexcept = default;
  BroadPhase2(Arena& arena, int max_boxes) noexcept;

  // Item i of a query is boxes[i]. False when there are more boxes than the capacity.
  [[nodiscard]] bool build(std::span<const Aabb2> boxes) noexcept;

  // Calls visit(i) -> bool for every box within `radius_m` of segment [p, q] (and possibly for
  // boxes a little further away), in an order that depends on the build alone; stops when visit
  // returns false. Returns false when it was stopped.
  template <class Visit>
  bool for_each_near(const Vec2& p, const Vec2& q, double radius_m, Visit&& visit) const {
    if (nodes_.empty()) return true;
    const ThickSegment segment(p, q, radius_m);
    std::int32_t stack[kMaxDepth * kFanOut];
    int depth = 0;
    stack[depth++] = root_;
    while (depth > 0) {
      const Node& node = nodes_[stack[--depth]];
      unsigned hits = segment.overlapping_lanes(node);
      while (hits != 0) {
        const auto lane = static_cast<unsigned>(__builtin_ctz(hits));
        hits &= hits - 1;
        const std::int32_t child = node.child[lane];
        if (child >= 0) {
          stack[depth++] = child;
        } else if (!visit(static_cast<int>(~child))) {
          return false;
        }
      }
    }
    return true;
  }

 private:
  static constexpr int kFanOut = 8;
  static constexpr int kMaxDepth = 12;           // 8^12 boxes
  static constexpr double kEmptyLane = -1e300;   // half extent of unused lanes
  static constexpr double kMaxRadius_m = 1e290;  // beyond it unused lanes would overlap

  struct Node {
    double center_x[kFanOut], center_y[kFanOut];
    double half_x[kFanOut], half_y[kFanOut];  // hugely negative in unused lanes: never overlap
    std::int32_t child[kFanOut];              // >= 0: node; < 0: ~box
  };

  struct Entry {
    Aabb2 box;
    std::int32_t child = 0;
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
      for (int i = 0; i < kFanOut; i += kLanesDouble) {
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

  void add_level(int first_entry, int num_entries) noexcept;

  FixedVector<Node> nodes_;
  FixedVector<Entry> entries_;  // scratch of the build
  std::int32_t root_ = 0;
};

}  // namespace sopt
