// A shape of a robot description and the capsule around it, in the shape's own frame.
#pragma once

#include <string>
#include <vector>

#include "models/space/shape3.h"

namespace sopt {

struct CapsuleApproximation {
  std::string link;
  std::string geometry;  // "box 0.1 x 0.2 x 0.3", "mesh arm.stl, 812 vertices"
  Capsule3 capsule;
  bool is_visual = false;
  double volume_ratio = 0.0;  // capsule over shape; 0 when the shape encloses no volume
};

// `volume_m3` is that of the shape the points stand for, 0 if it has none.
[[nodiscard]] CapsuleApproximation wrap_points(const std::vector<Vec3>& points, double volume_m3);
[[nodiscard]] CapsuleApproximation wrap_sphere(double radius_m);
[[nodiscard]] CapsuleApproximation wrap_box(const Vec3& size_m);
[[nodiscard]] CapsuleApproximation wrap_cylinder(double radius_m, double length_m);  // along z

}  // namespace sopt
