// The row space of a single integrator's segment: rows a_i . z(t_i) >= b_i on positions, both ends
// fixed, cost 1/2 sum |z(t+1) - z(t)|^2 over n steps. The reduced inverse Hessian is the Green's
// function of the second difference, so nothing is stored or factorised:
//     G(i,k) = min(i,k) (n - max(i,k)) / n
//     gram(i,k) = G(t_i,t_k) a_i . a_k
//     z(lambda) = line from z(0) to z(n) + sum_i lambda_i a_i G(t_i, .)
// The last line is a polyline whose slope changes by -lambda_i a_i at t_i: O(n + active). Rows lie
// in time order, in groups of four per waypoint padded by rows that always hold, so pricing reads
// each waypoint once per group. Rows are priced by violation / sqrt(G(t,t)). docs/qp.md, 3.
#pragma once

#include <span>

#include "alloc/fixed_vector.h"
#include "models/plane/convex2.h"
#include "models/simd.h"
#include "rt/annotations.h"

namespace sopt {

class PointRows {
 public:
  using Scalar = double;

  PointRows() noexcept = default;
  PointRows(Arena& arena, int max_window, int max_rows) noexcept;

  // Starts a new segment of `num_steps` >= 1 from `first` to `last`, without rows.
  void reset(int num_steps, const Vec2& first, const Vec2& last) SOPT_RT;

  // Adds a row normal . z(t) >= bound, |normal| = 1, at a waypoint t in [1, num_steps - 1] not
  // before that of the row added last. False when the rows are full.
  [[nodiscard]] bool try_add(int t, const Vec2& normal, double bound) SOPT_RT;

  // Moves every bound by normal . offset(t); offsets of 0 .. num_steps. Before the first solve.
  void shift_bounds(const Vec2* offsets) SOPT_RT;

  // --- what the active-set core asks of a row space (active_set_qp.h)
  [[nodiscard]] bool is_valid() const SOPT_RT { return not_finite_ == 0.0; }
  [[nodiscard]] static int num_equalities() SOPT_RT { return 0; }
  [[nodiscard]] int num_ids() const SOPT_RT { return bound_.size(); }
  [[nodiscard]] bool is_free(int id) const SOPT_RT;
  void enter(int id) SOPT_RT;
  void leave(int id) SOPT_RT;
  void gram(std::span<const int> ids, int id, double* out) const SOPT_RT;
  [[nodiscard]] static double softness(int) SOPT_RT { return 0.0; }
  void update_primal(std::span<const int> ids, std::span<const double> weights) SOPT_RT;
  void update_step(std::span<const int> ids, std::span<const double> weights) SOPT_RT;
  [[nodiscard]] double step_value(int id) const SOPT_RT;
  [[nodiscard]] double step_energy() const SOPT_RT;
  void add_step() SOPT_RT;
  // bound - normal . z of a row: positive is a violation, in m.
  [[nodiscard]] double violation(int id) const SOPT_RT;
  [[nodiscard]] double size_of_terms(int id) const SOPT_RT;
  // Of the rows not entered and violated by more than `tolerance`, the largest in the pricing
  // scale, the lowest id among equals; -1 when there is none.
  [[nodiscard]] int most_violated(double tolerance) const SOPT_RT;

  // --- meaning of ids, and results
  struct Row {
    int t = 0;
    Vec2 normal = Vec2::Zero();
    double bound = 0.0;
  };
  // What try_add was given; ids of padding are those that are not free before any row is entered.
  [[nodiscard]] Row row(int id) const SOPT_RT { return {time(id), normal(id), bound_[id]}; }
  [[nodiscard]] int num_steps() const SOPT_RT { return num_steps_; }
  [[nodiscard]] Vec2 position(int t) const SOPT_RT { return {z_.x[t], z_.y[t]}; }
  // Puts z at other points, 0 .. num_steps, with the same ends.
  void set_positions(const Vec2* points) SOPT_RT;
  // Replaces z by reference + step (z - reference); reference has num_steps + 1 points.
  void shorten_step(const Vec2* reference, double step) SOPT_RT;

 private:
  struct Group {
    double normal_x[kLanesDouble], normal_y[kLanesDouble];
    double priced_bound[kLanesDouble];  // lowered out of sight for entered rows
  };
  // Coordinates of 0..num_steps.
  struct Points {
    FixedVector<double> x, y;
  };

  void add_forces(std::span<const int> ids, std::span<const double> weights) SOPT_RT;
  void integrate_forces(Points& points) SOPT_RT;
  [[nodiscard]] Vec2 normal(int id) const SOPT_RT {
    const Group& group = groups_[id / kLanesDouble];
    return {group.normal_x[id % kLanesDouble], group.normal_y[id % kLanesDouble]};
  }
  [[nodiscard]] int time(int id) const SOPT_RT { return group_time_[id / kLanesDouble]; }

  int num_steps_ = 0;
  int num_in_group_ = kLanesDouble;
  double not_finite_ = 0.0;  // NaN once some number was not finite
  FixedVector<Group> groups_;
  FixedVector<int> group_time_;
  FixedVector<double> bound_;  // of every id
  FixedVector<double> price_;  // 1 / sqrt(G(t,t)) at each waypoint
  Points z_;
  Points step_;   // ends at 0
  Points force_;  // sum of w_i a_i at each waypoint
};

}  // namespace sopt
