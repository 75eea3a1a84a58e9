// What pictures show of an arm at one configuration: its capsules, and the tool: the point of the
// last link that is farthest out along the line from the link's joint to the middle of its
// capsules, the joint itself when the link has none. World frame, m.
#pragma once

#include <algorithm>
#include <vector>

#include "models/arm/arm.h"
#include "models/space/pose3.h"

namespace sopt {

struct PlacedCapsule {
  int i_link = 0;
  Capsule3 capsule;
};

template <int N>
[[nodiscard]] std::vector<PlacedCapsule> place_capsules(const Arm<N>& arm,
                                                        const typename Arm<N>::Config& q) {
  ArmPose<N> pose;
  arm.forward(q, pose);
  std::vector<PlacedCapsule> placed;
  for (int i = 0; i < arm.num_capsules(); ++i) {
    placed.push_back({arm.capsule_link(i), arm.capsule_W(pose, i)});
  }
  return placed;
}

template <int N>
[[nodiscard]] Vec3 tool_point(const Arm<N>& arm, const typename Arm<N>::Config& q) {
  ArmPose<N> pose;
  arm.forward(q, pose);
  Vec3 sum = Vec3::Zero();
  const int first = arm.first_capsule(N);
  const int last = arm.first_capsule(N + 1);
  for (int i = first; i < last; ++i) sum += arm.capsule_J(i).p0 + arm.capsule_J(i).p1;
  const Vec3 outward = sum.normalized();  // zero stays zero
  double reach_m = 0.0;
  for (int i = first; i < last; ++i) {
    const Capsule3& capsule = arm.capsule_J(i);
    reach_m = std::max({reach_m, outward.dot(capsule.p0), outward.dot(capsule.p1)});
  }
  return transform(pose.X_WJ[N], reach_m * outward);
}

}  // namespace sopt
