// Rigid motions at setup: composition, the check of a rotation, and rotations from the angles robot
// files give.
#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "models/space/shape3.h"

namespace sopt {

// X_AC of X_AB and X_BC.
[[nodiscard]] inline Pose3 compose(const Pose3& a, const Pose3& b) SOPT_RT {
  return {a.rotation * b.rotation, a.rotation * b.position + a.position};
}

// Orthonormal within 1e-9 and right-handed; NaN is not.
[[nodiscard]] inline bool is_rotation(const Mat3& rotation) SOPT_RT {
  constexpr double kTolerance = 1e-9;
  const Mat3 defect = rotation.transpose() * rotation - Mat3::Identity();
  return defect.cwiseAbs().maxCoeff() <= kTolerance && rotation.determinant() > 0.0;
}

// R_z(yaw) R_y(pitch) R_x(roll) of (roll, pitch, yaw).
[[nodiscard]] inline Mat3 rotation_from_rpy(const Vec3& rpy_rad) SOPT_RT {
  const double cr = std::cos(rpy_rad.x());
  const double sr = std::sin(rpy_rad.x());
  const double cp = std::cos(rpy_rad.y());
  const double sp = std::sin(rpy_rad.y());
  const double cy = std::cos(rpy_rad.z());
  const double sy = std::sin(rpy_rad.z());
  Mat3 rotation;
  rotation << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
      sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,          //
      -sp, cp * sr, cp * cr;
  return rotation;
}

// The inverse, pitch in [-pi/2, pi/2]; roll is 0 where pitch leaves it free.
[[nodiscard]] inline Vec3 rpy_from_rotation(const Mat3& rotation) SOPT_RT {
  const double cos_pitch = std::hypot(rotation(0, 0), rotation(1, 0));
  const double pitch = std::atan2(-rotation(2, 0), cos_pitch);
  constexpr double kFree = 1e-9;
  if (cos_pitch < kFree) return {0.0, pitch, std::atan2(-rotation(0, 1), rotation(1, 1))};
  return {std::atan2(rotation(2, 1), rotation(2, 2)), pitch,
          std::atan2(rotation(1, 0), rotation(0, 0))};
}

[[nodiscard]] inline Mat3 rotation_about(const Vec3& unit_axis, double angle_rad) SOPT_RT {
  return Eigen::AngleAxisd(angle_rad, unit_axis).toRotationMatrix();
}

}  // namespace sopt
