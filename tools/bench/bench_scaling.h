// The measurement behind `sopt bench scaling`: how the time and the exact counts of planning grow
// with the horizon and with the number of obstacles. A figure y that grows as a power of the size n
// has an exponent e in y = scale n^e: least squares of log y over log n, over all cases. A fit
// hides constant costs at small sizes, so the exponent over the upper half of the range is given
// too. The standard error is the scatter within a run; runs differ by more (docs/RESULTS.md).
// Behind the sampler the corridor and the maze are also measured from a way that their
// generator knows: whatever the sampler can, every size has a plan.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "opt/planner.h"
#include "tools/scenes/scaling_scenes.h"

namespace sopt {

struct BenchScalingOptions {
  std::vector<ScalingFamily> families = {ScalingFamily::kCorridor, ScalingFamily::kMaze,
                                         ScalingFamily::kField};
  int max_size = 5000;             // larger sizes are left out
  int num_seeds = 5;               // 1..num_seeds; each has a scene of its own
  int num_repeats = 3;             // timed calls; a case has the median of each stage
  std::optional<int> num_samples;  // PlanOptions::num_samples
  Clock clock = thread_cpu_clock();
};

// A plan, or what follows the sampler.
struct ScalingPlan {
  bool is_planned = false;
  StageTimes times;
  int horizon = 0;
  int iterations = 0;
  SamplerCounts sampler_counts;
  OptimizerCounts optimizer_counts;
};

struct ScalingCase {
  int size = 0;
  std::uint64_t seed = 0;
  int num_obstacles = 0;
  ScalingPlan plan;       // of Planner::plan
  ScalingPlan known_way;  // shortcut, reference, optimise, verify; no sampling
};

struct ScalingRun {
  ScalingFamily family = ScalingFamily::kCorridor;
  std::vector<ScalingCase> cases;  // by size, then seed
};

// One call to warm up per case; one that fails is not repeated. Throws HostError when there is no
// memory.
[[nodiscard]] std::vector<ScalingRun> run_bench_scaling(const BenchScalingOptions& options);

struct PowerFit {
  int num_points = 0;
  double scale = 0.0;  // y at n = 1
  double exponent = 0.0;
  double standard_error = 0.0;  // of the exponent; 0 for two points
};

// Points (n, y), both > 0; others are left out. None with less than two different n.
[[nodiscard]] std::optional<PowerFit> fit_power(std::span<const Vec2> points);

// What is looked at in a case.
struct ScalingFigure {
  const char* name;
  const char* unit;  // empty: a count
  bool is_of_known_way;
  bool has_target;
  bool is_drawn;  // those that say most: more would hide each other
  double (*value)(const ScalingPlan& plan);
};
[[nodiscard]] std::span<const ScalingFigure> scaling_figures();

// (horizon, or number of obstacles in the field; value) of the cases that are planned.
[[nodiscard]] std::vector<Vec2> points_of(const ScalingRun& run, const ScalingFigure& figure);

struct ScalingExponent {
  std::optional<PowerFit> fit;
  std::optional<PowerFit> upper_half;  // from the geometric mean of least and largest n on
  double limit = 0.0;                  // the target
  int num_failed = 0;                  // cases without a plan: the fit says nothing about them
  // The whole range is below the limit, and no case is missing.
  [[nodiscard]] bool is_met() const {
    return fit.has_value() && fit->exponent <= limit && num_failed == 0;
  }
};
[[nodiscard]] ScalingExponent exponent_of(const ScalingRun& run, const ScalingFigure& figure);

// Cases without a plan, in all runs.
[[nodiscard]] int num_failures(std::span<const ScalingRun> runs);

}  // namespace sopt
