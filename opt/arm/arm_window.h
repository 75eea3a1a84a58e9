// One window of one sweep for an arm, positions and velocities fixed at both ends:
// 1. The QP without rows. Where its solution keeps the whole margin it is the window's.
// 2. Else rows per (link, obstacle) and pair of links at every interior waypoint, as far away as
//    the links would have moved, and the QP with them; soft when they cannot all hold.
// 3. The largest step {1, 1/2, .. 1/16} towards its solution that passes the window check: limits
//    at all times, clearance along the parabolas between waypoints at least min_clearance, nothing
//    at a waypoint closer than the profile asks for (or than it was), a lower cost.
// Rows are linearisations of sets that are not convex: the check is what keeps the window safe. It
// lowers the clearances known from the rows by bounds on the links' motion and computes only those
// that this does not decide. The profile is fixed, so that nothing erodes over sweeps.
#pragma once

#include "opt/arm/arm_gaps.h"
#include "opt/arm/arm_qp.h"
#include "opt/arm/arm_rows.h"
#include "opt/splits.h"
#include "opt/sweep_problem.h"
#include "rt/annotations.h"
#include "rt/deadline.h"

namespace sopt {

// Largest activation radius of rows beyond the margin, m.
inline constexpr double kArmActivation_m = 0.25;

template <int N>
class WindowOptimizer<Arm<N>> {
 public:
  using Robot = Arm<N>;
  using Config = typename Robot::Config;
  using State = typename Robot::State;
  static constexpr int kMinSteps = 3;  // fewer leave nothing to move

  struct Shared {
    Shared() noexcept = default;
    Shared(Arena& arena, const PlannerSettings& settings) noexcept;
    IntegratorKernel<double> kernel;
  };

  WindowOptimizer() noexcept = default;
  WindowOptimizer(Arena& arena, const PlannerSettings& settings, const Shared& shared) noexcept;

  // Optimises states(window.first, window.last), both exclusive, in place.
  [[nodiscard]] WindowResult optimize(const SweepProblem<Robot>& problem, const Window& window,
                                      const Deadline& deadline) SOPT_RT;

  // Rows of the last window, for tests and pictures.
  [[nodiscard]] std::span<const ArmRow<N>> rows() const SOPT_RT { return rows_.rows(); }

 private:
  [[nodiscard]] WindowStatus improve(const SweepProblem<Robot>& problem, const Window& window,
                                     const Deadline& deadline, WindowResult& result) SOPT_RT;
  [[nodiscard]] ArmSegment<N> make_segment(const SweepProblem<Robot>& problem,
                                           const State* reference) SOPT_RT;
  [[nodiscard]] QpStatus solve(const SweepProblem<Robot>& problem, const ArmSegment<N>& segment,
                               const State* reference, const Deadline& deadline,
                               WindowResult& result) SOPT_RT;
  void linearize(const SweepProblem<Robot>& problem, const Window& window) SOPT_RT;
  [[nodiscard]] WindowStatus take_step(const SweepProblem<Robot>& problem, const Window& window,
                                       WindowResult& result) SOPT_RT;
  WindowStatus write(const SweepProblem<Robot>& problem, State* reference, double share,
                     WindowResult& result) SOPT_RT;
  [[nodiscard]] bool gains(const SweepProblem<Robot>& problem,
                           const WindowResult& result) const SOPT_RT;
  [[nodiscard]] double candidate_cost(const SweepProblem<Robot>& problem) const SOPT_RT;

  // The window check.
  [[nodiscard]] bool keeps_margin(const SweepProblem<Robot>& problem, const Window& window) SOPT_RT;
  [[nodiscard]] bool passes(const SweepProblem<Robot>& problem, const Window& window) SOPT_RT;
  [[nodiscard]] bool keeps_limits(const Robot& robot, double dt_s) const SOPT_RT;
  [[nodiscard]] bool keeps_waypoints(const SweepProblem<Robot>& problem,
                                     const Window& window) SOPT_RT;
  void measure(const SweepProblem<Robot>& problem, const Window& window, int t) SOPT_RT;
  [[nodiscard]] bool steps_are_clear(const SweepProblem<Robot>& problem,
                                     const Window& window) SOPT_RT;
  [[nodiscard]] bool step_is_clear(const SweepProblem<Robot>& problem, const Window& window,
                                   int t) SOPT_RT;

  int max_window_ = 0;
  int num_steps_ = 0;    // of the window
  double full_m_ = 0.0;  // largest bound on a link's move from the reference to the solution
  ArmRows<N> rows_;
  ArmQp<N> qp_;
  ArmGapFinder<N> finder_;
  FixedVector<Config> lower_, upper_;       // of positions, by waypoint
  FixedVector<ArmGaps<N>> gaps_;            // at the reference
  FixedVector<ArmGaps<N>> candidate_gaps_;  // at the candidate
  FixedVector<bool> is_measured_;           // candidate_gaps_ are exact
  FixedVector<State> solution_;             // of the last QP
  FixedVector<LinkRadii<N>> move_m_;        // bounds by link, without rows
  FixedVector<State> candidate_;
};

extern template class WindowOptimizer<Arm<4>>;
extern template class WindowOptimizer<Arm<5>>;
extern template class WindowOptimizer<Arm<6>>;
extern template class WindowOptimizer<Arm<7>>;
extern template class WindowOptimizer<Arm<8>>;

}  // namespace sopt
