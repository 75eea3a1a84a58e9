#include "models/sphere_lanes3.h"

#include <cmath>
#include <limits>

namespace sopt {
namespace {

float rounded_up(double value) noexcept {
  const auto nearest = static_cast<float>(value);
  return static_cast<double>(nearest) < value
             ? std::nextafter(nearest, std::numeric_limits<float>::infinity())
             : nearest;
}

V8f dot8(const float* axis, const V8f& x, const V8f& y, const V8f& z) noexcept {
  return x * axis[0] + y * axis[1] + z * axis[2];
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
  o.own_margin_m = rounded_up(margin_m);
  const double extent_m = shape.center.lpNorm<1>() + (box.upper - box.lower).lpNorm<1>();
  const double pad_m = static_cast<double>(PaddedLanes::kPad) * extent_m;
  o.radius_m = rounded_up(shape.radius_m + pad_m);
  o.pad_m = rounded_up(pad_m);
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

V8f ObstacleLanes3::distance2(const Obstacle& o, const V8f& x, const V8f& y,
                              const V8f& z) const SOPT_RT {
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

unsigned ObstacleLanes3::lanes_near_one(const Obstacle& o, const PaddedLanes& lanes,
                                        const ClearanceRule& rule) const SOPT_RT {
  const V8f x = lanes.spheres.x - o.center[0];
  const V8f y = lanes.spheres.y - o.center[1];
  const V8f z = lanes.spheres.z - o.center[2];
  const double required_m = rule.required_m(static_cast<double>(o.own_margin_m));
  // The rounding of required_m is covered by the pad, as it is nearly the distance or harmless.
  const V8f limit = lanes.padded_radius_m + (static_cast<float>(required_m) + o.radius_m);
  return ~lane_mask8(distance2(o, x, y, z) > limit * limit) & kAllLanes;
}

unsigned ObstacleLanes3::lanes_near(int i_obstacle, const PaddedLanes& lanes,
                                    const ClearanceRule& rule) const SOPT_RT {
  return lanes_near_one(obstacles_[i_obstacle], lanes, rule);
}

NestedNear ObstacleLanes3::lanes_near(int i_obstacle, const NestedLanes& lanes,
                                      const ClearanceRule& rule) const SOPT_RT {
  const Obstacle& o = obstacles_[i_obstacle];
  const V8f pad_m = PaddedLanes::kPad * (abs8(lanes.x) + abs8(lanes.y) + abs8(lanes.z));
  const V8f d2 = distance2(o, lanes.x - o.center[0], lanes.y - o.center[1], lanes.z - o.center[2]);
  const float required_m =
      static_cast<float>(rule.required_m(static_cast<double>(o.own_margin_m))) + o.radius_m;
  const auto may_be_within = [&](const V8f& reach_m) __attribute__((always_inline)) {
    return ~lane_mask8(d2 > reach_m * reach_m) & kAllLanes;
  };
  const V8f within_m = (lanes.inner_m + required_m - 2.0F * o.pad_m) - 2.0F * pad_m;
  // Of a hull d2 is a lower bound.
  const unsigned inner = o.kind == CoreKind::kHull
                             ? 0U
                             : lane_mask8(within_m > 0.0F) & lane_mask8(d2 < within_m * within_m);
  return {may_be_within(lanes.wide_m + pad_m + required_m),
          may_be_within(lanes.radius_m + pad_m + required_m), inner};
}

unsigned ObstacleLanes3::lanes_near(const PaddedLanes& lanes,
                                    const ClearanceRule& rule) const SOPT_RT {
  unsigned near = 0;
  for (const Obstacle& o : obstacles_) near |= lanes_near_one(o, lanes, rule);
  return near;
}

}  // namespace sopt
