#include "opt/active_set_qp.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sopt {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// How far the multiplier of the entering row can rise before an active one reaches zero.
struct Blocking {
  double step = kInfinity;
  int position = -1;
};

Blocking find_blocking(std::span<const double> lambda, std::span<const double> direction) noexcept {
  Blocking blocking;
  for (std::size_t j = 0; j < lambda.size(); ++j) {
    if (direction[j] <= 0.0) continue;
    const double step = lambda[j] / direction[j];
    if (step < blocking.step) blocking = {step, static_cast<int>(j)};
  }
  return blocking;
}

}  // namespace

ActiveSetQp::ActiveSetQp(Arena& arena, int max_active) noexcept
    : stride_(max_active),
      active_(arena, max_active),
      lambda_(arena, max_active),
      forward_(arena, max_active),
      direction_(arena, max_active),
      factor_(arena, max_active * max_active) {
  (void)factor_.try_resize(factor_.capacity());
}

template <class RowSpace>
QpResult ActiveSetQp::solve(RowSpace& rows, const QpOptions& options,
                            const Deadline& deadline) SOPT_RT {
  QpResult result;
  active_.clear();
  lambda_.clear();
  while (true) {
    rows.update_primal(active_.span(), lambda_.span());
    result.num_active = active_.size();
    const int row = rows.most_violated();
    double violation = row < 0 ? 0.0 : rows.violation(row);
    if (violation <= options.violation_tolerance) {
      result.status = QpStatus::kOptimal;
      return result;
    }
    if (std::find(active_.begin(), active_.end(), row) != active_.end()) {
      result.status = QpStatus::kInaccurate;
      return result;
    }
    // Raise the multiplier of `row` until it holds, dropping rows that block.
    for (double lambda = 0.0;;) {
      if (result.num_steps >= options.max_steps || deadline.expired()) {
        result.status =
            result.num_steps >= options.max_steps ? QpStatus::kStepLimit : QpStatus::kDeadline;
        return result;
      }
      ++result.num_steps;
      const double curvature = compute_direction(rows, row);
      const bool dependent = curvature <= kSingular * rows.gram(row, row);
      const Blocking blocking = find_blocking(lambda_.span(), direction_.span());
      const double full_step = dependent ? kInfinity : violation / curvature;
      const double step = std::min(full_step, blocking.step);
      if (step == kInfinity) {
        result.status = QpStatus::kInfeasible;
        result.blocking_row = row;
        return result;
      }
      for (int j = 0; j < active_.size(); ++j) {
        lambda_[j] = std::max(0.0, lambda_[j] - step * direction_[j]);
      }
      lambda += step;
      if (full_step <= blocking.step) {
        result.status = append(row, lambda, curvature);
        if (result.status == QpStatus::kCapacity) return result;
        break;
      }
      if (!dependent) violation -= step * curvature;
      remove(blocking.position);
    }
  }
}

// Fills forward_ and direction_ for entering row `row`; returns the curvature s.
template <class RowSpace>
double ActiveSetQp::compute_direction(const RowSpace& rows, int row) SOPT_RT {
  const int q = active_.size();
  (void)forward_.try_resize(q);
  (void)direction_.try_resize(q);
  double curvature = rows.gram(row, row);
  for (int i = 0; i < q; ++i) {
    const double* const factor = factor_row(i);
    double sum = rows.gram(active_[i], row);
    for (int k = 0; k < i; ++k) sum -= factor[k] * forward_[k];
    forward_[i] = sum / factor[i];
    curvature -= forward_[i] * forward_[i];
  }
  std::copy(forward_.begin(), forward_.end(), direction_.begin());
  for (int i = q - 1; i >= 0; --i) {
    const double* const factor = factor_row(i);
    direction_[i] /= factor[i];
    for (int k = 0; k < i; ++k) direction_[k] -= factor[k] * direction_[i];
  }
  return curvature;
}

QpStatus ActiveSetQp::append(int row, double lambda, double curvature) SOPT_RT {
  const int q = active_.size();
  if (!active_.try_push_back(row) || !lambda_.try_push_back(lambda)) return QpStatus::kCapacity;
  double* const factor = factor_row(q);
  std::copy(forward_.begin(), forward_.end(), factor);
  factor[q] = std::sqrt(curvature);
  return QpStatus::kNotSolved;
}

// Drops an active row. Its factor row goes; the rows below have one entry right of their new
// diagonal, which a Givens rotation of two neighbouring columns folds back:
//     [ l . . ]      [ l .   ]
//     [ l l l ]  ->  [ l l 0 ]
void ActiveSetQp::remove(int position) SOPT_RT {
  const int q = active_.size() - 1;
  std::copy(active_.begin() + position + 1, active_.end(), active_.begin() + position);
  std::copy(lambda_.begin() + position + 1, lambda_.end(), lambda_.begin() + position);
  (void)active_.try_resize(q);
  (void)lambda_.try_resize(q);
  for (int i = position; i < q; ++i) {
    std::copy(factor_row(i + 1), factor_row(i + 1) + i + 2, factor_row(i));
  }
  for (int i = position; i < q; ++i) {
    const double a = factor_row(i)[i];
    const double b = factor_row(i)[i + 1];
    const double length = std::sqrt(a * a + b * b);
    const double c = a / length;
    const double s = b / length;
    for (int k = i; k < q; ++k) {
      double* const factor = factor_row(k);
      const double left = factor[i];
      const double right = factor[i + 1];
      factor[i] = c * left + s * right;
      factor[i + 1] = c * right - s * left;
    }
  }
}

template QpResult ActiveSetQp::solve(PointRows&, const QpOptions&, const Deadline&) SOPT_RT;

}  // namespace sopt
