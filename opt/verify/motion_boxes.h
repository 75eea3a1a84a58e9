// Boxes around runs of consecutive motions of a trajectory, and around pairs of those and so on up
// to the whole, so that `verify` passes by what an obstacle is far from: of H motions an obstacle
// away from the path looks at one box, one beside it at about log H. At most 256 runs, of 16
// motions at least. Knows nothing of the world's broad phase: verify shares no code with what it
// checks.
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "models/plane/point2.h"
#include "models/trajectory.h"

namespace sopt {

class MotionBoxes {
 public:
  explicit MotionBoxes(const Trajectory<Point2>& trajectory) noexcept
      : horizon_(trajectory.horizon()),
        run_(std::max(kMinRun, (trajectory.horizon() + kMaxRuns - 1) / kMaxRuns)) {
    const int num_runs = (horizon_ + run_ - 1) / run_;
    while (num_leaves_ < num_runs) num_leaves_ *= 2;
    for (int i = 0; i < num_leaves_; ++i) {
      Aabb2& box = boxes_[static_cast<std::size_t>(num_leaves_ + i)];
      box = {Vec2::Constant(kInfinity), Vec2::Constant(-kInfinity)};
      for (int t = i * run_; t <= std::min(horizon_, (i + 1) * run_) && i < num_runs; ++t) {
        box.lower = box.lower.cwiseMin(trajectory.states[t]);
        box.upper = box.upper.cwiseMax(trajectory.states[t]);
      }
    }
    for (auto node = static_cast<std::size_t>(num_leaves_) - 1; node > 0; --node) {
      const Aabb2& left = boxes_[2 * node];
      const Aabb2& right = boxes_[2 * node + 1];
      boxes_[node] = {left.lower.cwiseMin(right.lower), left.upper.cwiseMax(right.upper)};
    }
  }

  // In the order of time: asks is_relevant(first, box) whether motions from `first` on, all within
  // `box`, are worth a look, and calls visit(first, last) for runs [first, last) that are.
  template <class IsRelevant, class Visit>
  void for_each_run(IsRelevant&& is_relevant, Visit&& visit) const {
    int node = 1;
    int width = num_leaves_;  // leaves below `node`
    while (true) {
      const int first = (node * width - num_leaves_) * run_;
      const bool is_inside =
          first < horizon_ && is_relevant(first, boxes_[static_cast<std::size_t>(node)]);
      if (is_inside && width > 1) {
        node *= 2;
        width /= 2;
        continue;
      }
      if (is_inside) visit(first, std::min(horizon_, first + run_));
      for (; node % 2 == 1; node /= 2) width *= 2;  // right children: their parent is done too
      if (node == 0) return;
      ++node;
    }
  }

 private:
  static constexpr int kMaxRuns = 256;
  static constexpr int kMinRun = 16;
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  int horizon_;
  int run_;
  int num_leaves_ = 1;
  std::array<Aabb2, 2 * kMaxRuns>
      boxes_;  // a heap: the root is 1, below node i are 2 i and 2 i + 1
};

}  // namespace sopt
