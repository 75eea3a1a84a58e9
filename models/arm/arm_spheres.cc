#include "models/arm/arm_spheres.h"

#include <cmath>
#include <limits>

#include "models/arm/arm.h"

namespace sopt {
namespace {

// Of the 1-norm of a center in its joint frame: to_world rounds the frame, three products and
// three sums, 9 times 2^-24 in each component.
constexpr double kTurnPad = 0x1p-19;

void put(SphereBatch& batch, const Capsule3& c) noexcept {
  const int lane = batch.num++;
  const Vec3 center = 0.5 * (c.p0 + c.p1);
  batch.x[lane] = static_cast<float>(center.x());
  batch.y[lane] = static_cast<float>(center.y());
  batch.z[lane] = static_cast<float>(center.z());
  const double radius_m = 0.5 * (c.p1 - c.p0).norm() + c.radius_m;
  batch.radius_m[lane] = float_above(radius_m * (1.0 + 1e-12) + kTurnPad * center.lpNorm<1>());
}

}  // namespace

void ArmSpheres::build(std::span<const Capsule3> capsules,
                       std::span<const ArmBody> bodies) noexcept {
  first_of_link_.fill(0);
  std::uint8_t num = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    for (int i = bodies[b].first; i < bodies[b].last; ++i) {
      if ((i - bodies[b].first) % kLanesFloat == 0) {
        batches_[num] = {};
        batches_[num].first = i;
        batches_[num++].radius_m = splat8(-std::numeric_limits<float>::infinity());
      }
      put(batches_[num - 1U], capsules[static_cast<std::size_t>(i)]);
    }
    first_of_body_[b + 1] = num;
    for (auto l = static_cast<std::size_t>(bodies[b].i_link) + 1; l < first_of_link_.size(); ++l) {
      first_of_link_[l] = num;
    }
  }
}

}  // namespace sopt
