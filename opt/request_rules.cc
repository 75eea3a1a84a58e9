#include "opt/request_rules.h"

#include <cmath>

namespace sopt {

template <class Robot>
BrokenRule find_broken_rule(const PlanRequest<Robot>& request,
                            const PlannerSettings& settings) SOPT_RT {
  const PlanOptions& o = request.options;
  struct Rule {
    bool holds;
    const char* reason;
    double value;
  };
  const auto positive = [](double v) { return v > 0.0 && std::isfinite(v); };
  const auto not_negative = [](double v) { return v >= 0.0 && std::isfinite(v); };
  const Rule rules[] = {
      {request.world != nullptr, "world is missing", 0.0},
      {request.start.allFinite(), "start is not finite", 0.0},
      {request.goal.allFinite(), "goal is not finite", 0.0},
      {request.deadline_s > 0.0, "deadline_s must be positive", request.deadline_s},
      {not_negative(o.speed_mps), "speed_mps must be finite and not negative", o.speed_mps},
      {positive(o.dt_s), "dt_s must be finite and positive", o.dt_s},
      {positive(o.min_clearance_m), "min_clearance_m must be finite and positive",
       o.min_clearance_m},
      {std::isfinite(o.margin_m) && o.margin_m >= o.min_clearance_m,
       "margin_m must be finite and at least min_clearance_m", o.margin_m},
      {o.num_samples > 0, "num_samples must be positive", static_cast<double>(o.num_samples)},
      {o.num_batches > 0, "num_batches must be positive", static_cast<double>(o.num_batches)},
      {o.num_streams >= 0 && o.num_streams <= settings.num_streams,
       "num_streams must be 0 or at most PlannerSettings::num_streams",
       static_cast<double>(o.num_streams)},
      {o.num_segments >= 0 && o.num_segments <= settings.max_horizon,
       "num_segments must be 0 or at most max_horizon", static_cast<double>(o.num_segments)},
      {o.steps_per_window >= 2, "steps_per_window must be at least 2",
       static_cast<double>(o.steps_per_window)},
      {o.solver != WindowSolver::kDense || settings.dense_solver,
       "solver is kDense without PlannerSettings::dense_solver", 0.0},
      {o.max_window == 0 || (o.max_window >= 4 && o.max_window <= settings.max_window),
       "max_window must be 0 or in [4, PlannerSettings::max_window]",
       static_cast<double>(o.max_window)},
      {o.max_iterations >= 0 && o.max_iterations <= kMaxIterations,
       "max_iterations must be in [0, kMaxIterations]", static_cast<double>(o.max_iterations)},
      {not_negative(o.improve_s), "improve_s must be finite and not negative", o.improve_s},
      {not_negative(o.tol_step), "tol_step must be finite and not negative", o.tol_step},
  };
  for (const Rule& rule : rules) {
    if (!rule.holds) return {rule.reason, rule.value};
  }
  return {};
}

template BrokenRule find_broken_rule(const PlanRequest<Point2>&, const PlannerSettings&) SOPT_RT;
template BrokenRule find_broken_rule(const PlanRequest<Arm<4>>&, const PlannerSettings&) SOPT_RT;
template BrokenRule find_broken_rule(const PlanRequest<Arm<5>>&, const PlannerSettings&) SOPT_RT;
template BrokenRule find_broken_rule(const PlanRequest<Arm<6>>&, const PlannerSettings&) SOPT_RT;
template BrokenRule find_broken_rule(const PlanRequest<Arm<7>>&, const PlannerSettings&) SOPT_RT;
template BrokenRule find_broken_rule(const PlanRequest<Arm<8>>&, const PlannerSettings&) SOPT_RT;

}  // namespace sopt
