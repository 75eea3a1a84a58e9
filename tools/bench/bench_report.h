// Tables and JSON of a benchmark run.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/bench/bench_plan.h"

namespace sopt {

// One line about where the figures come from: CPU, compiler, build type, date (UTC).
[[nodiscard]] std::string describe_machine();

// Distributions over all cases, one line each.
[[nodiscard]] std::string describe_run(const BenchRun& run);

// Everything: machine, options, distributions, one entry per scene and one per case.
[[nodiscard]] nlohmann::ordered_json to_json(const BenchRun& run, const BenchPlanOptions& options);

// The same scenes and seeds with other numbers of segments.
struct SegmentsRun {
  BenchPlanOptions options;
  BenchRun run;
};
[[nodiscard]] std::string describe_by_segments(const std::vector<SegmentsRun>& runs);
// One document per run.
[[nodiscard]] nlohmann::ordered_json to_json(const std::vector<SegmentsRun>& runs);

// Cases in which the sampler found no path.
[[nodiscard]] int num_without_path(const BenchRun& run);
// Cases without a usable plan.
[[nodiscard]] int num_failures(const BenchRun& run);

}  // namespace sopt
