#include "models/broad_phase3.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sopt {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Nodes over n entries, all levels together: at most n/8 + n/64 + .. plus one partial per level.
int max_nodes(int max_boxes, int fan_out, int max_depth) noexcept {
  return max_boxes / (fan_out - 1) + max_depth + 1;
}

int divided_up(int a, int b) noexcept { return (a + b - 1) / b; }

}  // namespace

BroadPhase3::BroadPhase3(Arena& arena, int max_boxes) noexcept
    : nodes_(arena, max_nodes(max_boxes, kFanOut, kMaxDepth)), entries_(arena, max_boxes) {}

bool BroadPhase3::build(std::span<const Aabb3> boxes) noexcept {
  nodes_.clear();
  if (boxes.size() > static_cast<std::size_t>(entries_.capacity())) return false;
  const int num_boxes = static_cast<int>(boxes.size());
  if (num_boxes == 0) return true;

  if (!entries_.try_resize(num_boxes)) return false;
  for (int i = 0; i < num_boxes; ++i) entries_[i] = {boxes[static_cast<std::size_t>(i)], ~i};
  // Slabs of equal count along x, each cut into bars along y, each sorted along z; runs of eight
  // become nodes.
  const int num_leaves = divided_up(num_boxes, kFanOut);
  const int num_slabs = static_cast<int>(std::ceil(std::cbrt(num_leaves)));
  const int bar = divided_up(num_leaves, num_slabs * num_slabs) * kFanOut;
  const int slab = num_slabs * bar;
  sort_along(0, 0, num_boxes);
  for (int first = 0; first < num_boxes; first += slab) {
    const int last = std::min(first + slab, num_boxes);
    sort_along(1, first, last);
    for (int i = first; i < last; i += bar) sort_along(2, i, std::min(i + bar, last));
  }

  for (int num_entries = num_boxes;;) {
    const int first_node = nodes_.size();
    for (int first = 0; first < num_entries; first += kFanOut) {
      add_node(first, std::min(kFanOut, num_entries - first));
    }
    num_entries = nodes_.size() - first_node;
    if (num_entries == 1) {
      root_ = first_node;
      return true;
    }
  }
}

// Ties are broken by index, so the order depends on the boxes alone.
void BroadPhase3::sort_along(int axis, int first, int last) noexcept {
  std::sort(entries_.begin() + first, entries_.begin() + last,
            [axis](const Entry& a, const Entry& b) {
              const double at_a = a.box.lower[axis] + a.box.upper[axis];
              const double at_b = b.box.lower[axis] + b.box.upper[axis];
              return at_a != at_b ? at_a < at_b : a.child > b.child;
            });
}

// Packs entries [first_entry, first_entry + num_entries) into one new node and replaces them, at
// the position of that node among its level, by the node's own entry.
void BroadPhase3::add_node(int first_entry, int num_entries) noexcept {
  Node node{};
  Aabb3 all{Vec3::Constant(kInfinity), Vec3::Constant(-kInfinity)};
  for (int lane = 0; lane < kFanOut; ++lane) {
    for (int axis = 0; axis < 3; ++axis) {
      node.lower[axis][lane] = kEmptyLane;
      node.upper[axis][lane] = -kEmptyLane;
    }
    if (lane >= num_entries) continue;
    const Entry& entry = entries_[first_entry + lane];
    for (int axis = 0; axis < 3; ++axis) {
      // Room for the rounding of whoever computes the box of a query.
      const double room = 1e-12 * (1.0 + entry.box.lower.cwiseAbs().maxCoeff() +
                                   entry.box.upper.cwiseAbs().maxCoeff());
      node.lower[axis][lane] = entry.box.lower[axis] - room;
      node.upper[axis][lane] = entry.box.upper[axis] + room;
    }
    node.child[lane] = entry.child;
    all.lower = all.lower.cwiseMin(entry.box.lower);
    all.upper = all.upper.cwiseMax(entry.box.upper);
  }
  const int i_node = nodes_.size();
  if (!nodes_.try_push_back(node)) return;  // cannot happen: max_nodes covers every level
  entries_[first_entry / kFanOut] = {all, i_node};
}

}  // namespace sopt
