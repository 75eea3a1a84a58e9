#include "tools/bench/bench_plan.h"

#include <memory>
#include <optional>
#include <variant>

#include "tools/bench/allocation_counter.h"
#include "tools/bench/world_build.h"
#include "tools/cli/planner_host.h"

namespace sopt {
namespace {

constexpr int kConvergedSweeps = 200;

template <class Robot>
BenchCase to_case(const SceneOf<Robot>& scene, std::uint64_t seed,
                  const PlanResult<Robot>& result) {
  BenchCase c;
  c.scene = scene.name;
  c.seed = seed;
  c.status = result.status;
  c.has_path = result.path != nullptr;
  c.times = result.times;
  c.sampler_path_length = result.sampler_path_length;
  c.path_length = result.path_length;
  c.cost = result.cost;
  c.iterations = result.iterations;
  c.segments_initial = result.segments_initial;
  c.segments_final = result.segments_final;
  c.fell_back = result.fell_back;
  c.sampler_counts = result.sampler_counts;
  c.optimizer_counts = result.optimizer_counts;
  if (!result.plan) return c;
  c.duration_s = result.plan->trajectory().duration_s();
  c.horizon = result.plan->trajectory().horizon();
  if (const std::optional<double> reference = reference_of(scene)) {
    c.reference_ratio = c.path_length / *reference;
  }
  return c;
}

template <class Robot>
BenchCase plan_case(Planner<Robot>& planner, const SceneOf<Robot>& scene,
                    const PlanRequest<Robot>& request) {
  const std::int64_t allocations_before = num_allocations();
  const PlanResult<Robot> result = planner.plan(request);
  const std::int64_t allocations = num_allocations() - allocations_before;
  BenchCase c = to_case<Robot>(scene, request.seed, result);
  c.num_allocations = allocations;
  return c;
}

template <class Robot>
void compare_converged(Planner<Robot>& planner, PlanRequest<Robot> request, BenchCase& c) {
  request.options.max_iterations = kConvergedSweeps;
  request.options.tol_step = 0.0;
  const PlanResult<Robot> converged = planner.plan(request);
  if (!converged.plan) return;
  c.cost_ratio = c.cost / converged.cost;
  c.length_ratio = c.path_length / converged.path_length;
  c.duration_ratio = c.duration_s / converged.plan->trajectory().duration_s();
}

template <class Robot>
void run_scene(const SceneOf<Robot>& scene, const BenchPlanOptions& options, BenchRun& run) {
  const Clock clock = options.cpu_time ? thread_cpu_clock() : monotonic_clock();
  PlanRequest<Robot> request = make_request(scene);
  apply(options.algorithm, request.options, paper_options<Robot>());
  const auto host = std::make_unique<PlannerHost<Robot>>(scene, request.options, clock);
  run.world_build_us.push_back(measure_world_build_us(*scene.world, clock));
  (void)host->planner().plan(request);
  for (int seed = 1; seed <= options.num_seeds; ++seed) {
    request.seed = static_cast<std::uint64_t>(seed);
    for (int i = 0; i < options.num_repeats; ++i) {
      run.cases.push_back(plan_case<Robot>(host->planner(), scene, request));
    }
    if (options.compare_converged && run.cases.back().status >= PlanStatus::kOk) {
      compare_converged<Robot>(host->planner(), request, run.cases.back());
    }
  }
}

}  // namespace

BenchRun run_bench(const BenchScenes& scenes, const BenchPlanOptions& options) {
  BenchRun run;
  run.kind = scenes.kind;
  for (const AnyScene& any : scenes.scenes) {
    std::visit(
        [&](const auto& scene) {
          run_scene<RobotOf<std::decay_t<decltype(scene)>>>(scene, options, run);
        },
        any);
  }
  return run;
}

}  // namespace sopt
