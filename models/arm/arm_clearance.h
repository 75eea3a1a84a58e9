// What is near an arm at one configuration: obstacles near its links, and its links near each
// other. Exact (clearance3.h); per-link bounding spheres are tested first. Jacobians follow from
// the envelope theorem: the witness points move as if fixed to their links.
#pragma once

#include <array>

#include "models/arm/arm.h"
#include "models/margin.h"
#include "models/space/clearance3.h"
#include "models/space/world3.h"
#include "rt/annotations.h"

namespace sopt {

// A link and what is near it; both in the world.
struct ArmContact {
  int i_link = 0;
  int i_obstacle = kNoObstacle;  // kSelfObstacle: another link
  int i_other_link = kNoLink;    // then this one, < i_link
  Clearance3 clearance;          // from the obstacle or other link to i_link
};

[[nodiscard]] inline Aabb3 box_around(const Sphere3& sphere, double more_m) SOPT_RT {
  const Vec3 reach = Vec3::Constant(sphere.radius_m + more_m);
  return {sphere.center - reach, sphere.center + reach};
}

// False only when the sphere is at least radius_m away from the obstacle, rounding considered. Of a
// hull a lower bound of the distance is tested, of other shapes the distance itself.
[[nodiscard]] bool may_be_within(const Convex3& obstacle, const Sphere3& sphere,
                                 double radius_m) SOPT_RT;

// Whether a capsule of link i_link is closer than radius_m to the obstacle. Exact.
template <int N>
[[nodiscard]] bool link_is_within(const Arm<N>& arm, const ArmPose<N>& pose, int i_link,
                                  const Convex3& obstacle, double radius_m) SOPT_RT;
// Whether capsules of two bodies are closer than radius_m to each other. Exact.
template <int N>
[[nodiscard]] bool bodies_are_within(const Arm<N>& arm, const ArmPose<N>& pose, int i_body_a,
                                     int i_body_b, double radius_m) SOPT_RT;

// The nearest capsule of every link to every obstacle that is at most `radius_m` away, links in
// order, obstacles in the broad phase's order. visit(const ArmContact&) -> bool; false stops.
// Returns false when it was stopped.
template <int N, class Visit>
bool for_each_contact(const Arm<N>& arm, const World3& world, const ArmPose<N>& pose,
                      double radius_m, Visit&& visit);
// With a radius for every link.
template <int N>
using LinkRadii = std::array<double, N + 1>;
template <int N, class Visit>
bool for_each_contact(const Arm<N>& arm, const World3& world, const ArmPose<N>& pose,
                      const LinkRadii<N>& radius_m, Visit&& visit);

// Likewise the nearest capsules of every pair of bodies that may collide and are at most `radius_m`
// apart.
template <int N, class Visit>
bool for_each_self_contact(const Arm<N>& arm, const ArmPose<N>& pose, double radius_m,
                           Visit&& visit);

// d distance / dq, per unit of joint travel.
template <int N>
[[nodiscard]] typename Arm<N>::Config contact_gradient(const Arm<N>& arm, const ArmPose<N>& pose,
                                                       const ArmContact& contact) SOPT_RT;

// The nearest obstacle within limit_m; kNoObstacle and limit_m if there is none.
template <int N>
[[nodiscard]] ArmContact nearest_obstacle(const Arm<N>& arm, const World3& world,
                                          const ArmPose<N>& pose, double limit_m) SOPT_RT;
// The nearest pair of links within limit_m.
template <int N>
[[nodiscard]] ArmContact nearest_link_pair(const Arm<N>& arm, const ArmPose<N>& pose,
                                           double limit_m) SOPT_RT;

// True when every link keeps the clearance that `rule` asks for from every obstacle, and pairs of
// links `self_clearance_m` from each other. False where the configuration was not finite.
template <int N>
[[nodiscard]] bool is_clear(const Arm<N>& arm, const World3& world, const ArmPose<N>& pose,
                            const ClearanceRule& rule, double self_clearance_m) SOPT_RT;

// --- implementation

namespace arm_clearance_detail {

[[nodiscard]] inline bool may_be_within(const Sphere3& a, const Sphere3& b,
                                        double radius_m) SOPT_RT {
  const double limit_m = (a.radius_m + b.radius_m + radius_m) * (1.0 + 1e-12);
  return limit_m >= 0.0 && !((a.center - b.center).squaredNorm() > limit_m * limit_m);
}

// Calls look(lane) for lanes whose bound is at most limit_m, the lowest bound first; `look` may
// lower limit_m.
template <class Look>
[[gnu::always_inline]] inline void look_at_nearest(const V8f& bound_m, const double& limit_m,
                                                   Look&& look) {
  unsigned open = ~lane_mask8(bound_m > float_above(limit_m)) & kAllLanes;
  while (open != 0) {
    int nearest = __builtin_ctz(open);
    for (unsigned rest = open & (open - 1); rest != 0; rest &= rest - 1) {
      const int lane = __builtin_ctz(rest);
      if (bound_m[lane] < bound_m[nearest]) nearest = lane;
    }
    if (static_cast<double>(bound_m[nearest]) > limit_m) return;
    look(nearest);
    open &= ~(1U << nearest);
  }
}

// The nearest capsule of link i_link to obstacle i_obstacle, as far as limit_m.
template <int N>
[[nodiscard]] bool find_nearest_capsule(const Arm<N>& arm, const World3& world,
                                        const ArmPose<N>& pose, int i_link, int i_obstacle,
                                        double limit_m, Clearance3& out) SOPT_RT {
  const Convex3& obstacle = world.obstacle(i_obstacle);
  const int first = arm.first_capsule(i_link);
  if (arm.first_capsule(i_link + 1) == first + 1) {
    return compute_clearance_within(obstacle, arm.capsule_W(pose, first), limit_m, out);
  }
  bool found = false;
  for (const SphereBatch& batch : arm.capsule_spheres().of_link(i_link)) {
    const PaddedLanes spheres = to_world(pose.X_WJ[static_cast<std::size_t>(i_link)], batch);
    look_at_nearest(world.distance_bounds(i_obstacle, spheres), limit_m, [&](int lane) {
      const Capsule3 capsule = arm.capsule_W(pose, batch.first + lane);
      if (!compute_clearance_within(obstacle, capsule, limit_m, out)) return;
      found = true;
      limit_m = out.distance_m;
    });
  }
  return found;
}

// The nearest capsules of two bodies, as far as limit_m.
template <int N>
[[nodiscard]] bool find_nearest_capsules(const Arm<N>& arm, const ArmPose<N>& pose, int i_body_a,
                                         int i_body_b, double limit_m, Clearance3& out) SOPT_RT {
  const auto frame = [&](int i_body) -> const Pose3& {
    return pose.X_WJ[static_cast<std::size_t>(arm.body(i_body).i_link)];
  };
  bool found = false;
  for (const SphereBatch& batch_b : arm.capsule_spheres().of_body(i_body_b)) {
    const PaddedLanes b = to_world(frame(i_body_b), batch_b);
    for (const SphereBatch& batch_a : arm.capsule_spheres().of_body(i_body_a)) {
      const PaddedLanes a = to_world(frame(i_body_a), batch_a);
      for (int i = 0; i < batch_a.num; ++i) {
        const V8f bound_m = distance_bounds(b, a, i);
        look_at_nearest(bound_m, limit_m, [&](int lane) {
          const Convex3 one = to_convex(arm.capsule_W(pose, batch_a.first + i));
          const Capsule3 other = arm.capsule_W(pose, batch_b.first + lane);
          if (!compute_clearance_within(one, other, limit_m, out)) return;
          found = true;
          limit_m = out.distance_m;
        });
      }
    }
  }
  return found;
}

}  // namespace arm_clearance_detail

template <int N, class Visit>
bool for_each_contact(const Arm<N>& arm, const World3& world, const ArmPose<N>& pose,
                      double radius_m, Visit&& visit) {
  LinkRadii<N> radii_m;
  radii_m.fill(radius_m);
  return for_each_contact(arm, world, pose, radii_m, static_cast<Visit&&>(visit));
}

template <int N, class Visit>
bool for_each_contact(const Arm<N>& arm, const World3& world, const ArmPose<N>& pose,
                      const LinkRadii<N>& radii_m, Visit&& visit) {
  namespace detail = arm_clearance_detail;
  for (int l = 0; l <= N; ++l) {
    if (arm.first_capsule(l) == arm.first_capsule(l + 1)) continue;
    const double radius_m = radii_m[static_cast<std::size_t>(l)];
    const Sphere3 sphere = arm.link_sphere_W(pose, l);
    const bool went_on = world.for_each_near(box_around(sphere, radius_m), [&](int i) {
      const Convex3& obstacle = world.obstacle(i);
      if (!may_be_within(obstacle, sphere, radius_m)) return true;
      ArmContact contact{l, i, kNoLink, {}};
      return !detail::find_nearest_capsule(arm, world, pose, l, i, radius_m, contact.clearance) ||
             visit(static_cast<const ArmContact&>(contact));
    });
    if (!went_on) return false;
  }
  return true;
}

template <int N, class Visit>
bool for_each_self_contact(const Arm<N>& arm, const ArmPose<N>& pose, double radius_m,
                           Visit&& visit) {
  namespace detail = arm_clearance_detail;
  for (const auto& pair : arm.self_collision_pairs()) {
    if (!detail::may_be_within(arm.body_sphere_W(pose, pair.i_body_a),
                               arm.body_sphere_W(pose, pair.i_body_b), radius_m)) {
      continue;
    }
    ArmContact contact{
        arm.body(pair.i_body_b).i_link, kSelfObstacle, arm.body(pair.i_body_a).i_link, {}};
    if (detail::find_nearest_capsules(arm, pose, pair.i_body_a, pair.i_body_b, radius_m,
                                      contact.clearance) &&
        !visit(static_cast<const ArmContact&>(contact))) {
      return false;
    }
  }
  return true;
}

}  // namespace sopt
