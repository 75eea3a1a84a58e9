// What flows between the layers: a path (configurations joined by straight motions), a trajectory
// (states and inputs on a time grid), and a request. All storage is fixed at setup.
#pragma once

#include <cstdint>
#include <limits>

#include "alloc/fixed_vector.h"
#include "models/config.h"
#include "models/margin.h"

namespace sopt {

// Configurations joined by straight motions of the robot; at least two when it is a path.
template <class Robot>
struct Path {
  Path() noexcept = default;
  Path(Arena& arena, int max_vertices) noexcept : vertices(arena, max_vertices) {}

  // In the robot's path metric.
  [[nodiscard]] double length(const Robot& robot) const SOPT_RT {
    double sum = 0.0;
    for (int i = 1; i < vertices.size(); ++i) {
      sum += robot.path_distance(vertices[i - 1], vertices[i]);
    }
    return sum;
  }

  // Takes whole turns out of joints that turn without end, so that consecutive vertices differ by
  // the motion between them.
  void unwrap(const Robot& robot) SOPT_RT {
    for (int i = 1; i < vertices.size(); ++i) {
      vertices[i] = robot.unwrapped(vertices[i - 1], vertices[i]);
    }
  }

  FixedVector<typename Robot::Config> vertices;
};

// states[0..horizon], inputs[0..horizon-1]; states[t+1] follows from states[t] and inputs[t] by the
// robot's dynamics over dt_s.
template <class Robot>
struct Trajectory {
  Trajectory() noexcept = default;
  Trajectory(Arena& arena, int max_horizon) noexcept
      : states(arena, max_horizon + 1), inputs(arena, max_horizon) {}

  [[nodiscard]] int horizon() const SOPT_RT { return states.empty() ? 0 : states.size() - 1; }
  [[nodiscard]] double duration_s() const SOPT_RT { return dt_s * horizon(); }

  FixedVector<typename Robot::State> states;
  FixedVector<typename Robot::Input> inputs;
  double dt_s = 0.0;
};

// One planning problem. The world must stay as it is while it is planned.
template <class Robot>
struct PlanRequest {
  typename Robot::Config start{};
  typename Robot::Config goal{};
  const typename Robot::World* world = nullptr;
  std::uint64_t seed = 1;
  double deadline_s = std::numeric_limits<double>::infinity();  // from the call of plan(), > 0
  PlanOptions options;
};

}  // namespace sopt
