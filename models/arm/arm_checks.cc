#include "models/arm/arm_checks.h"

#include <algorithm>

namespace sopt {

ArmStatus check_joint(const ArmJoint& joint) noexcept {
  constexpr double kTolerance = 1e-9;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const bool is_continuous = joint.kind == JointKind::kContinuous;
  const bool poses_finite = joint.origin.position.allFinite() &&
                            joint.origin.rotation.allFinite() && joint.axis.allFinite() &&
                            std::isfinite(joint.v_max) && std::isfinite(joint.a_max);
  const bool limits_finite = std::isfinite(joint.lower) && std::isfinite(joint.upper);
  if (!poses_finite || (!is_continuous && !limits_finite)) return ArmStatus::kNotFinite;
  if (!is_rotation(joint.origin.rotation)) return ArmStatus::kBadRotation;
  if (std::abs(joint.axis.norm() - 1.0) > kTolerance) return ArmStatus::kBadAxis;
  const bool limits_hold = is_continuous ? joint.lower == -kInfinity && joint.upper == kInfinity
                                         : joint.lower <= joint.upper;
  if (!limits_hold) return ArmStatus::kBadLimits;
  if (!(joint.v_max > 0.0) || !(joint.a_max > 0.0)) return ArmStatus::kBadRate;
  const bool weight_fits = joint.weight >= 1.0 / kMaxJointWeight && joint.weight <= kMaxJointWeight;
  if (!weight_fits) return ArmStatus::kBadWeight;
  return ArmStatus::kOk;
}

ArmStatus check_capsules(std::span<const LinkCapsule> capsules, int num_links) noexcept {
  if (capsules.size() > static_cast<std::size_t>(kMaxLinkCapsules)) {
    return ArmStatus::kTooManyCapsules;
  }
  for (const LinkCapsule& capsule : capsules) {
    const bool is_finite =
        capsule.p0.allFinite() && capsule.p1.allFinite() && std::isfinite(capsule.radius_m);
    if (!is_finite) return ArmStatus::kNotFinite;
    if (capsule.radius_m < 0.0) return ArmStatus::kBadRadius;
    if (capsule.i_link < 0 || capsule.i_link >= num_links) return ArmStatus::kBadLink;
    if (capsule.i_body < 0 || capsule.i_body >= kMaxBodies) return ArmStatus::kBadLink;
  }
  return ArmStatus::kOk;
}

ArmStatus check_pairs(std::span<const BodyPair> pairs, int num_links) noexcept {
  if (pairs.size() > static_cast<std::size_t>(kMaxBodyPairs)) return ArmStatus::kTooManyPairs;
  for (const BodyPair& pair : pairs) {
    for (const int i_link : {pair.i_link_a, pair.i_link_b}) {
      if (i_link < 0 || i_link >= num_links) return ArmStatus::kBadLink;
    }
    for (const int i_body : {pair.i_body_a, pair.i_body_b}) {
      if (i_body < 0 || i_body >= kMaxBodies) return ArmStatus::kBadLink;
    }
    if (pair.i_link_a == pair.i_link_b) return ArmStatus::kBadLink;
  }
  return ArmStatus::kOk;
}

// A capsule is the hull of the balls at its ends. From the middle of their box, the centre moves
// towards the farthest ball by a share of the way that shrinks as 1/k (Badoiu and Clarkson, 2003);
// the best centre met is kept.
Sphere3 enclosing_sphere(std::span<const Capsule3> capsules) noexcept {
  constexpr int kNumSteps = 300;
  constexpr double kRounding = 1.0 + 1e-12;
  if (capsules.empty()) return {};
  Aabb3 box{Vec3::Constant(std::numeric_limits<double>::infinity()),
            Vec3::Constant(-std::numeric_limits<double>::infinity())};
  for (const Capsule3& c : capsules) {
    const Vec3 r = Vec3::Constant(c.radius_m);
    box.lower = box.lower.cwiseMin(c.p0 - r).cwiseMin(c.p1 - r);
    box.upper = box.upper.cwiseMax(c.p0 + r).cwiseMax(c.p1 + r);
  }
  Vec3 center = 0.5 * (box.lower + box.upper);
  Sphere3 best{center, std::numeric_limits<double>::infinity()};
  for (int k = 1; k <= kNumSteps; ++k) {
    Vec3 farthest = center;
    double radius_m = 0.0;
    for (const Capsule3& c : capsules) {
      for (const Vec3* end : {&c.p0, &c.p1}) {
        const double reach_m = (*end - center).norm() + c.radius_m;
        if (reach_m > radius_m) {
          radius_m = reach_m;
          farthest = *end;
        }
      }
    }
    if (radius_m < best.radius_m) best = {center, radius_m};
    center += (farthest - center) / (k + 1.0);
  }
  // Relative to the coordinates too: they are rounded before they are subtracted.
  best.radius_m = best.radius_m * kRounding + 1e-15 * best.center.norm();
  return best;
}

}  // namespace sopt
