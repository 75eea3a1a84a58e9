#include "tools/bench/bench_plan.h"

#include <algorithm>
#include <memory>
#include <vector>

#include "tools/cli/planner_host.h"
#include "tools/io/input_error.h"
#include "tools/io/scene_file.h"

namespace sopt {
namespace {

constexpr int kConvergedSweeps = 200;

BenchCase to_case(const Scene& scene, std::uint64_t seed, const PlanResult<Point2>& result) {
  BenchCase c;
  c.scene = scene.name;
  c.seed = seed;
  c.status = result.status;
  c.times = result.times;
  c.sampler_path_length_m = result.sampler_path_length;
  c.path_length_m = result.path_length;
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
  if (scene.reference_feasible_length) {
    c.reference_ratio = c.path_length_m / *scene.reference_feasible_length;
  }
  return c;
}

void compare_converged(Planner<Point2>& planner, PlanRequest<Point2> request, BenchCase& c) {
  request.options.max_iterations = kConvergedSweeps;
  request.options.tol_step = 0.0;
  const PlanResult<Point2> converged = planner.plan(request);
  if (!converged.plan) return;
  c.cost_ratio = c.cost / converged.cost;
  c.length_ratio = c.path_length_m / converged.path_length;
  c.duration_ratio = c.duration_s / converged.plan->trajectory().duration_s();
}

// Obstacles as a program holds them before they are a world; a box is a polygon here.
struct Shapes {
  std::vector<Disc> discs;
  std::vector<Polygon2> polygons;
};

Shapes shapes_of(const World2& world) {
  Shapes shapes;
  for (int i = 0; i < world.num_obstacles(); ++i) {
    const ConvexView view = world.obstacle(i);
    if (view.num_vertices == 1) {
      shapes.discs.push_back({{view.x[0], view.y[0]}, view.radius_m});
      continue;
    }
    Polygon2& polygon = shapes.polygons.emplace_back();
    polygon.num_vertices = view.num_vertices;
    for (int k = 0; k < view.num_vertices; ++k) {
      polygon.vertices[static_cast<std::size_t>(k)] = {view.x[k], view.y[k]};
    }
  }
  return shapes;
}

bool fill(World2& world, const Aabb2& bounds, const Shapes& shapes) {
  bool ok = world.reset(bounds) == WorldStatus::kOk;
  for (const Disc& disc : shapes.discs) ok = world.try_add(disc) == WorldStatus::kOk && ok;
  for (const Polygon2& polygon : shapes.polygons) {
    ok = world.try_add(polygon) == WorldStatus::kOk && ok;
  }
  world.build();
  return ok;
}

// Once on cold memory, then timed, as a process does whose world changes.
double measure_world_build_us(const World2& like, const Clock& clock) {
  const WorldCapacity capacity;
  const MemoryBlock memory(World2::required_bytes(capacity));
  Arena arena(memory);
  World2 world(arena, capacity);
  const Shapes shapes = shapes_of(like);
  if (!fill(world, like.bounds(), shapes)) throw HostError("a copy of the world was refused");
  const std::int64_t begin_ns = clock.now_ns();
  (void)fill(world, like.bounds(), shapes);
  return 1e-3 * static_cast<double>(clock.now_ns() - begin_ns);
}

void run_scene(const Scene& scene, const BenchPlanOptions& options, BenchRun& run) {
  const Clock clock = options.cpu_time ? thread_cpu_clock() : monotonic_clock();
  PlanRequest<Point2> request = make_request(scene);
  apply(options.algorithm, request.options);
  const auto host = std::make_unique<PlannerHost>(scene, request.options, clock);
  run.world_build_us.push_back(measure_world_build_us(*scene.world, clock));
  (void)host->planner().plan(request);
  for (int seed = 1; seed <= options.num_seeds; ++seed) {
    request.seed = static_cast<std::uint64_t>(seed);
    for (int i = 0; i < options.num_repeats; ++i) {
      run.cases.push_back(to_case(scene, request.seed, host->planner().plan(request)));
    }
    if (options.compare_converged && run.cases.back().status >= PlanStatus::kOk) {
      compare_converged(host->planner(), request, run.cases.back());
    }
  }
}

}  // namespace

BenchRun run_bench(const std::vector<std::filesystem::path>& scenes,
                   const BenchPlanOptions& options) {
  BenchRun run;
  for (const std::filesystem::path& file : scenes) {
    const Scene scene = load_scene(file);
    run_scene(scene, options, run);
  }
  return run;
}

}  // namespace sopt
