#include "sampler/tree.h"

#include <algorithm>

#include "models/arm/arm.h"
#include "models/plane/point2.h"

namespace sopt {
namespace {

constexpr float kFar = 1e18F;  // padding lanes: squared it is still finite

// Adds a node within `limit2`. When there is no room it takes the place of the farthest, and
// `limit2` shrinks to what could still replace one.
void keep_nearest(NearNodes& near, int index, float distance2, float& limit2) noexcept {
  auto slot = static_cast<std::size_t>(near.count);
  if (near.count < kMaxNeighbors) {
    ++near.count;
  } else {
    slot = static_cast<std::size_t>(std::max_element(near.distance2.begin(), near.distance2.end()) -
                                    near.distance2.begin());
  }
  near.index[slot] = index;
  near.distance2[slot] = distance2;
  if (near.count == kMaxNeighbors) {
    limit2 = *std::max_element(near.distance2.begin(), near.distance2.end());
  }
}

// Differences of angles, less whole turns. Padding stays far.
[[gnu::always_inline]] inline V8f short_way8(const V8f& d) noexcept {
  constexpr float kTurn = 6.28318530717958647692F;
  constexpr float kRounder = 0x1.8p23F;  // adding it rounds to an integer
  const V8f turns = (d * (1.0F / kTurn) + kRounder) - kRounder;
  return abs8(d) < splat8(0.5F * kFar) ? d - turns * kTurn : d;
}

}  // namespace

template <class Robot>
Tree<Robot>::Tree(Arena& arena, int max_nodes) noexcept : nodes_(arena, max_nodes) {
  for (float*& axis : coordinate_) {
    axis = arena.take<float>(static_cast<std::size_t>(max_nodes) + kLanesFloat);
  }
}

template <class Robot>
void Tree<Robot>::reset(const Robot& robot, const Config& root) SOPT_RT {
  robot_ = &robot;
  nodes_.clear();
  try_add(root, kNoNode);
}

template <class Robot>
int Tree<Robot>::try_add(const Config& config, int parent) SOPT_RT {
  Node node;
  node.config = config;
  if (parent != kNoNode) {
    node.cost = nodes_[parent].cost + robot_->path_distance(nodes_[parent].config, config);
  }
  if (!nodes_.try_push_back(node)) return kNoNode;
  const int i_node = nodes_.size() - 1;
  for (int dof = 0; dof < Robot::kDof; ++dof) {
    float* const axis = coordinate_[static_cast<std::size_t>(dof)];
    axis[i_node] = static_cast<float>(config[dof]);
    if (i_node % kLanesFloat == 0) std::fill_n(axis + i_node + 1, kLanesFloat - 1, kFar);
  }
  if (parent != kNoNode) link(i_node, parent);
  return i_node;
}

template <class Robot>
void Tree<Robot>::find_near(const Config& q, double radius, NearNodes& out) const SOPT_RT {
  auto limit2 = static_cast<float>(radius * radius);
  V8f best = splat8(std::numeric_limits<float>::infinity());
  V8i best_index{};
  V8i index{0, 1, 2, 3, 4, 5, 6, 7};
  out.count = 0;
  const Config weights = robot_->weights();
  for (int i = 0; i < nodes_.size(); i += kLanesFloat, index += kLanesFloat) {
    V8f distance2 = splat8(0.0F);
    for (int dof = 0; dof < Robot::kDof; ++dof) {
      V8f d = load8(coordinate_[static_cast<std::size_t>(dof)] + i) - static_cast<float>(q[dof]);
      if (robot_->is_continuous(dof)) d = short_way8(d);
      d *= static_cast<float>(weights[dof]);
      distance2 += d * d;
    }
    best_index = distance2 < best ? index : best_index;
    best = distance2 < best ? distance2 : best;
    unsigned hits = lane_mask8(distance2 < splat8(limit2));
    while (hits != 0) {
      const int lane = __builtin_ctz(hits);
      hits &= hits - 1;
      if (distance2[lane] < limit2) keep_nearest(out, i + lane, distance2[lane], limit2);
    }
  }
  int nearest_lane = 0;
  for (int lane = 1; lane < kLanesFloat; ++lane) {
    const bool tie = best[lane] == best[nearest_lane];
    if (best[lane] < best[nearest_lane] || (tie && best_index[lane] < best_index[nearest_lane])) {
      nearest_lane = lane;
    }
  }
  out.nearest = best_index[nearest_lane];
}

template <class Robot>
void Tree<Robot>::link(int node, int parent) SOPT_RT {
  Node& child = nodes_[node];
  Node& above = nodes_[parent];
  child.parent = parent;
  child.previous_sibling = kNoNode;
  child.next_sibling = above.first_child;
  if (above.first_child != kNoNode) nodes_[above.first_child].previous_sibling = node;
  above.first_child = node;
}

template <class Robot>
void Tree<Robot>::unlink(int node) SOPT_RT {
  const Node& child = nodes_[node];
  if (child.previous_sibling != kNoNode) {
    nodes_[child.previous_sibling].next_sibling = child.next_sibling;
  } else {
    nodes_[child.parent].first_child = child.next_sibling;
  }
  if (child.next_sibling != kNoNode) {
    nodes_[child.next_sibling].previous_sibling = child.previous_sibling;
  }
}

template <class Robot>
void Tree<Robot>::rewire(int node, int parent) SOPT_RT {
  unlink(node);
  link(node, parent);
  // Breadth first over a bounded queue of nodes whose parent's cost changed.
  std::array<int, kMaxPropagation> queue{};
  std::size_t head = 0;
  std::size_t tail = 0;
  queue[tail++] = node;
  while (head < tail) {
    Node& current = nodes_[queue[head++]];
    const Node& above = nodes_[current.parent];
    current.cost = above.cost + robot_->path_distance(above.config, current.config);
    for (int child = current.first_child; child != kNoNode && tail < queue.size();
         child = nodes_[child].next_sibling) {
      queue[tail++] = child;
    }
  }
}

template class Tree<Point2>;
template class Tree<Arm<4>>;
template class Tree<Arm<5>>;
template class Tree<Arm<6>>;
template class Tree<Arm<7>>;
template class Tree<Arm<8>>;

}  // namespace sopt
