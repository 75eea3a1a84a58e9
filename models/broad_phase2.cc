#include "models/broad_phase2.h"

#include <algorithm>
#include <limits>

namespace sopt {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Nodes over n entries, all levels together: at most n/8 + n/64 + .. plus one partial per level.
int max_nodes(int max_boxes, int fan_out, int max_depth) noexcept {
  return max_boxes / (fan_out - 1) + max_depth + 1;
}

Vec2 doubled_center(const Aabb2& box) noexcept { return box.lower + box.upper; }

}  // namespace

BroadPhase2::BroadPhase2(Arena& arena, int max_boxes) noexcept
    : nodes_(arena, max_nodes(max_boxes, kFanOut, kMaxDepth)), entries_(arena, max_boxes) {}

bool BroadPhase2::build(std::span<const Aabb2> boxes) noexcept {
  nodes_.clear();
  if (boxes.size() > static_cast<std::size_t>(entries_.capacity())) return false;
  const int num_boxes = static_cast<int>(boxes.size());
  if (num_boxes == 0) return true;

  if (!entries_.try_resize(num_boxes)) return false;
  for (int i = 0; i < num_boxes; ++i) entries_[i] = {boxes[static_cast<std::size_t>(i)], ~i};
  // Slices of equal count along x, each sorted along y; runs of eight become nodes. Ties are broken
  // by index, so the order depends on the boxes alone.
  const auto less_along = [](int axis) {
    return [axis](const Entry& a, const Entry& b) {
      const double at_a = doubled_center(a.box)[axis];
      const double at_b = doubled_center(b.box)[axis];
      return at_a != at_b ? at_a < at_b : a.child > b.child;
    };
  };
  const int num_leaves = (num_boxes + kFanOut - 1) / kFanOut;
  const int num_slices = static_cast<int>(std::ceil(std::sqrt(num_leaves)));
  const int slice = (num_leaves + num_slices - 1) / num_slices * kFanOut;
  std::sort(entries_.begin(), entries_.end(), less_along(0));
  for (int first = 0; first < num_boxes; first += slice) {
    const int last = std::min(first + slice, num_boxes);
    std::sort(entries_.begin() + first, entries_.begin() + last, less_along(1));
  }

  for (int num_entries = num_boxes;;) {
    const int first_node = nodes_.size();
    for (int first = 0; first < num_entries; first += kFanOut) {
      add_level(first, std::min(kFanOut, num_entries - first));
    }
    num_entries = nodes_.size() - first_node;
    if (num_entries == 1) {
      root_ = first_node;
      return true;
    }
  }
}

// Packs entries [first_entry, first_entry + num_entries) into one new node and replaces them, at
// the position of that node among its level, by the node's own entry.
void BroadPhase2::add_level(int first_entry, int num_entries) noexcept {
  Node node{};
  Aabb2 all{Vec2::Constant(kInfinity), Vec2::Constant(-kInfinity)};
  for (int lane = 0; lane < kFanOut; ++lane) {
    node.half_x[lane] = node.half_y[lane] = kEmptyLane;
    if (lane >= num_entries) continue;
    const Entry& entry = entries_[first_entry + lane];
    const Vec2 center = 0.5 * doubled_center(entry.box);
    // Rounded outwards: center +- half must cover the box whatever the rounding.
    const Vec2 half =
        (entry.box.upper - center).cwiseMax(center - entry.box.lower) * (1.0 + 1e-12) +
        Vec2::Constant(1e-12 * (1.0 + center.cwiseAbs().maxCoeff()));
    node.center_x[lane] = center.x();
    node.center_y[lane] = center.y();
    node.half_x[lane] = half.x();
    node.half_y[lane] = half.y();
    node.child[lane] = entry.child;
    all.lower = all.lower.cwiseMin(entry.box.lower);
    all.upper = all.upper.cwiseMax(entry.box.upper);
  }
  const int i_node = nodes_.size();
  if (!nodes_.try_push_back(node)) return;  // cannot happen: max_nodes covers every level
  entries_[first_entry / kFanOut] = {all, i_node};
}

}  // namespace sopt
