#include "tools/io/capsule_wrap.h"

#include <cmath>
#include <numbers>

#include "tools/io/capsule_fit.h"
#include "tools/io/json_fields.h"

namespace sopt {

CapsuleApproximation wrap_points(const std::vector<Vec3>& points, double volume_m3) {
  CapsuleApproximation result;
  result.capsule = fit_capsule(points);
  if (volume_m3 > 0.0) result.volume_ratio = capsule_volume_m3(result.capsule) / volume_m3;
  return result;
}

CapsuleApproximation wrap_sphere(double radius_m) {
  CapsuleApproximation result;
  result.geometry = "sphere " + show(radius_m);
  result.capsule.radius_m = radius_m;
  result.volume_ratio = 1.0;
  return result;
}

CapsuleApproximation wrap_box(const Vec3& size_m) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) {
    const Vec3 sign((i & 1) != 0 ? 0.5 : -0.5, (i & 2) != 0 ? 0.5 : -0.5,
                    (i & 4) != 0 ? 0.5 : -0.5);
    corners.push_back(sign.cwiseProduct(size_m));
  }
  CapsuleApproximation result = wrap_points(corners, size_m.prod());
  result.geometry = "box " + show(size_m.x()) + " x " + show(size_m.y()) + " x " + show(size_m.z());
  return result;
}

// Polygons around the rims stand for the cylinder.
CapsuleApproximation wrap_cylinder(double radius_m, double length_m) {
  constexpr int kNumCorners = 64;
  const double step = 2.0 * std::numbers::pi / kNumCorners;
  const double corner_m = radius_m / std::cos(0.5 * step);
  std::vector<Vec3> points;
  for (int i = 0; i < kNumCorners; ++i) {
    for (const double z_m : {-0.5 * length_m, 0.5 * length_m}) {
      points.emplace_back(corner_m * std::cos(i * step), corner_m * std::sin(i * step), z_m);
    }
  }
  CapsuleApproximation result =
      wrap_points(points, std::numbers::pi * radius_m * radius_m * length_m);
  result.geometry = "cylinder " + show(radius_m) + " x " + show(length_m);
  return result;
}

}  // namespace sopt
