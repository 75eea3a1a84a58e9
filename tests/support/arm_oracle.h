// Arms computed the long way, for tests only: frames by products of homogeneous matrices with
// general axis-angle rotations (Rodrigues), none of the library's folded frames; and random arms.
#pragma once

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "models/arm/arm.h"
#include "models/arm/arm_pairs.h"
#include "tests/support/oracle2.h"
#include "tests/support/oracle3.h"

namespace sopt::oracle {

using Mat4 = Eigen::Matrix4d;

[[nodiscard]] inline Mat4 to_matrix(const Pose3& pose) {
  Mat4 matrix = Mat4::Identity();
  matrix.topLeftCorner<3, 3>() = pose.rotation;
  matrix.topRightCorner<3, 1>() = pose.position;
  return matrix;
}

[[nodiscard]] inline Mat3 rotation_about(const Vec3& axis, double angle) {
  Mat3 cross;
  cross << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
  return Mat3::Identity() + std::sin(angle) * cross + (1.0 - std::cos(angle)) * cross * cross;
}

[[nodiscard]] inline Mat4 joint_motion(const ArmJoint& joint, double q) {
  if (joint.kind == JointKind::kPrismatic) return to_matrix({Mat3::Identity(), joint.axis * q});
  return to_matrix({rotation_about(joint.axis, q), Vec3::Zero()});
}

// Link frames in the world.
template <int N>
[[nodiscard]] std::vector<Mat4> link_frames(const ArmDescription<N>& description,
                                            const typename Arm<N>::Config& q) {
  std::vector<Mat4> frames = {to_matrix(description.X_WB)};
  for (int j = 0; j < N; ++j) {
    const ArmJoint& joint = description.joints[static_cast<std::size_t>(j)];
    frames.push_back(frames.back() * to_matrix(joint.origin) * joint_motion(joint, q[j]));
  }
  return frames;
}

[[nodiscard]] inline Vec3 transform(const Mat4& frame, const Vec3& p) {
  return (frame * p.homogeneous()).head<3>();
}

// Half of them along a coordinate axis.
[[nodiscard]] inline Vec3 random_axis(Random& random) {
  if (random.chance(0.5)) {
    return (random.chance(0.5) ? 1.0 : -1.0) * Vec3(Vec3::Unit(random.index(3)));
  }
  Vec3 axis = random_vector(random, 1.0);
  while (axis.norm() < 0.1) axis = random_vector(random, 1.0);
  return axis.normalized();
}

// Half of them by quarter turns.
[[nodiscard]] inline Pose3 random_pose(Random& random, double reach) {
  const double quarter = std::numbers::pi / 2.0;
  const double angle = random.chance(0.5) ? quarter * random.index(4) : random.uniform(-3.0, 3.0);
  return {rotation_about(random_axis(random), angle), random_vector(random, reach)};
}

template <int N>
struct RandomArm {
  ArmDescription<N> description;
  std::vector<LinkCapsule> capsules;
  Arm<N> arm;
};

// Half of the arms weigh all joints alike. Drawn apart from the rest, which stays as it is.
template <int N>
void draw_weights(ArmDescription<N>& description) {
  Random random(static_cast<std::uint64_t>(1e9 * description.joints[0].v_max));
  const bool alike = random.chance(0.5);
  for (ArmJoint& joint : description.joints) {
    joint.weight = alike ? 1.0 : std::exp2(random.uniform(-2.0, 2.0));
  }
}

// Length of a motion by dq in the path metric, joint by joint.
template <int N>
[[nodiscard]] double weighted_length(const Arm<N>& arm, const typename Arm<N>::Config& dq) {
  double sum = 0.0;
  for (int j = 0; j < N; ++j) sum += std::pow(arm.joint(j).weight * dq[j], 2);
  return std::sqrt(sum);
}

template <int N>
void draw_arm(Random& random, RandomArm<N>& out) {
  out.description.X_WB = random_pose(random, 1.0);
  for (ArmJoint& joint : out.description.joints) {
    joint.origin = random_pose(random, 0.5);
    joint.axis = random_axis(random);
    const int kind = random.index(4);
    joint.kind = kind == 0   ? JointKind::kPrismatic
                 : kind == 1 ? JointKind::kContinuous
                             : JointKind::kRevolute;
    const bool is_continuous = joint.kind == JointKind::kContinuous;
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    joint.lower = is_continuous ? -kInfinity : random.uniform(-3.0, 0.5);
    joint.upper = is_continuous ? kInfinity : joint.lower + random.uniform(0.1, 3.0);
    joint.v_max = random.uniform(0.1, 3.0);
    joint.a_max = random.uniform(0.1, 9.0);
  }
  draw_weights(out.description);
  out.capsules.clear();
  for (int i = 0; i < 3 * (N + 1); ++i) {
    LinkCapsule capsule{random.index(N + 1), random_vector(random, 0.3), random_vector(random, 0.3),
                        random.uniform(0.0, 0.2)};
    if (random.chance(0.3)) capsule.p1 = capsule.p0;
    out.capsules.push_back(capsule);
  }
  out.description.capsules = out.capsules;
}

// Links of one capsule, from joint to joint, that may collide when they are apart at home; joints
// of all kinds about any axis. About 1.5 m long. False when it is refused.
template <int N>
[[nodiscard]] bool draw_chain(Random& random, RandomArm<N>& out) {
  out.description = {};
  if (random.chance(0.5)) out.description.X_WB = random_pose(random, 1.0);
  out.capsules.clear();
  for (int i = 0; i <= N; ++i) {
    const Vec3 end = random.uniform(0.08, 2.0 / N) * Vec3::UnitZ();
    out.capsules.push_back({i, Vec3::Zero(), end, random.uniform(0.02, 0.05)});
    if (i == N) break;
    ArmJoint& joint = out.description.joints[static_cast<std::size_t>(i)];
    joint.origin = random_pose(random, 0.0);
    joint.origin.position = end;
    joint.axis = random_axis(random);
    const int kind = random.index(6);
    joint.kind = kind == 0   ? JointKind::kPrismatic
                 : kind == 1 ? JointKind::kContinuous
                             : JointKind::kRevolute;
    const double reach = kind == 0 ? 0.2 : 3.0;
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    joint.lower = kind == 1 ? -kInfinity : random.uniform(-reach, -0.3 * reach);
    joint.upper = kind == 1 ? kInfinity : random.uniform(0.3 * reach, reach);
    joint.v_max = random.uniform(0.3, 3.0);
    joint.a_max = random.uniform(1.0, 15.0);
  }
  draw_weights(out.description);
  out.description.capsules = out.capsules;
  if (out.arm.reset(out.description) != ArmStatus::kOk) return false;
  const LinkPairList pairs = find_pairs_apart(out.arm);
  out.description.pairs = pairs.view();
  const ArmStatus status = out.arm.reset(out.description);
  out.description.pairs = {};
  return status == ArmStatus::kOk;
}

template <int N>
[[nodiscard]] typename Arm<N>::Config random_configuration(Random& random, const Arm<N>& arm) {
  typename Arm<N>::Config q;
  for (int j = 0; j < N; ++j) {
    const bool is_free = arm.joint(j).kind == JointKind::kContinuous;
    q[j] = is_free ? random.uniform(-10.0, 10.0) : random.uniform(arm.lower()[j], arm.upper()[j]);
  }
  return q;
}

}  // namespace sopt::oracle
