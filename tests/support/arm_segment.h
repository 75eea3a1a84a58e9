// Arm problems for tests: a world of random obstacles around a path that keeps a clearance from
// all of them, the exact reference along it, and brute-force checks of trajectories that use the
// distance of two shapes and nothing else of the library.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "alloc/arena.h"
#include "alloc/memory_block.h"
#include "models/arm/arm.h"
#include "models/space/clearance3.h"
#include "models/space/world3.h"
#include "models/trajectory.h"
#include "opt/reference.h"
#include "tests/support/test_arm.h"

namespace sopt::oracle {

template <int N>
using Configs = std::vector<typename Arm<N>::Config>;
template <int N>
using States = std::vector<typename Arm<N>::State>;

struct ArmTestWorld {
  explicit ArmTestWorld(const World3Capacity& capacity = {64, 8})
      : block(World3::required_bytes(capacity)), arena(block), world(arena, capacity) {
    world.reset();
    world.build();
  }
  MemoryBlock block;
  Arena arena;
  World3 world;
};

template <int N>
struct EmptyArmTrajectory {
  explicit EmptyArmTrajectory(int max_horizon = 1024)
      : block(static_cast<std::size_t>(max_horizon + 1) * (sizeof(typename Arm<N>::State) * 2) +
              4 * Arena::kAlignment),
        arena(block),
        trajectory(arena, max_horizon) {}
  MemoryBlock block;
  Arena arena;
  Trajectory<Arm<N>> trajectory;
};

template <int N>
void make_arm_reference(const Arm<N>& arm, const Configs<N>& way, double step_length, double dt_s,
                        Trajectory<Arm<N>>& out) {
  MemoryBlock block(way.size() * sizeof(way[0]) + 2 * Arena::kAlignment);
  Arena arena(block);
  Path<Arm<N>> path(arena, static_cast<int>(way.size()));
  for (const auto& q : way) (void)path.vertices.try_push_back(q);
  if (!make_reference(arm, path, step_length, dt_s, out)) out.states.clear();
}

// Least distance of moving links to obstacles.
template <int N>
[[nodiscard]] double brute_clearance(const Arm<N>& arm, const World3& world,
                                     const typename Arm<N>::Config& q) {
  ArmPose<N> pose;
  arm.forward(q, pose);
  double least = std::numeric_limits<double>::infinity();
  for (int i = arm.first_capsule(1); i < arm.num_capsules(); ++i) {
    for (int k = 0; k < world.num_obstacles(); ++k) {
      least =
          std::min(least, compute_clearance(world.obstacle(k), arm.capsule_W(pose, i)).distance_m);
    }
  }
  return least;
}

// Configuration at `share` of the step from z to z_next: the parabola.
template <int N>
[[nodiscard]] typename Arm<N>::Config between(const typename Arm<N>::State& z,
                                              const typename Arm<N>::State& z_next, double dt_s,
                                              double share) {
  const typename Arm<N>::Config w = z.template tail<N>();
  const typename Arm<N>::Config alpha = (z_next.template tail<N>() - w) / dt_s;
  const double tau_s = share * dt_s;
  return z.template head<N>() + tau_s * w + 0.5 * tau_s * tau_s * alpha;
}

struct TrajectoryFacts {
  double clearance_m = std::numeric_limits<double>::infinity();  // between waypoints too
  double self_clearance_m = std::numeric_limits<double>::infinity();
  double limit_excess = -std::numeric_limits<double>::infinity();  // of any limit, own unit
  double defect = 0.0;  // of the dynamics, over all states
};

// `samples` per step.
template <int N>
[[nodiscard]] TrajectoryFacts examine(const Arm<N>& arm, const World3& world, const States<N>& z,
                                      double dt_s, int samples) {
  TrajectoryFacts facts;
  for (std::size_t t = 0; t + 1 < z.size(); ++t) {
    const typename Arm<N>::Config w = z[t].template tail<N>();
    const typename Arm<N>::Config alpha = (z[t + 1].template tail<N>() - w) / dt_s;
    const double defect = (Arm<N>::step(z[t], alpha, dt_s) - z[t + 1]).cwiseAbs().maxCoeff();
    facts.defect = std::max(facts.defect, defect);
    for (int i = 0; i < samples; ++i) {
      const auto q = between<N>(z[t], z[t + 1], dt_s, static_cast<double>(i) / samples);
      facts.clearance_m = std::min(facts.clearance_m, brute_clearance(arm, world, q));
      facts.self_clearance_m = std::min(facts.self_clearance_m, least_self_distance(arm, q));
      facts.limit_excess = std::max(
          {facts.limit_excess, (q - arm.upper()).maxCoeff(), (arm.lower() - q).maxCoeff()});
    }
    facts.limit_excess = std::max({facts.limit_excess, (w.cwiseAbs() - arm.v_max()).maxCoeff(),
                                   (alpha.cwiseAbs() - arm.a_max()).maxCoeff()});
  }
  return facts;
}

template <int N>
[[nodiscard]] double arm_cost(const Arm<N>& arm, const States<N>& z, double dt_s, double ds) {
  double sum = 0.0;
  for (std::size_t t = 0; t + 1 < z.size(); ++t) {
    const typename Arm<N>::Config change = (z[t + 1] - z[t]).template tail<N>();
    sum += std::pow(weighted_length(arm, dt_s * z[t].template tail<N>()), 2);
    sum += 2.0 * std::pow(weighted_length(arm, dt_s * change), 2);
  }
  return sum / ds;
}

template <int N>
[[nodiscard]] double way_clearance(const Arm<N>& arm, const World3& world, const Configs<N>& way,
                                   bool between_links) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < way.size(); ++i) {
    for (int k = 0; k <= 40; ++k) {
      const auto q = arm.interpolate(way[i], way[i + 1], k / 40.0);
      least = std::min(
          least, between_links ? least_self_distance(arm, q) : brute_clearance(arm, world, q));
    }
  }
  return least;
}

// A random path of `num_legs` motions inside the middle of the limits, without self-collision.
template <int N>
[[nodiscard]] Configs<N> random_way(Random& random, const Arm<N>& arm, int num_legs) {
  Configs<N> way;
  const ArmTestWorld empty;
  do {
    way.clear();
    for (int i = 0; i <= num_legs; ++i) {
      typename Arm<N>::Config q;
      for (int j = 0; j < N; ++j) {
        const double share = random.uniform(0.1, 0.9);
        q[j] = arm.is_continuous(j) ? random.uniform(-3.0, 3.0)
                                    : (1.0 - share) * arm.lower()[j] + share * arm.upper()[j];
        if (i > 0) q[j] = 0.5 * (q[j] + way.back()[j]);
      }
      way.push_back(q);
    }
  } while (way_clearance(arm, empty.world, way, true) < 0.005);
  return way;
}

struct DrawnObstacle {
  int kind = 0;
  Pose3 pose;
  Vec3 size_m = Vec3::Zero();
};

inline void fill(std::span<const DrawnObstacle> obstacles, World3& world) {
  world.reset();
  for (const DrawnObstacle& o : obstacles) {
    const Vec3 half = 0.5 * o.size_m.z() * o.pose.rotation.col(2);
    const Vec3 p = o.pose.position;
    if (o.kind == 0) (void)world.try_add(Sphere3{p, 0.5 * o.size_m.x()});
    if (o.kind == 1) (void)world.try_add(Box3{o.pose, o.size_m});
    if (o.kind == 2) (void)world.try_add(Capsule3{p - half, p + half, 0.3 * o.size_m.x()});
  }
  world.build();
}

// Fills `world` with obstacles within `reach_m` of the origin that leave the way `clearance_m`; as
// far as they are found, such that are in the way of the straight motion between its ends.
template <int N>
void draw_obstacles(Random& random, const Arm<N>& arm, const Configs<N>& way, int num_obstacles,
                    double reach_m, double clearance_m, World3& world, int max_tries = 2000) {
  const Configs<N> straight = {way.front(), way.back()};
  std::vector<DrawnObstacle> kept;
  ArmTestWorld alone;
  for (int tries = 0; tries < max_tries && static_cast<int>(kept.size()) < num_obstacles; ++tries) {
    DrawnObstacle o{random.index(3), random_pose(random, reach_m), Vec3::Zero()};
    o.size_m = {random.uniform(0.05, 0.3), random.uniform(0.05, 0.3), random.uniform(0.05, 0.3)};
    fill({&o, 1}, alone.world);
    if (tries < max_tries / 2 && way_clearance(arm, alone.world, straight, false) > clearance_m)
      continue;
    if (way_clearance(arm, alone.world, way, false) >= clearance_m) kept.push_back(o);
  }
  fill(kept, world);
}

}  // namespace sopt::oracle
