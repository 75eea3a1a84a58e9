// Dual active-set method for strictly convex QPs, written on the rows' Gram matrix alone:
//     min 1/2 x' H x + f' x   s.t.  A x >= b      K = A H^-1 A',  x(lambda) = x0 + H^-1 A' lambda
// Starts at the unconstrained optimum with no active row; in each outer step takes the most
// violated row p and raises its multiplier until the row holds, keeping all active rows tight:
//     K_aa r = K_ap,  curvature s = K_pp - K_pa r        (r: how active multipliers react)
//     t = min( violation_p / s  (row holds),  min_j lambda_j / r_j  (row j leaves) )
// [Goldfarb, Idnani 1983; in Gram form: Arnstrom, Bemporad, Axehill 2022 (DAQP)]. The Cholesky
// factor of K_aa grows by one row per addition and is repaired by Givens rotations on removal, so
// only active rows are ever factorised: O(q^2) per change with q active rows, plus one pricing
// pass. A row that depends on the active ones (s = 0) can only enter when another leaves; when none
// can, the rows contradict each other and p is the certificate. An interrupted solve is not
// feasible. The problem is a RowSpace (opt/point_rows.h): num_rows, gram, update_primal, violation,
// most_violated.
#pragma once

#include <cstdint>
#include <span>

#include "alloc/fixed_vector.h"
#include "opt/point_rows.h"
#include "rt/annotations.h"
#include "rt/deadline.h"

namespace sopt {

enum class QpStatus : std::int8_t {
  kOptimal = 0,
  kNotSolved = -1,   // default
  kInfeasible = -2,  // rows contradict each other; blocking_row cannot hold together with others
  kStepLimit = -3,   // max_steps working-set changes were not enough
  kDeadline = -4,
  kCapacity = -5,    // more active rows than the workspace holds
  kInaccurate = -6,  // rounding: a row that is kept tight is violated beyond the tolerance
};

struct QpOptions {
  double violation_tolerance = 1e-9;  // rows may be violated by this much, in the rows' unit
  int max_steps = 1000;               // working-set changes
};

struct QpResult {
  QpStatus status = QpStatus::kNotSolved;
  int num_steps = 0;  // working-set changes
  int num_active = 0;
  int blocking_row = -1;  // of an infeasible problem
};

class ActiveSetQp {
 public:
  ActiveSetQp() noexcept = default;
  ActiveSetQp(Arena& arena, int max_active) noexcept;

  // Solves over `rows`, whose primal ends at the solution. The deadline is polled at every change.
  template <class RowSpace>
  [[nodiscard]] QpResult solve(RowSpace& rows, const QpOptions& options,
                               const Deadline& deadline) SOPT_RT;

  // Rows active at the end of the last solve and their multipliers (>= 0).
  [[nodiscard]] std::span<const int> active_rows() const SOPT_RT { return active_.span(); }
  [[nodiscard]] std::span<const double> multipliers() const SOPT_RT { return lambda_.span(); }

 private:
  // Relative curvature below which a row counts as dependent on the active ones.
  static constexpr double kSingular = 1e-11;

  template <class RowSpace>
  [[nodiscard]] double compute_direction(const RowSpace& rows, int row) SOPT_RT;
  [[nodiscard]] QpStatus append(int row, double lambda, double curvature) SOPT_RT;
  void remove(int position) SOPT_RT;
  [[nodiscard]] double* factor_row(int i) SOPT_RT { return factor_.begin() + i * stride_; }

  int stride_ = 0;
  FixedVector<int> active_;        // q rows
  FixedVector<double> lambda_;     // q
  FixedVector<double> forward_;    // q: y of L y = K_ap
  FixedVector<double> direction_;  // q: r of K_aa r = K_ap
  FixedVector<double> factor_;     // lower L of K_aa = L L', rows of stride_
};

extern template QpResult ActiveSetQp::solve(PointRows&, const QpOptions&, const Deadline&) SOPT_RT;

}  // namespace sopt
