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
  }
  return "unknown violation";
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

std::string describe_figures(const PlanResult<Point2>& result, const StageTimes& times) {
  const std::string time = describe_time(times.total_ns);
  if (!result.plan) {
    return format("%lld nodes, %lld edges checked, stopped after %s",
                  static_cast<long long>(result.sampler_counts.nodes),
                  static_cast<long long>(result.sampler_counts.edges), time.c_str());
  }
  const Trajectory<Point2>& trajectory = result.plan->trajectory();
  return format("%.4g m in %.4g s, %d steps, %d iterations, clearance %.3g m, planned in %s",
                result.path_length, trajectory.duration_s(), trajectory.horizon(),
                result.iterations, result.plan->certificate().min_clearance_m, time.c_str());
}

std::string describe_failure(const Scene& scene, const PlanResult<Point2>& result) {
  if (result.plan) return "";
  const PlanFailure& failure = result.failure;
  std::string line = failure.reason;
  if (failure.i_obstacle != kNoObstacle) {
    line += format(": clearance %.4g m from %s", failure.amount,
                   obstacle_name(scene, failure.i_obstacle).c_str());
  } else if (failure.amount != 0.0) {
    line += format(": %.4g", failure.amount);
  }
  if (failure.t_s != 0.0) line += format(" at %.4g s", failure.t_s);
  return line;
}

std::string describe_certificate(const Scene& scene, const Certificate& certificate) {
  std::string text = "  clearance     ";
  if (certificate.i_obstacle == kNoObstacle) {
    text += "nothing near\n";
  } else {
    text += format("%.6g m at %.4g s, from %s\n", certificate.min_clearance_m,
                   certificate.where_t_s, obstacle_name(scene, certificate.i_obstacle).c_str());
  }
  text += format("  certificate   goal error %.2g m, dynamics defect %.2g m, ",
                 certificate.goal_error, certificate.dynamics_defect);
  const bool has_limit = scene.robot.v_max_mps < std::numeric_limits<double>::infinity();
  text += has_limit ? format("top speed %.4g %% of the limit\n",
                             100.0 * (1.0 - certificate.worst_limit_margin))
                    : "no speed limit\n";
  return text;
}

std::string describe_violation(const Scene& scene, const Violation& violation,
                               double min_clearance_m) {
  std::string text =
      format("%s at %.6g s (step %d)", describe(violation.kind), violation.t_s, violation.step);
  switch (violation.kind) {
    case ViolationKind::kCollision:
      text += format(": clearance %.6g m from %s, at least %g m needed", violation.amount,
                     obstacle_name(scene, violation.i_obstacle).c_str(), min_clearance_m);
      break;
    case ViolationKind::kStart:
    case ViolationKind::kGoal:
      text += format(": %.3g m away", violation.amount);
      break;
    case ViolationKind::kDynamics:
      text += format(": defect %.3g m, at most %g m allowed", violation.amount, kMaxDynamicsDefect);
      break;
    case ViolationKind::kSpeed:
      text += format(": by %.3g m/s, the limit is %g m/s", violation.amount, scene.robot.v_max_mps);
      break;
    case ViolationKind::kNone:
    case ViolationKind::kShape:
    case ViolationKind::kNotFinite:
      break;
  }
  return text;
}

std::string describe_plan(const Scene& scene, const PlanResult<Point2>& result,
                          const StageTimes& times, int num_calls) {
  const std::string name = printable(scene.name);
  std::string text = format("%s  %s", to_string(result.status), name.c_str());
  if (!result.plan) {
    text += format(": no plan after %s\n", describe_time(times.total_ns).c_str());
    text += "  reason        " + describe_failure(scene, result) + '\n';
    return text + describe_times(times, num_calls);
  }
  const Trajectory<Point2>& trajectory = result.plan->trajectory();
  text += format(": verified plan in %s\n", describe_time(times.total_ns).c_str());
  text += format("  path          %.5g m in %.4g s, %d steps of %.4g s; the sampler's was %.5g m\n",
                 result.path_length, trajectory.duration_s(), trajectory.horizon(), trajectory.dt_s,
                 result.sampler_path_length);
  text += format("  optimisation  %d iterations, %d -> %d segments, cost %.5g, margin %.3g m\n",
                 result.iterations, result.segments_initial, result.segments_final, result.cost,
                 result.margin_m);
  if (result.fell_back)
    text += "                its result was refused: this is the path as sampled\n";
  text += describe_certificate(scene, result.plan->certificate());
  return text + describe_times(times, num_calls);
}

}  // namespace sopt
