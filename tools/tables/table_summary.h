// What the cases of a column say together: mean and standard deviation as the paper prints them,
// and the median, which a few interrupted cases do not move.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/tables/table_run.h"

namespace sopt {

struct Spread {
  int count = 0;
  double mean = 0.0;
  double deviation = 0.0;  // of a sample: over count - 1; 0 for fewer than two values
  double median = 0.0;     // nearest rank
};

// All zero for no values.
[[nodiscard]] Spread spread_of(const std::vector<double>& values);

struct StageSpread {
  Spread serial_us;
  Spread critical_us;
};

struct RunSummary {
  int num_cases = 0;
  int num_succeeded = 0;
  int num_fell_back = 0;
  StageSpread sample, optimize, total;  // of all cases
  Spread iterations, segments_initial, segments_final;
  Spread length;         // of cases that succeeded, in the robot's path metric
  Spread common_length;  // of cases that succeeded in every run compared

  // Percent of the cases.
  [[nodiscard]] double success_percent() const;
  [[nodiscard]] double fell_back_percent() const;
};

// Whether case i succeeded in every one of `runs`, which have the same cases.
[[nodiscard]] std::vector<bool> common_successes(std::span<const TableRun> runs);

[[nodiscard]] RunSummary summarize(const TableRun& run, const std::vector<bool>& is_common);

// A mode beside RRT* alone; common are the cases that succeeded in all of its columns.
struct ModeSummary {
  char letter = '?';
  std::string name;
  int num_common = 0;
  RunSummary rrt_star;
  std::vector<RunSummary> columns;  // as the paper's
};

[[nodiscard]] ModeSummary summarize(const TableMode& mode, const TableRun& rrt_star);

}  // namespace sopt
