// A tree of bounding boxes with eight children per node, whatever the boxes and the queries are: up
// to eight boxes are one node, so a handful costs no more than a plain scan, and thousands cost
// what is near. Packed bottom-up from boxes in sort-tile-recursive order [Leutenegger, Lopez,
// Edgington 1997], which the owner brings them into. No heap.
// Box: vectors `lower` and `upper`. Node: std::int32_t child[kTreeFanOut] (>= 0: node; < 0: ~box);
// made with lanes that no query overlaps; set_box(lane, box). Query: overlapping_lanes(node), a bit
// per lane.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>

#include "alloc/fixed_vector.h"
#include "rt/annotations.h"

namespace sopt {

inline constexpr int kTreeFanOut = 8;

// a / b, rounded up.
[[nodiscard]] constexpr int divided_up(int a, int b) noexcept { return (a + b - 1) / b; }

template <class Box, class Node>
class BoxTree {
 public:
  BoxTree() noexcept = default;
  BoxTree(Arena& arena, int max_boxes) noexcept
      : nodes_(arena, max_nodes(max_boxes)), entries_(arena, max_boxes) {}

  // Calls sort(num_boxes), which calls sort_along, and packs runs of eight. False when there are
  // more boxes than the capacity.
  template <class Sort>
  [[nodiscard]] bool build(std::span<const Box> boxes, Sort&& sort) noexcept {
    nodes_.clear();
    if (boxes.size() > static_cast<std::size_t>(entries_.capacity())) return false;
    const int num_boxes = static_cast<int>(boxes.size());
    if (num_boxes == 0) return true;
    if (!entries_.try_resize(num_boxes)) return false;
    for (int i = 0; i < num_boxes; ++i) entries_[i] = {boxes[static_cast<std::size_t>(i)], ~i};
    sort(num_boxes);
    for (int num_entries = num_boxes;;) {
      const int first_node = nodes_.size();
      for (int first = 0; first < num_entries; first += kTreeFanOut) {
        add_node(first, std::min(kTreeFanOut, num_entries - first));
      }
      num_entries = nodes_.size() - first_node;
      if (num_entries == 1) {
        root_ = first_node;
        return true;
      }
    }
  }

  // Sorts boxes [first, last) by their centers. Ties are broken by index, so the order depends on
  // the boxes alone.
  void sort_along(int axis, int first, int last) noexcept {
    std::sort(entries_.begin() + first, entries_.begin() + last,
              [axis](const Entry& a, const Entry& b) {
                const double at_a = a.box.lower[axis] + a.box.upper[axis];
                const double at_b = b.box.lower[axis] + b.box.upper[axis];
                return at_a != at_b ? at_a < at_b : a.child > b.child;
              });
  }

  // Calls visit(i) -> bool for every box that `query` overlaps, in an order that depends on the
  // build alone; stops when visit returns false. Returns false when it was stopped.
  template <class Query, class Visit>
  bool for_each_near(const Query& query, Visit&& visit) const {
    if (nodes_.empty()) return true;
    std::int32_t stack[kMaxDepth * kTreeFanOut];
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
  static constexpr int kMaxDepth = 12;  // 8^12 boxes

  struct Entry {
    Box box;
    std::int32_t child = 0;
  };

  // All levels together: at most n/8 + n/64 + .. plus one partial per level.
  [[nodiscard]] static constexpr int max_nodes(int max_boxes) noexcept {
    return max_boxes / (kTreeFanOut - 1) + kMaxDepth + 1;
  }

  // Packs entries [first_entry, first_entry + num_entries) into one new node and replaces them, at
  // the position of that node among its level, by the node's own entry.
  void add_node(int first_entry, int num_entries) noexcept {
    using Corner = decltype(Box::lower);
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Node node;
    Box all{Corner::Constant(kInfinity), Corner::Constant(-kInfinity)};
    for (int lane = 0; lane < num_entries; ++lane) {
      const Entry& entry = entries_[first_entry + lane];
      node.set_box(lane, entry.box);
      node.child[lane] = entry.child;
      all.lower = all.lower.cwiseMin(entry.box.lower);
      all.upper = all.upper.cwiseMax(entry.box.upper);
    }
    const int i_node = nodes_.size();
    if (!nodes_.try_push_back(node)) return;  // cannot happen: max_nodes covers every level
    entries_[first_entry / kTreeFanOut] = {all, i_node};
  }

  FixedVector<Node> nodes_;
  FixedVector<Entry> entries_;  // scratch of the build
  std::int32_t root_ = 0;
};

}  // namespace sopt
