// Which boxes an axis-aligned box may touch: a tree of boxes (box_tree.h) tested four at a time.
// Build: O(n log n), no heap, at setup or between requests. Query: never misses a box.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "models/box_tree.h"
#include "models/simd.h"
#include "models/space/shape3.h"

namespace sopt {

class BroadPhase3 {
 public:
  BroadPhase3() noexcept = default;
  BroadPhase3(Arena& arena, int max_boxes) noexcept : tree_(arena, max_boxes) {}

  // Item i of a query is boxes[i]. False when there are more boxes than the capacity.
  [[nodiscard]] bool build(std::span<const Aabb3> boxes) noexcept;

  // Calls visit(i) -> bool for every box that overlaps or touches `area` (and possibly for boxes
  // about 1e-12 away), in an order that depends on the build alone; stops when visit returns
  // false. Returns false when it was stopped.
  template <class Visit>
  bool for_each_near(const Aabb3& area, Visit&& visit) const {
    return tree_.for_each_near(Query(area), static_cast<Visit&&>(visit));
  }

 private:
  static constexpr double kEmptyLane = 1e300;  // lower bound of unused lanes
  static constexpr double kMaxArea_m = 1e290;  // beyond it unused lanes would overlap

  struct Node {
    double lower[3][kTreeFanOut] = {}, upper[3][kTreeFanOut] = {};
    std::int32_t child[kTreeFanOut] = {};

    Node() noexcept {
      for (int axis = 0; axis < 3; ++axis) {
        std::fill_n(lower[axis], kTreeFanOut, kEmptyLane);
        std::fill_n(upper[axis], kTreeFanOut, -kEmptyLane);
      }
    }
    void set_box(int lane, const Aabb3& box) noexcept;
  };

  struct Query {
    Vec3 lower, upper;

    explicit Query(const Aabb3& area) noexcept
        : lower(area.lower.cwiseMax(-kMaxArea_m)), upper(area.upper.cwiseMin(kMaxArea_m)) {}

    [[nodiscard]] unsigned overlapping_lanes(const Node& node) const noexcept {
      unsigned lanes = 0;
      for (int i = 0; i < kTreeFanOut; i += kLanesDouble) {
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

  BoxTree<Aabb3, Node> tree_;
};

}  // namespace sopt
