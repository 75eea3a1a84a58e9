// Bounding spheres of an arm's capsules, eight to a batch, for finding out which few of many
// capsules can be nearest to something. One configuration, spheres in the lanes; arm_lanes.h has it
// the other way round. A body's capsules begin a batch. Floats: radii contain what rounding moves
// the centers, in the joint frame and on the way to the world, but for the share that grows with
// the distance from the world's origin, which PaddedLanes adds.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "models/capacity.h"
#include "models/simd.h"
#include "models/space/shape3.h"
#include "models/space/sphere_lanes3.h"
#include "rt/annotations.h"

namespace sopt {

struct ArmBody;

struct SphereBatch {
  int first = 0;  // capsule of lane 0
  int num = 0;
  V8f x{}, y{}, z{};  // joint frame
  V8f radius_m{};     // -infinity in lanes from `num` on: these are near nothing
};

class ArmSpheres {
 public:
  // Bodies in order of links; at most kMaxLinkCapsules capsules.
  void build(std::span<const Capsule3> capsules, std::span<const ArmBody> bodies) noexcept;

  [[nodiscard]] std::span<const SphereBatch> of_link(int i_link) const SOPT_RT {
    return between(first_of_link_, i_link);
  }
  [[nodiscard]] std::span<const SphereBatch> of_body(int i_body) const SOPT_RT {
    return between(first_of_body_, i_body);
  }

 private:
  static constexpr std::size_t kMaxBatches = kMaxLinkCapsules / kLanesFloat + kMaxBodies;

  template <class Firsts>
  [[nodiscard]] std::span<const SphereBatch> between(const Firsts& firsts, int i) const SOPT_RT {
    const auto k = static_cast<std::size_t>(i);
    return std::span(batches_).subspan(firsts[k], std::size_t{firsts[k + 1]} - firsts[k]);
  }

  std::array<SphereBatch, kMaxBatches> batches_{};
  std::array<std::uint8_t, kMaxArmJoints + 2> first_of_link_{};
  std::array<std::uint8_t, kMaxBodies + 1> first_of_body_{};
};

// In the world, for a joint frame at X_WJ.
[[gnu::always_inline]] inline PaddedLanes to_world(const Pose3& X_WJ,
                                                   const SphereBatch& batch) noexcept {
  const auto row = [&](int i) __attribute__((always_inline)) {
    return batch.x * static_cast<float>(X_WJ.rotation(i, 0)) +
           batch.y * static_cast<float>(X_WJ.rotation(i, 1)) +
           batch.z * static_cast<float>(X_WJ.rotation(i, 2)) + static_cast<float>(X_WJ.position[i]);
  };
  return PaddedLanes({row(0), row(1), row(2), batch.radius_m});
}

}  // namespace sopt
