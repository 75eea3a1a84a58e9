// A tree of configurations in fixed storage, with costs from the root. Neighbour search is a linear
// scan over structure-of-arrays floats, eight nodes at a time: below 8 k nodes in 2-D it beats
// kd-trees (docs/RESULTS.md) and needs no upkeep. Joints that turn without end count the short way,
// all of them by their weights. Floats only choose neighbours; every length that enters a cost is
// computed in double from the configurations.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "alloc/fixed_vector.h"
#include "models/capacity.h"
#include "models/simd.h"
#include "rt/annotations.h"

namespace sopt {

inline constexpr int kNoNode = -1;

// Result of one scan: the nearest node, and up to kMaxNeighbors nodes within a radius (the nearest
// ones if there are more).
struct NearNodes {
  int nearest = kNoNode;
  int count = 0;
  std::array<int, kMaxNeighbors> index{};
  std::array<float, kMaxNeighbors> distance2{};
};

template <class Robot>
class Tree {
 public:
  using Config = typename Robot::Config;

  Tree() noexcept = default;
  Tree(Arena& arena, int max_nodes) noexcept;

  // Empties the tree and plants its root. The robot must outlive what follows.
  void reset(const Robot& robot, const Config& root) SOPT_RT;

  [[nodiscard]] int size() const SOPT_RT { return nodes_.size(); }
  [[nodiscard]] bool full() const SOPT_RT { return nodes_.size() == nodes_.capacity(); }
  [[nodiscard]] const Config& config(int i) const SOPT_RT { return nodes_[i].config; }
  [[nodiscard]] int parent(int i) const SOPT_RT { return nodes_[i].parent; }
  [[nodiscard]] double cost(int i) const SOPT_RT { return nodes_[i].cost; }

  // Adds a node; kNoNode when the tree is full.
  int try_add(const Config& config, int parent) SOPT_RT;

  // One pass: nearest node to `q`, and the nodes within `radius` (0: nearest only).
  void find_near(const Config& q, double radius, NearNodes& out) const SOPT_RT;

  // Makes `parent` the parent of `node` and lowers the costs below it, at most kMaxPropagation
  // nodes: never recursive. Beyond the bound costs stay too high, which is safe (they are upper
  // bounds) and is corrected when the path is extracted. `parent` must not lie below `node`; a
  // strictly lower cost guarantees that.
  void rewire(int node, int parent) SOPT_RT;

 private:
  static constexpr int kMaxPropagation = 256;

  struct Node {
    Config config{};
    double cost = 0.0;
    int parent = kNoNode;
    int first_child = kNoNode;
    int next_sibling = kNoNode;
    int previous_sibling = kNoNode;
  };

  void link(int node, int parent) SOPT_RT;
  void unlink(int node) SOPT_RT;

  const Robot* robot_ = nullptr;
  FixedVector<Node> nodes_;
  std::array<float*, Robot::kDof> coordinate_{};  // [dof][node], padded to whole lanes
};

}  // namespace sopt
