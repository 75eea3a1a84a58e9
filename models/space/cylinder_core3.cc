// segment_to_cylinder of segment_core3.h, in the cylinder's frame: axis z, r = h.x(), half height
// h.z().
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "models/space/local_segment3.h"

namespace sopt {
namespace {

constexpr int kMaxNewton = 64;
constexpr double kSmallStep = 1e-15;  // of the share t
constexpr int kMaxHalvings = 28;      // of a right angle: 6e-9 rad, an error of 1e-17 in the depth

double beyond(double x, double limit) noexcept { return x - std::clamp(x, -limit, limit); }

// Half the derivative of the squared distance at share t, and the derivative of that.
struct Slope {
  double value = 0.0;
  double rate = 0.0;
  bool is_curved = false;  // beside the mantle: not linear in t
};

class CylinderDistance {
 public:
  CylinderDistance(const LocalSegment& s, const Vec3& h) noexcept
      : s_(s), r_(h.x()), half_z_(h.z()), along2_(s.along.head<2>().squaredNorm()) {}

  [[nodiscard]] double nearest_share() noexcept {
    add_knots();
    for (int i = 0; i < num_knots_; ++i) {
      const double t = knots_[i];
      const double value = slope_at(t).value;
      if (value <= 0.0 && t >= lower_) {
        lower_ = t;
        slope_lower_ = value;
      }
      if (value >= 0.0 && t <= upper_) {
        upper_ = t;
        slope_upper_ = value;
      }
    }
    if (lower_ >= upper_ || !(slope_upper_ > slope_lower_)) return 0.5 * (lower_ + upper_);
    const double secant = lower_ - slope_lower_ / (slope_upper_ - slope_lower_) * (upper_ - lower_);
    return slope_at(0.5 * (lower_ + upper_)).is_curved ? newton(secant) : secant;
  }

 private:
  void add_knot(double t) noexcept {
    if (t > 0.0 && t < 1.0) knots_[num_knots_++] = t;
  }

  // Where the formula for the distance changes.
  void add_knots() noexcept {
    if (s_.along.z() != 0.0) {
      add_knot((-half_z_ - s_.p.z()) / s_.along.z());
      add_knot((half_z_ - s_.p.z()) / s_.along.z());
    }
    if (along2_ == 0.0) return;
    const double middle = -s_.p.head<2>().dot(s_.along.head<2>()) / along2_;
    add_knot(middle);
    const double inside2 = r_ * r_ - s_.at(middle).head<2>().squaredNorm();
    if (inside2 <= 0.0) return;
    const double reach = std::sqrt(inside2 / along2_);
    add_knot(middle - reach);
    add_knot(middle + reach);
  }

  [[nodiscard]] Slope slope_at(double t) const noexcept {
    const Vec3 z = s_.at(t);
    const double above = beyond(z.z(), half_z_);
    Slope slope;
    slope.value = above * s_.along.z();
    if (above != 0.0) slope.rate = s_.along.z() * s_.along.z();
    const double rho2 = z.head<2>().squaredNorm();
    if (rho2 > r_ * r_) {
      const double rho = std::sqrt(rho2);
      const double rho_rate = z.head<2>().dot(s_.along.head<2>()) / rho;
      slope.value += (rho - r_) * rho_rate;
      slope.rate += rho_rate * rho_rate + (rho - r_) * (along2_ - rho_rate * rho_rate) / rho;
      slope.is_curved = true;
    }
    return slope;
  }

  [[nodiscard]] double newton(double t) noexcept {
    for (int i = 0; i < kMaxNewton; ++i) {
      const Slope slope = slope_at(t);
      (slope.value < 0.0 ? lower_ : upper_) = t;
      double next = slope.rate > 0.0 ? t - slope.value / slope.rate : lower_;
      if (!(next > lower_ && next < upper_)) next = 0.5 * (lower_ + upper_);
      const double step = std::abs(next - t);
      t = next;
      if (step <= kSmallStep) break;
    }
    return t;
  }

  const LocalSegment& s_;
  double r_, half_z_;
  double along2_;  // squared length across the axis
  double knots_[7] = {0.0, 1.0};
  int num_knots_ = 2;
  double lower_ = 0.0;
  double upper_ = 1.0;
  double slope_lower_ = 0.0;
  double slope_upper_ = 0.0;
};

CorePair closest_to_cylinder(const LocalSegment& s, const Vec3& h) noexcept {
  const Vec3 z = s.at(CylinderDistance(s, h).nearest_share());
  const double rho = z.head<2>().norm();
  const double shrink = rho > h.x() ? h.x() / rho : 1.0;
  return {Vec3(shrink * z.x(), shrink * z.y(), std::clamp(z.z(), -h.z(), h.z())), z};
}

// Direction (cos t, sin t), t in [0, pi/2], to the point (r cos t, b sin t) of a quarter ellipse
// that is nearest to (x, y), x >= 0, r >= b. Half the derivative of the squared distance is
// sin t cos t q(t) with q = -(r^2 - b^2) + x r / cos t - y b / sin t: for y >= 0 q rises, for y < 0
// it is convex with its lowest point at tan^3 t = -y b / (x r), and the nearest point is at its
// second root or at t = 0.
Eigen::Vector2d nearest_on_quarter(double r, double b, double x, double y) noexcept {
  const auto rise = [&](const Eigen::Vector2d& at) {
    return -(r * r - b * b) * at.x() * at.y() + x * r * at.y() - y * b * at.x();
  };
  Eigen::Vector2d lower(1.0, 0.0);
  Eigen::Vector2d upper(0.0, 1.0);
  if (y < 0.0) {
    lower = Eigen::Vector2d(std::cbrt(x * r), std::cbrt(-y * b));
    if (lower.squaredNorm() == 0.0) lower.x() = 1.0;
    lower.normalize();
    if (rise(lower) > 0.0) return {1.0, 0.0};
  }
  for (int i = 0; i < kMaxHalvings; ++i) {
    const Eigen::Vector2d middle = (lower + upper).normalized();
    (rise(middle) < 0.0 ? lower : upper) = middle;
  }
  return (lower + upper).normalized();
}

class CylinderAxes {
 public:
  CylinderAxes(const LocalSegment& s, const Vec3& h) noexcept
      : middle_(s.middle()), half_(0.5 * s.along), h_(h) {}

  [[nodiscard]] SeparatingAxis3 widest() noexcept {
    try_normal(Vec3::UnitZ());
    try_mantle();
    try_rim();
    return best_;
  }

 private:
  // Valid for every unit direction; turned to the segment's side.
  void try_normal(const Vec3& unit) noexcept {
    const double at = unit.dot(middle_);
    const double reach =
        h_.x() * unit.head<2>().norm() + h_.z() * std::abs(unit.z()) + std::abs(unit.dot(half_));
    best_.keep_wider(std::abs(at) - reach, at < 0.0 ? -unit : unit, kTie_m);
  }

  // Seen along the axis: from the axis to the nearest point of the segment.
  void try_mantle() noexcept {
    const Eigen::Vector2d along = half_.head<2>();
    const Eigen::Vector2d middle = middle_.head<2>();
    const double along2 = along.squaredNorm();
    Eigen::Vector2d across = Eigen::Vector2d::UnitX();
    if (along2 > 0.0) {
      across = Eigen::Vector2d(-along.y(), along.x()).normalized();
      const double t = -middle.dot(along) / along2;
      const Eigen::Vector2d end = middle + std::copysign(1.0, t) * along;
      if (std::abs(t) > 1.0 && end.squaredNorm() > 0.0) across = end.normalized();
    } else if (middle.squaredNorm() > 0.0) {
      across = middle.normalized();
    }
    try_normal({across.x(), across.y(), 0.0});
  }

  // Seen along the segment: an ellipse with half axes r and r |cos|, stretched along the short one.
  void try_rim() noexcept {
    const double length = half_.norm();
    if (length == 0.0) return;
    const Vec3 along = half_ / length;
    const Vec3 cross = Vec3::UnitZ().cross(along);
    const double sine = cross.norm();
    if (sine <= 1e-10) return;
    const Vec3 u = cross / sine;
    const Vec3 v = along.cross(u);
    const double x = u.dot(middle_);
    const double y = v.dot(middle_);
    const double b = h_.x() * std::abs(along.z());
    const Eigen::Vector2d at =
        nearest_on_quarter(h_.x(), b, std::abs(x), std::abs(y) - h_.z() * sine);
    const Vec3 normal = std::copysign(b * at.x(), x) * u + std::copysign(h_.x() * at.y(), y) * v;
    if (normal.squaredNorm() > 0.0) try_normal(normal.normalized());
  }

  Vec3 middle_, half_;
  const Vec3& h_;
  SeparatingAxis3 best_;
};

}  // namespace

CoreClearance3 segment_to_cylinder(const Convex3& cylinder, const Capsule3& body) SOPT_RT {
  const Vec3& h = cylinder.half_m;
  return clearance_by(
      cylinder, LocalSegment(cylinder, body),
      [&h](const LocalSegment& s) { return closest_to_cylinder(s, h); },
      [&h](const LocalSegment& s) { return CylinderAxes(s, h).widest(); });
}

}  // namespace sopt
