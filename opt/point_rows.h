// The row space of a single integrator's segment: rows a_i . z(t_i) >= b_i on positions, both ends
// fixed, cost 1/2 sum |z(t+1) - z(t)|^2 over n steps. The reduced inverse Hessian is the Green's
// function of the second difference, so nothing is stored or factorised:
//     G(i,k) = min(i,k) (n - max(i,k)) / n
//     gram(i,k) = G(t_i,t_k) a_i . a_k
//     z(lambda) = line from z(0) to z(n) + sum_i lambda_i a_i G(t_i, .)
// The last line is a polyline whose slope changes by -lambda_i a_i at t_i: O(n + active).
// Rows lie in time order, in groups of four per waypoint padded by rows that always hold, so
// pricing reads each waypoint once per group. Source: DESIGN notes in docs/algorithm.md, "segment
// QP".
#pragma once

#include <span>

#include "alloc/fixed_vector.h"
#include "models/convex2.h"
#include "models/simd.h"
#include "rt/annotations.h"

namespace sopt {

class PointRows {
 public:
  PointRows() noexcept = default;
  PointRows(Arena& arena, int max_window, int max_rows) noexcept;

  // Starts a new segment of `num_steps` >= 1 from `first` to `last`, without rows.
  void reset(int num_steps, const Vec2& first, const Vec2& last) SOPT_RT;

  // Adds a row normal . z(t) >= bound, |normal| = 1, at a waypoint t in [1, num_steps - 1] not
  // before that of the row added last. False when the rows are full.
  [[nodiscard]] bool try_add(int t, const Vec2& normal, double bound) SOPT_RT;

  // --- what the active-set core asks of a row space
  [[nodiscard]] int num_rows() const SOPT_RT { return num_padded_; }
  [[nodiscard]] double gram(int i, int k) const SOPT_RT;
  // Sets z from multipliers lambda[j] of rows active[j].
  void update_primal(std::span<const int> active, std::span<const double> lambda) SOPT_RT;
  // bound - normal . z of row i: positive is a violation, in m.
  [[nodiscard]] double violation(int i) const SOPT_RT;
  // The row with the largest violation, the lowest index among equals; -1 when there are no rows.
  [[nodiscard]] int most_violated() const SOPT_RT;

  // --- results
  [[nodiscard]] int num_steps() const SOPT_RT { return num_steps_; }
  [[nodiscard]] Vec2 position(int t) const SOPT_RT { return {z_x_[t], z_y_[t]}; }
  // Replaces z by reference + step (z - reference); reference has num_steps + 1 points.
  void shorten_step(const Vec2* reference, double step) SOPT_RT;

 private:
  struct Group {
    double normal_x[kLanesDouble], normal_y[kLanesDouble], bound[kLanesDouble];
  };

  int num_steps_ = 0;
  int num_padded_ = 0;
  int num_in_group_ = kLanesDouble;
  FixedVector<Group> groups_;
  FixedVector<int> group_time_;
  // 0..num_steps
  FixedVector<double> z_x_, z_y_;
  FixedVector<double> force_x_, force_y_;  // sum of lambda_i a_i at each waypoint
};

}  // namespace sopt
