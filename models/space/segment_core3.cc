#include "models/space/segment_core3.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "models/simd.h"
#include "models/space/local_segment3.h"

namespace sopt {
namespace {

double share_on(const Vec3& from, const Vec3& along, const Vec3& z) noexcept {
  const double length2 = along.squaredNorm();
  return length2 > 0.0 ? std::clamp((z - from).dot(along) / length2, 0.0, 1.0) : 0.0;
}

class SegmentPair {
 public:
  SegmentPair(const Capsule3& a, const Capsule3& b) noexcept
      : a_(a.p0), b_(b.p0), along_a_(a.p1 - a.p0), along_b_(b.p1 - b.p0) {
    const Vec3 cross = along_a_.cross(along_b_);
    const double cross2 = cross.squaredNorm();
    const Vec3 r = b_ - a_;
    if (cross2 > 0.0) {
      const double s = r.cross(along_b_).dot(cross) / cross2;
      const double t = r.cross(along_a_).dot(cross) / cross2;
      if (s >= 0.0 && s <= 1.0 && t >= 0.0 && t <= 1.0) try_shares(s, t);
    }
    for (const double end : {0.0, 1.0}) {
      try_shares(end, share_on(b_, along_b_, a_ + end * along_a_));
      try_shares(share_on(a_, along_a_, b_ + end * along_b_), end);
    }
  }

  double distance2 = std::numeric_limits<double>::infinity();
  Vec3 on_a = Vec3::Zero();
  Vec3 on_b = Vec3::Zero();

  // An axis that separates segments that touch.
  [[nodiscard]] Vec3 touching_normal() const noexcept {
    const Vec3 cross = along_a_.cross(along_b_);
    const double length2 = along_a_.squaredNorm() * along_b_.squaredNorm();
    Vec3 normal = cross;
    if (cross.squaredNorm() <= kParallel2 * length2) {
      const Vec3& along = along_a_.squaredNorm() > 0.0 ? along_a_ : along_b_;
      normal = along.squaredNorm() > 0.0 ? along.unitOrthogonal() : Vec3::UnitX();
    }
    const double towards = normal.dot(b_ + 0.5 * along_b_ - a_ - 0.5 * along_a_);
    return towards < 0.0 ? -normal.normalized() : normal.normalized();
  }

 private:
  void try_shares(double s, double t) noexcept {
    const Vec3 at_a = a_ + s * along_a_;
    const Vec3 at_b = b_ + t * along_b_;
    const double candidate = (at_b - at_a).squaredNorm();
    if (candidate >= distance2) return;
    distance2 = candidate;
    on_a = at_a;
    on_b = at_b;
  }

  Vec3 a_, b_, along_a_, along_b_;
};

// --- box

// Share t in [0, 1] where the segment is nearest to the box.
double nearest_share(const LocalSegment& s, const Vec3& h) noexcept {
  const auto inverse = [](double d) { return d != 0.0 ? 1.0 / d : 0.0; };
  const V4d inv{0.0, inverse(s.along.x()), inverse(s.along.y()), inverse(s.along.z())};
  const V4d p{0.0, s.p.x(), s.p.y(), s.p.z()};
  const V4d half{0.0, h.x(), h.y(), h.z()};
  const V4d zero = splat4(0.0);
  const V4d one = splat4(1.0);
  V4d knots[2] = {min4(max4((-half - p) * inv, zero), one),
                  min4(max4((half - p) * inv, zero), one)};
  knots[1][0] = 1.0;
  // lower: last knot where the distance still falls; upper: first where it rises.
  double lower = 0.0;
  double upper = 1.0;
  double slope_lower = 0.0;
  double slope_upper = 0.0;
  for (const V4d& t : knots) {
    V4d slope = zero;
    for (int axis = 0; axis < 3; ++axis) {
      const V4d x = s.p[axis] + t * s.along[axis];
      slope += s.along[axis] * (x - min4(max4(x, splat4(-h[axis])), splat4(h[axis])));
    }
    for (int lane = 0; lane < kLanesDouble; ++lane) {
      if (slope[lane] <= 0.0 && t[lane] >= lower) {
        lower = t[lane];
        slope_lower = slope[lane];
      }
      if (slope[lane] >= 0.0 && t[lane] <= upper) {
        upper = t[lane];
        slope_upper = slope[lane];
      }
    }
  }
  if (lower >= upper) return 0.5 * (lower + upper);
  const double rise = slope_upper - slope_lower;
  return rise > 0.0 ? lower - slope_lower / rise * (upper - lower) : 0.5 * (lower + upper);
}

CorePair closest_to_box(const LocalSegment& s, const Vec3& h) noexcept {
  const Vec3 z = s.at(nearest_share(s, h));
  return {z.cwiseMax(-h).cwiseMin(h), z};
}

SeparatingAxis3 widest_axis_of_box(const LocalSegment& s, const Vec3& h) noexcept {
  const Vec3 middle = s.middle();
  const Vec3 half = 0.5 * s.along;
  SeparatingAxis3 best;
  for (int i = 0; i < 3; ++i) {
    const double side = middle[i] < 0.0 ? -1.0 : 1.0;
    best.keep_wider(std::abs(middle[i]) - h[i] - std::abs(half[i]), side * Vec3::Unit(i), kTie_m);
  }
  for (int i = 0; i < 3; ++i) {
    const Vec3 cross = Vec3::Unit(i).cross(half);
    const double cross2 = cross.squaredNorm();
    if (cross2 <= kParallel2 * half.squaredNorm()) continue;
    const Vec3 unit = cross / std::sqrt(cross2);
    const double at = unit.dot(middle);
    const double separation = std::abs(at) - unit.cwiseAbs().dot(h) - std::abs(unit.dot(half));
    best.keep_wider(separation, at < 0.0 ? -unit : unit, kTie_m);
  }
  return best;
}

}  // namespace

CoreClearance3 segment_to_segment(const Convex3& obstacle, const Capsule3& body) SOPT_RT {
  const SegmentPair pair(to_capsule(obstacle), body);
  if (pair.distance2 > kTouching_m * kTouching_m) {
    const double distance_m = std::sqrt(pair.distance2);
    return {distance_m, (pair.on_b - pair.on_a) / distance_m, pair.on_a, pair.on_b};
  }
  const Vec3 normal = pair.touching_normal();
  const double separation_m = normal.dot(pair.on_b - pair.on_a);
  return {separation_m, normal, pair.on_b - separation_m * normal, pair.on_b};
}

CoreClearance3 segment_to_box(const Convex3& box, const Capsule3& body) SOPT_RT {
  const Vec3& h = box.half_m;
  return clearance_by(
      box, LocalSegment(box, body), [&h](const LocalSegment& s) { return closest_to_box(s, h); },
      [&h](const LocalSegment& s) { return widest_axis_of_box(s, h); });
}

}  // namespace sopt
