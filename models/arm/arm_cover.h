// Spheres whose union contains the capsules of an arm, for checks of several configurations at a
// time. A capsule of radius r and length L gets k spheres of radius R = r + d on its axis: the
// outer ones d from its ends, where they contain the end's ball, neighbours at most 2 sqrt(R^2 -
// r^2) apart, where they meet on the capsule's surface. k is the least that makes d small, up to a
// bound. Floats; radii contain what the centers' rounding moves.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "models/capacity.h"
#include "models/space/shape3.h"
#include "rt/annotations.h"

namespace sopt {

struct CoverSphere {
  float center[3] = {};
  float radius_m = 0.0F;
  float inner_m = 0.0F;  // a ball of this radius around the center is inside what is covered
};

// The same capsule in floats, which are off by less than one rounding each.
struct CoverCapsule {
  float p0[3] = {};
  float axis[3] = {};            // p1 - p0
  float inverse_length2 = 0.0F;  // of the axis; 0: it has no length
  float radius_m = 0.0F;         // rounded up
};

// Contains `sphere`, and has its inner ball inside, in spite of rounding.
[[nodiscard]] CoverSphere to_cover(const Sphere3& sphere) noexcept;

class ArmCover {
 public:
  // At most kMaxLinkCapsules capsules.
  void build(std::span<const Capsule3> capsules) noexcept;

  [[nodiscard]] std::span<const CoverSphere> of(int i_capsule) const SOPT_RT {
    const auto i = static_cast<std::size_t>(i_capsule);
    const auto first = static_cast<std::size_t>(first_[i]);
    return {spheres_.data() + first, static_cast<std::size_t>(first_[i + 1]) - first};
  }

  [[nodiscard]] const CoverCapsule& capsule(int i_capsule) const SOPT_RT {
    return capsules_[static_cast<std::size_t>(i_capsule)];
  }

 private:
  std::array<CoverCapsule, kMaxLinkCapsules> capsules_{};
  std::array<CoverSphere, kMaxCoverSpheres> spheres_{};
  std::array<std::int16_t, kMaxLinkCapsules + 1> first_{};
};

}  // namespace sopt
