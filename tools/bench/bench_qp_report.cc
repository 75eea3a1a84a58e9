#include "tools/bench/bench_qp_report.h"

#include "tools/io/plan_report.h"

namespace sopt {
namespace {

nlohmann::ordered_json to_json(const BenchQpResult& result) {
  const Distribution& time = result.time_us;
  return {{"solver", result.solver},
          {"start", result.is_warm ? "warm" : "cold"},
          {"median_us", time.median},
          {"p99_us", time.p99},
          {"max_us", time.max},
          {"slowest_us", result.slowest_us},
          {"ns_per_step", result.ns_per_step},
          {"steps_median", result.steps.median},
          {"steps_max", result.steps.max},
          {"steps_total", result.total_steps},
          {"allocations", result.num_allocations},
          {"failed", result.failed},
          {"max_difference", result.max_difference}};
}

}  // namespace

std::string describe(const BenchQpFamily& family) {
  std::string text = format(
      "family %s, %s: %d pairs, %d variables, rows %d .. %.0f, active "
      "%d / %.0f / %.0f\n",
      family.name.c_str(), family.description.c_str(), family.num_pairs, family.num_variables,
      family.min_rows, family.rows.max, family.min_active, family.active.median, family.active.max);
  text += format("  %-14s %-4s %9s %9s %9s %9s %7s %6s %8s %8s %6s %6s %9s\n", "[us]", "", "median",
                 "p99", "max", "slowest", "steps", "max", "total", "ns/step", "allocs", "failed",
                 "|dx|");
  for (const BenchQpResult& result : family.results) {
    const Distribution& time = result.time_us;
    text +=
        format("  %-14s %-4s %9.1f %9.1f %9.1f %9.1f %7.0f %6.0f %8lld %8.0f %6lld %6zu %9.1e\n",
               result.solver.c_str(), result.is_warm ? "warm" : "cold", time.median, time.p99,
               time.max, result.slowest_us, result.steps.median, result.steps.max,
               static_cast<long long>(result.total_steps), result.ns_per_step,
               static_cast<long long>(result.num_allocations), result.failed.size(),
               result.max_difference);
  }
  for (const BenchQpResult& result : family.results) {
    for (const std::string& failed : result.failed) {
      text += format("  failed: %s (%s, %s)\n", failed.c_str(), result.solver.c_str(),
                     result.is_warm ? "warm" : "cold");
    }
  }
  return text;
}

nlohmann::ordered_json to_json(const BenchQpFamily& family) {
  nlohmann::ordered_json document = {
      {"family", family.name},
      {"description", family.description},
      {"pairs", family.num_pairs},
      {"variables", family.num_variables},
      {"rows", {family.min_rows, family.rows.median, family.rows.max}},
      {"active", {family.min_active, family.active.median, family.active.max}}};
  for (const BenchQpResult& result : family.results) {
    document["results"].push_back(to_json(result));
  }
  return document;
}

nlohmann::ordered_json counts_json(const std::vector<BenchQpFamily>& families) {
  nlohmann::ordered_json document;
  for (const BenchQpFamily& family : families) {
    for (const BenchQpResult& result : family.results) {
      document[family.name][result.solver][result.is_warm ? "warm" : "cold"] = result.total_steps;
    }
  }
  return document;
}

}  // namespace sopt
