// How near an arm comes to things along a trajectory, for tests only: the library's exact distance
// at many instants of every step, and a search between samples around every low one. Also
// trajectories of arms to look at: from rest to rest, exact, with accelerations that jump.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "alloc/arena.h"
#include "alloc/memory_block.h"
#include "models/arm/arm.h"
#include "models/trajectory.h"
#include "models/world_status.h"
#include "tests/support/oracle2.h"

namespace sopt::oracle {

struct MotionMinimum {
  double clearance_m = std::numeric_limits<double>::infinity();
  double t_s = 0.0;
  int i_link = 0;
  int i_obstacle = kNoObstacle;
  int i_other_link = kNoLink;
};

// Over all obstacles, or the one given, and over all pairs of bodies that may collide, or the one.
template <int N>
[[nodiscard]] MotionMinimum obstacle_minimum(const Arm<N>& arm, const Trajectory<Arm<N>>& motion,
                                             std::span<const Convex3* const> obstacles,
                                             int samples_per_step);
template <int N>
[[nodiscard]] MotionMinimum self_minimum(const Arm<N>& arm, const Trajectory<Arm<N>>& motion,
                                         int samples_per_step);
// At one instant.
template <int N>
[[nodiscard]] MotionMinimum obstacle_clearance(const Arm<N>& arm, const typename Arm<N>::Config& q,
                                               std::span<const Convex3* const> obstacles);
template <int N>
[[nodiscard]] MotionMinimum self_clearance(const Arm<N>& arm, const typename Arm<N>::Config& q);

template <int N>
[[nodiscard]] typename Arm<N>::Config configuration_at(const Trajectory<Arm<N>>& motion,
                                                       double t_s);

// With its own memory.
template <int N>
struct ArmTrajectory {
  // From rest at `start`; rounding apart it ends at rest when the inputs sum to 0.
  ArmTrajectory(const typename Arm<N>::Config& start,
                const std::vector<typename Arm<N>::Input>& inputs, double dt_s)
      : block((inputs.size() + 2) * 3 * sizeof(typename Arm<N>::State) + 4 * Arena::kAlignment),
        arena(block),
        trajectory(arena, static_cast<int>(inputs.size())) {
    trajectory.dt_s = dt_s;
    typename Arm<N>::State state = Arm<N>::State::Zero();
    state.template head<N>() = start;
    (void)trajectory.states.try_push_back(state);
    for (const auto& input : inputs) {
      (void)trajectory.inputs.try_push_back(input);
      state = Arm<N>::step(state, input, dt_s);
      (void)trajectory.states.try_push_back(state);
    }
    trajectory.states.back().template tail<N>().setZero();
  }

  [[nodiscard]] typename Arm<N>::Config start() const {
    return trajectory.states[0].template head<N>();
  }
  [[nodiscard]] typename Arm<N>::Config goal() const {
    return trajectory.states[trajectory.horizon()].template head<N>();
  }

  MemoryBlock block;
  Arena arena;
  Trajectory<Arm<N>> trajectory;
};

// Within the arm's limits.
template <int N>
[[nodiscard]] ArmTrajectory<N> random_motion(Random& random, const Arm<N>& arm, int horizon,
                                             double dt_s);

}  // namespace sopt::oracle
