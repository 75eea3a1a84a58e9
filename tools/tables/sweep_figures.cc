#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>
#include <type_traits>
#include <variant>

#include "tools/io/json_fields.h"
#include "tools/io/plan_picture.h"
#include "tools/io/plan_report.h"
#include "tools/io/segment_picture.h"
#include "tools/tables/tables_figures.h"
#include "tools/tables/timed_planner.h"

namespace sopt {
namespace {

// Finer than the default: sweeps after the first ones, and merging among them.
constexpr double kFineTolerance = 3e-4;

// A path as it was sampled leaves the optimiser something to do.
AlgorithmOptions from_sampled_path(const char* num_segments, bool merges) {
  AlgorithmOptions choices;
  choices.sampler = "rrt_star";
  choices.no_shortcut = true;
  choices.no_lattice = true;
  choices.segments = num_segments;
  choices.no_merge = !merges;
  choices.max_window = kLongestWindow;
  return choices;
}

struct Descent {
  std::string name;
  std::vector<IterationRecord> history;
};

template <class Robot>
Descent descend(TimedPlanner<Robot>& timed, const std::string& name,
                const AlgorithmOptions& choices) {
  PlanRequest<Robot> request = timed.make_request(choices, 1);
  request.options.tol_step = kFineTolerance;
  (void)timed.planner().plan(request);  // brings code and memory into the caches
  const PlanResult<Robot> result = timed.planner().plan(request);
  const std::string end = choices.no_merge ? "" : format(" to %d", result.segments_final);
  return {name + end, {result.history.begin(), result.history.end()}};
}

template <class Robot>
std::vector<Descent> descents(TimedPlanner<Robot>& timed, const char* qp) {
  std::vector<Descent> result;
  const auto add = [&](const char* name, const char* num_segments, bool merges) {
    AlgorithmOptions choices = from_sampled_path(num_segments, merges);
    choices.qp = qp;
    result.push_back(descend(timed, name, choices));
  };
  add("3 segments", "3", false);
  add("9 segments", "9", false);
  add("merging, 9", "9", true);
  return result;
}

double sweep_of(const IterationRecord& entry) { return entry.iteration; }
double time_us_of(const IterationRecord& entry) {
  return 1e-3 * static_cast<double>(entry.time_ns);
}

template <class Robot>
LineChart descent_chart(const std::vector<Descent>& all, const std::string& title,
                        const char* x_label, double (*x)(const IterationRecord&)) {
  LineChart chart;
  chart.title = title;
  chart.x_label = x_label;
  chart.y_label = format("cost [%s]", kPathUnit<Robot>);
  for (const Descent& descent : all) {
    ChartSeries& series =
        chart.series.emplace_back(ChartSeries{descent.name, {}, SeriesStyle::kLineMarkers, {}});
    for (const IterationRecord& entry : descent.history) {
      series.points.emplace_back(x(entry), entry.cost);
    }
  }
  return chart;
}

// Windows of the sweep after which k sweeps are done end here; W as in opt/splits.h.
std::vector<int> window_ends(std::span<const int> splits, int horizon, int k) {
  if (k % 2 == 1) return segment_ends(splits, horizon);
  std::vector<int> ends = segment_ends(splits.subspan(1), horizon);
  ends.insert(ends.begin(), splits[1]);
  return ends;
}

struct Sweep {
  std::vector<Vec2> waypoints;
  std::vector<int> splits;
  double length_m = 0.0;
};

Sweep plan_sweeps(TimedPlanner<Point2>& timed, int num_sweeps) {
  PlanRequest<Point2> request = timed.make_request(from_sampled_path("3", false), 1);
  request.options.max_iterations = num_sweeps;
  const PlanResult<Point2> result = timed.planner().plan(request);
  if (!result.plan) return {};
  const Trajectory<Point2>& trajectory = result.plan->trajectory();
  return {{trajectory.states.begin(), trajectory.states.end()},
          {result.splits.begin(), result.splits.end()},
          result.path_length};
}

template <class Robot>
std::vector<LineChart> merging_charts_of(const SceneOf<Robot>& scene) {
  TimedPlanner<Robot> timed(scene);
  const std::vector<Descent> dense = descents(timed, "dense");
  const std::vector<Descent> kernel = descents(timed, "kernel");
  const char* const time_label = "optimiser's thread CPU time [us]";
  const std::string name = printable(scene.name);
  return {descent_chart<Robot>(dense, name + ": cost over sweeps", "sweep", sweep_of),
          descent_chart<Robot>(dense, "over time, dense QP", time_label, time_us_of),
          descent_chart<Robot>(kernel, "over time, kernel QP", time_label, time_us_of)};
}

}  // namespace

std::vector<LineChart> merging_charts(const AnyScene& scene) {
  return std::visit(
      [](const auto& typed) {
        return merging_charts_of<std::decay_t<decltype(robot_of(typed))>>(typed);
      },
      scene);
}

std::string draw_segmentations(const Scene& scene) {
  TimedPlanner<Point2> timed(scene);
  SegmentPicture picture;
  picture.scene = &scene;
  picture.title = "Splits and windows of the first three sweeps";
  picture.details = printable(scene.name) +
                    ", N = 3: odd sweeps optimise [w1, w3], [w3, w5], [w5, w7], even ones " +
                    "[w1, w2], [w2, w4], [w4, w6], [w6, w7]";
  Sweep before;
  for (int k = 0; k <= 3; ++k) {
    const Sweep sweep = plan_sweeps(timed, k);
    if (sweep.waypoints.empty()) break;
    SegmentPanel panel;
    const int horizon = static_cast<int>(sweep.waypoints.size()) - 1;
    panel.title = k == 0 ? format("as sampled: %.2f m", sweep.length_m)
                         : format("after sweep %d (%s): %.2f m", k, k % 2 == 1 ? "odd" : "even",
                                  sweep.length_m);
    panel.waypoints = sweep.waypoints;
    panel.previous = before.waypoints;
    panel.splits = k == 0 ? sweep.splits : before.splits;
    if (k > 0) panel.window_ends = window_ends(before.splits, horizon, k);
    picture.panels.push_back(panel);
    before = sweep;
  }
  return draw(picture);
}

}  // namespace sopt
