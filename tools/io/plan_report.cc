#include "tools/io/plan_report.h"

#include <cstdarg>
#include <cstdio>
#include <limits>

#include "tools/io/json_fields.h"
#include "tools/io/plan_file.h"

namespace sopt {
namespace {

double to_us(std::int64_t time_ns) { return static_cast<double>(time_ns) / 1000.0; }

// "0.283 ms", "12.4 us" or "1.2 s".
std::string describe_time(std::int64_t time_ns) {
  const double time_us = to_us(time_ns);
  if (time_us < 1e3) return format("%.3g us", time_us);
  if (time_us < 1e6) return format("%.3g ms", time_us / 1e3);
  return format("%.3g s", time_us / 1e6);
}

std::string describe_times(const StageTimes& times, int num_calls) {
  std::string text = format(
      "  times (us)    sample %.1f, shortcut %.1f, reference %.1f, optimise %.1f, verify %.1f, "
      "total %.1f\n",
      to_us(times.sample_ns), to_us(times.shortcut_ns), to_us(times.reference_ns),
      to_us(times.optimize_ns), to_us(times.verify_ns), to_us(times.total_ns));
  if (num_calls > 1) text += format("                medians over %d calls\n", num_calls);
  return text;
}

const char* describe(ViolationKind kind) {
  switch (kind) {
    case ViolationKind::kNone:
      return "no violation";
    case ViolationKind::kShape:
      return "no motion, or a step time that is not positive";
    case ViolationKind::kNotFinite:
      return "a state or input is not finite";
    case ViolationKind::kStart:
      return "the first state is not the start";
    case ViolationKind::kGoal:
      return "the last state is not the goal";
    case ViolationKind::kDynamics:
      return "the next state does not follow from the input";
    case ViolationKind::kSpeed:
      return "faster than the limit";
    case ViolationKind::kCollision:
      return "too close";
    case ViolationKind::kNotAtRest:
      return "not at rest at an end";
    case ViolationKind::kPosition:
      return "a joint outside its limits";
    case ViolationKind::kVelocity:
      return "a joint faster than its limit";
    case ViolationKind::kAcceleration:
      return "a joint that accelerates beyond its limit";
    case ViolationKind::kSelfCollision:
      return "two links too close";
    case ViolationKind::kSecondOpinion:
      return "the second opinion sees contact";
  }
  return "unknown violation";
}

// The planar robot is one body without names.
std::string of_link(const Scene& /*scene*/, int /*i_link*/) { return ""; }
std::string joint_name(const Scene& /*scene*/, int i_joint) { return i_joint == 0 ? "x" : "y"; }
std::string partner_name(const Scene& scene, int i_obstacle, int /*i_other_link*/) {
  return obstacle_name(scene, i_obstacle);
}
double speed_limit(const Scene& scene) { return scene.robot.v_max_mps; }
std::string describe_limits(const Scene& scene, const Certificate& certificate) {
  if (speed_limit(scene) == std::numeric_limits<double>::infinity()) return "no speed limit\n";
  return format("top speed %.4g %% of the limit\n", 100.0 * (1.0 - certificate.worst_limit_margin));
}

std::string name_of(const std::vector<std::string>& names, int i) {
  return printable(names[static_cast<std::size_t>(i)]);
}
template <int N>
std::string of_link(const ArmScene<N>& scene, int i_link) {
  return " of link " + name_of(scene.link_names, i_link);
}
template <int N>
std::string joint_name(const ArmScene<N>& scene, int i_joint) {
  return "joint " + name_of(scene.joint_names, i_joint);
}
template <int N>
std::string partner_name(const ArmScene<N>& scene, int i_obstacle, int i_other_link) {
  if (i_obstacle == kSelfObstacle) return "link " + name_of(scene.link_names, i_other_link);
  return obstacle_name(scene, i_obstacle);
}
template <int N>
double speed_limit(const ArmScene<N>& /*scene*/) {
  return std::numeric_limits<double>::infinity();  // joints have limits of their own
}
template <int N>
std::string describe_limits(const ArmScene<N>& scene, const Certificate& certificate) {
  std::string text = format("%.3g %% of a limit left", 100.0 * certificate.worst_limit_margin);
  if (certificate.i_joint != kNoJoint) text += ", " + joint_name(scene, certificate.i_joint);
  text += '\n';
  if (certificate.i_self_link == kNoLink) return text;
  return text + format("  links         %.6g m%s from %s at %.4g s\n",
                       certificate.min_self_clearance_m,
                       of_link(scene, certificate.i_self_link).c_str(),
                       partner_name(scene, kSelfObstacle, certificate.i_other_link).c_str(),
                       certificate.self_where_t_s);
}

}  // namespace

const char* to_string(ViolationKind kind) {
  switch (kind) {
    case ViolationKind::kNone:
      return "none";
    case ViolationKind::kShape:
      return "shape";
    case ViolationKind::kNotFinite:
      return "not_finite";
    case ViolationKind::kStart:
      return "start";
    case ViolationKind::kGoal:
      return "goal";
    case ViolationKind::kDynamics:
      return "dynamics";
    case ViolationKind::kSpeed:
      return "speed";
    case ViolationKind::kCollision:
      return "collision";
    case ViolationKind::kNotAtRest:
      return "not_at_rest";
    case ViolationKind::kPosition:
      return "position";
    case ViolationKind::kVelocity:
      return "velocity";
    case ViolationKind::kAcceleration:
      return "acceleration";
    case ViolationKind::kSelfCollision:
      return "self_collision";
    case ViolationKind::kSecondOpinion:
      return "second_opinion";
  }
  return "none";
}

std::string format(const char* pattern, ...) {
  std::va_list arguments;
  va_start(arguments, pattern);
  std::va_list again;
  va_copy(again, arguments);
  const int length = std::vsnprintf(nullptr, 0, pattern, arguments);
  va_end(arguments);
  std::string text(static_cast<std::size_t>(length) + 1, '\0');
  (void)std::vsnprintf(text.data(), text.size(), pattern, again);
  va_end(again);
  text.pop_back();
  return text;
}

template <class Robot>
std::string describe_figures(const PlanResult<Robot>& result, const StageTimes& times) {
  const std::string time = describe_time(times.total_ns);
  if (!result.plan) {
    return format("%lld nodes, %lld edges checked, stopped after %s",
                  static_cast<long long>(result.sampler_counts.nodes),
                  static_cast<long long>(result.sampler_counts.edges), time.c_str());
  }
  const Trajectory<Robot>& trajectory = result.plan->trajectory();
  return format("%.4g %s in %.4g s, %d steps, %d iterations, clearance %.3g m, planned in %s",
                result.path_length, kPathUnit<Robot>, trajectory.duration_s(), trajectory.horizon(),
                result.iterations, result.plan->certificate().min_clearance_m, time.c_str());
}

template <class Robot>
std::string describe_failure(const SceneOf<Robot>& scene, const PlanResult<Robot>& result) {
  if (result.plan) return "";
  const PlanFailure& failure = result.failure;
  std::string line = failure.reason;
  if (failure.i_joint >= 0 && failure.stage != PlanStage::kRequest) {
    line += format(": %s by %.3g", joint_name(scene, failure.i_joint).c_str(), failure.amount);
  } else if (failure.i_joint >= 0) {
    line +=
        format(": %s is %.6g, allowed is %.6g to %.6g", joint_name(scene, failure.i_joint).c_str(),
               failure.amount, failure.lower, failure.upper);
  } else if (failure.i_obstacle != kNoObstacle) {
    line += format(": clearance %.6g m%s from %s", failure.amount,
                   of_link(scene, failure.i_link).c_str(),
                   partner_name(scene, failure.i_obstacle, failure.i_other_link).c_str());
    if (failure.lower > 0.0) line += format(", at least %.6g m needed", failure.lower);
  } else if (failure.amount != 0.0) {
    line += format(": %.4g", failure.amount);
  }
  if (failure.t_s != 0.0) line += format(" at %.4g s", failure.t_s);
  return line;
}

template <class Robot>
std::string describe_certificate(const SceneOf<Robot>& scene, const Certificate& certificate) {
  std::string text = "  clearance     ";
  if (certificate.i_obstacle == kNoObstacle) {
    text += "nothing near\n";
  } else {
    text += format("%.6g m%s at %.4g s, from %s\n", certificate.min_clearance_m,
                   of_link(scene, certificate.i_link).c_str(), certificate.where_t_s,
                   obstacle_name(scene, certificate.i_obstacle).c_str());
  }
  text += format("  certificate   goal error %.2g %s, dynamics defect %.2g, ",
                 certificate.goal_error, kPathUnit<Robot>, certificate.dynamics_defect);
  return text + describe_limits(scene, certificate);
}

template <class Robot>
std::string describe_violation(const SceneOf<Robot>& scene, const Violation& violation,
                               double min_clearance_m) {
  std::string text =
      format("%s at %.6g s (step %d)", describe(violation.kind), violation.t_s, violation.step);
  switch (violation.kind) {
    case ViolationKind::kCollision:
    case ViolationKind::kSecondOpinion:
      text += format(": clearance %.6g m%s from %s, at least %g m needed", violation.amount,
                     of_link(scene, violation.i_link).c_str(),
                     partner_name(scene, violation.i_obstacle, violation.i_other_link).c_str(),
                     min_clearance_m);
      break;
    case ViolationKind::kSelfCollision:
      text += format(": clearance %.6g m%s from %s", violation.amount,
                     of_link(scene, violation.i_link).c_str(),
                     partner_name(scene, kSelfObstacle, violation.i_other_link).c_str());
      break;
    case ViolationKind::kStart:
    case ViolationKind::kGoal:
      text += format(": %.3g %s away", violation.amount, kPathUnit<Robot>);
      break;
    case ViolationKind::kDynamics:
      text += format(": defect %.3g %s, at most %g allowed", violation.amount, kPathUnit<Robot>,
                     kMaxDynamicsDefect);
      break;
    case ViolationKind::kSpeed:
      text += format(": by %.3g m/s, the limit is %g m/s", violation.amount, speed_limit(scene));
      break;
    case ViolationKind::kNotAtRest:
      text += format(": %s moves at %.3g per second", joint_name(scene, violation.i_joint).c_str(),
                     violation.amount);
      break;
    case ViolationKind::kPosition:
    case ViolationKind::kVelocity:
    case ViolationKind::kAcceleration:
      text +=
          format(": %s by %.3g", joint_name(scene, violation.i_joint).c_str(), violation.amount);
      break;
    case ViolationKind::kNone:
    case ViolationKind::kShape:
    case ViolationKind::kNotFinite:
      break;
  }
  return text;
}

template <class Robot>
std::string describe_plan(const SceneOf<Robot>& scene, const PlanResult<Robot>& result,
                          const StageTimes& times, int num_calls) {
  const std::string name = printable(scene.name);
  std::string text = format("%s  %s", to_string(result.status), name.c_str());
  if (!result.plan) {
    text += format(": no plan after %s\n", describe_time(times.total_ns).c_str());
    text += "  reason        " + describe_failure<Robot>(scene, result) + '\n';
    return text + describe_times(times, num_calls);
  }
  const Trajectory<Robot>& trajectory = result.plan->trajectory();
  text += format(": verified plan in %s\n", describe_time(times.total_ns).c_str());
  text +=
      format("  path          %.5g %s in %.4g s, %d steps of %.4g s; the sampler's was %.5g %s\n",
             result.path_length, kPathUnit<Robot>, trajectory.duration_s(), trajectory.horizon(),
             trajectory.dt_s, result.sampler_path_length, kPathUnit<Robot>);
  text += format("  optimisation  %d iterations, %d -> %d segments, cost %.5g, margin %.3g m\n",
                 result.iterations, result.segments_initial, result.segments_final, result.cost,
                 result.margin_m);
  if (result.fell_back)
    text += "                its result was refused: this is the path as sampled\n";
  text += describe_certificate<Robot>(scene, result.plan->certificate());
  return text + describe_times(times, num_calls);
}

#define SOPT_PLAN_REPORT(Robot)                                                                \
  template std::string describe_plan(const SceneOf<Robot>&, const PlanResult<Robot>&,          \
                                     const StageTimes&, int);                                  \
  template std::string describe_figures(const PlanResult<Robot>&, const StageTimes&);          \
  template std::string describe_failure(const SceneOf<Robot>&, const PlanResult<Robot>&);      \
  template std::string describe_certificate<Robot>(const SceneOf<Robot>&, const Certificate&); \
  template std::string describe_violation<Robot>(const SceneOf<Robot>&, const Violation&, double);
SOPT_PLAN_REPORT(Point2)
SOPT_PLAN_REPORT(Arm<4>)
SOPT_PLAN_REPORT(Arm<5>)
SOPT_PLAN_REPORT(Arm<6>)
SOPT_PLAN_REPORT(Arm<7>)
SOPT_PLAN_REPORT(Arm<8>)
#undef SOPT_PLAN_REPORT

}  // namespace sopt
