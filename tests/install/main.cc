// What a user of the installed library writes: a world, one planner, one request.
#include <cstdio>

#include "alloc/arena.h"
#include "alloc/memory_block.h"
#include "models/plane/point2.h"
#include "models/plane/world2.h"
#include "opt/planner.h"
#include "rt/executor.h"

int main() {
  const sopt::WorldCapacity capacity{.max_obstacles = 16, .max_vertices = 256};
  const sopt::PlannerSettings settings{};
  const sopt::MemoryBlock block(sopt::World2::required_bytes(capacity) +
                                sopt::Planner<sopt::Point2>::required_bytes(settings));
  sopt::Arena arena(block);

  sopt::World2 world(arena, capacity);
  if (world.reset({{0.0, 0.0}, {20.0, 10.0}}) != sopt::WorldStatus::kOk) return 2;
  for (const double x : {5.0, 10.0, 15.0}) {
    const sopt::Box2 wall{.center = {x, x == 10.0 ? 6.5 : 3.5}, .size_m = {1.0, 6.5}};
    if (world.try_add(wall) != sopt::WorldStatus::kOk) return 2;
  }
  world.build();

  sopt::SerialExecutor executor;
  sopt::Planner<sopt::Point2> planner(arena, {.radius_m = 0.2}, settings, executor);
  if (arena.exhausted()) return 3;

  const auto result = planner.plan({.start = {1.0, 1.0}, .goal = {19.0, 9.0}, .world = &world});
  if (!result.plan) {
    std::printf("no plan: %s\n", result.failure.reason);
    return 1;
  }
  std::printf("length %.3f m, %d steps, clearance %.4f m\n", result.path_length,
              result.plan->trajectory().horizon(), result.plan->certificate().min_clearance_m);
  return 0;
}
