#include "opt/verify/separation3.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace sopt {
namespace {

constexpr double kOverlap_m = 1e-12;  // nearer to the origin than this there is no direction

double signed_half(double half, double along) noexcept { return along < 0.0 ? -half : half; }

Vec3 hull_farthest(const HullData& hull, const Vec3& d) noexcept {
  int i_best = 0;
  double best = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < hull.num_vertices; ++i) {
    const double value = d.x() * hull.x[i] + d.y() * hull.y[i] + d.z() * hull.z[i];
    if (value > best) {
      best = value;
      i_best = i;
    }
  }
  return {hull.x[i_best], hull.y[i_best], hull.z[i_best]};
}

// Farthest point of the obstacle's core along d, relative to its center.
Vec3 farthest(const Convex3& o, const Vec3& d) noexcept {
  switch (o.kind) {
    case CoreKind::kPoint:
      return Vec3::Zero();
    case CoreKind::kSegment:
      return signed_half(o.half_m.z(), o.axes.col(2).dot(d)) * o.axes.col(2);
    case CoreKind::kBox: {
      Vec3 point = Vec3::Zero();
      for (int i = 0; i < 3; ++i) {
        point += signed_half(o.half_m[i], o.axes.col(i).dot(d)) * o.axes.col(i);
      }
      return point;
    }
    case CoreKind::kCylinder: {
      const double x = o.axes.col(0).dot(d);
      const double y = o.axes.col(1).dot(d);
      const double length = std::sqrt(x * x + y * y);
      const double scale = length > 0.0 ? o.half_m.x() / length : 0.0;
      return scale * (x * o.axes.col(0) + y * o.axes.col(1)) +
             signed_half(o.half_m.z(), o.axes.col(2).dot(d)) * o.axes.col(2);
    }
    case CoreKind::kHull:
      return hull_farthest(*o.hull, d);
  }
  return Vec3::Zero();
}

// body - obstacle, as far as one can ask: its lowest point along a direction.
class Difference {
 public:
  Difference(const Convex3& obstacle, std::span<const Vec3> points) noexcept
      : obstacle_(obstacle), num_(std::min(points.size(), points_.size())) {
    for (std::size_t i = 0; i < num_; ++i) points_[i] = points[i] - obstacle.center;
  }

  [[nodiscard]] Vec3 lowest(const Vec3& d) const noexcept {
    std::size_t i_best = 0;
    double best = d.dot(points_[0]);
    for (std::size_t i = 1; i < num_; ++i) {
      const double value = d.dot(points_[i]);
      if (value < best) {
        best = value;
        i_best = i;
      }
    }
    return points_[i_best] - farthest(obstacle_, d);
  }

 private:
  const Convex3& obstacle_;
  std::size_t num_;
  std::array<Vec3, kMaxSeparationPoints> points_;
};

// At most four points and weights >= 0 that sum to 1: x is their mean.
class Corral {
 public:
  explicit Corral(const Vec3& point) noexcept : num_(1), x_(point) {
    points_[0] = point;
    weights_[0] = 1.0;
  }

  [[nodiscard]] const Vec3& x() const noexcept { return x_; }

  // Moves x to the point nearest to the origin of the hull of the corral and `point`, or, where
  // rounding does not allow that, of the segment from x to `point`.
  void add(const Vec3& point) noexcept {
    const Vec3 before = x_;
    bool is_done = false;
    if (num_ < 4) {
      points_[num_] = point;
      weights_[num_] = 0.0;
      ++num_;
      for (int i = 0; i < 4 && !is_done; ++i) {
        double affine[4];
        if (!find_affine(affine)) break;
        is_done = walk_to(affine);
      }
      update_x();
    }
    if (!is_done || !(x_.squaredNorm() < before.squaredNorm())) restart(before, point);
  }

 private:
  // Weights, of any sign, of the point of the affine hull nearest to the origin.
  [[nodiscard]] bool find_affine(double (&affine)[4]) const noexcept {
    const auto& s = points_;
    if (num_ == 1) {
      affine[0] = 1.0;
      return true;
    }
    const Vec3 a = s[1] - s[0];
    if (num_ == 2) {
      affine[1] = -s[0].dot(a) / a.squaredNorm();
      affine[0] = 1.0 - affine[1];
      return std::isfinite(affine[1]);
    }
    const Vec3 b = s[2] - s[0];
    const Vec3 normal = a.cross(b);
    if (num_ == 3) {
      const double area2 = normal.squaredNorm();
      if (!(area2 > 1e-24 * a.squaredNorm() * b.squaredNorm())) return false;
      affine[0] = s[1].cross(s[2]).dot(normal) / area2;
      affine[1] = s[2].cross(s[0]).dot(normal) / area2;
      affine[2] = 1.0 - affine[0] - affine[1];
      return true;
    }
    const Vec3 c = s[3] - s[0];
    const double volume = normal.dot(c);
    if (!(std::abs(volume) > 1e-14 * normal.norm() * c.norm())) return false;
    affine[1] = -s[0].dot(b.cross(c)) / volume;
    affine[2] = -s[0].dot(c.cross(a)) / volume;
    affine[3] = -s[0].dot(normal) / volume;
    affine[0] = 1.0 - affine[1] - affine[2] - affine[3];
    return true;
  }

  // Towards the affine weights as far as all stay >= 0; points that reach 0 go. True when it got
  // all the way.
  bool walk_to(const double (&affine)[4]) noexcept {
    double share = 1.0;
    std::size_t i_first = num_;
    for (std::size_t i = 0; i < num_; ++i) {
      if (affine[i] >= 0.0) continue;
      const double stop = weights_[i] / (weights_[i] - affine[i]);
      if (stop < share || i_first == num_) {
        share = std::min(share, stop);
        i_first = i;
      }
    }
    for (std::size_t i = 0; i < num_; ++i) {
      weights_[i] = std::max(0.0, weights_[i] + share * (affine[i] - weights_[i]));
    }
    if (i_first == num_) return true;
    weights_[i_first] = 0.0;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < num_; ++i) {
      if (weights_[i] <= 0.0) continue;
      points_[kept] = points_[i];
      weights_[kept++] = weights_[i];
    }
    num_ = kept;
    return false;
  }

  void update_x() noexcept {
    double sum = 0.0;
    x_.setZero();
    for (std::size_t i = 0; i < num_; ++i) {
      x_ += weights_[i] * points_[i];
      sum += weights_[i];
    }
    x_ /= sum;
  }

  void restart(const Vec3& before, const Vec3& point) noexcept {
    const Vec3 along = point - before;
    const double share = std::clamp(-before.dot(along) / along.squaredNorm(), 0.0, 1.0);
    points_[0] = std::isfinite(share) ? Vec3(before + share * along) : before;
    weights_[0] = 1.0;
    num_ = 1;
    x_ = points_[0];
  }

  std::size_t num_;
  Vec3 x_;
  std::array<Vec3, 4> points_;
  std::array<double, 4> weights_{};
};

}  // namespace

Separation3 separate(const Convex3& obstacle, std::span<const Vec3> points, const Vec3& first,
                     const SeparationGoal& goal) SOPT_RT {
  const Difference difference(obstacle, points);
  Separation3 result;
  const double length = first.norm();
  if (length > 0.0) result.direction = first / length;
  const Vec3 start = difference.lowest(result.direction);
  result.lower_m = result.direction.dot(start);
  result.upper_m = start.norm();
  if (result.lower_m >= goal.enough_m) return result;
  Corral corral(start);
  for (int step = 0; step < kMaxSeparationSteps; ++step) {
    const double distance_m = corral.x().norm();
    result.upper_m = std::min(result.upper_m, distance_m);
    if (distance_m < kOverlap_m) {
      result.upper_m = 0.0;
      break;
    }
    const Vec3 d = corral.x() / distance_m;
    const Vec3 point = difference.lowest(d);
    const double lower_m = d.dot(point);
    if (lower_m > result.lower_m) {
      result.lower_m = lower_m;
      result.direction = d;
    }
    if (result.lower_m >= goal.enough_m) break;
    if (goal.all_or_none && result.upper_m < goal.enough_m) break;
    if (result.upper_m - result.lower_m <= kSeparationTol_m) break;
    corral.add(point);
  }
  return result;
}

Aabb3 box_around(const Convex3& obstacle) SOPT_RT {
  Aabb3 box{obstacle.center, obstacle.center};
  for (int i = 0; i < 3; ++i) {
    box.lower[i] += farthest(obstacle, -Vec3::Unit(i))[i] - obstacle.radius_m;
    box.upper[i] += farthest(obstacle, Vec3::Unit(i))[i] + obstacle.radius_m;
  }
  return box;
}

}  // namespace sopt
