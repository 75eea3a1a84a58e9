// Verify's rules for arms: what holds at waypoints and within a step is checked here in closed
// form, clearance by ArmSweep and, at waypoints, ArmCcd. What a step's motion is, the states and
// inputs say: a parabola per joint.
#include <algorithm>
#include <cmath>
#include <limits>

#include "opt/verify/verify.h"
#include "opt/verify/verify_arm_ccd.h"
#include "opt/verify/verify_arm_sweep.h"

namespace sopt {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kWholeTurnTol_rad = 1e-12;  // of a continuous joint's angle

static_assert(sizeof(ArmSweep<kMaxArmJoints>) + sizeof(ArmMotion<kMaxArmJoints>) < 60 * 1024,
              "verify stays within 64 KiB of stack");
static_assert(sizeof(ArmCcd<kMaxArmJoints>) < sizeof(ArmSweep<kMaxArmJoints>),
              "one after the other");

// Collects the certificate and the earliest violation.
template <int N>
class ArmCheck {
 public:
  using Config = typename Arm<N>::Config;
  using State = typename Arm<N>::State;

  ArmCheck(const Arm<N>& arm, const Trajectory<Arm<N>>& trajectory,
           const VerifyProblem<Arm<N>>& problem) noexcept
      : arm_(arm), trajectory_(trajectory), problem_(problem) {
    certificate_.worst_limit_margin = 1.0;
    violation_.kind = ViolationKind::kNone;
  }

  // Each returns false when there is no point in looking further.
  [[nodiscard]] bool shape() noexcept {
    const int horizon = trajectory_.horizon();
    const bool fits = horizon >= 1 && trajectory_.inputs.size() == horizon;
    if (fits && trajectory_.dt_s > 0.0 && std::isfinite(trajectory_.dt_s)) return true;
    report(ViolationKind::kShape, 0.0, trajectory_.dt_s);
    return false;
  }

  [[nodiscard]] bool finite() noexcept {
    for (int t = 0; t <= trajectory_.horizon(); ++t) {
      const bool input_ok = t == trajectory_.horizon() || trajectory_.inputs[t].allFinite();
      if (trajectory_.states[t].allFinite() && input_ok) continue;
      report(ViolationKind::kNotFinite, t, 0.0);
      return false;
    }
    return true;
  }

  void ends() noexcept {
    const int horizon = trajectory_.horizon();
    const double start_error = end_error(trajectory_.states[0], problem_.start);
    certificate_.goal_error = end_error(trajectory_.states[horizon], problem_.goal);
    if (start_error != 0.0) report(ViolationKind::kStart, 0.0, start_error);
    if (certificate_.goal_error != 0.0) {
      report(ViolationKind::kGoal, horizon, certificate_.goal_error);
    }
    for (const int t : {0, horizon}) {
      int j = 0;
      const double speed = trajectory_.states[t].template tail<N>().cwiseAbs().maxCoeff(&j);
      if (speed != 0.0) report(ViolationKind::kNotAtRest, t, speed, j);
    }
  }

  void dynamics() noexcept {
    const double dt_s = trajectory_.dt_s;
    for (int t = 0; t < trajectory_.horizon(); ++t) {
      const auto theta = trajectory_.states[t].template head<N>();
      const auto omega = trajectory_.states[t].template tail<N>();
      const Config& alpha = trajectory_.inputs[t];
      State end;
      end.template head<N>() = theta + dt_s * (omega + (0.5 * dt_s) * alpha);
      end.template tail<N>() = omega + dt_s * alpha;
      const double defect = (end - trajectory_.states[t + 1]).norm();
      certificate_.dynamics_defect = std::max(certificate_.dynamics_defect, defect);
      if (!(defect <= kMaxDynamicsDefect)) report(ViolationKind::kDynamics, t + 1, defect);
    }
  }

  void limits() noexcept {
    const int horizon = trajectory_.horizon();
    for (int t = 0; t <= horizon; ++t) {
      for (int j = 0; j < N; ++j) {
        const double omega = trajectory_.states[t][N + j];
        position(t, j, trajectory_.states[t][j]);
        magnitude(ViolationKind::kVelocity, t, j, omega, arm_.v_max()[j]);
        if (t == horizon) continue;
        const double alpha = trajectory_.inputs[t][j];
        magnitude(ViolationKind::kAcceleration, t, j, alpha, arm_.a_max()[j]);
        const double turn_s = -omega / alpha;  // where the joint turns back
        if (!(turn_s > 0.0 && turn_s < trajectory_.dt_s)) continue;
        position(t + turn_s / trajectory_.dt_s, j, trajectory_.states[t][j] + 0.5 * omega * turn_s);
      }
    }
  }

  void clearance() noexcept {
    const bool is_complete = violation_.kind == ViolationKind::kNone;
    const double x_stop = is_complete ? trajectory_.horizon() + 1.0 : x_violation_;
    // Larger defects are violations, and nothing after the first one matters.
    const double defect = std::min(certificate_.dynamics_defect, kMaxDynamicsDefect);
    const ArmMotion<N> motion(arm_, trajectory_, defect);
    ask_ccd(motion, sweep(motion, x_stop));
  }

  [[nodiscard]] const Certificate& certificate() const noexcept { return certificate_; }
  [[nodiscard]] const Violation& violation() const noexcept { return violation_; }

 private:
  // Not inlined: the two are on the stack one after the other. Returns where to stop looking.
  [[gnu::noinline]] double sweep(const ArmMotion<N>& motion, double x_stop) noexcept {
    ArmSweep<N> sweep(arm_, problem_, motion, trajectory_.dt_s, x_stop);
    const Violation found = sweep.run(certificate_);
    if (found.kind != ViolationKind::kNone) violation_ = found;
    return sweep.x_stop();
  }
  [[gnu::noinline]] void ask_ccd(const ArmMotion<N>& motion, double x_stop) noexcept {
    ArmCcd<N> ccd(arm_, problem_, motion);
    const Violation found = ccd.run(trajectory_.dt_s, x_stop);
    if (found.kind != ViolationKind::kNone) violation_ = found;
  }

  // Distance from where the trajectory should begin or end; a continuous joint may have turned
  // around any number of times.
  [[nodiscard]] double end_error(const State& state, const Config& wanted) const noexcept {
    Config error = state.template head<N>() - wanted;
    for (int j = 0; j < N; ++j) {
      if (arm_.joint(j).kind != JointKind::kContinuous) continue;
      error[j] -= 2.0 * kPi * std::round(error[j] / (2.0 * kPi));
      if (std::abs(error[j]) <= kWholeTurnTol_rad) error[j] = 0.0;
    }
    return error.norm();
  }

  void position(double x, int j, double q) noexcept {
    if (arm_.joint(j).kind == JointKind::kContinuous) return;
    const double lower = arm_.lower()[j];
    const double upper = arm_.upper()[j];
    const double inside = std::min(q - lower, upper - q);
    if (upper > lower) keep_margin(2.0 * inside / (upper - lower), j);
    if (!(inside >= -kMaxLimitExcess)) report(ViolationKind::kPosition, x, -inside, j);
  }

  void magnitude(ViolationKind kind, double x, int j, double value, double limit) noexcept {
    const double excess = std::abs(value) - limit;
    if (std::isfinite(limit)) keep_margin(-excess / limit, j);
    if (!(excess <= kMaxLimitExcess)) report(kind, x, excess, j);
  }

  void keep_margin(double margin, int j) noexcept {
    if (!(margin < certificate_.worst_limit_margin)) return;
    certificate_.worst_limit_margin = margin;
    certificate_.i_joint = j;
  }

  void report(ViolationKind kind, double x, double amount, int i_joint = kNoJoint) noexcept {
    if (violation_.kind != ViolationKind::kNone && !(x < x_violation_)) return;
    x_violation_ = x;
    const int step = std::clamp(static_cast<int>(x), 0, std::max(trajectory_.horizon() - 1, 0));
    violation_ = {kind, step, x * trajectory_.dt_s, 0, kNoObstacle, amount, kNoLink, i_joint};
  }

  const Arm<N>& arm_;
  const Trajectory<Arm<N>>& trajectory_;
  const VerifyProblem<Arm<N>>& problem_;
  Certificate certificate_;
  Violation violation_;
  double x_violation_ = 0.0;
};

}  // namespace

template <int N>
Violation find_violation(const Arm<N>& arm, const Trajectory<Arm<N>>& trajectory,
                         const VerifyProblem<Arm<N>>& problem, Certificate& certificate) SOPT_RT {
  ArmCheck<N> check(arm, trajectory, problem);
  if (check.shape() && check.finite()) {
    check.ends();
    check.dynamics();
    check.limits();
    check.clearance();
  }
  certificate = check.certificate();
  return check.violation();
}

#define SOPT_INSTANTIATE(N)                                                       \
  template Violation find_violation(const Arm<(N)>&, const Trajectory<Arm<(N)>>&, \
                                    const VerifyProblem<Arm<(N)>>&, Certificate&) SOPT_RT
SOPT_INSTANTIATE(4);
SOPT_INSTANTIATE(5);
SOPT_INSTANTIATE(6);
SOPT_INSTANTIATE(7);
SOPT_INSTANTIATE(8);
#undef SOPT_INSTANTIATE

}  // namespace sopt
