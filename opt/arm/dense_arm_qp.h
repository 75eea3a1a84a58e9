// An arm window's QP as the paper solves it [Leu22, III-B]: condensed to the inputs,
//     v_t = v_0 + sum_{s<t} a_s,   q_t = q_0 + t v_0 + sum_{s<t} (t - s - 1/2) a_s
// with a dense Hessian over all joints, factorised in every window although it is the same for all
// of them: the paper's solver does not know that. O((n N)^3) per window. Same solution as the
// kernel's (opt/arm/arm_qp.h).
#pragma once

#include <span>

#include "opt/arm/arm_rows.h"
#include "opt/qp/active_set_qp.h"
#include "opt/qp/dense_rows.h"
#include "opt/qp/kernel_rows.h"
#include "rt/annotations.h"
#include "rt/deadline.h"

namespace sopt {

// What a window is between and must keep; velocities and accelerations per step.
template <int N>
struct ArmSegment {
  using Config = typename Arm<N>::Config;
  int num_steps = 0;
  Config first_position, last_position;
  Config first_velocity, last_velocity;
  std::span<const ArmRow<N>> rows;
  std::span<const Config> lower, upper;  // positions, by waypoint
  Config v_max, a_max;
  Config factors;  // r_j of the joints' costs: their squared weights in the path metric
};

template <int N>
class DenseArmQp {
 public:
  using Config = typename Arm<N>::Config;

  DenseArmQp() noexcept = default;
  DenseArmQp(Arena& arena, int max_window, int max_rows) noexcept;

  // softness 0: rows are hard.
  [[nodiscard]] QpResult<double> solve(const ArmSegment<N>& segment, double softness,
                                       const Deadline& deadline) SOPT_RT;

  // Position or velocity at waypoint t of the last solution.
  [[nodiscard]] Config value(Quantity quantity, int t) const SOPT_RT {
    return quantity == Quantity::kPosition ? positions_[t] : velocities_[t];
  }

 private:
  void factorize(const ArmSegment<N>& segment) SOPT_RT;
  [[nodiscard]] bool add_rows(const ArmSegment<N>& segment) SOPT_RT;
  [[nodiscard]] bool add_limits(const ArmSegment<N>& segment) SOPT_RT;
  void load(Quantity quantity, int t, const Config& direction) SOPT_RT;
  void write_states(const ArmSegment<N>& segment) SOPT_RT;

  DenseRows<double> rows_;
  ActiveSetQp<double> qp_;
  FixedVector<double> hessian_;                 // nN x nN
  FixedVector<double> gradient_;                // nN: input of joint j at time t at t N + j
  FixedVector<double> row_;                     // nN
  FixedVector<Config> positions_, velocities_;  // n + 1
};

extern template class DenseArmQp<4>;
extern template class DenseArmQp<5>;
extern template class DenseArmQp<6>;
extern template class DenseArmQp<7>;
extern template class DenseArmQp<8>;

}  // namespace sopt
