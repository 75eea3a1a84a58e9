// Convex shapes of space and the one form all of them are stored in: a core (point, segment, box,
// cylinder or hull) plus a ball of `radius_m`. A sphere is a point, a capsule a segment with a
// radius. A hull's planes and edges are found at setup by trying all triples of its <= 32 vertices:
// O(n^4), 0.2 ms at most. Positions relative to the shape's own center keep distances exact far
// from the origin. Units m, world frame unless a name says local.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "models/capacity.h"
#include "models/simd.h"
#include "models/world_status.h"
#include "rt/annotations.h"

namespace sopt {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

// Frame of a body in the world: z_W = rotation z_B + position.
struct Pose3 {
  Mat3 rotation = Mat3::Identity();
  Vec3 position = Vec3::Zero();
};

// rotation * p + position, in lanes: compilers do not inline Eigen's.
[[nodiscard, gnu::always_inline]] inline Vec3 transform(const Pose3& pose, const Vec3& p) SOPT_RT {
  const double* const r = pose.rotation.data();  // by columns
  const V4d turned = load3(r) * p.x() + (load3(r + 3) * p.y() + load3(r + 6) * p.z());
  Vec3 out;
  store3(turned + load3(pose.position.data()), out.data());
  return out;
}

struct Aabb3 {
  Vec3 lower = Vec3::Zero();
  Vec3 upper = Vec3::Zero();
};

struct Sphere3 {
  Vec3 center = Vec3::Zero();
  double radius_m = 0.0;  // > 0
};

struct Capsule3 {
  Vec3 p0 = Vec3::Zero();
  Vec3 p1 = Vec3::Zero();  // p0 == p1: a sphere
  double radius_m = 0.0;   // > 0 as an obstacle, >= 0 as a body
};

struct Box3 {
  Pose3 pose;                  // of the middle
  Vec3 size_m = Vec3::Zero();  // full extents, > 0
};

struct Cylinder3 {
  Pose3 pose;             // of the middle; the axis is local z
  double radius_m = 0.0;  // > 0
  double height_m = 0.0;  // > 0
};

struct Hull3 {
  std::span<const Vec3> vertices;  // kMinHullVertices..kMaxHullVertices, any order, with a volume
};

// Of a hull, relative to its center; arrays padded to whole SIMD lanes by repeating the last entry.
struct HullData {
  int num_vertices = 0;
  int num_padded = 0;  // multiple of kLanesDouble
  int num_planes = 0;
  int num_edges = 0;  // distinct directions only
  alignas(32) double x[kMaxHullVertices] = {};
  alignas(32) double y[kMaxHullVertices] = {};
  alignas(32) double z[kMaxHullVertices] = {};
  Vec3 normal[kMaxHullPlanes];         // outward, unit
  double offset[kMaxHullPlanes] = {};  // the hull lies in normal . z <= offset
  Vec3 edge[kMaxHullEdges];            // unit directions
};

enum class CoreKind : std::int8_t { kPoint, kSegment, kBox, kCylinder, kHull };

struct Convex3 {
  CoreKind kind = CoreKind::kPoint;
  double radius_m = 0.0;
  Vec3 center = Vec3::Zero();
  Mat3 axes = Mat3::Identity();    // columns: axes of box and cylinder; a segment's is column 2
  Vec3 half_m = Vec3::Zero();      // along the axes: box (x, y, z), cylinder (r, r, z), segment z
  const HullData* hull = nullptr;  // of a hull; borrowed

  [[nodiscard]] bool is_round() const SOPT_RT { return kind <= CoreKind::kSegment; }
};

// Checks a shape and stores it; on a status other than kOk `out` is not written. A hull's data goes
// to `storage`, to which `out` then points.
[[nodiscard]] WorldStatus try_make_convex(const Sphere3& sphere, Convex3& out) noexcept;
[[nodiscard]] WorldStatus try_make_convex(const Capsule3& capsule, Convex3& out) noexcept;
[[nodiscard]] WorldStatus try_make_convex(const Box3& box, Convex3& out) noexcept;
[[nodiscard]] WorldStatus try_make_convex(const Cylinder3& cylinder, Convex3& out) noexcept;
[[nodiscard]] WorldStatus try_make_convex(const Hull3& hull, HullData& storage,
                                          Convex3& out) noexcept;

// A capsule as a stored shape, unchecked.
[[nodiscard]] Convex3 to_convex(const Capsule3& capsule) SOPT_RT;

// The core's segment; both ends at the center for other kinds than kPoint and kSegment.
[[nodiscard]] inline Capsule3 to_capsule(const Convex3& shape) SOPT_RT {
  const Vec3 half = shape.half_m.z() * shape.axes.col(2);
  return {shape.center - half, shape.center + half, shape.radius_m};
}

// Farthest point of the core along `direction` (any length), relative to the center.
[[nodiscard]] Vec3 core_support(const Convex3& shape, const Vec3& direction) SOPT_RT;

// Extent of the core along `direction`, relative to the center.
struct Interval {
  double lower = 0.0;
  double upper = 0.0;
};
[[nodiscard]] Interval core_interval(const Convex3& shape, const Vec3& direction) SOPT_RT;

// Boxes around a shape, radius included.
[[nodiscard]] Aabb3 bounding_box(const Convex3& shape) SOPT_RT;
[[nodiscard]] inline Aabb3 bounding_box(const Capsule3& capsule) SOPT_RT {
  const Vec3 radius = Vec3::Constant(capsule.radius_m);
  return {capsule.p0.cwiseMin(capsule.p1) - radius, capsule.p0.cwiseMax(capsule.p1) + radius};
}
[[nodiscard]] inline Aabb3 grown(const Aabb3& box, double by_m) SOPT_RT {
  return {box.lower - Vec3::Constant(by_m), box.upper + Vec3::Constant(by_m)};
}

}  // namespace sopt
