#include "models/arm/arm_cover.h"

#include <algorithm>
#include <cmath>

#include "models/simd.h"

namespace sopt {
namespace {

constexpr int kMaxPerCapsule = 12;
// Wanted excess of the spheres' radius: a share of the capsule's, and at most 8 mm.
constexpr double kExcessShare = 0.15;
constexpr double kMaxExcess_m = 0.008;

// Length of the capsule that `num` spheres of radius r + d contain.
double covered_length(int num, double r, double d) noexcept {
  return 2.0 * d + 2.0 * (num - 1) * std::sqrt(d * (2.0 * r + d));
}

// The d at which `num` spheres contain a capsule of this length: bisection from the side where they
// do.
double least_excess(int num, double r, double length_m) noexcept {
  double short_m = 0.0;
  double enough_m = 0.5 * length_m;
  for (int i = 0; i < 40; ++i) {
    const double middle_m = 0.5 * (short_m + enough_m);
    (covered_length(num, r, middle_m) < length_m ? short_m : enough_m) = middle_m;
  }
  return enough_m;
}

CoverCapsule to_floats(const Capsule3& c) noexcept {
  CoverCapsule cover;
  const Vec3 axis = c.p1 - c.p0;
  for (int i = 0; i < 3; ++i) {
    cover.p0[i] = static_cast<float>(c.p0[i]);
    cover.axis[i] = static_cast<float>(axis[i]);
  }
  const double length2 = axis.squaredNorm();
  cover.inverse_length2 = length2 > 0.0 ? static_cast<float>(1.0 / length2) : 0.0F;
  cover.radius_m = float_above(c.radius_m);
  return cover;
}

}  // namespace

CoverSphere to_cover(const Sphere3& sphere) noexcept {
  CoverSphere cover;
  double moved_m = 0.0;
  for (int i = 0; i < 3; ++i) {
    cover.center[i] = static_cast<float>(sphere.center[i]);
    moved_m += std::abs(static_cast<double>(cover.center[i]) - sphere.center[i]);
  }
  const double radius_m = (sphere.radius_m + moved_m) * (1.0 + 1e-12);
  cover.radius_m = float_above(radius_m);
  cover.inner_m = float_below((sphere.radius_m - moved_m) * (1.0 - 1e-12));
  return cover;
}

void ArmCover::build(std::span<const Capsule3> capsules) noexcept {
  const int share = kMaxCoverSpheres / std::max(1, static_cast<int>(capsules.size()));
  const int max_num = std::min(kMaxPerCapsule, share);
  int size = 0;
  for (std::size_t i = 0; i < capsules.size(); ++i) {
    const Capsule3& c = capsules[i];
    capsules_[i] = to_floats(c);
    const double length_m = (c.p1 - c.p0).norm();
    const double wanted_m = std::min(kMaxExcess_m, kExcessShare * c.radius_m);
    int num = 1;
    while (num < max_num && covered_length(num, c.radius_m, wanted_m) < length_m) ++num;
    const double excess_m = least_excess(num, c.radius_m, length_m);
    const double radius_m = c.radius_m + excess_m;
    for (int k = 0; k < num; ++k) {
      // One sphere sits in the middle, of more the outer ones excess_m from the ends.
      const double inset = length_m > 0.0 ? excess_m / length_m : 0.0;
      const double share_of_axis = num == 1 ? 0.5 : inset + k * (1.0 - 2.0 * inset) / (num - 1);
      const Vec3 center = c.p0 + share_of_axis * (c.p1 - c.p0);
      CoverSphere& sphere = spheres_[static_cast<std::size_t>(size++)];
      sphere = to_cover({center, radius_m});
      sphere.inner_m = to_cover({center, c.radius_m}).inner_m;
    }
    first_[i + 1] = static_cast<std::int16_t>(size);
  }
}

}  // namespace sopt
