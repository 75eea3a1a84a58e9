#include "models/space/clearance3.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "models/space/gjk3.h"
#include "models/space/overlap3.h"
#include "models/space/segment_core3.h"

namespace sopt {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kFlat = 1e-7;       // cosine below which an edge counts as across the axis
constexpr double kMinCross2 = 1e-6;  // squared sine below which edges count as parallel

CoreClearance3 flipped(const CoreClearance3& c) noexcept {
  return {c.separation_m, -c.normal, c.on_body, c.on_obstacle};
}

// The corner, edge or face of a box that is farthest along a direction.
struct BoxFeature {
  Vec3 middle;
  Vec3 edge = Vec3::Zero();  // unit, of an edge
  int num_free = 0;          // 0: corner, 1: edge, 2: face

  BoxFeature(const Convex3& box, const Vec3& direction) noexcept : middle(box.center) {
    for (int i = 0; i < 3; ++i) {
      const double along = box.axes.col(i).dot(direction);
      if (std::abs(along) < kFlat) {
        edge = box.axes.col(i);
        ++num_free;
      } else {
        middle += std::copysign(box.half_m[i], along) * box.axes.col(i);
      }
    }
  }
};

// The point of a that lies deepest in b, which overlaps it along `axis`: under a corner of either
// box or where two edges cross. False when edges or faces are parallel.
bool try_read_off(const Convex3& a, const Convex3& b, const SeparatingAxis3& axis,
                  Vec3& on_a) noexcept {
  const BoxFeature of_a(a, axis.normal);
  const BoxFeature of_b(b, -axis.normal);
  if (of_a.num_free == 0) {
    on_a = of_a.middle;
    return true;
  }
  if (of_b.num_free == 0) {
    on_a = of_b.middle - axis.separation_m * axis.normal;
    return true;
  }
  if (of_a.num_free != 1 || of_b.num_free != 1) return false;
  const Vec3 cross = of_a.edge.cross(of_b.edge);
  const double cross2 = cross.squaredNorm();
  if (cross2 < kMinCross2) return false;
  const double share = (of_b.middle - of_a.middle).cross(of_b.edge).dot(cross) / cross2;
  on_a = of_a.middle + share * of_a.edge;
  return true;
}

// In general the shapes are pushed apart along the axis: the closest points are those that touch
// last.
CoreClearance3 from_axis(const Convex3& a, const Convex3& b, const SeparatingAxis3& axis) noexcept {
  const bool are_boxes = a.kind == CoreKind::kBox && b.kind == CoreKind::kBox;
  Vec3 on_a;
  if (are_boxes && try_read_off(a, b, axis, on_a)) {
    return {axis.separation_m, axis.normal, on_a, on_a + axis.separation_m * axis.normal};
  }
  Convex3 pushed = b;
  pushed.center += (kPush_m - axis.separation_m) * axis.normal;
  const GjkResult apart = compute_core_distance(a, pushed, kInfinity, axis.normal);
  return {axis.separation_m, axis.normal, apart.on_a, apart.on_a + axis.separation_m * axis.normal};
}

// Two cores of any kind; false, and `out` is not written, when they are proven farther apart than
// `limit_m`.
bool general_clearance(const Convex3& a, const Convex3& b, double limit_m,
                       CoreClearance3& out) noexcept {
  Vec3 first = Vec3::Zero();
  if (a.kind == CoreKind::kBox && b.kind == CoreKind::kBox) {
    const SeparatingAxis3 axis = widest_axis_of_boxes(a, b, kTouching_m);
    if (axis.separation_m > limit_m) return false;
    if (axis.separation_m <= 0.0) {
      out = from_axis(a, b, axis);
      return true;
    }
    first = axis.normal;
  }
  const GjkResult gjk = compute_core_distance(a, b, limit_m, first);
  if (gjk.status == GjkStatus::kBeyondLimit) return false;
  out = gjk.status == GjkStatus::kTouching
            ? from_axis(a, b, widest_axis(a, b, gjk.normal))
            : CoreClearance3{gjk.distance_m, gjk.normal, gjk.on_a, gjk.on_b};
  return true;
}

bool core_clearance(const Convex3& obstacle, const Capsule3& body, double limit_m,
                    CoreClearance3& out) noexcept {
  switch (obstacle.kind) {
    case CoreKind::kPoint:
    case CoreKind::kSegment:
      out = segment_to_segment(obstacle, body);
      return true;
    case CoreKind::kBox:
      out = segment_to_box(obstacle, body);
      return true;
    case CoreKind::kCylinder:
      out = segment_to_cylinder(obstacle, body);
      return true;
    case CoreKind::kHull:
      return general_clearance(obstacle, to_convex(body), limit_m, out);
  }
  return false;
}

bool core_clearance(const Convex3& obstacle, const Convex3& body, double limit_m,
                    CoreClearance3& out) noexcept {
  if (body.is_round()) return core_clearance(obstacle, to_capsule(body), limit_m, out);
  if (!obstacle.is_round()) return general_clearance(obstacle, body, limit_m, out);
  CoreClearance3 reversed;
  if (!core_clearance(body, to_capsule(obstacle), limit_m, reversed)) return false;
  out = flipped(reversed);
  return true;
}

template <class Body>
bool clearance_within(const Convex3& obstacle, const Body& body, double limit_m,
                      Clearance3& out) noexcept {
  const double radii_m = obstacle.radius_m + body.radius_m;
  CoreClearance3 core;
  if (!core_clearance(obstacle, body, limit_m + radii_m, core)) return false;
  const double distance_m = core.separation_m - radii_m;
  if (distance_m > limit_m) return false;
  out.distance_m = distance_m;
  out.normal = core.normal;
  out.on_obstacle = core.on_obstacle + obstacle.radius_m * core.normal;
  out.on_body = core.on_body - body.radius_m * core.normal;
  return true;
}

template <class Body>
Clearance3 clearance(const Convex3& obstacle, const Body& body) noexcept {
  Clearance3 result;
  const bool found = clearance_within(obstacle, body, kInfinity, result);
  if (!found) result.distance_m = kInfinity;  // only for coordinates that are not numbers
  return result;
}

// As is_within, without the depth when cores overlap.
bool is_closer_by_gjk(const Convex3& a, const Convex3& b, double radius_m) noexcept {
  const double limit_m = radius_m + a.radius_m + b.radius_m;
  const GjkResult gjk = compute_core_distance(a, b, limit_m, Vec3::Zero());
  if (gjk.status == GjkStatus::kBeyondLimit) return false;
  if (gjk.status != GjkStatus::kTouching) return gjk.distance_m < limit_m;
  return limit_m > kTouching_m || widest_axis(a, b, gjk.normal).separation_m < limit_m;
}

}  // namespace

Clearance3 compute_clearance(const Convex3& obstacle, const Capsule3& body) SOPT_RT {
  return clearance(obstacle, body);
}

Clearance3 compute_clearance(const Convex3& obstacle, const Convex3& body) SOPT_RT {
  return clearance(obstacle, body);
}

bool compute_clearance_within(const Convex3& obstacle, const Capsule3& body, double limit_m,
                              Clearance3& out) SOPT_RT {
  return clearance_within(obstacle, body, limit_m, out);
}

bool compute_clearance_within(const Convex3& obstacle, const Convex3& body, double limit_m,
                              Clearance3& out) SOPT_RT {
  return clearance_within(obstacle, body, limit_m, out);
}

bool is_within(const Convex3& obstacle, const Capsule3& body, double radius_m) SOPT_RT {
  if (obstacle.kind == CoreKind::kHull) {
    return is_closer_by_gjk(obstacle, to_convex(body), radius_m);
  }
  Clearance3 c;
  return clearance_within(obstacle, body, radius_m, c) && !(c.distance_m >= radius_m);
}

bool is_within(const Convex3& obstacle, const Convex3& body, double radius_m) SOPT_RT {
  if (body.is_round()) return is_within(obstacle, to_capsule(body), radius_m);
  if (obstacle.is_round()) return is_within(body, to_capsule(obstacle), radius_m);
  if (obstacle.kind != CoreKind::kBox || body.kind != CoreKind::kBox) {
    return is_closer_by_gjk(obstacle, body, radius_m);
  }
  Clearance3 c;
  return clearance_within(obstacle, body, radius_m, c) && !(c.distance_m >= radius_m);
}

}  // namespace sopt
