#include "opt/arm/dense_arm_qp.h"

#include <algorithm>
#include <limits>

#include "opt/step_measure.h"

namespace sopt {

// Rows: those of the window, two ends, and two limits per waypoint and joint.
template <int N>
DenseArmQp<N>::DenseArmQp(Arena& arena, int max_window, int max_rows) noexcept
    : rows_(arena, {N * max_window, max_rows + 2 * N * (max_window + 1), N * max_window}),
      qp_(arena, N * max_window),
      hessian_(arena, N * max_window * N * max_window),
      gradient_(arena, N * max_window),
      row_(arena, N * max_window),
      positions_(arena, max_window + 1),
      velocities_(arena, max_window + 1) {
  for (auto* numbers : {&hessian_, &gradient_, &row_}) {
    (void)numbers->try_resize(numbers->capacity());
  }
  for (auto* states : {&positions_, &velocities_}) (void)states->try_resize(states->capacity());
}

template <int N>
QpResult<double> DenseArmQp<N>::solve(const ArmSegment<N>& segment, double softness,
                                      const Deadline& deadline) SOPT_RT {
  QpResult<double> result;
  result.status = QpStatus::kCapacity;
  if (segment.num_steps >= positions_.capacity()) return result;
  factorize(segment);
  if (!add_rows(segment) || !add_limits(segment)) return result;
  if (softness > 0.0) {
    const int num_rows = static_cast<int>(segment.rows.size());
    for (int i = 0; i < num_rows; ++i) rows_.set_softness(2 * N + i, softness);
  }
  result = qp_.solve(rows_, {}, deadline);
  result.num_active = std::max(0, result.num_active - rows_.num_equalities());
  if (result.status == QpStatus::kOptimal) write_states(segment);
  return result;
}

// 1/2 sum_j r_j (sum_{0 < t < n} v_tj^2 + w sum_t a_tj^2) in the inputs; v_n is fixed by an
// equality.
template <int N>
void DenseArmQp<N>::factorize(const ArmSegment<N>& segment) SOPT_RT {
  const int n = segment.num_steps;
  const int num_inputs = N * n;
  std::fill_n(hessian_.begin(), num_inputs * num_inputs, 0.0);
  for (int s = 0; s < n; ++s) {
    for (int r = 0; r < n; ++r) {
      const double h = n - 1 - std::max(s, r) + (s == r ? kArmInputWeight : 0.0);
      for (int j = 0; j < N; ++j) {
        hessian_[(N * s + j) * num_inputs + N * r + j] = h * segment.factors[j];
      }
    }
    for (int j = 0; j < N; ++j) {
      gradient_[N * s + j] = (n - 1 - s) * segment.first_velocity[j] * segment.factors[j];
    }
  }
  (void)rows_.factorize(num_inputs, hessian_.begin());
  rows_.reset(gradient_.begin());
}

// Coefficients of direction . quantity(t) in the inputs.
template <int N>
void DenseArmQp<N>::load(Quantity quantity, int t, const Config& direction) SOPT_RT {
  std::fill(row_.begin(), row_.end(), 0.0);
  for (int s = 0; s < t; ++s) {
    const double share = quantity == Quantity::kPosition ? t - s - 0.5 : 1.0;
    for (int j = 0; j < N; ++j) row_[N * s + j] = share * direction[j];
  }
}

template <int N>
bool DenseArmQp<N>::add_rows(const ArmSegment<N>& segment) SOPT_RT {
  const int n = segment.num_steps;
  for (int j = 0; j < N; ++j) {
    const Config axis = Config::Unit(j);
    const double v = segment.last_velocity[j] - segment.first_velocity[j];
    const double q =
        segment.last_position[j] - segment.first_position[j] - n * segment.first_velocity[j];
    load(Quantity::kPosition, n, axis);
    if (!rows_.try_add(row_.begin(), q, q)) return false;
    load(Quantity::kVelocity, n, axis);
    if (!rows_.try_add(row_.begin(), v, v)) return false;
  }
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const ArmRow<N>& row : segment.rows) {
    load(Quantity::kPosition, row.t, row.gradient);
    const double rest = row.gradient.dot(segment.first_position + row.t * segment.first_velocity);
    if (!rows_.try_add(row_.begin(), row.bound - rest, kInfinity)) return false;
  }
  return true;
}

template <int N>
bool DenseArmQp<N>::add_limits(const ArmSegment<N>& segment) SOPT_RT {
  for (int t = 1; t < segment.num_steps; ++t) {
    const auto i = static_cast<std::size_t>(t);
    for (int j = 0; j < N; ++j) {
      const double v = segment.first_velocity[j];
      const double q = segment.first_position[j] + t * v;
      load(Quantity::kPosition, t, Config::Unit(j));
      if (!rows_.try_add(row_.begin(), segment.lower[i][j] - q, segment.upper[i][j] - q)) {
        return false;
      }
      load(Quantity::kVelocity, t, Config::Unit(j));
      if (!rows_.try_add(row_.begin(), -segment.v_max[j] - v, segment.v_max[j] - v)) return false;
    }
  }
  for (int i = 0; i < N * segment.num_steps; ++i) {
    rows_.set_bounds(i, -segment.a_max[i % N], segment.a_max[i % N]);
  }
  return true;
}

template <int N>
void DenseArmQp<N>::write_states(const ArmSegment<N>& segment) SOPT_RT {
  const std::span<const double> inputs = rows_.primal();
  positions_[0] = segment.first_position;
  velocities_[0] = segment.first_velocity;
  for (int t = 0; t < segment.num_steps; ++t) {
    const Eigen::Map<const Config> a(inputs.data() + N * t);
    positions_[t + 1] = positions_[t] + velocities_[t] + 0.5 * a;
    velocities_[t + 1] = velocities_[t] + a;
  }
}

template class DenseArmQp<4>;
template class DenseArmQp<5>;
template class DenseArmQp<6>;
template class DenseArmQp<7>;
template class DenseArmQp<8>;

}  // namespace sopt
