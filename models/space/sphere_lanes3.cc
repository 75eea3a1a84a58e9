#include "models/space/sphere_lanes3.h"

#include <limits>

namespace sopt {
namespace {

V8f dot8(const float* axis, const V8f& x, const V8f& y, const V8f& z) noexcept {
  return x * axis[0] + y * axis[1] + z * axis[2];
}

// Lanes where the distance is not above reach_m, or undefined.
unsigned lanes_within(const V8f& distance2, const V8f& reach_m) noexcept {
  return ~lane_mask8(distance2 > reach_m * reach_m) & kAllLanes;
}

// |v| beyond `limit`, at least 0.
V8f beyond8(const V8f& v, float limit) noexcept { return max8(abs8(v) - limit, splat8(0.0F)); }

V8f segment_distance2(const float* axis, float half, const V8f& x, const V8f& y,
                      const V8f& z) noexcept {
  const V8f along = min8(max8(dot8(axis, x, y, z), splat8(-half)), splat8(half));
  const V8f rx = x - along * axis[0];
  const V8f ry = y - along * axis[1];
  const V8f rz = z - along * axis[2];
  return rx * rx + ry * ry + rz * rz;
}

V8f box_distance2(const float (*axis)[3], const float* half, const V8f& x, const V8f& y,
                  const V8f& z) noexcept {
  const V8f ex = beyond8(dot8(axis[0], x, y, z), half[0]);
  const V8f ey = beyond8(dot8(axis[1], x, y, z), half[1]);
  const V8f ez = beyond8(dot8(axis[2], x, y, z), half[2]);
  return ex * ex + ey * ey + ez * ez;
}

V8f cylinder_distance2(const float (*axis)[3], const float* half, const V8f& x, const V8f& y,
                       const V8f& z) noexcept {
  const V8f u = dot8(axis[0], x, y, z);
  const V8f v = dot8(axis[1], x, y, z);
  const V8f across = max8(sqrt8(u * u + v * v) - half[0], splat8(0.0F));
  const V8f above = beyond8(dot8(axis[2], x, y, z), half[2]);
  return across * across + above * above;
}

}  // namespace

ObstacleLanes3::ObstacleLanes3(Arena& arena, int max_obstacles, int max_hulls) noexcept
    : obstacles_(arena, max_obstacles), planes_(arena, max_hulls * kMaxHullPlanes) {}

void ObstacleLanes3::clear() noexcept {
  obstacles_.clear();
  planes_.clear();
}

void ObstacleLanes3::add(const Convex3& shape, const Aabb3& box, double margin_m) noexcept {
  Obstacle o;
  o.kind = shape.kind;
  for (int row = 0; row < 3; ++row) {
    o.center[row] = static_cast<float>(shape.center[row]);
    o.half[row] = static_cast<float>(shape.half_m[row]);
    for (int k = 0; k < 3; ++k) o.axis[row][k] = static_cast<float>(shape.axes(k, row));
  }
  o.own_margin_m = float_above(margin_m);
  const double extent_m = shape.center.lpNorm<1>() + (box.upper - box.lower).lpNorm<1>();
  const double pad_m = static_cast<double>(PaddedLanes::kPad) * extent_m;
  o.radius_m = float_above(shape.radius_m + pad_m);
  o.pad_m = float_above(pad_m);
  o.first_plane = planes_.size();
  if (shape.kind == CoreKind::kHull) {
    const HullData& hull = *shape.hull;
    o.num_planes = hull.num_planes;
    for (int k = 0; k < hull.num_planes; ++k) {
      const Eigen::Vector3f normal = hull.normal[k].cast<float>();
      (void)planes_.try_push_back(
          {{normal.x(), normal.y(), normal.z()}, static_cast<float>(hull.offset[k])});
    }
  }
  (void)obstacles_.try_push_back(o);
}

V8f ObstacleLanes3::distance2(const Obstacle& o, const V8f& x_W, const V8f& y_W,
                              const V8f& z_W) const SOPT_RT {
  const V8f x = x_W - o.center[0];
  const V8f y = y_W - o.center[1];
  const V8f z = z_W - o.center[2];
  switch (o.kind) {
    case CoreKind::kPoint:
      return x * x + y * y + z * z;
    case CoreKind::kSegment:
      return segment_distance2(o.axis[2], o.half[2], x, y, z);
    case CoreKind::kBox:
      return box_distance2(o.axis, o.half, x, y, z);
    case CoreKind::kCylinder:
      return cylinder_distance2(o.axis, o.half, x, y, z);
    case CoreKind::kHull:
      break;
  }
  const V8f distance = max8(plane_distance(o, x, y, z), splat8(0.0F));
  return distance * distance;
}

V8f ObstacleLanes3::plane_distance(const Obstacle& o, const V8f& x, const V8f& y,
                                   const V8f& z) const SOPT_RT {
  V8f best = splat8(-std::numeric_limits<float>::infinity());
  for (int i = 0; i < o.num_planes; ++i) {
    const Plane& plane = planes_[o.first_plane + i];
    best = max8(dot8(plane.normal, x, y, z) - plane.offset, best);
  }
  return best;
}

// The rounding of what is required is covered by the pad, as that is nearly the distance or
// harmless.
unsigned ObstacleLanes3::lanes_near_one(const Obstacle& o, const PaddedLanes& lanes,
                                        const ClearanceRule& rule) const SOPT_RT {
  const SphereLanes& s = lanes.spheres;
  return lanes_within(distance2(o, s.x, s.y, s.z), lanes.padded_radius_m + o.reach_m(rule));
}

unsigned ObstacleLanes3::lanes_near(int i_obstacle, const PaddedLanes& lanes,
                                    const ClearanceRule& rule) const SOPT_RT {
  return lanes_near_one(obstacles_[i_obstacle], lanes, rule);
}

NestedNear ObstacleLanes3::lanes_near(int i_obstacle, const NestedLanes& lanes,
                                      const ClearanceRule& rule) const SOPT_RT {
  const Obstacle& o = obstacles_[i_obstacle];
  const V8f d2 = distance2(o, lanes.x, lanes.y, lanes.z);
  const float reach_m = o.reach_m(rule);
  NestedNear near{lanes_within(d2, lanes.wide_m + reach_m),
                  lanes_within(d2, lanes.radius_m + reach_m), 0U};
  if (o.kind == CoreKind::kHull) return near;  // d2 is a lower bound
  const V8f sure_m = lanes.inner_m + (reach_m - 2.0F * o.pad_m);
  near.inner = lane_mask8(sure_m > 0.0F) & lane_mask8(d2 < sure_m * sure_m);
  return near;
}

unsigned ObstacleLanes3::lanes_near(const PaddedLanes& lanes,
                                    const ClearanceRule& rule) const SOPT_RT {
  unsigned near = 0;
  for (const Obstacle& o : obstacles_) near |= lanes_near_one(o, lanes, rule);
  return near;
}

V8f ObstacleLanes3::distance_bounds(int i_obstacle, const PaddedLanes& lanes) const SOPT_RT {
  const Obstacle& o = obstacles_[i_obstacle];
  const SphereLanes& s = lanes.spheres;
  return sqrt8(distance2(o, s.x, s.y, s.z)) - (lanes.padded_radius_m + o.radius_m);
}

}  // namespace sopt
