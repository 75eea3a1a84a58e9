// An arm in a World3 with its own memory, and random scenes of obstacles around an arm, for tests.
// Clearances here are computed by looking at every capsule and every obstacle.
#pragma once

#include <algorithm>
#include <functional>
#include <limits>

#include "alloc/arena.h"
#include "alloc/memory_block.h"
#include "models/arm/arm.h"
#include "models/arm/arm_presets.h"
#include "models/space/clearance3.h"
#include "models/space/world3.h"
#include "tests/support/arm_oracle.h"
#include "tests/support/oracle3.h"

namespace sopt::oracle {

struct TestWorld3 {
  explicit TestWorld3(const World3Capacity& capacity = {64, 16})
      : block(World3::required_bytes(capacity)), arena(block), world(arena, capacity) {}

  MemoryBlock block;
  Arena arena;
  World3 world;
};

// The nearest obstacle less what `rule` asks for it.
template <int N>
[[nodiscard]] double least_excess(const Arm<N>& arm, const World3& world,
                                  const typename Arm<N>::Config& q, const ClearanceRule& rule) {
  ArmPose<N> pose;
  arm.forward(q, pose);
  double least_m = std::numeric_limits<double>::infinity();
  for (int k = 0; k < arm.num_capsules(); ++k) {
    for (int i = 0; i < world.num_obstacles(); ++i) {
      const Clearance3 c = compute_clearance(world.obstacle(i), arm.capsule_W(pose, k));
      least_m = std::min(least_m, c.distance_m - world.required_m(i, rule));
    }
  }
  return least_m;
}

// The smallest distance of a pair of links that may collide.
template <int N>
[[nodiscard]] double least_self_distance(const Arm<N>& arm, const typename Arm<N>::Config& q) {
  ArmPose<N> pose;
  arm.forward(q, pose);
  double least_m = std::numeric_limits<double>::infinity();
  for (const auto& pair : arm.self_collision_pairs()) {
    const ArmBody& a = arm.body(pair.i_body_a);
    const ArmBody& b = arm.body(pair.i_body_b);
    for (int i = a.first; i < a.last; ++i) {
      const Convex3 one = to_convex(arm.capsule_W(pose, i));
      for (int k = b.first; k < b.last; ++k) {
        least_m = std::min(least_m, compute_clearance(one, arm.capsule_W(pose, k)).distance_m);
      }
    }
  }
  return least_m;
}

// A box, sphere, capsule, cylinder or hull 0.1 to 0.4 m large, its middle at `center`.
[[nodiscard]] inline Solid random_obstacle(Random& random, const Vec3& center) {
  const auto kind = static_cast<SolidKind>(random.index(kNumSolidKinds));
  Solid solid;
  solid.kind = kind;
  const Pose3 pose{random_rotation(random), center};
  const Vec3 half =
      0.5 * Vec3(random.uniform(0.1, 0.4), random.uniform(0.1, 0.4), random.uniform(0.1, 0.4));
  solid.sphere = {center, half.x()};
  const Vec3 axis = pose.rotation.col(2) * half.z();
  solid.capsule = {center - axis, center + axis, 0.5 * half.x()};
  solid.box = {pose, 2.0 * half};
  solid.cylinder = {pose, half.x(), 2.0 * half.z()};
  for (int i = 0; i < 8 && kind == SolidKind::kHull; ++i) {
    const Vec3 corner((i & 1) != 0 ? 1.0 : -1.0, (i & 2) != 0 ? 1.0 : -1.0,
                      (i & 4) != 0 ? 0.6 : -1.0);
    solid.hull.push_back(center + pose.rotation * corner.cwiseProduct(half));
  }
  return solid;
}

// `num` obstacles around the arm's base, 0.35 to 0.9 m from it.
template <int N>
void scatter_obstacles(Random& random, const Arm<N>& arm, int num, World3& world) {
  world.reset();
  for (int tries = 0; world.num_obstacles() < num && tries < 1000; ++tries) {
    Vec3 offset = random_vector(random, 0.9);
    offset.z() = std::abs(offset.z());
    if (offset.head<2>().norm() < 0.35 || offset.norm() > 0.9) continue;
    const Vec3 center = arm.kinematics().X_WB.position + offset;
    (void)add_to(world, random_obstacle(random, center));
  }
  world.build();
}

// The first of `max_tries` random configurations, each changed by `change`, that is clear by `rule`
// and has its links `self_m` apart. False when none is: then q is the last.
template <int N, class Change = std::identity>
bool draw_free(Random& random, const Arm<N>& arm, const World3& world, const ClearanceRule& rule,
               double self_m, int max_tries, typename Arm<N>::Config& q,
               const Change& change = {}) {
  for (int i = 0; i < max_tries; ++i) {
    q = random_configuration(random, arm);
    (void)change(q);
    if (least_excess(arm, world, q, rule) > 0.0 && least_self_distance(arm, q) > self_m) {
      return true;
    }
  }
  return false;
}

// A request in such a scene: start and goal clear by `rule`, the tool more than 0.6 m apart, the
// straight motion between them blocked. False when none was found.
template <int N>
[[nodiscard]] bool draw_request(Random& random, const Arm<N>& arm, const World3& world,
                                const ClearanceRule& rule, typename Arm<N>::Config& start,
                                typename Arm<N>::Config& goal) {
  const auto draw = [&](typename Arm<N>::Config& q) {
    return draw_free(random, arm, world, rule, 1e-3, 200, q);
  };
  const auto tool = [&](const typename Arm<N>::Config& q) {
    ArmPose<N> pose;
    arm.forward(q, pose);
    return arm.capsule_W(pose, arm.num_capsules() - 1).p1;
  };
  for (int i = 0; i < 200; ++i) {
    if (!draw(start) || !draw(goal)) return false;
    if ((tool(goal) - tool(start)).norm() <= 0.6) continue;
    for (int k = 1; k < 100; ++k) {
      const auto q = arm.interpolate(start, goal, 0.01 * k);
      if (least_excess(arm, world, q, rule) < 0.0 || least_self_distance(arm, q) < 0.0) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace sopt::oracle
