#include "tools/bench/bench_improve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "tools/bench/bench_statistics.h"
#include "tools/cli/planner_host.h"
#include "tools/io/line_chart.h"
#include "tools/io/plan_report.h"

namespace sopt {
namespace {

// As many as have a colour and a marker of their own.
constexpr std::size_t kMaxSeriesPerChart = 7;

constexpr const char* kBestSeenNote =
    "* without a reference: relative to the best plan of all seeds";

template <class Robot>
ImproveCase to_case(std::uint64_t seed, const PlanResult<Robot>& result) {
  ImproveCase c;
  c.seed = seed;
  c.status = result.status;
  c.improvements.assign(result.improvements.begin(), result.improvements.end());
  // Without a budget, and where the clock cut it, the first plan is on no record.
  if (result.plan && c.improvements.empty()) {
    c.improvements.push_back({result.times.total_ns, result.path_length});
  }
  return c;
}

template <class Robot>
ImproveScene run_scene(const SceneOf<Robot>& scene, const BenchImproveOptions& options) {
  ImproveScene run{scene.name, reference_of(scene), {}};
  PlanRequest<Robot> request = make_request(scene);
  const auto host = std::make_unique<PlannerHost<Robot>>(scene, request.options, options.clock);
  (void)host->planner().plan(request);
  request.options.improve_s = 1e-3 * options.budgets_ms.back();
  for (int seed = 1; seed <= options.num_seeds; ++seed) {
    request.seed = static_cast<std::uint64_t>(seed);
    run.cases.push_back(to_case(request.seed, host->planner().plan(request)));
  }
  return run;
}

// What a budget left of a scene.
struct Outcome {
  double median = 0.0;
  double worst = 0.0;
};

using Member = double Outcome::*;
struct Table {
  const char* title;
  Member member;
};
constexpr std::array<Table, 2> kTables = {
    {{"median over seeds", &Outcome::median}, {"worst over seeds", &Outcome::worst}}};

// None without a plan.
std::optional<Outcome> outcome_of(const ImproveScene& scene, double budget_ms) {
  const std::vector<double> ratios = length_ratios(scene, budget_ms);
  if (ratios.empty()) return std::nullopt;
  const Distribution distribution = summarize(ratios);
  return Outcome{distribution.median, distribution.max};
}

// Over the scenes that have plans; none without any.
std::optional<double> mean_of(const std::vector<ImproveScene>& scenes, double budget_ms,
                              Member member) {
  std::vector<double> values;
  for (const ImproveScene& scene : scenes) {
    if (const auto outcome = outcome_of(scene, budget_ms)) values.push_back((*outcome).*member);
  }
  if (values.empty()) return std::nullopt;
  return summarize(values).mean;
}

double share_of_good(const std::vector<ImproveScene>& scenes, double budget_ms) {
  std::size_t num_good = 0, num_cases = 0;
  for (const ImproveScene& scene : scenes) {
    const std::vector<double> ratios = length_ratios(scene, budget_ms);
    num_good += static_cast<std::size_t>(std::count_if(
        ratios.begin(), ratios.end(), [](double ratio) { return ratio <= kGoodLengthRatio; }));
    num_cases += scene.cases.size();
  }
  return static_cast<double>(num_good) / static_cast<double>(std::max<std::size_t>(num_cases, 1));
}

std::string cell(const std::optional<double>& value) {
  return value ? format(" %8.4f", *value) : format(" %8s", "-");
}

std::string row_name(const ImproveScene& scene) {
  return scene.name + (scene.reference_length ? "" : " *");
}

std::string describe(const Table& table, const std::vector<ImproveScene>& scenes,
                     const std::vector<double>& budgets_ms, int name_width) {
  std::string text = format("\n%-*s planned", name_width, table.title);
  for (const double budget_ms : budgets_ms) text += format(" %8g", budget_ms);
  text += '\n';
  for (const ImproveScene& scene : scenes) {
    text += format("%-*s %2d/%-4zu", name_width, row_name(scene).c_str(), scene.num_planned(),
                   scene.cases.size());
    for (const double budget_ms : budgets_ms) {
      const auto outcome = outcome_of(scene, budget_ms);
      text += cell(outcome ? std::optional((*outcome).*table.member) : std::nullopt);
    }
    text += '\n';
  }
  text += format("%-*s        ", name_width, "mean over scenes");
  for (const double budget_ms : budgets_ms) text += cell(mean_of(scenes, budget_ms, table.member));
  return text + '\n';
}

nlohmann::ordered_json to_json(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json case_json(const ImproveCase& c) {
  nlohmann::ordered_json object = {{"seed", c.seed},
                                   {"status", static_cast<int>(c.status)},
                                   {"improvements", nlohmann::ordered_json::array()}};
  for (const ImprovementRecord& record : c.improvements) {
    object["improvements"].push_back(
        {1e-6 * static_cast<double>(record.time_ns), record.path_length});
  }
  return object;
}

nlohmann::ordered_json scene_json(const ImproveScene& scene,
                                  const std::vector<double>& budgets_ms) {
  nlohmann::ordered_json object = {{"scene", scene.name},
                                   {"unit_length", to_json(scene.unit_length())},
                                   {"unit", scene.reference_length ? "reference" : "best_seen"},
                                   {"planned", scene.num_planned()}};
  for (const double budget_ms : budgets_ms) {
    const auto outcome = outcome_of(scene, budget_ms);
    object["median"].push_back(outcome ? to_json(outcome->median) : nullptr);
    object["worst"].push_back(outcome ? to_json(outcome->worst) : nullptr);
  }
  for (const ImproveCase& c : scene.cases) object["cases"].push_back(case_json(c));
  return object;
}

// Where budget 0 is drawn: the next lower end that a logarithmic axis can have.
double left_edge_ms(const std::vector<double>& budgets_ms) {
  const auto least = std::upper_bound(budgets_ms.begin(), budgets_ms.end(), 0.0);
  if (least == budgets_ms.end()) return 1.0;
  const double decade = std::pow(10.0, std::floor(std::log10(*least)));
  for (const double digit : {5.0, 2.0, 1.0}) {
    if (digit * decade < *least * (1.0 - 1e-9)) return digit * decade;
  }
  return 0.5 * decade;
}

void add_to_chart(const ImproveScene& scene, const std::vector<double>& budgets_ms,
                  LineChart& chart) {
  ChartSeries series{row_name(scene), {}, SeriesStyle::kLineMarkers, {}};
  for (const double budget_ms : budgets_ms) {
    const auto outcome = outcome_of(scene, budget_ms);
    if (!outcome) continue;
    series.points.emplace_back(budget_ms > 0.0 ? budget_ms : left_edge_ms(budgets_ms),
                               outcome->median);
  }
  chart.series.push_back(series);
  std::vector<std::string>& notes = chart.notes;
  if (!scene.reference_length &&
      std::find(notes.begin(), notes.end(), kBestSeenNote) == notes.end()) {
    notes.insert(notes.begin(), kBestSeenNote);
  }
  const int num_failed = static_cast<int>(scene.cases.size()) - scene.num_planned();
  if (num_failed > 0) {
    notes.push_back(format("%s: %d of %zu seeds without a plan", scene.name.c_str(), num_failed,
                           scene.cases.size()));
  }
}

}  // namespace

int ImproveScene::num_planned() const {
  return static_cast<int>(std::count_if(
      cases.begin(), cases.end(), [](const ImproveCase& c) { return !c.improvements.empty(); }));
}

std::optional<double> ImproveScene::unit_length() const {
  if (reference_length) return reference_length;
  double best = std::numeric_limits<double>::infinity();
  for (const ImproveCase& c : cases) {
    if (!c.improvements.empty()) best = std::min(best, c.improvements.back().path_length);
  }
  // A plan that stays at its start has no length to be relative to.
  if (!std::isfinite(best) || best == 0.0) return std::nullopt;
  return best;
}

std::vector<ImproveScene> run_bench_improve(const BenchScenes& scenes,
                                            const BenchImproveOptions& options) {
  std::vector<ImproveScene> runs;
  for (const AnyScene& any : scenes.scenes) {
    std::visit(
        [&](const auto& scene) {
          runs.push_back(run_scene<RobotOf<std::decay_t<decltype(scene)>>>(scene, options));
        },
        any);
  }
  return runs;
}

std::vector<double> length_ratios(const ImproveScene& scene, double budget_ms) {
  std::vector<double> ratios;
  for (const ImproveCase& c : scene.cases) {
    if (c.improvements.empty()) continue;
    const double until_ns = static_cast<double>(c.improvements.front().time_ns) + 1e6 * budget_ms;
    double length = c.improvements.front().path_length;
    for (const ImprovementRecord& record : c.improvements) {
      if (static_cast<double>(record.time_ns) <= until_ns) length = record.path_length;
    }
    ratios.push_back(length / scene.unit_length().value_or(1.0));
  }
  return ratios;
}

int num_failures(const std::vector<ImproveScene>& scenes) {
  int num_failed = 0;
  for (const ImproveScene& scene : scenes) {
    num_failed += static_cast<int>(scene.cases.size()) - scene.num_planned();
  }
  return num_failed;
}

std::string describe(const std::vector<ImproveScene>& scenes,
                     const std::vector<double>& budgets_ms) {
  std::size_t name_width = std::string("share of cases <= 1.03").size();
  bool has_best_seen = false;
  for (const ImproveScene& scene : scenes) {
    name_width = std::max(name_width, row_name(scene).size());
    has_best_seen = has_best_seen || !scene.reference_length;
  }
  std::string text = "length of the plan, relative to the reference, by budget [ms]\n";
  if (has_best_seen) text += std::string(kBestSeenNote) + '\n';
  const int width = static_cast<int>(name_width);
  for (const Table& table : kTables) text += describe(table, scenes, budgets_ms, width);
  const std::string share = format("share of cases <= %.2f", kGoodLengthRatio);
  text += format("\n%-*s        ", width, share.c_str());
  for (const double budget_ms : budgets_ms) {
    text += format(" %7.1f%%", 100.0 * share_of_good(scenes, budget_ms));
  }
  return text + '\n';
}

nlohmann::ordered_json to_json(const std::vector<ImproveScene>& scenes,
                               const std::vector<double>& budgets_ms) {
  nlohmann::ordered_json document = {{"budgets_ms", budgets_ms},
                                     {"cases_failed", num_failures(scenes)}};
  for (const double budget_ms : budgets_ms) {
    document["mean_median"].push_back(to_json(mean_of(scenes, budget_ms, &Outcome::median)));
    document["mean_worst"].push_back(to_json(mean_of(scenes, budget_ms, &Outcome::worst)));
    document["share_good"].push_back(share_of_good(scenes, budget_ms));
  }
  for (const ImproveScene& scene : scenes) {
    document["scenes"].push_back(scene_json(scene, budgets_ms));
  }
  return document;
}

std::string draw(const std::vector<ImproveScene>& scenes, const std::vector<double>& budgets_ms) {
  const std::size_t num_charts = (scenes.size() + kMaxSeriesPerChart - 1) / kMaxSeriesPerChart;
  std::vector<LineChart> charts;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    if (i % kMaxSeriesPerChart == 0) {
      LineChart& chart = charts.emplace_back();
      chart.title = "Length over budget, median over seeds";
      if (num_charts > 1) chart.title += format(" (%zu of %zu)", charts.size(), num_charts);
      chart.x_label = "budget after the first plan [ms], left edge: 0";
      chart.y_label = "length / reference";
      chart.log_x = true;
      chart.references.push_back({format("%.2f", kGoodLengthRatio), kGoodLengthRatio});
    }
    add_to_chart(scenes[i], budgets_ms, charts.back());
  }
  return draw(charts, 2);
}

}  // namespace sopt
