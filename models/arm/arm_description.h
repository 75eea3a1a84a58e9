// What an `Arm<N>` is made of, as presets and files give it: joints and capsules in the frames of
// the links, the pairs of bodies that may collide, and why a description is refused. Units m, rad,
// s; "unit" is rad for a joint that turns and m for one that slides.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "models/capacity.h"
#include "models/space/shape3.h"

namespace sopt {

// Joint weights compare metres with radians and long links with short ones. Far beyond this ratio
// the light joints' share of a length is lost in rounding.
inline constexpr double kMaxJointWeight = 1e3;

enum class JointKind : std::int8_t { kRevolute, kContinuous, kPrismatic };

struct ArmJoint {
  Pose3 origin;               // joint frame in the frame of the link before it, at q = 0
  Vec3 axis = Vec3::UnitZ();  // unit, in the joint frame
  JointKind kind = JointKind::kRevolute;
  double lower = 0.0;   // unit; -inf for continuous
  double upper = 0.0;   // unit; +inf for continuous
  double v_max = 0.0;   // unit/s, > 0
  double a_max = 0.0;   // unit/s^2, > 0
  double weight = 1.0;  // of the path metric, 1/kMaxJointWeight..kMaxJointWeight
};

// Part of a link. Capsules of one link that have different partners in self-collision belong to
// different bodies; usually a link is one body.
struct LinkCapsule {
  int i_link = 0;
  Vec3 p0 = Vec3::Zero();  // link frame
  Vec3 p1 = Vec3::Zero();
  double radius_m = 0.0;  // >= 0
  int i_body = 0;         // within the link, 0..kMaxBodies - 1
};

// Two bodies that may collide; of different links.
struct BodyPair {
  int i_link_a = 0;
  int i_link_b = 0;
  int i_body_a = 0;
  int i_body_b = 0;
};

template <int N>
struct ArmDescription {
  Pose3 X_WB;  // base in the world
  std::array<ArmJoint, N> joints;
  std::span<const LinkCapsule> capsules;  // any order
  std::span<const BodyPair> pairs;        // a body without capsules touches nothing
};

enum class ArmStatus : std::int8_t {
  kOk = 0,
  kNotReset = -1,         // default: nothing was done
  kNotFinite = -2,        // NaN or infinite, but for the limits of a continuous joint
  kBadRotation = -3,      // a pose's rotation is not orthonormal and right-handed within 1e-9
  kBadAxis = -4,          // not of length 1 within 1e-9
  kBadLimits = -5,        // lower > upper, or a continuous joint with limits
  kBadRate = -6,          // v_max or a_max <= 0
  kBadRadius = -7,        // < 0
  kBadLink = -8,          // no such link or body, or a pair within one link
  kTooManyCapsules = -9,  // kMaxLinkCapsules
  kTooManyBodies = -10,   // kMaxBodies
  kTooManyPairs = -11,    // kMaxBodyPairs
  kBadWeight = -12,       // outside 1/kMaxJointWeight..kMaxJointWeight
};

}  // namespace sopt
