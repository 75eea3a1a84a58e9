#include "models/sphere_lanes3.h"

#include <cmath>
#include <limits>

namespace sopt {
namespace {

constexpr unsigned kAllLanes = 0xFF;

float rounded_up(double value) noexcept {
  const auto nearest = static_cast<float>(value);
  return static_cast<double>(nearest) < value
             ? std::nextafter(nearest, std::numeric_limits<float>::infinity())
             : nearest;
}

double min_of(const V8f& v) noexcept {
  float low = v[0];
  for (int i = 1; i < kLanesFloat; ++i) low = v[i] < low ? v[i] : low;
  return static_cast<double>(low);
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

struct LaneWorld3::Lanes {
  SphereLanes spheres;
  V8f padded_radius_m;  // with the sphere's share of the pad

  explicit Lanes(const SphereLanes& s) noexcept
      : spheres(s), padded_radius_m(s.radius_m + kPad * (abs8(s.x) + abs8(s.y) + abs8(s.z))) {}
};

LaneWorld3::LaneWorld3(Arena& arena, const World3Capacity& capacity) noexcept
    : obstacles_(arena, capacity.max_obstacles),
      planes_(arena, capacity.max_hulls * kMaxHullPlanes) {}

std::size_t LaneWorld3::required_bytes(const World3Capacity& capacity) noexcept {
  Arena arena = Arena::measuring();
  const LaneWorld3 world(arena, capacity);
  return arena.used_B();
}

void LaneWorld3::build(const World3& world) noexcept {
  obstacles_.clear();
  planes_.clear();
  world_ = &world;
  for (int i = 0; i < world.num_obstacles(); ++i) {
    const Convex3& shape = world.obstacle(i);
    Obstacle o;
    o.kind = shape.kind;
    for (int row = 0; row < 3; ++row) {
      o.center[row] = static_cast<float>(shape.center[row]);
      o.half[row] = static_cast<float>(shape.half_m[row]);
      for (int k = 0; k < 3; ++k) o.axis[row][k] = static_cast<float>(shape.axes(k, row));
    }
    o.own_margin_m = rounded_up(world.obstacle_margin_m(i));
    const Aabb3& box = world.obstacle_box(i);
    const double extent_m = shape.center.lpNorm<1>() + (box.upper - box.lower).lpNorm<1>();
    o.radius_m = rounded_up(shape.radius_m + static_cast<double>(kPad) * extent_m);
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
}

V8f LaneWorld3::distance2(const Obstacle& o, const V8f& x, const V8f& y,
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

V8f LaneWorld3::plane_distance(const Obstacle& o, const V8f& x, const V8f& y,
                               const V8f& z) const SOPT_RT {
  V8f best = splat8(-std::numeric_limits<float>::infinity());
  for (int i = 0; i < o.num_planes; ++i) {
    const Plane& plane = planes_[o.first_plane + i];
    best = max8(dot8(plane.normal, x, y, z) - plane.offset, best);
  }
  return best;
}

// Where squares overflow or are undefined, near.
unsigned LaneWorld3::lanes_near_one(const Obstacle& o, const Lanes& lanes,
                                    const ClearanceRule& rule) const SOPT_RT {
  const V8f x = lanes.spheres.x - o.center[0];
  const V8f y = lanes.spheres.y - o.center[1];
  const V8f z = lanes.spheres.z - o.center[2];
  const double required_m = rule.required_m(static_cast<double>(o.own_margin_m));
  // The rounding of required_m is covered by the pad, as it is nearly the distance or harmless.
  const V8f limit = lanes.padded_radius_m + (static_cast<float>(required_m) + o.radius_m);
  return ~lane_mask8(distance2(o, x, y, z) > limit * limit) & kAllLanes;
}

unsigned LaneWorld3::lanes_near(const SphereLanes& spheres,
                                const ClearanceRule& rule) const SOPT_RT {
  const Lanes lanes(spheres);
  const V8f infinity = splat8(std::numeric_limits<float>::infinity());
  if (lane_mask8(lanes.padded_radius_m < infinity) != kAllLanes) return kAllLanes;
  unsigned near = 0;
  if (obstacles_.size() <= kMaxScan) {
    for (const Obstacle& o : obstacles_) near |= lanes_near_one(o, lanes, rule);
    return near;
  }
  const double reach_m = world_->max_required_m(rule) - min_of(-lanes.padded_radius_m);
  const Vec3 lower(min_of(spheres.x), min_of(spheres.y), min_of(spheres.z));
  const Vec3 upper(-min_of(-spheres.x), -min_of(-spheres.y), -min_of(-spheres.z));
  const Aabb3 area{lower - Vec3::Constant(reach_m), upper + Vec3::Constant(reach_m)};
  (void)world_->for_each_near(area, [&](int i) {
    near |= lanes_near_one(obstacles_[i], lanes, rule);
    return near != kAllLanes;
  });
  return near;
}

}  // namespace sopt
