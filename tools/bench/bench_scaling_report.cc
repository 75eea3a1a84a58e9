#include "tools/bench/bench_scaling_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

#include "tools/bench/bench_statistics.h"
#include "tools/io/line_chart.h"
#include "tools/io/plan_report.h"

namespace sopt {
namespace {

// Figures that share a table, a chart, an object.
struct Group {
  const char* title;
  bool is_of_known_way;
  bool is_count;

  [[nodiscard]] std::vector<ScalingFigure> figures() const {
    std::vector<ScalingFigure> result;
    for (const ScalingFigure& figure : scaling_figures()) {
      if (figure.is_of_known_way == is_of_known_way && (*figure.unit == '\0') == is_count) {
        result.push_back(figure);
      }
    }
    return result;
  }
};

constexpr std::array<Group, 4> kGroups = {
    {{"times of a plan", false, false},
     {"counts of a plan", false, true},
     {"times behind the sampler, from a known way", true, false},
     {"counts behind the sampler, from a known way", true, true}}};

bool has_points(const ScalingRun& run, const Group& group) {
  return !points_of(run, group.figures().front()).empty();
}

const char* axis_of(const ScalingRun& run) {
  return run.family == ScalingFamily::kField ? "obstacles" : "steps";
}

// The cases of each size, in order.
std::vector<ScalingRun> by_size(const ScalingRun& run) {
  std::vector<ScalingRun> groups;
  for (const ScalingCase& c : run.cases) {
    if (groups.empty() || groups.back().cases.back().size != c.size) {
      groups.push_back({run.family, {}});
    }
    groups.back().cases.push_back(c);
  }
  return groups;
}

double median_of(const ScalingRun& run, const std::function<double(const ScalingCase&)>& value) {
  std::vector<double> values;
  for (const ScalingCase& c : run.cases) values.push_back(value(c));
  return summarize(values).median;
}

std::string number(double value) { return format(value < 9999.5 ? "%.4g" : "%.0f", value); }

std::string cell(const std::string& text) { return format(" %10s", text.c_str()); }

std::string size_line(const ScalingRun& cases, const Group& group) {
  const ScalingCase& first = cases.cases.front();
  const double obstacles =
      median_of(cases, [](const ScalingCase& c) { return static_cast<double>(c.num_obstacles); });
  std::vector<double> steps;
  for (const ScalingCase& c : cases.cases) {
    const ScalingPlan& plan = group.is_of_known_way ? c.known_way : c.plan;
    if (plan.is_planned) steps.push_back(plan.horizon);
  }
  std::string line =
      format("%10d %3zu of %zu %9.0f", first.size, steps.size(), cases.cases.size(), obstacles) +
      cell(steps.empty() ? "-" : number(summarize(steps).median));
  for (const ScalingFigure& figure : group.figures()) {
    std::vector<double> values;
    for (const Vec2& point : points_of(cases, figure)) values.push_back(point.y());
    line += cell(values.empty() ? "-" : number(summarize(values).median));
  }
  return line + '\n';
}

using FitText = std::string (*)(const ScalingExponent&);

std::string exponent_line(const ScalingRun& run, const Group& group, const char* name,
                          FitText text) {
  std::string line = format("%-39s", name);
  for (const ScalingFigure& figure : group.figures()) line += cell(text(exponent_of(run, figure)));
  return line + '\n';
}

std::string table(const ScalingRun& run, const Group& group) {
  std::string text = format("%s, medians%s\n%10s %8s %9s %10s", group.title,
                            group.is_count ? "" : " [us]", "size", "planned", "obstacles", "steps");
  for (const ScalingFigure& figure : group.figures()) text += cell(figure.name);
  text += '\n';
  for (const ScalingRun& cases : by_size(run)) text += size_line(cases, group);
  text += exponent_line(run, group, "exponent", [](const ScalingExponent& e) {
    return e.fit ? format("%.2f", e.fit->exponent) : std::string("-");
  });
  text += exponent_line(run, group, "- its standard error", [](const ScalingExponent& e) {
    return e.fit ? format("%.2f", e.fit->standard_error) : std::string("-");
  });
  text += exponent_line(run, group, "- over the upper half", [](const ScalingExponent& e) {
    return e.upper_half ? format("%.2f", e.upper_half->exponent) : std::string("-");
  });
  return text;
}

std::string verdict_line(const ScalingRun& run, const ScalingFigure& figure) {
  const ScalingExponent e = exponent_of(run, figure);
  std::string line = format("%s%s over %s: ", figure.name,
                            figure.is_of_known_way ? " from a known way" : "", axis_of(run));
  if (!e.fit) return line + "no plans\n";
  line += format("exponent %.2f +- %.2f, target %.1f: %s", e.fit->exponent, e.fit->standard_error,
                 e.limit, e.is_met() ? "met" : "missed");
  if (e.num_failed > 0)
    line += format(" (%d of %zu without a plan)", e.num_failed, run.cases.size());
  return line + '\n';
}

nlohmann::ordered_json to_json(const std::optional<PowerFit>& fit) {
  if (!fit) return nullptr;
  return {{"points", fit->num_points},
          {"exponent", fit->exponent},
          {"standard_error", fit->standard_error},
          {"scale", fit->scale}};
}

nlohmann::ordered_json exponents_json(const ScalingRun& run, const Group& group) {
  nlohmann::ordered_json object;
  for (const ScalingFigure& figure : group.figures()) {
    const ScalingExponent e = exponent_of(run, figure);
    nlohmann::ordered_json& entry = object[figure.name];
    entry = {{"fit", to_json(e.fit)}, {"upper_half", to_json(e.upper_half)}};
    if (figure.has_target) entry.update({{"limit", e.limit}, {"is_met", e.is_met()}});
  }
  return object;
}

nlohmann::ordered_json plan_json(const ScalingPlan& plan, bool is_of_known_way) {
  if (!plan.is_planned) return nullptr;
  nlohmann::ordered_json object = {{"horizon", plan.horizon}};
  for (const ScalingFigure& figure : scaling_figures()) {
    if (figure.is_of_known_way == is_of_known_way) object[figure.name] = figure.value(plan);
  }
  return object;
}

// A figure's cases as markers, its fit as a line of the same colour.
void add_series(const ScalingRun& run, const ScalingFigure& figure, const std::string& color,
                LineChart& chart) {
  const std::vector<Vec2> points = points_of(run, figure);
  const std::optional<PowerFit> fit = fit_power(points);
  if (!fit) return;
  chart.series.push_back({figure.name, points, SeriesStyle::kMarkers, color});
  const auto less = [](const Vec2& a, const Vec2& b) { return a.x() < b.x(); };
  const auto [least, largest] = std::minmax_element(points.begin(), points.end(), less);
  const auto at = [&fit](double n) { return Vec2(n, fit->scale * std::pow(n, fit->exponent)); };
  chart.series.push_back({format("%s ~ n^%.2f", figure.name, fit->exponent),
                          {at(least->x()), at(largest->x())},
                          SeriesStyle::kLine,
                          color});
}

LineChart make_chart(const ScalingRun& run, const Group& group) {
  constexpr std::array kColors = {"#0072b2", "#d55e00", "#009e73", "#cc79a7"};
  LineChart chart;
  chart.title = std::string(to_string(run.family)) + ": " + group.title;
  chart.x_label = axis_of(run);
  chart.y_label = group.is_count ? "count" : "time [us]";
  chart.log_x = chart.log_y = true;
  std::size_t num_drawn = 0;
  for (const ScalingFigure& figure : group.figures()) {
    if (figure.is_drawn) add_series(run, figure, kColors[num_drawn++ % kColors.size()], chart);
  }
  const int num_failed = exponent_of(run, group.figures().front()).num_failed;
  if (num_failed > 0) {
    chart.notes.push_back(format("%d of %zu scenes without a plan", num_failed, run.cases.size()));
  }
  return chart;
}

}  // namespace

std::string describe(const ScalingRun& run) {
  std::string text =
      format("\n%s: growth with the number of %s\n", to_string(run.family), axis_of(run));
  for (const Group& group : kGroups) {
    if (!group.is_of_known_way || has_points(run, group)) text += table(run, group);
  }
  for (const ScalingFigure& figure : scaling_figures()) {
    if (!figure.has_target) continue;
    if (figure.is_of_known_way && run.family == ScalingFamily::kField) continue;
    text += verdict_line(run, figure);
  }
  return text;
}

nlohmann::ordered_json to_json(const ScalingRun& run) {
  nlohmann::ordered_json document = {{"family", to_string(run.family)}, {"n", axis_of(run)}};
  for (const Group& group : kGroups) {
    if (has_points(run, group)) document["exponents"][group.title] = exponents_json(run, group);
  }
  for (const ScalingCase& c : run.cases) {
    document["cases"].push_back({{"size", c.size},
                                 {"seed", c.seed},
                                 {"obstacles", c.num_obstacles},
                                 {"plan", plan_json(c.plan, false)},
                                 {"known_way", plan_json(c.known_way, true)}});
  }
  return document;
}

std::string draw(const ScalingRun& run) {
  std::vector<LineChart> charts;
  for (const Group& group : kGroups) {
    if (has_points(run, group)) charts.push_back(make_chart(run, group));
  }
  return draw(charts, 2);
}

}  // namespace sopt
