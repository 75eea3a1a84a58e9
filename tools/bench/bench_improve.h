// The measurement behind `sopt bench improve`: how much shorter plans get the longer the planner
// may look for other ways after its first plan. Every scene is planned once per seed, with the
// largest budget; what smaller ones would have left is read off the record of improvements: the
// last plan at most `budget` after the first. (A search that ends there also takes the plan it is
// at, cut short.) Lengths are relative to that of the scene's known path, else to the best plan of
// the scene over all seeds.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "opt/planner.h"
#include "tools/bench/bench_scenes.h"

namespace sopt {

// What counts as good, relative to the reference.
inline constexpr double kGoodLengthRatio = 1.03;

struct BenchImproveOptions {
  std::vector<double> budgets_ms = {0, 1, 2, 5, 10, 20, 50, 100, 200};  // increasing, not empty
  int num_seeds = 8;                                                    // 1..num_seeds
  // CPU time does not count what other programs take, but reading it is a system call, into which
  // about half of the budget goes.
  Clock clock = thread_cpu_clock();
};

struct ImproveCase {
  std::uint64_t seed = 0;
  PlanStatus status = PlanStatus::kBadInput;
  std::vector<ImprovementRecord> improvements;  // entry 0 is the first plan; empty: there is none
};

struct ImproveScene {
  std::string name;
  std::optional<double> reference_length;  // of a known path
  std::vector<ImproveCase> cases;

  [[nodiscard]] int num_planned() const;
  // What lengths are relative to; none without a reference and without a plan.
  [[nodiscard]] std::optional<double> unit_length() const;
};

// One call to warm up per scene. Throws what PlannerHost throws.
[[nodiscard]] std::vector<ImproveScene> run_bench_improve(const BenchScenes& scenes,
                                                          const BenchImproveOptions& options);

// Relative lengths `budget_ms` after the first plan, in the order of the cases that have one.
[[nodiscard]] std::vector<double> length_ratios(const ImproveScene& scene, double budget_ms);

// Cases without a plan, in all scenes.
[[nodiscard]] int num_failures(const std::vector<ImproveScene>& scenes);

// Median and worst by scene and budget, means over the scenes, share of good cases (of all; one
// without a plan is not good).
[[nodiscard]] std::string describe(const std::vector<ImproveScene>& scenes,
                                   const std::vector<double>& budgets_ms);

// Curves, and all records.
[[nodiscard]] nlohmann::ordered_json to_json(const std::vector<ImproveScene>& scenes,
                                             const std::vector<double>& budgets_ms);

// Medians over the budget, a series per scene; budget 0 stands at the left edge.
[[nodiscard]] std::string draw(const std::vector<ImproveScene>& scenes,
                               const std::vector<double>& budgets_ms);

}  // namespace sopt
