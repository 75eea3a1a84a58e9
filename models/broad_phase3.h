// Which boxes an axis-aligned box may touch. A bounding-volume tree with eight children per node
// whose boxes are tested four at a time; up to eight boxes are one node, so a handful of obstacles
// costs no more than a plain scan, and thousands cost what is near. Packed bottom-up by
// sort-tile-recursive order [Leutenegger, Lopez, Edgington 1997]. Build: O(n log n), no heap, at
// setup or between requests. Query: never misses a box.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "alloc/fixed_vector.h"
#include "models/shape3.h"
#include "models/simd.h"
#include "rt/annotations.h"

namespace sopt {

class BroadPhase3 {
 public:
  BroadPhase3() noexcept = default;
  BroadPhase3(Arena& arena, int max_boxes) noexcept;

  // Item i of a query is boxes[i]. False when there are more boxes than the capacity.
  [[nodiscard]] bool build(std::span<const Aabb3> boxes) noexcept;

  // Calls visit(i) -> bool for every box that overlaps or touches `area` (and possibly for boxes
  // about 1e-12 away), in an order that depends on the build alone; stops when visit returns
  // false. Returns false when it was stopped.
  template <class Visit>
  bool for_each_near(const Aabb3& area, Visit&& visit) const {
    if (nodes_.empty()) return true;
    const Query query(area);
    std::int32_t stack[kMaxDepth * kFanOut];
    int depth = 0;
    stack[depth++] = root_;
    while (depth > 0) {
      const Node& node = nodes_[stack[--depth]];
      unsigned hits = query.overlapping_lanes(node);
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
  static constexpr int kMaxDepth = 12;         // 8^12 boxes
  static constexpr double kEmptyLane = 1e300;  // lower bound of unused lanes
  static constexpr double kMaxArea_m = 1e290;  // beyond it unused lanes would overlap

  struct Node {
    double lower[3][kFanOut], upper[3][kFanOut];  // lower > upper in unused lanes: never overlap
    std::int32_t child[kFanOut];                  // >= 0: node; < 0: ~box
  };

  struct Entry {
    Aabb3 box;
    std::int32_t child = 0;
  };

  struct Query {
    Vec3 lower, upper;

    explicit Query(const Aabb3& area) noexcept
        : lower(area.lower.cwiseMax(-kMaxArea_m)), upper(area.upper.cwiseMin(kMaxArea_m)) {}

    [[nodiscard]] unsigned overlapping_lanes(const Node& node) const noexcept {
      unsigned lanes = 0;
      for (int i = 0; i < kFanOut; i += kLanesDouble) {
        V4d gap = splat4(-kEmptyLane);
        for (int axis = 0; axis < 3; ++axis) {
          gap = max4(gap, load4(node.lower[axis] + i) - upper[axis]);
          gap = max4(gap, lower[axis] - load4(node.upper[axis] + i));
        }
        lanes |= lane_mask4(gap <= splat4(0.0)) << i;
      }
      return lanes;
    }
  };

  void sort_along(int axis, int first, int last) noexcept;
  void add_node(int first_entry, int num_entries) noexcept;

  FixedVector<Node> nodes_;
  FixedVector<Entry> entries_;  // scratch of the build
  std::int32_t root_ = 0;
};

}  // namespace sopt
