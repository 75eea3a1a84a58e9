// The measurement behind `sopt bench plan`: every scene with every seed, on a planner that was
// warmed up by one call. Robots of the scenes may differ (bench_scenes.h).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "models/config.h"
#include "opt/planner.h"
#include "tools/bench/bench_scenes.h"
#include "tools/cli/algorithm_options.h"

namespace sopt {

struct BenchPlanOptions {
  AlgorithmOptions algorithm;
  int num_seeds = 16;              // 1..num_seeds
  int num_repeats = 1;             // calls per scene and seed, each of them counted
  bool cpu_time = false;           // thread CPU time instead of elapsed time
  bool compare_converged = false;  // also plan with 200 sweeps and no early stop
};

// One call of plan().
struct BenchCase {
  std::string scene;
  std::uint64_t seed = 0;
  PlanStatus status = PlanStatus::kBadInput;
  bool has_path = false;  // from the sampler
  StageTimes times;
  double sampler_path_length = 0.0;  // in the path metric, as path_length
  double path_length = 0.0;
  double cost = 0.0;
  double duration_s = 0.0;
  int horizon = 0;
  int iterations = 0;
  int segments_initial = 0;
  int segments_final = 0;
  bool fell_back = false;  // the optimiser's result was refused
  SamplerCounts sampler_counts;
  OptimizerCounts optimizer_counts;
  std::int64_t num_allocations = 0;
  double reference_ratio = 0.0;  // path length / that of a known path; 0: the scene has none
  // Relative to 200 sweeps; 0: not compared.
  double cost_ratio = 0.0;
  double length_ratio = 0.0;
  double duration_ratio = 0.0;
};

struct BenchRun {
  SceneKind kind = SceneKind::kPlane;
  std::vector<BenchCase> cases;
  std::vector<double> world_build_us;  // one per scene: emptied, obstacles added, broad phase
};

// Throws what PlannerHost throws.
[[nodiscard]] BenchRun run_bench(const BenchScenes& scenes, const BenchPlanOptions& options);

}  // namespace sopt
