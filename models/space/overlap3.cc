#include "models/space/overlap3.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "models/space/gjk3.h"

namespace sopt {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSmallGain_m = 1e-9;  // of a step that is the last of a climb
constexpr double kClimbGap_m = 1e-2;   // between the shapes when pushed out

int num_faces(const Convex3& s) noexcept {
  if (s.kind == CoreKind::kHull) return s.hull->num_planes;
  if (s.kind == CoreKind::kBox) return 3;
  return s.kind == CoreKind::kCylinder ? 1 : 0;
}

Vec3 face(const Convex3& s, int i) noexcept {
  if (s.kind == CoreKind::kHull) return s.hull->normal[i];
  return s.axes.col(s.kind == CoreKind::kCylinder ? 2 : i);
}

// Directions of edges; a cylinder's and a segment's is the axis.
int num_edges(const Convex3& s) noexcept {
  if (s.kind == CoreKind::kHull) return s.hull->num_edges;
  if (s.kind == CoreKind::kBox) return 3;
  return s.kind == CoreKind::kPoint ? 0 : 1;
}

Vec3 edge(const Convex3& s, int i) noexcept {
  if (s.kind == CoreKind::kHull) return s.hull->edge[i];
  return s.axes.col(s.kind == CoreKind::kBox ? i : 2);
}

class AxisSearch {
 public:
  AxisSearch(const Convex3& a, const Convex3& b) noexcept
      : a_(a), b_(b), offset_(b.center - a.center) {}

  [[nodiscard]] SeparatingAxis3 run(const Vec3& guess) noexcept {
    for (int i = 0; i < num_faces(a_); ++i) try_axis(face(a_, i));
    for (int i = 0; i < num_faces(b_); ++i) try_axis(face(b_, i));
    for (int i = 0; i < num_edges(a_); ++i) {
      for (int j = 0; j < num_edges(b_); ++j) try_normalized(edge(a_, i).cross(edge(b_, j)));
    }
    if (a_.kind == CoreKind::kCylinder || b_.kind == CoreKind::kCylinder) {
      climb(best_.normal);
      climb(guess);
      if (offset_.squaredNorm() > 0.0) climb(offset_.normalized());
    }
    return best_;
  }

 private:
  // Both directions of a unit axis.
  void try_axis(const Vec3& unit) noexcept {
    const Interval at_a = core_interval(a_, unit);
    const Interval at_b = core_interval(b_, unit);
    const double at = unit.dot(offset_);
    const double ahead = at + at_b.lower - at_a.upper;
    const double behind = at_a.lower - at - at_b.upper;
    const double separation_m = ahead >= behind ? ahead : behind;
    best_.keep_wider(separation_m, ahead >= behind ? unit : -unit, kTie_m);
  }

  void try_normalized(const Vec3& direction) noexcept {
    const double length2 = direction.squaredNorm();
    if (length2 > kParallel2) try_axis(direction / std::sqrt(length2));
  }

  [[nodiscard]] double separation_along(const Vec3& unit) const noexcept {
    return unit.dot(offset_) + core_interval(b_, unit).lower - core_interval(a_, unit).upper;
  }

  void climb(Vec3 normal) noexcept {
    double separation_m = separation_along(normal);
    for (int i = 0; i < kMaxClimb; ++i) {
      Convex3 pushed = b_;
      pushed.center += (kClimbGap_m - separation_m) * normal;
      const GjkResult gjk = compute_core_distance(a_, pushed, kInfinity, normal);
      if (gjk.status == GjkStatus::kTouching) break;
      const double wider_m = separation_along(gjk.normal);
      if (wider_m <= separation_m + kSmallGain_m) break;
      separation_m = wider_m;
      normal = gjk.normal;
    }
    best_.keep_wider(separation_m, normal, kTie_m);
  }

  const Convex3& a_;
  const Convex3& b_;
  Vec3 offset_;
  SeparatingAxis3 best_;
};

}  // namespace

SeparatingAxis3 widest_axis(const Convex3& a, const Convex3& b, const Vec3& guess) SOPT_RT {
  if (a.kind == CoreKind::kBox && b.kind == CoreKind::kBox) {
    return widest_axis_of_boxes(a, b, kInfinity);
  }
  return AxisSearch(a, b).run(guess);
}

// In the frame of a: every axis is projected in full, so rounding in a cross of nearly parallel
// edges costs nothing.
SeparatingAxis3 widest_axis_of_boxes(const Convex3& a, const Convex3& b, double enough_m) SOPT_RT {
  const Mat3 turn = a.axes.transpose() * b.axes;  // b's axes in the frame of a
  const Mat3 size = turn.cwiseAbs();
  const Vec3 offset = a.axes.transpose() * (b.center - a.center);
  const Vec3 along_b = turn.transpose() * offset;
  SeparatingAxis3 best;  // normal in the frame of a
  const auto keep = [&best](double separation_m, double at, const Vec3& unit) {
    if (separation_m <= best.separation_m + kTie_m) return;
    best.separation_m = separation_m;
    best.normal = at < 0.0 ? -unit : unit;
  };
  const Vec3 from_a = offset.cwiseAbs() - a.half_m - size * b.half_m;
  const Vec3 from_b = along_b.cwiseAbs() - b.half_m - size.transpose() * a.half_m;
  for (int i = 0; i < 3; ++i) keep(from_a[i], offset[i], Vec3::Unit(i));
  for (int i = 0; i < 3; ++i) keep(from_b[i], along_b[i], turn.col(i));
  for (int i = 0; i < 3 && best.separation_m <= enough_m; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Vec3 cross = Vec3::Unit(i).cross(turn.col(j));
      const double length2 = cross.squaredNorm();
      if (length2 <= kParallel2) continue;
      const Vec3 unit = cross / std::sqrt(length2);
      const double at = unit.dot(offset);
      const double reach =
          unit.cwiseAbs().dot(a.half_m) + (turn.transpose() * unit).cwiseAbs().dot(b.half_m);
      keep(std::abs(at) - reach, at, unit);
    }
  }
  return {best.separation_m, a.axes * best.normal};
}

}  // namespace sopt
