#include "models/arm/arm_clearance.h"

#include <algorithm>
#include <cmath>

namespace sopt {
namespace {

// Square of the distance from a core to a point in the core's frame, relative to its center; of a
// hull of the widest plane distance.
double core_distance2(const Convex3& shape, const Vec3& offset) noexcept {
  if (shape.kind == CoreKind::kPoint) return offset.squaredNorm();
  if (shape.kind == CoreKind::kHull) {
    double best = 0.0;
    for (int i = 0; i < shape.hull->num_planes; ++i) {
      best = std::max(best, shape.hull->normal[i].dot(offset) - shape.hull->offset[i]);
    }
    return best * best;
  }
  if (shape.kind == CoreKind::kSegment) {
    const Vec3 axis = shape.axes.col(2);
    const double along = std::clamp(axis.dot(offset), -shape.half_m.z(), shape.half_m.z());
    return (offset - along * axis).squaredNorm();
  }
  const Vec3 local = shape.axes.transpose() * offset;
  if (shape.kind == CoreKind::kBox) {
    return (local.cwiseAbs() - shape.half_m).cwiseMax(0.0).squaredNorm();
  }
  const double across = std::max(local.head<2>().norm() - shape.half_m.x(), 0.0);
  const double above = std::max(std::abs(local.z()) - shape.half_m.z(), 0.0);
  return across * across + above * above;
}

// Exact. Where that is slow, only if one of the spheres that cover the capsule is near, too. Not
// inlined: is_clear is 2 % faster.
template <int N>
[[nodiscard]] [[gnu::noinline]] bool is_near(const Arm<N>& arm, const ArmPose<N>& pose,
                                             int i_capsule, const Convex3& obstacle,
                                             double radius_m) noexcept {
  if (obstacle.kind == CoreKind::kCylinder || obstacle.kind == CoreKind::kHull) {
    const Pose3& X = pose.X_WJ[static_cast<std::size_t>(arm.capsule_link(i_capsule))];
    const auto cover = arm.cover(i_capsule);
    if (std::none_of(cover.begin(), cover.end(), [&](const CoverSphere& s) {
          const Vec3 center = Eigen::Vector3f(s.center[0], s.center[1], s.center[2]).cast<double>();
          const Sphere3 sphere{transform(X, center), static_cast<double>(s.radius_m)};
          return may_be_within(obstacle, sphere, radius_m);
        })) {
      return false;
    }
  }
  return is_within(obstacle, arm.capsule_W(pose, i_capsule), radius_m);
}

}  // namespace

bool may_be_within(const Convex3& obstacle, const Sphere3& sphere, double radius_m) SOPT_RT {
  const Vec3 offset = sphere.center - obstacle.center;
  const double rounding_m =
      1e-15 * (sphere.center.lpNorm<1>() + obstacle.center.lpNorm<1>() + obstacle.half_m.sum());
  const double limit_m =
      (sphere.radius_m + obstacle.radius_m + radius_m) * (1.0 + 1e-12) + 8.0 * rounding_m;
  return limit_m >= 0.0 && !(core_distance2(obstacle, offset) > limit_m * limit_m);
}

template <int N>
bool link_is_within(const Arm<N>& arm, const ArmPose<N>& pose, int i_link, const Convex3& obstacle,
                    double radius_m) SOPT_RT {
  for (int i = arm.first_capsule(i_link); i < arm.first_capsule(i_link + 1); ++i) {
    if (is_near(arm, pose, i, obstacle, radius_m)) return true;
  }
  return false;
}

template <int N>
bool bodies_are_within(const Arm<N>& arm, const ArmPose<N>& pose, int i_body_a, int i_body_b,
                       double radius_m) SOPT_RT {
  const ArmBody& a = arm.body(i_body_a);
  const ArmBody& b = arm.body(i_body_b);
  for (int i = a.first; i < a.last; ++i) {
    const Convex3 one = to_convex(arm.capsule_W(pose, i));
    for (int k = b.first; k < b.last; ++k) {
      if (is_within(one, arm.capsule_W(pose, k), radius_m)) return true;
    }
  }
  return false;
}

template <int N>
typename Arm<N>::Config contact_gradient(const Arm<N>& arm, const ArmPose<N>& pose,
                                         const ArmContact& contact) SOPT_RT {
  typename Arm<N>::Config gradient = arm.distance_gradient(
      pose, contact.i_link, contact.clearance.on_body, contact.clearance.normal);
  // Joints below both links move them as one.
  for (int j = 0; j < contact.i_other_link; ++j) gradient[j] = 0.0;
  return gradient;
}

template <int N>
ArmContact nearest_obstacle(const Arm<N>& arm, const World3& world, const ArmPose<N>& pose,
                            double limit_m) SOPT_RT {
  ArmContact nearest;
  nearest.clearance.distance_m = limit_m;
  // Not for_each_contact: here the limit shrinks on the way.
  for (int l = 0; l <= N; ++l) {
    if (arm.first_capsule(l) == arm.first_capsule(l + 1)) continue;
    const Sphere3 sphere = arm.link_sphere_W(pose, l);
    const double reach_m = std::max(nearest.clearance.distance_m, 0.0);
    (void)world.for_each_near(box_around(sphere, reach_m), [&](int i) {
      const double best_m = nearest.clearance.distance_m;
      Clearance3 c;
      if (may_be_within(world.obstacle(i), sphere, best_m) &&
          arm_clearance_detail::find_nearest_capsule(arm, world, pose, l, i, best_m, c) &&
          c.distance_m < best_m) {
        nearest = {l, i, kNoLink, c};
      }
      return true;
    });
  }
  return nearest;
}

template <int N>
ArmContact nearest_link_pair(const Arm<N>& arm, const ArmPose<N>& pose, double limit_m) SOPT_RT {
  ArmContact nearest;
  nearest.clearance.distance_m = limit_m;
  (void)for_each_self_contact(arm, pose, limit_m, [&](const ArmContact& contact) {
    if (contact.clearance.distance_m < nearest.clearance.distance_m) nearest = contact;
    return true;
  });
  return nearest;
}

template <int N>
bool is_clear(const Arm<N>& arm, const World3& world, const ArmPose<N>& pose,
              const ClearanceRule& rule, double self_clearance_m) SOPT_RT {
  const Pose3& tip = pose.X_WJ[N];  // the others' product: finite only if they are
  if (!std::isfinite(tip.rotation.col(0).sum() + tip.position.sum())) return false;
  const double reach_m = world.max_required_m(rule);
  for (int l = N; l >= 0; --l) {  // the outer links meet more
    const int first = arm.first_capsule(l);
    const int last = arm.first_capsule(l + 1);
    if (first == last) continue;
    const Sphere3 sphere = arm.link_sphere_W(pose, l);
    // A single capsule's box is tighter than its sphere's.
    const Aabb3 area = last == first + 1 ? grown(bounding_box(arm.capsule_W(pose, first)), reach_m)
                                         : box_around(sphere, reach_m);
    const bool is_free = world.for_each_near(area, [&](int i) {
      const double required_m = world.required_m(i, rule);
      return !may_be_within(world.obstacle(i), sphere, required_m) ||
             !link_is_within(arm, pose, l, world.obstacle(i), required_m);
    });
    if (!is_free) return false;
  }
  for (const auto& pair : arm.self_collision_pairs()) {
    if (arm_clearance_detail::may_be_within(arm.body_sphere_W(pose, pair.i_body_a),
                                            arm.body_sphere_W(pose, pair.i_body_b),
                                            self_clearance_m) &&
        bodies_are_within(arm, pose, pair.i_body_a, pair.i_body_b, self_clearance_m)) {
      return false;
    }
  }
  return true;
}

template <int N>
ArmContact Arm<N>::clearance(const World& world, const Config& q, double limit_m) const SOPT_RT {
  Pose pose;
  forward(q, pose);
  const ArmContact pair = nearest_link_pair(*this, pose, kSelfClearance_m);
  return pair.i_obstacle == kSelfObstacle ? pair : nearest_obstacle(*this, world, pose, limit_m);
}

#define SOPT_ARM_CLEARANCE(N)                                                                   \
  template bool link_is_within(const Arm<N>&, const ArmPose<N>&, int, const Convex3&, double)   \
      SOPT_RT;                                                                                  \
  template bool bodies_are_within(const Arm<N>&, const ArmPose<N>&, int, int, double) SOPT_RT;  \
  template Arm<N>::Config contact_gradient(const Arm<N>&, const ArmPose<N>&, const ArmContact&) \
      SOPT_RT;                                                                                  \
  template ArmContact nearest_obstacle(const Arm<N>&, const World3&, const ArmPose<N>&, double) \
      SOPT_RT;                                                                                  \
  template ArmContact nearest_link_pair(const Arm<N>&, const ArmPose<N>&, double) SOPT_RT;      \
  template bool is_clear(const Arm<N>&, const World3&, const ArmPose<N>&, const ClearanceRule&, \
                         double) SOPT_RT;                                                       \
  template ArmContact Arm<N>::clearance(const World&, const Config&, double) const SOPT_RT;
SOPT_ARM_CLEARANCE(4)
SOPT_ARM_CLEARANCE(5)
SOPT_ARM_CLEARANCE(6)
SOPT_ARM_CLEARANCE(7)
SOPT_ARM_CLEARANCE(8)
#undef SOPT_ARM_CLEARANCE

}  // namespace sopt
