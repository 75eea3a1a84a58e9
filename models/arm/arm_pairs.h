// Which links an arm checks against each other when nobody says: all pairs of links that are not
// neighbours in the chain and whose capsules are apart, none touching, at the home configuration
// (every joint at 0, or at the limit nearest to 0). Pairs that touch there by construction, such as
// an elbow whose capsules overlap across a short link, would reject everything.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "models/arm/arm.h"
#include "models/space/clearance3.h"

namespace sopt {

struct LinkPairList {
  std::array<BodyPair, kMaxBodyPairs> pairs{};
  int num_pairs = 0;

  [[nodiscard]] std::span<const BodyPair> view() const noexcept {
    return {pairs.data(), static_cast<std::size_t>(num_pairs)};
  }
};

template <int N>
[[nodiscard]] typename Arm<N>::Config home_configuration(const Arm<N>& arm) noexcept {
  return Arm<N>::Config::Zero().cwiseMax(arm.lower()).cwiseMin(arm.upper());
}

// Pairs of whole links, each of one body; at most 28 for 8 joints.
template <int N>
[[nodiscard]] LinkPairList find_pairs_apart(const Arm<N>& arm) noexcept {
  ArmPose<N> pose;
  arm.forward(home_configuration(arm), pose);
  LinkPairList list;
  for (int a = 0; a <= N; ++a) {
    for (int b = a + 2; b <= N; ++b) {
      double distance_m = std::numeric_limits<double>::infinity();
      for (int i = arm.first_capsule(a); i < arm.first_capsule(a + 1); ++i) {
        const Convex3 one = to_convex(arm.capsule_W(pose, i));
        for (int j = arm.first_capsule(b); j < arm.first_capsule(b + 1); ++j) {
          const Clearance3 found = compute_clearance(one, arm.capsule_W(pose, j));
          distance_m = std::min(distance_m, found.distance_m);
        }
      }
      const bool both = std::isfinite(distance_m);
      if (both && distance_m > 0.0) list.pairs[static_cast<std::size_t>(list.num_pairs++)] = {a, b};
    }
  }
  return list;
}

}  // namespace sopt
