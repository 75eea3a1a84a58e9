#include <algorithm>
#include <cstdint>
#include <type_traits>
#include <variant>

#include "tools/io/json_fields.h"
#include "tools/io/plan_report.h"
#include "tools/tables/tables_figures.h"
#include "tools/tables/timed_planner.h"

namespace sopt {
namespace {

double to_ms(std::int64_t time_ns) { return 1e-6 * static_cast<double>(time_ns); }

// Restarts until the budget is used; the last point is where it ends.
template <class Robot>
ChartSeries sample_alone(TimedPlanner<Robot>& timed, const AlgorithmOptions& choices,
                         double budget_ms) {
  ChartSeries series{"RRT* alone: restarts, best so far", {}, SeriesStyle::kSteps, {}};
  double time_ms = 0.0;
  int num_starts = 0;
  while (time_ms < budget_ms) {
    PlanRequest<Robot> request =
        timed.make_request(choices, static_cast<std::uint64_t>(++num_starts));
    request.options.max_iterations = 0;
    const PlanResult<Robot> result = timed.planner().plan(request);
    if (result.path == nullptr) {
      time_ms += to_ms(result.times.total_ns);
      continue;
    }
    time_ms += to_ms(result.times.sample_ns + result.times.shortcut_ns);
    const double length_m = result.sampler_path_length;
    const double best_m = series.points.empty() ? length_m : series.points.back().y();
    if (series.points.empty() || length_m < best_m) {
      series.points.emplace_back(time_ms, length_m);
    } else if (time_ms >= budget_ms) {
      series.points.emplace_back(time_ms, best_m);
    }
  }
  return series;
}

// From the sampled path on, one point per sweep.
template <class Robot>
ChartSeries sample_and_optimize(TimedPlanner<Robot>& timed, const char* name,
                                const AlgorithmOptions& choices) {
  const PlanRequest<Robot> request = timed.make_request(choices, 1);
  (void)timed.planner().plan(request);  // brings code and memory into the caches
  const PlanResult<Robot> result = timed.planner().plan(request);
  ChartSeries series{name, {}, SeriesStyle::kLineMarkers, {}};
  if (result.path == nullptr) return series;
  series.points.emplace_back(to_ms(result.times.sample_ns), result.sampler_path_length);
  const std::int64_t begin_ns =
      result.times.sample_ns + result.times.shortcut_ns + result.times.reference_ns;
  for (const IterationRecord& entry : result.history) {
    series.points.emplace_back(to_ms(begin_ns + entry.time_ns), entry.path_length);
  }
  return series;
}

template <class Robot>
LineChart concept_chart_of(const SceneOf<Robot>& scene, double budget_s) {
  TimedPlanner<Robot> timed(scene);
  AlgorithmOptions sampled;
  sampled.sampler = "rrt_star";
  sampled.no_shortcut = true;
  sampled.no_lattice = true;
  LineChart chart;
  chart.title = printable(scene.name) + format(", %d obstacles", scene.world->num_obstacles());
  chart.x_label = "thread CPU time [ms]";
  chart.y_label = format("path length [%s]", kPathUnit<Robot>);
  chart.log_x = true;
  // Optimised first: then the sampler alone finds its code and memory in the caches too.
  const ChartSeries from_sample =
      sample_and_optimize(timed, "RRT*-sOpt from RRT*'s first solution", sampled);
  chart.series = {sample_alone(timed, sampled, 1e3 * budget_s), from_sample,
                  sample_and_optimize(timed, "RRT*-sOpt, defaults", {})};
  return chart;
}

}  // namespace

LineChart concept_chart(const AnyScene& scene, double budget_s) {
  return std::visit(
      [&](const auto& typed) {
        return concept_chart_of<std::decay_t<decltype(robot_of(typed))>>(typed, budget_s);
      },
      scene);
}

}  // namespace sopt
