// The QP of one arm window, in step units (omega dt, alpha dt^2):
//     min 1/2 sum_t sum_j r_j (v_tj^2 + 2 a_tj^2)   s.t. both ends fixed, the window's rows
//     (opt/arm/arm_rows.h), lower_t <= q_t <= upper_t,  |v_t| <= v_max,  |a_t| <= a_max
// r_j is the squared weight of joint j in the path metric. Over the double integrator's kernel
// (opt/qp/kernel_rows.h). Soft: rows, but not bounds, may be violated at a quadratic cost, softness
// 1e-4 of the largest gram diagonal.
#pragma once

#include <span>

#include "models/config.h"
#include "opt/arm/arm_rows.h"
#include "opt/arm/dense_arm_qp.h"
#include "opt/qp/active_set_qp.h"
#include "opt/qp/kernel_rows.h"
#include "rt/annotations.h"
#include "rt/deadline.h"

namespace sopt {

template <int N>
class ArmQp {
 public:
  using Config = typename Arm<N>::Config;

  ArmQp() noexcept = default;
  // The kernel outlives this.
  ArmQp(Arena& arena, const PlannerSettings& settings,
        const IntegratorKernel<double>& kernel) noexcept;

  [[nodiscard]] QpResult<double> solve(const ArmSegment<N>& segment, WindowSolver solver,
                                       const Deadline& deadline) SOPT_RT;
  // The segment of the last `solve` with soft rows.
  [[nodiscard]] QpResult<double> solve_soft(const ArmSegment<N>& segment, WindowSolver solver,
                                            const Deadline& deadline) SOPT_RT;

  // Of the solution, at waypoint t, in step units.
  [[nodiscard]] Config position(int t) const SOPT_RT { return value(Quantity::kPosition, t); }
  [[nodiscard]] Config velocity(int t) const SOPT_RT { return value(Quantity::kVelocity, t); }

 private:
  static constexpr int kJointLanes = N <= 4 ? 4 : 8;

  [[nodiscard]] bool load(const ArmSegment<N>& segment) SOPT_RT;
  [[nodiscard]] double largest_gram() SOPT_RT;
  [[nodiscard]] Config value(Quantity quantity, int t) const SOPT_RT;

  KernelRows<double, kJointLanes> rows_;
  ActiveSetQp<double> qp_;
  DenseArmQp<N> dense_;  // empty without PlannerSettings::dense_solver
  bool is_dense_ = false;
};

extern template class ArmQp<4>;
extern template class ArmQp<5>;
extern template class ArmQp<6>;
extern template class ArmQp<7>;
extern template class ArmQp<8>;

}  // namespace sopt
