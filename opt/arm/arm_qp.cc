#include "opt/arm/arm_qp.h"

#include <algorithm>

namespace sopt {
namespace {

// Rows active at the same time.
constexpr int kMaxActive = 256;

}  // namespace

template <int N>
ArmQp<N>::ArmQp(Arena& arena, const PlannerSettings& settings,
                const IntegratorKernel<double>& kernel) noexcept
    : rows_(arena, kernel, {settings.max_window, settings.rows_per_window, kMaxActive}),
      qp_(arena, kMaxActive) {
  if (settings.dense_solver) {
    dense_ = DenseArmQp<N>(arena, settings.max_window, settings.rows_per_window);
  }
}

template <int N>
QpResult<double> ArmQp<N>::solve(const ArmSegment<N>& segment, WindowSolver solver,
                                 const Deadline& deadline) SOPT_RT {
  QpResult<double> result;
  is_dense_ = solver == WindowSolver::kDense;
  if (is_dense_) return dense_.solve(segment, 0.0, deadline);
  if (!load(segment)) {
    result.status = QpStatus::kCapacity;
    return result;
  }
  return qp_.solve(rows_, {}, deadline);
}

template <int N>
QpResult<double> ArmQp<N>::solve_soft(const ArmSegment<N>& segment, WindowSolver solver,
                                      const Deadline& deadline) SOPT_RT {
  constexpr double kSoftness = 1e-4;  // of the largest gram diagonal
  is_dense_ = solver == WindowSolver::kDense;
  if (is_dense_ && !load(segment)) return {};  // for the gram diagonal
  const double softness = kSoftness * largest_gram();
  if (is_dense_) return dense_.solve(segment, softness, deadline);
  rows_.set_softness(softness);
  return qp_.solve(rows_, {}, deadline);
}

template <int N>
bool ArmQp<N>::load(const ArmSegment<N>& segment) SOPT_RT {
  const int n = segment.num_steps;
  KernelSegment<double> ends;
  ends.num_steps = n;
  ends.num_joints = N;
  ends.first_position = segment.first_position.data();
  ends.last_position = segment.last_position.data();
  ends.first_velocity = segment.first_velocity.data();
  ends.last_velocity = segment.last_velocity.data();
  ends.factors = segment.factors.data();
  rows_.reset(ends);
  for (int t = 1; t < n; ++t) {
    const auto i = static_cast<std::size_t>(t);
    rows_.set_bounds(Quantity::kPosition, t, t, segment.lower[i].data(), segment.upper[i].data());
  }
  const Config v_min = -segment.v_max;
  const Config a_min = -segment.a_max;
  rows_.set_bounds(Quantity::kVelocity, 1, n - 1, v_min.data(), segment.v_max.data());
  rows_.set_bounds(Quantity::kAcceleration, 0, n - 1, a_min.data(), segment.a_max.data());
  for (const ArmRow<N>& row : segment.rows) {
    if (!rows_.try_add(Quantity::kPosition, row.t, row.gradient.data(), row.bound)) return false;
  }
  return true;
}

template <int N>
double ArmQp<N>::largest_gram() SOPT_RT {
  double largest = 0.0;
  for (int i = 0; i < rows_.num_rows(); ++i) {
    const int id = rows_.row_id(i);
    double diagonal = 0.0;
    rows_.enter(id);
    rows_.gram({&id, 1}, id, &diagonal);
    rows_.leave(id);
    largest = std::max(largest, diagonal);
  }
  return largest;
}

template <int N>
typename Arm<N>::Config ArmQp<N>::value(Quantity quantity, int t) const SOPT_RT {
  return is_dense_ ? dense_.value(quantity, t)
                   : Config(Eigen::Map<const Config>(rows_.value(quantity, t)));
}

template class ArmQp<4>;
template class ArmQp<5>;
template class ArmQp<6>;
template class ArmQp<7>;
template class ArmQp<8>;

}  // namespace sopt
