#include "opt/qp/active_set_qp.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "opt/qp/dense_rows.h"
#include "opt/qp/kernel_rows.h"
#include "opt/qp/point_rows.h"
#include "opt/qp/sum_rows.h"

namespace sopt {
namespace {

template <class Scalar>
constexpr Scalar kInfinity = std::numeric_limits<Scalar>::infinity();

// How far the multiplier of the entering row can rise before an active one reaches zero.
template <class Scalar>
struct Blocking {
  Scalar step = kInfinity<Scalar>;
  int position = -1;
};

// Entries of the direction that are rounding, next to the largest, do not block.
template <class Scalar>
Blocking<Scalar> find_blocking(const FixedVector<Scalar>& lambda, const Scalar* direction,
                               const FixedVector<Scalar>& scale, int first,
                               Scalar scale_entering) noexcept {
  Scalar largest = scale_entering;
  for (int j = 0; j < lambda.size(); ++j) {
    largest = std::max(largest, std::abs(direction[j]) * scale[j]);
  }
  const Scalar threshold = QpTolerance<Scalar>::kBlocking * largest;
  Blocking<Scalar> blocking;
  for (int j = first; j < lambda.size(); ++j) {
    if (!(direction[j] * scale[j] > threshold)) continue;
    const Scalar step = lambda[j] / direction[j];
    if (step < blocking.step) blocking = {step, j};
  }
  return blocking;
}

template <class T>
void erase(FixedVector<T>& v, int position) noexcept {
  std::copy(v.begin() + position + 1, v.end(), v.begin() + position);
  (void)v.try_resize(v.size() - 1);
}

}  // namespace

template <class Scalar>
ActiveSetQp<Scalar>::ActiveSetQp(Arena& arena, int max_active) noexcept
    : active_(arena, max_active),
      wanted_(arena, max_active),
      aside_(arena, max_active),
      lambda_(arena, max_active),
      scale_(arena, max_active),
      residual_(arena, max_active),
      step_ids_(arena, max_active + 1),
      step_weights_(arena, max_active + 1),
      gram_(arena, max_active) {}

template <class Scalar>
template <class Rows>
QpResult<Scalar> ActiveSetQp<Scalar>::solve(Rows& rows, const QpOptions<Scalar>& options,
                                            const Deadline& deadline) SOPT_RT {
  Run<Rows> run{rows, options, deadline};
  clear();
  if (!rows.is_valid()) {
    run.result.status = QpStatus::kBadInput;
    return run.result;
  }
  run.result.status = begin_from(run, options.warm);
  while (run.result.status == QpStatus::kNotSolved) {
    run.result.status = improve(run);
    if (run.result.status == QpStatus::kInaccurate && run.result.num_refactored < kMaxRefactored) {
      begin_again(run);
    }
  }
  finish(run);
  return run.result;
}

// Starts from the equalities and the warm rows that are independent: all tight, multipliers from
// K_aa lambda = violation at x0. Rows that would need a negative multiplier leave.
template <class Scalar>
template <class Rows>
QpStatus ActiveSetQp<Scalar>::begin_from(Run<Rows>& run, const QpWarmStart<Scalar>& warm) SOPT_RT {
  num_equalities_ = 0;
  cycles_.reset();
  if (run.rows.num_equalities() == 0 && warm.rows.empty()) return QpStatus::kNotSolved;
  run.rows.update_primal({}, {});
  QpStatus status = add_equalities(run);
  for (std::size_t i = 0; i < warm.rows.size() && status == QpStatus::kNotSolved; ++i) {
    const bool is_positive = i >= warm.multipliers.size() || warm.multipliers[i] > Scalar(0);
    if (is_positive) status = add_warm_row(run, warm.rows[i]);
  }
  return status == QpStatus::kNotSolved ? drop_negative(run) : status;
}

// Equalities that follow from the others, or contradict them, are left out here; the latter are
// told by the violation that remains.
template <class Scalar>
template <class Rows>
QpStatus ActiveSetQp<Scalar>::add_equalities(Run<Rows>& run) SOPT_RT {
  Rows& rows = run.rows;
  const int first_aside = aside_.size();
  for (int id = 0; id < rows.num_equalities(); ++id) {
    const QpStatus status = count_change(run);
    if (status != QpStatus::kNotSolved) return status;
    rows.enter(id);
    const Scalar diagonal = load_column(rows, id);
    const Direction direction = compute_direction(rows, id, 0, diagonal);
    const bool has_room = direction.is_dependent
                              ? aside_.try_push_back(id)
                              : try_append(id, Scalar(0), direction.curvature, diagonal);
    if (!has_room) {
      rows.leave(id);
      return QpStatus::kCapacity;
    }
    if (!direction.is_dependent) ++num_equalities_;
  }
  if (aside_.size() == first_aside) return QpStatus::kNotSolved;
  (void)active_residual(rows);
  std::copy(residual_.begin(), residual_.end(), lambda_.begin());
  gram_.solve(lambda_.begin());
  rows.update_primal(active_.span(), lambda_.span());
  (void)tighten_active(rows, run.options.violation_tolerance);
  QpStatus status = QpStatus::kNotSolved;
  for (int i = first_aside; i < aside_.size(); ++i) {
    if (is_rounding(rows, aside_[i], rows.violation(aside_[i]))) continue;
    run.result.blocking_row = aside_[i];
    status = QpStatus::kInfeasible;
  }
  rows.update_primal({}, {});
  return status;
}

template <class Scalar>
template <class Rows>
QpStatus ActiveSetQp<Scalar>::add_warm_row(Run<Rows>& run, int row) SOPT_RT {
  Rows& rows = run.rows;
  if (row < rows.num_equalities() || row >= rows.num_ids()) return QpStatus::kNotSolved;
  if (active_.size() == active_.capacity() || !rows.is_free(row)) return QpStatus::kNotSolved;
  const QpStatus status = count_change(run);
  if (status != QpStatus::kNotSolved) return status;
  rows.enter(row);
  const Scalar diagonal = load_column(rows, row);
  const Direction direction = compute_direction(rows, row, 0, diagonal);
  if (direction.is_dependent || !direction.is_settled ||
      !try_append(row, Scalar(0), direction.curvature, diagonal)) {
    rows.leave(row);
  }
  return QpStatus::kNotSolved;
}

template <class Scalar>
template <class Rows>
QpStatus ActiveSetQp<Scalar>::drop_negative(Run<Rows>& run) SOPT_RT {
  while (true) {
    for (int j = 0; j < active_.size(); ++j) lambda_[j] = run.rows.violation(active_[j]);
    gram_.solve(lambda_.begin());
    const int worst = find_negative();
    if (worst < 0) return QpStatus::kNotSolved;
    const QpStatus status = count_change(run);
    if (status != QpStatus::kNotSolved) return status;
    drop(run.rows, worst);
  }
}

// One round: prices all rows and makes the most violated one hold, or finds that all do.
template <class Scalar>
template <class Rows>
QpStatus ActiveSetQp<Scalar>::improve(Run<Rows>& run) SOPT_RT {
  if (cycles_.is_cycling(active_.span())) return QpStatus::kInaccurate;
  const Scalar tolerance = run.options.violation_tolerance;
  run.rows.update_primal(active_.span(), lambda_.span());
  if (!tighten_active(run.rows, tolerance)) return QpStatus::kInaccurate;
  int row = run.rows.most_violated(tolerance);
  if (row < 0 && worst_residual_ > tolerance / 8) {
    (void)tighten_active(run.rows, tolerance / 8);
    row = run.rows.most_violated(tolerance);
  }
  return row < 0 ? accept(run) : make_hold(run, row);
}

// Refines the multipliers until active rows are tight to `tolerance` or rounding forbids; false
// when they are far from it all the same: the factor is no good.
template <class Scalar>
template <class Rows>
bool ActiveSetQp<Scalar>::tighten_active(Rows& rows, Scalar tolerance) SOPT_RT {
  Scalar residual = active_residual(rows);
  for (int i = 0; i < kMaxRefinements && residual > tolerance; ++i) {
    refine_multipliers(rows);
    const Scalar before = residual;
    residual = active_residual(rows);
    if (!(residual < before / 2)) break;
  }
  constexpr Scalar kAstray = QpTolerance<Scalar>::kAstray;
  for (int j = 0; j < active_.size() && residual > kAstray; ++j) {
    if (std::abs(residual_[j]) > kAstray * rows.size_of_terms(active_[j])) return false;
  }
  return true;
}

template <class Scalar>
template <class Rows>
bool ActiveSetQp<Scalar>::is_rounding(const Rows& rows, int id, Scalar violation) SOPT_RT {
  const Scalar scale = std::max(Scalar(1), rows.size_of_terms(id));
  return std::abs(violation) <= QpTolerance<Scalar>::kConflict * scale;
}

// Raises the multiplier of `row` until the row holds; active rows that block leave.
template <class Scalar>
template <class Rows>
QpStatus ActiveSetQp<Scalar>::make_hold(Run<Rows>& run, int row) SOPT_RT {
  Rows& rows = run.rows;
  Scalar violation = rows.violation(row);
  rows.enter(row);
  const Scalar diagonal = load_column(rows, row);
  Scalar lambda = 0;
  int first_changed = 0;
  QpStatus status = count_change(run);
  while (status == QpStatus::kNotSolved) {
    const Direction direction = compute_direction(rows, row, first_changed, diagonal);
    if (!direction.is_settled) {
      status = QpStatus::kInaccurate;
      break;
    }
    const Blocking<Scalar> blocking =
        find_blocking(lambda_, gram_.direction(), scale_, num_equalities_, std::sqrt(diagonal));
    const Scalar full_step =
        direction.is_dependent ? kInfinity<Scalar> : violation / direction.curvature;
    const Scalar step = std::min(full_step, blocking.step);
    if (!(step < kInfinity<Scalar>)) return set_aside(run, row, violation);
    for (int j = 0; j < lambda_.size(); ++j) {
      lambda_[j] -= step * gram_.direction()[j];
      if (j >= num_equalities_) lambda_[j] = std::max(Scalar(0), lambda_[j]);
    }
    lambda += step;
    if (full_step <= blocking.step) {
      if (try_append(row, lambda, direction.curvature, diagonal)) return QpStatus::kNotSolved;
      status = QpStatus::kCapacity;
    } else {
      if (!direction.is_dependent) violation -= step * direction.curvature;
      drop(rows, blocking.position);
      first_changed = blocking.position;
      status = count_change(run);
    }
  }
  rows.leave(row);
  return status;
}

// `row` depends on active rows, none of which can give way: the rows contradict each other, or
// agree but for rounding.
template <class Scalar>
template <class Rows>
QpStatus ActiveSetQp<Scalar>::set_aside(Run<Rows>& run, int row, Scalar violation) SOPT_RT {
  if (is_rounding(run.rows, row, violation) && aside_.try_push_back(row)) {
    return QpStatus::kNotSolved;
  }
  run.rows.leave(row);
  run.result.blocking_row = row;
  return QpStatus::kInfeasible;
}

// Position of the most negative multiplier; those that are so by rounding become 0. -1: none.
template <class Scalar>
int ActiveSetQp<Scalar>::find_negative() SOPT_RT {
  Scalar largest = 0;
  Scalar lowest = 0;
  int position = -1;
  for (int j = 0; j < lambda_.size(); ++j) {
    const Scalar value = lambda_[j] * scale_[j];
    largest = std::max(largest, std::abs(value));
    if (j < num_equalities_ || value >= lowest) continue;
    lowest = value;
    position = j;
  }
  if (lowest < -QpTolerance<Scalar>::kNegative * largest) return position;
  for (int j = num_equalities_; j < lambda_.size(); ++j) {
    lambda_[j] = std::max(Scalar(0), lambda_[j]);
  }
  return -1;
}

// Equalities are violated either way.
template <class Scalar>
template <class Rows>
Scalar ActiveSetQp<Scalar>::aside_violation(const Rows& rows, int id) SOPT_RT {
  const Scalar violation = rows.violation(id);
  return id < rows.num_equalities() ? std::abs(violation) : violation;
}

template <class Scalar>
template <class Rows>
Scalar ActiveSetQp<Scalar>::aside_residual(const Rows& rows) const SOPT_RT {
  Scalar worst = 0;
  for (const int id : aside_) worst = std::max(worst, aside_violation(rows, id));
  return worst;
}

// No row is violated: the solution, if the multipliers' signs and the active rows agree.
template <class Scalar>
template <class Rows>
QpStatus ActiveSetQp<Scalar>::accept(Run<Rows>& run) SOPT_RT {
  const int negative = find_negative();
  if (negative >= 0) {
    const QpStatus status = count_change(run);
    if (status == QpStatus::kNotSolved) drop(run.rows, negative);
    return status;
  }
  const Scalar residual = std::max(worst_residual_, aside_residual(run.rows));
  return residual <= 10 * run.options.violation_tolerance ? QpStatus::kOptimal
                                                          : QpStatus::kInaccurate;
}

// Rounding got the better of the updates: starts afresh from the rows that are active.
template <class Scalar>
template <class Rows>
void ActiveSetQp<Scalar>::begin_again(Run<Rows>& run) SOPT_RT {
  ++run.result.num_refactored;
  (void)wanted_.try_assign(active_.span());
  leave_all(run.rows);
  clear();
  run.result.status = begin_from(run, {wanted_.span(), {}});
}

template <class Scalar>
void ActiveSetQp<Scalar>::clear() SOPT_RT {
  active_.clear();
  lambda_.clear();
  scale_.clear();
  aside_.clear();
  gram_.clear();
}

template <class Scalar>
template <class Rows>
void ActiveSetQp<Scalar>::finish(Run<Rows>& run) SOPT_RT {
  QpResult<Scalar>& result = run.result;
  result.num_active = active_.size();
  result.primal_residual =
      result.status == QpStatus::kOptimal ? worst_residual_ : active_residual(run.rows);
  if (result.status != QpStatus::kOptimal) {
    for (int id = 0; id < run.rows.num_ids(); ++id) {
      if (!run.rows.is_free(id)) continue;
      result.primal_residual = std::max(result.primal_residual, run.rows.violation(id));
    }
  }
  result.primal_residual = std::max(result.primal_residual, aside_residual(run.rows));
  Scalar largest = 0;
  Scalar lowest = 0;
  for (int j = 0; j < active_.size(); ++j) {
    result.gap += std::abs(lambda_[j] * residual_[j]);
    largest = std::max(largest, std::abs(lambda_[j]));
    if (j >= num_equalities_) lowest = std::min(lowest, lambda_[j]);
  }
  result.dual_residual = lowest < Scalar(0) ? -lowest / largest : Scalar(0);
  leave_all(run.rows);
}

// Counts one working-set change; anything but kNotSolved says that it must not be made.
template <class Scalar>
template <class Rows>
QpStatus ActiveSetQp<Scalar>::count_change(Run<Rows>& run) SOPT_RT {
  if (run.result.num_steps >= run.options.max_steps) return QpStatus::kStepLimit;
  if (run.deadline.expired()) return QpStatus::kDeadline;
  ++run.result.num_steps;
  return QpStatus::kNotSolved;
}

// Direction of the entering row, whose column changed from entry `first_changed` on.
template <class Scalar>
template <class Rows>
typename ActiveSetQp<Scalar>::Direction ActiveSetQp<Scalar>::compute_direction(
    Rows& rows, int row, int first_changed, Scalar diagonal) SOPT_RT {
  const Scalar curvature = gram_.solve_column(first_changed, diagonal);
  if (curvature > QpTolerance<Scalar>::kSuspect * diagonal) return {curvature, false, true};
  return refine_direction(rows, row, diagonal);
}

// K_pp - K_pa r is a difference of nearly equal numbers when row p nearly depends on the active
// ones. d = H^-1 (a_p - sum r_j a_j) is not: the curvature is its energy d'Hd, and rho_j = a_j . d
// tells how far r is from the one that makes it least, by rho' K^-1 rho.
template <class Scalar>
template <class Rows>
typename ActiveSetQp<Scalar>::Direction ActiveSetQp<Scalar>::refine_direction(
    Rows& rows, int row, Scalar diagonal) SOPT_RT {
  if (!(diagonal > Scalar(0))) return {Scalar(0), true, true};
  (void)step_ids_.try_assign(active_.span());
  (void)step_ids_.try_push_back(row);
  (void)step_weights_.try_resize(step_ids_.size());
  (void)residual_.try_resize(active_.size());
  Scalar* const direction = gram_.direction();
  for (int i = 0;; ++i) {
    for (int j = 0; j < active_.size(); ++j) step_weights_[j] = -direction[j];
    step_weights_.back() = Scalar(1);
    rows.update_step(step_ids_.span(), step_weights_.span());
    Scalar curvature = rows.step_energy() + rows.softness(row);
    Scalar miss = 0;           // largest rho_j, |a_j| = 1
    Scalar scale2 = diagonal;  // of the terms that d is the sum of
    for (int j = 0; j < active_.size(); ++j) {
      const Scalar shift = rows.softness(active_[j]) * direction[j];
      curvature += shift * direction[j];
      residual_[j] = rows.step_value(active_[j]) - shift;
      miss = std::max(miss, std::abs(residual_[j]) / scale_[j]);
      scale2 += direction[j] * direction[j] * scale_[j] * scale_[j];
    }
    const bool is_dependent = !(curvature > QpTolerance<Scalar>::kSingular * scale2);
    const bool is_straight = miss <= QpTolerance<Scalar>::kSettled * std::sqrt(scale2);
    if (i == kMaxRefinements) return {curvature, is_dependent, is_straight};
    (void)step_weights_.try_resize(active_.size());
    std::copy(residual_.begin(), residual_.end(), step_weights_.begin());
    gram_.solve(step_weights_.begin());
    Scalar excess = 0;
    for (int j = 0; j < active_.size(); ++j) excess += residual_[j] * step_weights_[j];
    const bool is_exact = std::abs(excess) <= Scalar(0.1) * curvature;
    if (is_straight && (is_exact || is_dependent)) return {curvature, is_dependent, true};
    for (int j = 0; j < active_.size(); ++j) direction[j] += step_weights_[j];
    (void)step_weights_.try_resize(step_ids_.size());
  }
}

// Largest distance of an active row from where its multiplier puts it; all of them in residual_.
template <class Scalar>
template <class Rows>
Scalar ActiveSetQp<Scalar>::active_residual(const Rows& rows) SOPT_RT {
  (void)residual_.try_resize(active_.size());
  Scalar worst = 0;
  for (int j = 0; j < active_.size(); ++j) {
    residual_[j] = rows.violation(active_[j]) - rows.softness(active_[j]) * lambda_[j];
    worst = std::max(worst, std::abs(residual_[j]));
  }
  worst_residual_ = worst;
  return worst;
}

// Multipliers and primal take up residual_. The primal moves by the correction itself, which is
// finer than the multipliers' rounding.
template <class Scalar>
template <class Rows>
void ActiveSetQp<Scalar>::refine_multipliers(Rows& rows) SOPT_RT {
  gram_.solve(residual_.begin());
  for (int j = 0; j < active_.size(); ++j) lambda_[j] += residual_[j];
  rows.update_step(active_.span(), residual_.span());
  rows.add_step();
}

template <class Scalar>
bool ActiveSetQp<Scalar>::try_append(int row, Scalar lambda, Scalar curvature,
                                     Scalar diagonal) SOPT_RT {
  if (!gram_.try_append(curvature)) return false;
  (void)active_.try_push_back(row);
  (void)lambda_.try_push_back(lambda);
  (void)scale_.try_push_back(std::sqrt(diagonal));
  return true;
}

// Column of an entered row; returns its diagonal entry.
template <class Scalar>
template <class Rows>
Scalar ActiveSetQp<Scalar>::load_column(Rows& rows, int row) SOPT_RT {
  rows.gram(active_.span(), row, gram_.column());
  Scalar diagonal = 0;
  rows.gram({&row, 1}, row, &diagonal);
  return diagonal + rows.softness(row);
}

template <class Scalar>
template <class Rows>
void ActiveSetQp<Scalar>::drop(Rows& rows, int position) SOPT_RT {
  rows.leave(active_[position]);
  erase(active_, position);
  erase(lambda_, position);
  erase(scale_, position);
  gram_.remove(position);
}

template <class Scalar>
template <class Rows>
void ActiveSetQp<Scalar>::leave_all(Rows& rows) SOPT_RT {
  for (const int id : active_) rows.leave(id);
  for (const int id : aside_) rows.leave(id);
}

template class ActiveSetQp<double>;
template class ActiveSetQp<float>;
template QpResult<double> ActiveSetQp<double>::solve(PointRows&, const QpOptions<double>&,
                                                     const Deadline&) SOPT_RT;
template QpResult<double> ActiveSetQp<double>::solve(DenseRows<double>&, const QpOptions<double>&,
                                                     const Deadline&) SOPT_RT;
template QpResult<float> ActiveSetQp<float>::solve(DenseRows<float>&, const QpOptions<float>&,
                                                   const Deadline&) SOPT_RT;
template QpResult<double> ActiveSetQp<double>::solve(KernelRows<double, 4>&,
                                                     const QpOptions<double>&,
                                                     const Deadline&) SOPT_RT;
template QpResult<double> ActiveSetQp<double>::solve(KernelRows<double, 8>&,
                                                     const QpOptions<double>&,
                                                     const Deadline&) SOPT_RT;
template QpResult<float> ActiveSetQp<float>::solve(KernelRows<float, 8>&, const QpOptions<float>&,
                                                   const Deadline&) SOPT_RT;
template QpResult<double> ActiveSetQp<double>::solve(
    SumRows<DenseRows<double>, KernelRows<double, 4>>&, const QpOptions<double>&,
    const Deadline&) SOPT_RT;
template QpResult<double> ActiveSetQp<double>::solve(
    SumRows<DenseRows<double>, KernelRows<double, 8>>&, const QpOptions<double>&,
    const Deadline&) SOPT_RT;

}  // namespace sopt
