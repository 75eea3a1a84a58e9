#include "tools/bench/bench_report.h"

#include <algorithm>
#include <cctype>
#include <ctime>
#include <fstream>
#include <functional>
#include <limits>
#include <optional>
#include <utility>

#include "tools/bench/bench_statistics.h"
#include "tools/io/plan_file.h"
#include "tools/io/plan_report.h"

namespace sopt {
namespace {

// One figure of a case. Cases for which `holds` is false do not count.
struct Metric {
  const char* name;
  const char* unit;
  std::function<double(const BenchCase&)> value;
  std::function<bool(const BenchCase&)> holds = [](const BenchCase&) { return true; };
};

bool succeeded(const BenchCase& c) { return c.status >= PlanStatus::kOk; }

Metric time_metric(const char* name, std::int64_t StageTimes::*stage) {
  return {name, "us",
          [stage](const BenchCase& c) { return 1e-3 * static_cast<double>(c.times.*stage); }};
}

template <class Member>
Metric case_metric(const char* name, const char* unit, Member member) {
  return {name, unit,
          [member](const BenchCase& c) { return static_cast<double>(std::invoke(member, c)); },
          succeeded};
}

template <class Counts>
Metric count_metric(const char* name, Counts BenchCase::*counts, std::int64_t Counts::*count) {
  return {name, "",
          [counts, count](const BenchCase& c) { return static_cast<double>(c.*counts.*count); }};
}

Metric ratio_metric(const char* name, double BenchCase::*ratio) {
  return {name, "", [ratio](const BenchCase& c) { return c.*ratio; },
          [ratio](const BenchCase& c) { return c.*ratio > 0.0; }};
}

std::vector<Metric> metrics(SceneKind kind) {
  const char* const unit = length_unit(kind);
  return {
      time_metric("total", &StageTimes::total_ns),
      time_metric("first_path", &StageTimes::first_path_ns),
      time_metric("sample", &StageTimes::sample_ns),
      time_metric("shortcut", &StageTimes::shortcut_ns),
      time_metric("reference", &StageTimes::reference_ns),
      time_metric("optimise", &StageTimes::optimize_ns),
      time_metric("verify", &StageTimes::verify_ns),
      case_metric("path_length", unit, &BenchCase::path_length),
      case_metric("sampler_path_length", unit, &BenchCase::sampler_path_length),
      case_metric("cost", "", &BenchCase::cost),
      case_metric("duration", "s", &BenchCase::duration_s),
      case_metric("horizon", "steps", &BenchCase::horizon),
      case_metric("iterations", "", &BenchCase::iterations),
      case_metric("segments_initial", "", &BenchCase::segments_initial),
      case_metric("segments_final", "", &BenchCase::segments_final),
      case_metric("fell_back", "", &BenchCase::fell_back),
      count_metric("nodes", &BenchCase::sampler_counts, &SamplerCounts::nodes),
      count_metric("edges", &BenchCase::sampler_counts, &SamplerCounts::edges),
      count_metric("clearance_queries", &BenchCase::optimizer_counts,
                   &OptimizerCounts::clearance_queries),
      count_metric("qp_solves", &BenchCase::optimizer_counts, &OptimizerCounts::qp_solves),
      count_metric("qp_steps", &BenchCase::optimizer_counts, &OptimizerCounts::qp_steps),
      {"allocations", "",
       [](const BenchCase& c) { return static_cast<double>(c.num_allocations); }},
      ratio_metric("length / reference", &BenchCase::reference_ratio),
      ratio_metric("f / f(200 sweeps)", &BenchCase::cost_ratio),
      ratio_metric("length / (200 sweeps)", &BenchCase::length_ratio),
      ratio_metric("duration / (200 sweeps)", &BenchCase::duration_ratio),
  };
}

Distribution measure(const BenchRun& run, const Metric& metric) {
  std::vector<double> values;
  for (const BenchCase& c : run.cases) {
    if (metric.holds(c)) values.push_back(metric.value(c));
  }
  return summarize(std::move(values));
}

std::string table_line(const std::string& name, const Distribution& d) {
  return format("%-24s %6d %10.4g %10.4g %10.4g %10.4g %10.4g\n", name.c_str(), d.count, d.mean,
                d.median, d.p95, d.p99, d.max);
}

nlohmann::ordered_json to_json(const Distribution& d) {
  return {{"count", d.count}, {"mean", d.mean}, {"median", d.median},
          {"p95", d.p95},     {"p99", d.p99},   {"max", d.max}};
}

nlohmann::ordered_json to_json(const BenchCase& c, const std::vector<Metric>& metrics) {
  nlohmann::ordered_json entry = {{"scene", c.scene},
                                  {"seed", c.seed},
                                  {"status", to_string(c.status)},
                                  {"has_path", c.has_path}};
  for (const Metric& metric : metrics) {
    if (metric.holds(c)) entry[metric.name] = metric.value(c);
  }
  return entry;
}

nlohmann::ordered_json summary_json(const BenchRun& run) {
  nlohmann::ordered_json summary;
  for (const Metric& metric : metrics(run.kind)) {
    const Distribution d = measure(run, metric);
    if (d.count > 0) summary[metric.name] = to_json(d);
  }
  return summary;
}

// The cases of each scene, in the order of the run.
std::vector<std::pair<std::string, BenchRun>> by_scene(const BenchRun& run) {
  std::vector<std::pair<std::string, BenchRun>> groups;
  for (const BenchCase& c : run.cases) {
    if (groups.empty() || groups.back().first != c.scene) {
      groups.push_back({c.scene, {run.kind, {}, {}}});
    }
    groups.back().second.cases.push_back(c);
  }
  return groups;
}

nlohmann::ordered_json to_json(const BenchPlanOptions& options, SceneKind kind) {
  nlohmann::ordered_json document = {{"clock", options.cpu_time ? "cpu" : "elapsed"},
                                     {"seeds", options.num_seeds},
                                     {"repeat", options.num_repeats},
                                     {"converged", options.compare_converged}};
  document.update(kind == SceneKind::kPlane
                      ? to_json(options.algorithm)
                      : to_json(options.algorithm, PlanOptions::arm(), PlanOptions::paper_arm()));
  return document;
}

std::string cpu_model() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  }
  return "unknown CPU";
}

const char* compiler() {
#if defined(__clang__)
  return "clang " __clang_version__;
#else
  return "g++ " __VERSION__;
#endif
}

}  // namespace

std::string describe_machine() {
  const std::time_t now = std::time(nullptr);
  char date[32] = "";
  (void)std::strftime(date, sizeof date, "%Y-%m-%d", std::gmtime(&now));
#if defined(NDEBUG)
  const char* const build = "release";
#else
  const char* const build = "with assertions";
#endif
  return format("%s, %s, %s, %s", cpu_model().c_str(), compiler(), build, date);
}

int num_failures(const BenchRun& run) {
  return static_cast<int>(std::count_if(run.cases.begin(), run.cases.end(),
                                        [](const BenchCase& c) { return !succeeded(c); }));
}

int num_without_path(const BenchRun& run) {
  return static_cast<int>(std::count_if(run.cases.begin(), run.cases.end(),
                                        [](const BenchCase& c) { return !c.has_path; }));
}

std::string describe_run(const BenchRun& run) {
  std::string text = format("%-24s %6s %10s %10s %10s %10s %10s\n", "", "n", "mean", "median",
                            "p95", "p99", "max");
  for (const Metric& metric : metrics(run.kind)) {
    const Distribution d = measure(run, metric);
    const std::string unit = *metric.unit == '\0' ? "" : std::string(" [") + metric.unit + ']';
    if (d.count > 0) text += table_line(metric.name + unit, d);
  }
  text += table_line("world build [us]", summarize(run.world_build_us));
  const auto total = static_cast<int>(run.cases.size());
  const auto share_line = [total](const char* name, int missing) {
    return format("%s %d of %d (%.2f %%)\n", name, total - missing, total,
                  100.0 * (total - missing) / std::max(total, 1));
  };
  text += share_line("first path", num_without_path(run));
  text += share_line("success", num_failures(run));
  for (const BenchCase& c : run.cases) {
    if (succeeded(c)) continue;
    text += format("  failed: %s seed %llu: %s\n", c.scene.c_str(),
                   static_cast<unsigned long long>(c.seed), to_string(c.status));
  }
  return text;
}

nlohmann::ordered_json to_json(const BenchRun& run, const BenchPlanOptions& options) {
  nlohmann::ordered_json document = {{"schema", 1},
                                     {"machine", describe_machine()},
                                     {"options", to_json(options, run.kind)},
                                     {"length_unit", length_unit(run.kind)},
                                     {"cases_total", run.cases.size()},
                                     {"cases_without_path", num_without_path(run)},
                                     {"cases_failed", num_failures(run)},
                                     {"summary", summary_json(run)}};
  document["summary"]["world_build"] = to_json(summarize(run.world_build_us));
  for (const auto& [scene, cases] : by_scene(run)) {
    document["scenes"].push_back({{"scene", scene},
                                  {"cases_total", cases.cases.size()},
                                  {"cases_failed", num_failures(cases)},
                                  {"summary", summary_json(cases)}});
  }
  const std::vector<Metric> all = metrics(run.kind);
  for (const BenchCase& c : run.cases) document["cases"].push_back(to_json(c, all));
  return document;
}

std::string describe_by_segments(const std::vector<SegmentsRun>& runs) {
  const SceneKind kind = runs.empty() ? SceneKind::kPlane : runs.front().run.kind;
  const std::string length_name = format("length [%s]", length_unit(kind));
  std::string text =
      format("%-9s %12s %12s %12s %12s %12s %12s %9s\n", "segments", "begun with", "ended with",
             length_name.c_str(), "cost", "iterations", "total [us]", "failures");
  double shortest = std::numeric_limits<double>::infinity();
  double longest = 0.0;
  for (const SegmentsRun& entry : runs) {
    const auto mean = [&entry](const auto& value) {
      return measure(entry.run, case_metric("", "", value)).mean;
    };
    const double length = mean(&BenchCase::path_length);
    shortest = std::min(shortest, length);
    longest = std::max(longest, length);
    text += format("%-9s %12.3f %12.3f %12.4f %12.4f %12.3f %12.1f %9d\n",
                   entry.options.algorithm.segments.c_str(), mean(&BenchCase::segments_initial),
                   mean(&BenchCase::segments_final), length, mean(&BenchCase::cost),
                   mean(&BenchCase::iterations),
                   measure(entry.run, time_metric("", &StageTimes::total_ns)).mean,
                   num_failures(entry.run));
  }
  if (shortest > 0.0) {
    text += format("spread of the mean length: %.3f %%\n", 100.0 * (longest / shortest - 1.0));
  }
  return text;
}

nlohmann::ordered_json to_json(const std::vector<SegmentsRun>& runs) {
  nlohmann::ordered_json document = {{"schema", 1}};
  for (const SegmentsRun& entry : runs) {
    document["runs"].push_back(to_json(entry.run, entry.options));
  }
  return document;
}

}  // namespace sopt
