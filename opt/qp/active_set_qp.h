// Dual active-set method for strictly convex QPs, written on the rows' Gram matrix alone:
//     min 1/2 x' H x + f' x   s.t.  a_i . x >= b_i        K_ik = a_i' H^-1 a_k,  K_ii += softness_i
//     x(lambda) = x0 + H^-1 A' lambda,  x0 = -H^-1 f
// Takes the most violated row p and raises its multiplier until it holds, all active rows kept
// tight:  K_aa r = K_ap,  curvature s = K_pp - K_pa r,  step = min(violation_p / s, lambda_j / r_j)
// [Goldfarb, Idnani 1983; in Gram form: Arnstrom, Bemporad, Axehill 2022]. Only active rows are
// ever factorised. O(q^2) per change with q active rows, plus one pricing pass of the row space.
// Directions of nearly dependent rows and multipliers whose rounding shows in the rows are refined
// against the row space itself. Derivation, work bounds and figures: docs/qp.md. No heap, no
// unbounded loop.
//
// The problem is a row space: point_rows.h, kernel_rows.h, dense_rows.h, sum_rows.h. Its rows are
// one-sided and numbered; a two-sided row has two ids. `Rows` offers:
//     Scalar                          number type
//     bool is_valid()                 data is finite and the Hessian positive definite
//     int num_equalities()            ids [0, num_equalities) hold with equality
//     int num_ids()
//     bool is_free(id)                has a bound to keep and is not entered
//     void enter(id), leave(id)       id is about to be used in what follows / is so no longer
//     void gram(ids, i, out)          K_ki for all k in ids, of entered ids, without softness
//     Scalar softness(id)             0: hard; > 0: exact quadratic penalty of weight 1 / softness
//     void update_primal(ids, w)      x = x0 + H^-1 sum w_i a_i; x is undefined before
//     void update_step(ids, w)        d = H^-1 sum w_i a_i
//     Scalar step_value(id)           a_id . d
//     Scalar step_energy()            d' H d, as a sum of squares
//     void add_step()                 x = x + d
//     Scalar violation(id)            b - a . x
//     Scalar size_of_terms(id)        |b| + sum |a_j x_j|: what rounding of it is relative to
//     int most_violated(tolerance)    not entered, violation above tolerance, largest in the
//                                     space's own scale; -1: none
#pragma once

#include <span>

#include "alloc/fixed_vector.h"
#include "opt/qp/cycle_detector.h"
#include "opt/qp/gram_inverse.h"
#include "opt/qp/qp_result.h"
#include "rt/annotations.h"
#include "rt/deadline.h"

namespace sopt {

template <class Scalar>
class ActiveSetQp {
 public:
  ActiveSetQp() noexcept = default;
  // `max_active` rows fit; n linearly independent rows at most are active in n variables.
  ActiveSetQp(Arena& arena, int max_active) noexcept;

  // Solves over `rows`, whose primal ends at the solution; when the status is not kOptimal, at the
  // solution for the rows active so far, which is not feasible. The deadline is polled at every
  // change. Compiled in active_set_qp.cc for the library's row spaces; another one needs a line
  // there.
  template <class Rows>
  [[nodiscard]] QpResult<Scalar> solve(Rows& rows, const QpOptions<Scalar>& options,
                                       const Deadline& deadline) SOPT_RT;

  // Rows active at the end of the last solve and their multipliers: >= 0 but for equalities.
  [[nodiscard]] std::span<const int> active_rows() const SOPT_RT { return active_.span(); }
  [[nodiscard]] std::span<const Scalar> multipliers() const SOPT_RT { return lambda_.span(); }

 private:
  // Refinement rounds of a direction, and of the multipliers.
  static constexpr int kMaxRefinements = 3;
  // Rebuilds of the factor.
  static constexpr int kMaxRefactored = 4;

  // A solve under way.
  template <class Rows>
  struct Run {
    Rows& rows;
    const QpOptions<Scalar>& options;
    const Deadline& deadline;
    QpResult<Scalar> result{};
  };
  struct Direction {
    Scalar curvature = 0;
    bool is_dependent = false;
    bool is_settled = true;  // the direction itself, in the gram factor, is right
  };

  template <class Rows>
  [[nodiscard]] QpStatus begin_from(Run<Rows>& run, const QpWarmStart<Scalar>& warm) SOPT_RT;
  template <class Rows>
  [[nodiscard]] QpStatus add_equalities(Run<Rows>& run) SOPT_RT;
  template <class Rows>
  [[nodiscard]] QpStatus add_warm_row(Run<Rows>& run, int row) SOPT_RT;
  template <class Rows>
  [[nodiscard]] QpStatus drop_negative(Run<Rows>& run) SOPT_RT;
  template <class Rows>
  [[nodiscard]] QpStatus improve(Run<Rows>& run) SOPT_RT;
  template <class Rows>
  [[nodiscard]] bool tighten_active(Rows& rows, Scalar tolerance) SOPT_RT;
  template <class Rows>
  [[nodiscard]] QpStatus make_hold(Run<Rows>& run, int row) SOPT_RT;
  template <class Rows>
  [[nodiscard]] QpStatus set_aside(Run<Rows>& run, int row, Scalar violation) SOPT_RT;
  [[nodiscard]] int find_negative() SOPT_RT;
  template <class Rows>
  [[nodiscard]] static bool is_rounding(const Rows& rows, int id, Scalar violation) SOPT_RT;
  template <class Rows>
  [[nodiscard]] static Scalar aside_violation(const Rows& rows, int id) SOPT_RT;
  template <class Rows>
  [[nodiscard]] Scalar aside_residual(const Rows& rows) const SOPT_RT;
  template <class Rows>
  [[nodiscard]] QpStatus accept(Run<Rows>& run) SOPT_RT;
  template <class Rows>
  void begin_again(Run<Rows>& run) SOPT_RT;
  void clear() SOPT_RT;
  template <class Rows>
  void finish(Run<Rows>& run) SOPT_RT;

  template <class Rows>
  [[nodiscard]] static QpStatus count_change(Run<Rows>& run) SOPT_RT;
  template <class Rows>
  [[nodiscard]] Direction compute_direction(Rows& rows, int row, int first_changed,
                                            Scalar diagonal) SOPT_RT;
  template <class Rows>
  [[nodiscard]] Direction refine_direction(Rows& rows, int row, Scalar diagonal) SOPT_RT;
  template <class Rows>
  [[nodiscard]] Scalar active_residual(const Rows& rows) SOPT_RT;
  template <class Rows>
  void refine_multipliers(Rows& rows) SOPT_RT;
  [[nodiscard]] bool try_append(int row, Scalar lambda, Scalar curvature, Scalar diagonal) SOPT_RT;
  template <class Rows>
  [[nodiscard]] Scalar load_column(Rows& rows, int row) SOPT_RT;
  template <class Rows>
  void drop(Rows& rows, int position) SOPT_RT;
  template <class Rows>
  void leave_all(Rows& rows) SOPT_RT;

  int num_equalities_ = 0;        // leading entries of active_ that never leave
  Scalar worst_residual_ = 0;     // largest of residual_, by size
  CycleDetector cycles_;          // of active_, round by round
  FixedVector<int> active_;       // q ids
  FixedVector<int> wanted_;       // ids to begin from again
  FixedVector<int> aside_;        // ids that hold but for rounding and cannot be made to
  FixedVector<Scalar> lambda_;    // q
  FixedVector<Scalar> scale_;     // q: sqrt(K_jj)
  FixedVector<Scalar> residual_;  // q: of active rows
  FixedVector<int> step_ids_;     // q + 1: active rows and the entering one
  FixedVector<Scalar> step_weights_;
  GramInverse<Scalar> gram_;
};

extern template class ActiveSetQp<double>;
extern template class ActiveSetQp<float>;

}  // namespace sopt
