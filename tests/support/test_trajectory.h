// A Trajectory<Point2> with its own memory, for tests: through given states, with the inputs that
// lead from one to the next.
#pragma once

#include <vector>

#include "alloc/arena.h"
#include "alloc/memory_block.h"
#include "models/plane/point2.h"
#include "models/trajectory.h"

namespace sopt::oracle {

struct TestTrajectory {
  explicit TestTrajectory(const std::vector<Vec2>& states, double dt_s = 0.1)
      : block((states.size() + 2) * 2 * sizeof(Vec2) + 4 * Arena::kAlignment),
        arena(block),
        trajectory(arena, static_cast<int>(states.size()) + 1) {
    trajectory.dt_s = dt_s;
    for (const Vec2& z : states) (void)trajectory.states.try_push_back(z);
    for (std::size_t t = 1; t < states.size(); ++t) {
      (void)trajectory.inputs.try_push_back((states[t] - states[t - 1]) / dt_s);
    }
  }

  MemoryBlock block;
  Arena arena;
  Trajectory<Point2> trajectory;
};

}  // namespace sopt::oracle
