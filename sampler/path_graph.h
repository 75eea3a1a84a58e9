// Combines several paths between the same ends into a shorter one: their vertices are the nodes of
// a graph, and the shortest way over any clear motions between nodes is found by A*, checking a
// motion only when it is the most promising one left [Raveh, Enosh, Halperin 2011; lazy weighted
// A*: Cohen, Phillips, Likhachev 2014]. Motions that cannot beat the best path known are never
// looked at, so a few short paths cost a few dozen checks. On long paths through many obstacles it
// makes the choice of sides piece by piece, which picking the best whole path cannot
// (docs/RESULTS.md). Deviation: the paper takes the shortest path as it is. Bounded by capacity^2
// queue entries.
#pragma once

#include "models/arm/arm.h"
#include "models/plane/point2.h"
#include "models/trajectory.h"
#include "rt/deadline.h"
#include "sampler/motion_checker.h"

namespace sopt {

inline constexpr int kMaxGraphNodes = 128;

template <class Robot>
class PathGraph {
 public:
  using Config = typename Robot::Config;

  PathGraph() noexcept = default;
  explicit PathGraph(Arena& arena) noexcept;

  // Empties the graph; the robot must outlive what follows.
  void reset(const Robot& robot) SOPT_RT;

  // Adds a path whose motions are clear; paths that no longer fit are left out.
  void add(const Path<Robot>& path) SOPT_RT;

  // Finds the shortest way from the common start to the common goal that is shorter than
  // `length_limit` and writes it to `out`. False, with `out` unchanged, when there is none, when it
  // does not fit, or when the deadline expires.
  [[nodiscard]] bool find_shorter(MotionChecker<Robot>& checker, const Deadline& deadline,
                                  double length_limit, Path<Robot>& out) SOPT_RT;

 private:
  static constexpr int kStart = 0;
  static constexpr int kGoal = 1;

  struct Node {
    Config config{};
    double to_goal = 0.0;     // straight path length to the goal: the heuristic
    double from_start = 0.0;  // along the tree of closed nodes
    int parent = -1;
    int next_on_path = -1;  // motion to this node is known to be clear
    bool is_closed = false;
  };

  // A motion that may become the way to node `to`.
  struct Candidate {
    double through = 0.0;  // lower bound of a way over it
    int from = 0;
    int to = 0;
  };

  // Heap order: the smallest lower bound on top.
  static bool is_later(const Candidate& a, const Candidate& b) SOPT_RT {
    return a.through != b.through ? a.through > b.through : a.to > b.to;
  }

  [[nodiscard]] RequestEnd end_of(int i) const SOPT_RT;
  [[nodiscard]] bool are_neighbors(int a, int b) const SOPT_RT;
  void close(int i, int parent, double length_limit) SOPT_RT;
  [[nodiscard]] bool store(Path<Robot>& out) const SOPT_RT;

  const Robot* robot_ = nullptr;
  FixedVector<Node> nodes_;
  FixedVector<Candidate> queue_;  // binary heap, smallest `through` first
};

extern template class PathGraph<Point2>;
extern template class PathGraph<Arm<4>>;
extern template class PathGraph<Arm<5>>;
extern template class PathGraph<Arm<6>>;
extern template class PathGraph<Arm<7>>;
extern template class PathGraph<Arm<8>>;

}  // namespace sopt
