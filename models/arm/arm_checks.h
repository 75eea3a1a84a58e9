// What `Arm<N>` checks and computes at setup without being part of it: the rules of a description
// and the sphere around a group of capsules.
#pragma once

#include <cmath>
#include <limits>
#include <span>

#include "models/arm/arm_description.h"
#include "models/space/pose3.h"

namespace sopt {

[[nodiscard]] ArmStatus check_joint(const ArmJoint& joint) noexcept;
[[nodiscard]] ArmStatus check_capsules(std::span<const LinkCapsule> capsules,
                                       int num_links) noexcept;
[[nodiscard]] ArmStatus check_pairs(std::span<const BodyPair> pairs, int num_links) noexcept;

// Contains every capsule, rounding included; no larger than the smallest such sphere by more than
// about a percent. Radius 0 at the origin for no capsules.
[[nodiscard]] Sphere3 enclosing_sphere(std::span<const Capsule3> capsules) noexcept;

template <int N>
[[nodiscard]] ArmStatus check_description(const ArmDescription<N>& description) noexcept {
  if (!description.X_WB.position.allFinite() || !description.X_WB.rotation.allFinite()) {
    return ArmStatus::kNotFinite;
  }
  if (!is_rotation(description.X_WB.rotation)) return ArmStatus::kBadRotation;
  for (const ArmJoint& joint : description.joints) {
    const ArmStatus status = check_joint(joint);
    if (status != ArmStatus::kOk) return status;
  }
  const ArmStatus status = check_capsules(description.capsules, N + 1);
  return status == ArmStatus::kOk ? check_pairs(description.pairs, N + 1) : status;
}

}  // namespace sopt
