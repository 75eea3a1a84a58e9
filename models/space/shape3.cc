#include "models/space/shape3.h"

#include <Eigen/Geometry>
#include <cmath>

#include "models/simd.h"
#include "models/space/hull3.h"
#include "models/space/pose3.h"

namespace sopt {
namespace {

// Orthonormal to rounding is what the closed forms need; what is nearly so is made so.
WorldStatus check_pose(const Pose3& pose, Mat3& axes) noexcept {
  if (!pose.rotation.allFinite() || !pose.position.allFinite()) return WorldStatus::kNotFinite;
  if (!is_rotation(pose.rotation)) return WorldStatus::kBadRotation;
  axes.col(2) = pose.rotation.col(2).normalized();
  axes.col(1) = axes.col(2).cross(pose.rotation.col(0)).normalized();
  axes.col(0) = axes.col(1).cross(axes.col(2));
  return WorldStatus::kOk;
}

V4d dots_of(const HullData& h, int i, const Vec3& d) noexcept {
  return load4(h.x + i) * d.x() + load4(h.y + i) * d.y() + load4(h.z + i) * d.z();
}

Vec3 hull_support(const HullData& h, const Vec3& d) noexcept {
  V4d best = dots_of(h, 0, d);
  V4d index{0.0, 1.0, 2.0, 3.0};
  V4d lanes = index;
  for (int i = kLanesDouble; i < h.num_padded; i += kLanesDouble) {
    lanes += 4.0;
    const V4d value = dots_of(h, i, d);
    index = value > best ? lanes : index;
    best = max4(value, best);
  }
  int i_lane = 0;
  for (int lane = 1; lane < kLanesDouble; ++lane) {
    if (best[lane] > best[i_lane]) i_lane = lane;
  }
  const auto i = static_cast<int>(index[i_lane]);
  return {h.x[i], h.y[i], h.z[i]};
}

// Unit radial direction of `direction` about the axis; any one when they are parallel.
Vec3 radial_offset(const Convex3& shape, const Vec3& direction) noexcept {
  const double x = shape.axes.col(0).dot(direction);
  const double y = shape.axes.col(1).dot(direction);
  const double length = std::sqrt(x * x + y * y);
  if (length == 0.0) return Vec3::Zero();
  return (shape.half_m.x() / length) * (x * shape.axes.col(0) + y * shape.axes.col(1));
}

// Half extent of a core that is symmetric about its center.
double half_extent(const Convex3& s, const Vec3& d) noexcept {
  const Vec3 local = s.axes.transpose() * d;
  if (s.kind == CoreKind::kBox) return local.cwiseAbs().dot(s.half_m);
  const double along = std::abs(local.z()) * s.half_m.z();
  return along + s.half_m.x() * std::sqrt(local.x() * local.x() + local.y() * local.y());
}

}  // namespace

WorldStatus try_make_convex(const Sphere3& sphere, Convex3& out) noexcept {
  return try_make_convex(Capsule3{sphere.center, sphere.center, sphere.radius_m}, out);
}

WorldStatus try_make_convex(const Capsule3& capsule, Convex3& out) noexcept {
  if (!capsule.p0.allFinite() || !capsule.p1.allFinite() || !std::isfinite(capsule.radius_m)) {
    return WorldStatus::kNotFinite;
  }
  if (capsule.radius_m <= 0.0) return WorldStatus::kBadSize;
  out = to_convex(capsule);
  return WorldStatus::kOk;
}

WorldStatus try_make_convex(const Box3& box, Convex3& out) noexcept {
  if (!box.size_m.allFinite()) return WorldStatus::kNotFinite;
  if (!(box.size_m.array() > 0.0).all()) return WorldStatus::kBadSize;
  Mat3 axes;
  const WorldStatus status = check_pose(box.pose, axes);
  if (status != WorldStatus::kOk) return status;
  out = {CoreKind::kBox, 0.0, box.pose.position, axes, 0.5 * box.size_m, nullptr};
  return WorldStatus::kOk;
}

WorldStatus try_make_convex(const Cylinder3& cylinder, Convex3& out) noexcept {
  const double radius_m = cylinder.radius_m;
  if (!std::isfinite(radius_m) || !std::isfinite(cylinder.height_m)) return WorldStatus::kNotFinite;
  if (radius_m <= 0.0 || cylinder.height_m <= 0.0) return WorldStatus::kBadSize;
  Mat3 axes;
  const WorldStatus status = check_pose(cylinder.pose, axes);
  if (status != WorldStatus::kOk) return status;
  const Vec3 half(radius_m, radius_m, 0.5 * cylinder.height_m);
  out = {CoreKind::kCylinder, 0.0, cylinder.pose.position, axes, half, nullptr};
  return WorldStatus::kOk;
}

WorldStatus try_make_convex(const Hull3& hull, HullData& storage, Convex3& out) noexcept {
  Vec3 center;
  const WorldStatus status = build_hull(hull, storage, center);
  if (status != WorldStatus::kOk) return status;
  out = {CoreKind::kHull, 0.0, center, Mat3::Identity(), Vec3::Zero(), &storage};
  return WorldStatus::kOk;
}

Convex3 to_convex(const Capsule3& capsule) SOPT_RT {
  Convex3 shape;
  shape.radius_m = capsule.radius_m;
  shape.center = 0.5 * (capsule.p0 + capsule.p1);
  const Vec3 along = capsule.p1 - capsule.p0;
  const double length = along.norm();
  if (length > 0.0) {
    shape.kind = CoreKind::kSegment;
    shape.axes.col(2) = along / length;
    shape.half_m.z() = 0.5 * length;
  }
  return shape;
}

Vec3 core_support(const Convex3& s, const Vec3& direction) SOPT_RT {
  switch (s.kind) {
    case CoreKind::kPoint:
      return Vec3::Zero();
    case CoreKind::kSegment:
      return std::copysign(s.half_m.z(), s.axes.col(2).dot(direction)) * s.axes.col(2);
    case CoreKind::kBox: {
      const Vec3 local = s.axes.transpose() * direction;
      return std::copysign(s.half_m.x(), local.x()) * s.axes.col(0) +
             std::copysign(s.half_m.y(), local.y()) * s.axes.col(1) +
             std::copysign(s.half_m.z(), local.z()) * s.axes.col(2);
    }
    case CoreKind::kCylinder:
      return radial_offset(s, direction) +
             std::copysign(s.half_m.z(), s.axes.col(2).dot(direction)) * s.axes.col(2);
    case CoreKind::kHull:
      return hull_support(*s.hull, direction);
  }
  return Vec3::Zero();
}

Interval core_interval(const Convex3& s, const Vec3& direction) SOPT_RT {
  if (s.kind == CoreKind::kPoint) return {};
  if (s.kind == CoreKind::kSegment) {
    const double half = std::abs(s.axes.col(2).dot(direction)) * s.half_m.z();
    return {-half, half};
  }
  if (s.kind != CoreKind::kHull) {
    const double half = half_extent(s, direction);
    return {-half, half};
  }
  V4d lower = dots_of(*s.hull, 0, direction);
  V4d upper = lower;
  for (int i = kLanesDouble; i < s.hull->num_padded; i += kLanesDouble) {
    const V4d value = dots_of(*s.hull, i, direction);
    lower = min4(lower, value);
    upper = max4(upper, value);
  }
  return {min_lane4(lower), max_lane4(upper)};
}

Aabb3 bounding_box(const Convex3& shape) SOPT_RT {
  Aabb3 box{shape.center, shape.center};
  for (int axis = 0; axis < 3; ++axis) {
    const Interval range = core_interval(shape, Vec3::Unit(axis));
    box.lower[axis] += range.lower - shape.radius_m;
    box.upper[axis] += range.upper + shape.radius_m;
  }
  return box;
}

}  // namespace sopt
