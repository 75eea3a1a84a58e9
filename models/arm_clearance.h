// What is near an arm at one configuration: obstacles near its links, and its links near each
// other. Exact (clearance3.h); per-link bounding spheres are tested first. Jacobians follow from
// the envelope theorem: the witness points move as if fixed to their links.
#pragma once

#include <array>

#include "models/arm.h"
#include "models/clearance3.h"
#include "models/margin.h"
#include "models/world3.h"
#include "rt/annotations.h"

namespace sopt {

// A link and what is near it; both in the world.
struct ArmContact {
  int i_link = 0;
  int i_obstacle = kNoObstacle;  // kSelfObstacle: another link
  int i_other_link = -1;         // then this one, < i_link
  Clearance3 clearance;          // from the obstacle or other link to i_link
};

// False only when the sphere is at least radius_m away from the obstacle, rounding considered. Of a
// hull a lower bound of the distance is tested, of other shapes the distance itself.
[[nodiscard]] bool may_be_within(const Convex3& obstacle, const Sphere3& sphere,
                                 double radius_m) SOPT_RT;

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

[[nodiscard]] inline Aabb3 box_around(const Sphere3& sphere, double more_m) SOPT_RT {
  const Vec3 reach = Vec3::Constant(sphere.radius_m + more_m);
  return {sphere.center - reach, sphere.center + reach};
}

[[nodiscard]] inline bool may_be_within(const Sphere3& a, const Sphere3& b,
                                        double radius_m) SOPT_RT {
  const double limit_m = (a.radius_m + b.radius_m + radius_m) * (1.0 + 1e-12);
  return limit_m >= 0.0 && !((a.center - b.center).squaredNorm() > limit_m * limit_m);
}

[[nodiscard]] inline Sphere3 sphere_around(const Capsule3& capsule) SOPT_RT {
  return {0.5 * (capsule.p0 + capsule.p1),
          (0.5 * (capsule.p1 - capsule.p0).norm() + capsule.radius_m) * (1.0 + 1e-12)};
}

// The nearest of capsules [first, last) of the arm to an obstacle, as far as limit_m. Of several,
// those whose spheres are farther are not looked at: may_reach(sphere, limit_m) is false for them.
template <int N, class MayReach>
[[nodiscard]] bool find_nearest_capsule(const Arm<N>& arm, const ArmPose<N>& pose, int first,
                                        int last, const Convex3& obstacle, double limit_m,
                                        Clearance3& out, MayReach&& may_reach) SOPT_RT {
  bool found = false;
  for (int i = first; i < last; ++i) {
    const Capsule3 capsule = arm.capsule_W(pose, i);
    if (last - first > 1 && !may_reach(sphere_around(capsule), limit_m)) continue;
    Clearance3 c;
    if (!compute_clearance_within(obstacle, capsule, limit_m, c)) continue;
    if (found && c.distance_m >= out.distance_m) continue;
    out = c;
    limit_m = c.distance_m;
    found = true;
  }
  return found;
}

// Of an obstacle of the world.
template <int N>
[[nodiscard]] bool find_nearest_capsule(const Arm<N>& arm, const ArmPose<N>& pose, int first,
                                        int last, const Convex3& obstacle, double limit_m,
                                        Clearance3& out) SOPT_RT {
  return find_nearest_capsule(
      arm, pose, first, last, obstacle, limit_m, out,
      [&](const Sphere3& s, double reach_m) { return may_be_within(obstacle, s, reach_m); });
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
    const int first = arm.first_capsule(l);
    const int last = arm.first_capsule(l + 1);
    if (first == last) continue;
    const double radius_m = radii_m[static_cast<std::size_t>(l)];
    const Sphere3 sphere = arm.link_sphere_W(pose, l);
    const bool went_on = world.for_each_near(detail::box_around(sphere, radius_m), [&](int i) {
      const Convex3& obstacle = world.obstacle(i);
      if (!may_be_within(obstacle, sphere, radius_m)) return true;
      ArmContact contact{l, i, -1, {}};
      return !detail::find_nearest_capsule(arm, pose, first, last, obstacle, radius_m,
                                           contact.clearance) ||
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
    const ArmBody& a = arm.body(pair.i_body_a);
    const ArmBody& b = arm.body(pair.i_body_b);
    const Sphere3 around_b = arm.body_sphere_W(pose, pair.i_body_b);
    if (!detail::may_be_within(arm.body_sphere_W(pose, pair.i_body_a), around_b, radius_m)) {
      continue;
    }
    ArmContact contact{b.i_link, kSelfObstacle, a.i_link, {}};
    double limit_m = radius_m;
    bool found = false;
    for (int i = a.first; i < a.last; ++i) {
      const Capsule3 capsule = arm.capsule_W(pose, i);
      const Sphere3 around_a = detail::sphere_around(capsule);
      if (!detail::may_be_within(around_a, around_b, limit_m)) continue;
      const auto may_reach = [&](const Sphere3& s, double reach_m) {
        return detail::may_be_within(around_a, s, reach_m);
      };
      if (detail::find_nearest_capsule(arm, pose, b.first, b.last, to_convex(capsule), limit_m,
                                       contact.clearance, may_reach)) {
        found = true;
        limit_m = contact.clearance.distance_m;
      }
    }
    if (found && !visit(static_cast<const ArmContact&>(contact))) return false;
  }
  return true;
}

}  // namespace sopt
