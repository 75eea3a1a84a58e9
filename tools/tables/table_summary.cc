#include "tools/tables/table_summary.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "tools/bench/bench_statistics.h"

namespace sopt {
namespace {

double percent(int part, int whole) { return whole == 0 ? 0.0 : 100.0 * part / whole; }

// Of the cases for which `holds`, by index and case.
template <class Value, class Holds>
Spread spread_over(const TableRun& run, Value value, Holds holds) {
  std::vector<double> values;
  for (std::size_t i = 0; i < run.cases.size(); ++i) {
    if (holds(i)) values.push_back(static_cast<double>(value(run.cases[i])));
  }
  return spread_of(values);
}

template <class Value>
Spread spread_over(const TableRun& run, Value value) {
  return spread_over(run, value, [](std::size_t) { return true; });
}

StageSpread stage_spread_of(const TableRun& run, StageTime TableCase::*stage) {
  return {spread_over(run, [=](const TableCase& c) { return (c.*stage).serial_us; }),
          spread_over(run, [=](const TableCase& c) { return (c.*stage).critical_us; })};
}

}  // namespace

Spread spread_of(const std::vector<double>& values) {
  const Distribution d = summarize(values);
  Spread spread{d.count, d.mean, 0.0, d.median};
  if (d.count < 2) return spread;
  double sum2 = 0.0;
  for (const double value : values) sum2 += (value - d.mean) * (value - d.mean);
  spread.deviation = std::sqrt(sum2 / (d.count - 1));
  return spread;
}

double RunSummary::success_percent() const { return percent(num_succeeded, num_cases); }
double RunSummary::fell_back_percent() const { return percent(num_fell_back, num_cases); }

std::vector<bool> common_successes(std::span<const TableRun> runs) {
  std::vector<bool> is_common(runs.empty() ? 0 : runs.front().cases.size(), true);
  for (const TableRun& run : runs) {
    for (std::size_t i = 0; i < is_common.size(); ++i) {
      if (!run.cases[i].succeeded()) is_common[i] = false;
    }
  }
  return is_common;
}

RunSummary summarize(const TableRun& run, const std::vector<bool>& is_common) {
  RunSummary summary;
  summary.num_cases = static_cast<int>(run.cases.size());
  for (const TableCase& c : run.cases) {
    summary.num_succeeded += c.succeeded() ? 1 : 0;
    summary.num_fell_back += c.fell_back ? 1 : 0;
  }
  summary.sample = stage_spread_of(run, &TableCase::sample);
  summary.optimize = stage_spread_of(run, &TableCase::optimize);
  summary.total = stage_spread_of(run, &TableCase::total);
  summary.iterations = spread_over(run, [](const TableCase& c) { return c.iterations; });
  summary.segments_initial =
      spread_over(run, [](const TableCase& c) { return c.segments_initial; });
  summary.segments_final = spread_over(run, [](const TableCase& c) { return c.segments_final; });
  const auto length = [](const TableCase& c) { return c.length; };
  summary.length =
      spread_over(run, length, [&](std::size_t i) { return run.cases[i].succeeded(); });
  summary.common_length = spread_over(run, length, [&](std::size_t i) { return is_common[i]; });
  return summary;
}

ModeSummary summarize(const TableMode& mode, const TableRun& rrt_star) {
  const std::vector<bool> is_common = common_successes(mode.columns);
  ModeSummary summary;
  summary.letter = mode.letter;
  summary.name = mode.name;
  summary.num_common = static_cast<int>(std::count(is_common.begin(), is_common.end(), true));
  summary.rrt_star = summarize(rrt_star, is_common);
  for (const TableRun& column : mode.columns) {
    summary.columns.push_back(summarize(column, is_common));
  }
  return summary;
}

}  // namespace sopt
