// One stream of the parallel sampler: its own random numbers and its own trees. It stops at its
// first path; on the way it rewires as RRT* does [Leu22, III-A; Karaman, Frazzoli 2011], so the
// first path is already improved. Modes: one tree from the start with direct attempts at the goal,
// or a tree from each end that grow towards each other [Kuffner, LaValle 2000] with the same
// rewiring. Every motion is checked exactly, edge by edge.
// Bounded: one sample makes at most 3 scans and, for checks, 2 + kMaxParentTries + kMaxNeighbors to
// extend and 2 kMaxConnectSteps to connect.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "models/arm/arm.h"
#include "models/config.h"
#include "models/plane/point2.h"
#include "models/trajectory.h"
#include "rt/deadline.h"
#include "sampler/motion_checker.h"
#include "sampler/rng.h"
#include "sampler/tree.h"

namespace sopt {

// What a stream plans; the same for all streams of a rung.
template <class Robot>
struct StreamProblem {
  const Robot* robot = nullptr;
  const typename Robot::World* world = nullptr;
  MarginProfile profile;
  typename Robot::Config start{};
  typename Robot::Config goal{};
  SamplerMode mode = SamplerMode::kRrtStarConnect;
  int patience = 0;  // see SamplerTuning::kPatience
  // Only configurations through which a path can be shorter than this are sampled [Gammell,
  // Srinivasa, Barfoot 2014], as far as kInformedTries find them.
  double max_length = std::numeric_limits<double>::infinity();
};

template <class Robot>
class SamplerStream {
 public:
  using Config = typename Robot::Config;

  SamplerStream() noexcept = default;
  SamplerStream(Arena& arena, const PlannerSettings& settings) noexcept;

  // Forgets the trees and the path and plants new roots.
  void reset(const StreamProblem<Robot>& problem, const CounterRng& rng) SOPT_RT;

  // Takes up to `num_samples` samples; returns early with a path, with full trees, or when the
  // deadline expires (polled at every sample). The first call tries the motion from start to goal.
  void run(int num_samples, const Deadline& deadline) SOPT_RT;

  [[nodiscard]] bool has_path() const SOPT_RT { return !path_.vertices.empty(); }
  // More samples are useless, or nearly: no more nodes fit, or a tree is shut in.
  [[nodiscard]] bool exhausted() const SOPT_RT {
    return trees_[kStartTree].full() || trees_[kGoalTree].full() || path_overflow_ ||
           is_shut_in(kStartTree) || is_shut_in(kGoalTree);
  }
  [[nodiscard]] Path<Robot>& path() SOPT_RT { return path_; }
  [[nodiscard]] const Path<Robot>& path() const SOPT_RT { return path_; }
  [[nodiscard]] std::int64_t num_checks() const SOPT_RT { return num_checks_; }
  // A path was found but has more vertices than the settings allow.
  [[nodiscard]] bool path_overflow() const SOPT_RT { return path_overflow_; }

  // All nodes of both trees (with one tree, the other one is the goal alone), for pictures and
  // counts; parent is -1 at a root.
  [[nodiscard]] int num_nodes() const SOPT_RT;
  [[nodiscard]] const Config& node(int i) const SOPT_RT;
  [[nodiscard]] int parent(int i) const SOPT_RT;

 private:
  static constexpr std::size_t kStartTree = 0;
  static constexpr std::size_t kGoalTree = 1;
  static constexpr int kInformedTries = 16;
  // A new node tries this many parents, cheapest cost first.
  static constexpr int kMaxParentTries = 6;
  // Steps of one tree towards a new node of the other.
  static constexpr int kMaxConnectSteps = 64;
  // Deviation: of the radius that asymptotic optimality asks for, because shortening the paths is
  // cheaper than rewiring (docs/RESULTS.md).
  static constexpr double kRadiusShare = 0.5;
  // A new parent must be this much better, relative: rounding can never build a cycle.
  static constexpr double kRewireGain = 1e-9;

  using Checker = MotionChecker<Robot>;

  [[nodiscard]] Config sample() SOPT_RT;
  [[nodiscard]] int extend(Checker& checker, std::size_t i_tree, const Config& target) SOPT_RT;
  [[nodiscard]] int best_parent(Checker& checker, std::size_t i_tree, int nearest,
                                const Config& q) SOPT_RT;
  void rewire_neighbors(Checker& checker, std::size_t i_tree, int node) SOPT_RT;
  void try_goal(Checker& checker, int node) SOPT_RT;
  void try_connect(Checker& checker, std::size_t i_tree, int node) SOPT_RT;
  void store_path(int start_node, int goal_node) SOPT_RT;
  [[nodiscard]] bool motion_is_clear(Checker& checker, std::size_t i_tree, int from,
                                     const Config& to, RequestEnd to_end) SOPT_RT;
  [[nodiscard]] double rewire_radius(int num_nodes) const SOPT_RT;
  [[nodiscard]] Config steer(const Config& from, const Config& to) const SOPT_RT;
  [[nodiscard]] bool is_shut_in(std::size_t i_tree) const SOPT_RT {
    return problem_.patience > 0 &&
           num_blocked_[i_tree] > problem_.patience * trees_[i_tree].size();
  }

  StreamProblem<Robot> problem_;
  CounterRng rng_{0};
  std::array<Tree<Robot>, 2> trees_;
  NearNodes near_;
  Path<Robot> path_;
  Config box_lower_{};
  Config box_size_{};
  double range_ = 0.0;
  double radius_scale_ = 0.0;         // gamma of RRT*: radius = gamma (log n / n)^(1/dof)
  std::array<int, 2> num_blocked_{};  // extensions in a row, by tree
  std::size_t next_tree_ = kStartTree;
  std::int64_t num_checks_ = 0;
  bool path_overflow_ = false;
};

extern template class SamplerStream<Point2>;
extern template class SamplerStream<Arm<4>>;
extern template class SamplerStream<Arm<5>>;
extern template class SamplerStream<Arm<6>>;
extern template class SamplerStream<Arm<7>>;
extern template class SamplerStream<Arm<8>>;

}  // namespace sopt
