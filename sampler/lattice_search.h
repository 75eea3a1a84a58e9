// A way that random samples would be long to find: Lazy Theta* [Nash, Koenig, Tovey 2010], A* whose
// motions may pass by points, over a square lattice of configurations with eight neighbours each,
// every motion checked exactly; then over one of half the spacing, as long as its points fit. Of n
// rooms in a row a uniform sample falls into the next one once in n, so that a tree takes n^2
// samples and, with its neighbour search, n^3 time; the lattice takes time in proportion to the
// free area (docs/RESULTS.md). Complete up to its spacing.
// Deviation: the paper samples only. Robots of more than two dimensions have no lattice: the empty
// primary template never finds a way.
// Deterministic; no heap; at most kLatticeLevels x max_points clearance queries and 9 checks per
// point.
#pragma once

#include <cstdint>

#include "alloc/fixed_vector.h"
#include "models/plane/point2.h"
#include "models/trajectory.h"
#include "rt/deadline.h"
#include "sampler/motion_checker.h"

namespace sopt {

// Level k has about 4096 4^k points.
inline constexpr int kLatticeLevels = 3;

template <class Robot>
class LatticeSearch {
 public:
  LatticeSearch() noexcept = default;
  LatticeSearch(Arena& /*arena*/, int /*max_points*/) noexcept {}

  [[nodiscard]] bool find_path(MotionChecker<Robot>& /*checker*/,
                               const typename Robot::Config& /*start*/,
                               const typename Robot::Config& /*goal*/, int /*first_level*/,
                               const Deadline& /*deadline*/, Path<Robot>& /*out*/) SOPT_RT {
    return false;
  }
};

template <>
class LatticeSearch<Point2> {
 public:
  LatticeSearch() noexcept = default;
  LatticeSearch(Arena& arena, int max_points) noexcept;

  // Writes a path from `start` to `goal` whose motions `checker` finds clear, from the coarsest
  // lattice from `first_level` on that has one; finer ones know more ways around obstacles. False,
  // with `out` empty, when no level has a path, when it has too many vertices, or when the deadline
  // expires.
  [[nodiscard]] bool find_path(MotionChecker<Point2>& checker, const Vec2& start, const Vec2& goal,
                               int first_level, const Deadline& deadline,
                               Path<Point2>& out) SOPT_RT;

 private:
  using Checker = MotionChecker<Point2>;

  static constexpr int kCoarsestPoints = 4096;
  static constexpr int kDeadlineStride = 64;
  static constexpr int kNoPoint = -1;
  static constexpr float kBlocked = -1.0F;
  static constexpr float kUnseen = -2.0F;

  struct Point {
    float from_start = 0.0F;     // length of the best way known
    float total = 0.0F;          // + straight to the goal
    float excess_m = kUnseen;    // clearance beyond what any obstacle asks for, or kBlocked
    std::int32_t parent = -1;    // -1: the start; of an open point perhaps out of sight
    std::int32_t neighbor = -1;  // from which the point was reached, in sight
    std::int32_t heap_slot = kNoPoint;
    bool is_closed = false;
  };

  [[nodiscard]] bool lay_out(const Aabb2& box, int num_points) SOPT_RT;
  [[nodiscard]] bool search(Checker& checker, const Deadline& deadline) SOPT_RT;
  void leave_start(Checker& checker) SOPT_RT;
  void settle(Checker& checker, int point) SOPT_RT;
  void expand(Checker& checker, int point) SOPT_RT;
  void try_reach(Checker& checker, int from, int point) SOPT_RT;
  void open(int point, int parent, int neighbor) SOPT_RT;
  [[nodiscard]] bool is_held(Checker& checker, int from, int point) SOPT_RT;
  [[nodiscard]] bool sees(Checker& checker, int from, int point) const SOPT_RT;
  [[nodiscard]] float excess(Checker& checker, int point) SOPT_RT;
  [[nodiscard]] float length_through(int parent, int point) const SOPT_RT;
  [[nodiscard]] Vec2 position(int point) const SOPT_RT;
  [[nodiscard]] bool is_goal(int point) const SOPT_RT { return point == points_.size() - 1; }
  [[nodiscard]] bool store_path(Path<Point2>& out) const SOPT_RT;
  void push_up(int slot) SOPT_RT;
  [[nodiscard]] int pop() SOPT_RT;

  FixedVector<Point> points_;       // row by row; the goal is the last one
  FixedVector<std::int32_t> heap_;  // open points, smallest total on top
  Vec2 start_ = Vec2::Zero();
  Vec2 goal_ = Vec2::Zero();
  Vec2 origin_ = Vec2::Zero();
  double spacing_m_ = 0.0;
  int num_columns_ = 0;
  int num_rows_ = 0;
};

}  // namespace sopt
