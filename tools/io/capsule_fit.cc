#include "tools/io/capsule_fit.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace sopt {
namespace {

// Points seen along a direction.
struct View {
  Mat3 axes;  // z: the direction
  std::vector<Vec3> points;

  View(std::span<const Vec3> all, const Vec3& direction) {
    axes = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), direction).toRotationMatrix();
    points.reserve(all.size());
    for (const Vec3& p : all) points.push_back(axes.transpose() * p);
  }
};

struct Circle {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  double radius_m = std::numeric_limits<double>::infinity();
};

Circle enclosing_circle(const std::vector<Vec3>& points) {
  constexpr int kNumSteps = 60;
  Eigen::Vector2d lower = points.front().head<2>();
  Eigen::Vector2d upper = lower;
  for (const Vec3& p : points) {
    lower = lower.cwiseMin(p.head<2>());
    upper = upper.cwiseMax(p.head<2>());
  }
  Eigen::Vector2d center = 0.5 * (lower + upper);
  Circle best;
  for (int k = 1; k <= kNumSteps; ++k) {
    double farthest2 = -1.0;
    Eigen::Vector2d farthest = center;
    for (const Vec3& p : points) {
      const double distance2 = (p.head<2>() - center).squaredNorm();
      if (distance2 > farthest2) {
        farthest2 = distance2;
        farthest = p.head<2>();
      }
    }
    if (std::sqrt(farthest2) < best.radius_m) best = {center, std::sqrt(farthest2)};
    center += (farthest - center) / (k + 1.0);
  }
  return best;
}

// Around the line through `circle`, with a radius not below the circle's. A ball at height t holds
// points at heights within sqrt(radius^2 - distance^2) of t.
Capsule3 close_ends(const View& view, const Circle& circle, double radius_m) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const Vec3& p : view.points) {
    const double distance2 = (p.head<2>() - circle.center).squaredNorm();
    const double reach_m = std::sqrt(std::max(0.0, radius_m * radius_m - distance2));
    low = std::min(low, p.z() + reach_m);
    high = std::max(high, p.z() - reach_m);
  }
  if (low > high) low = high = 0.5 * (low + high);  // one ball holds them all
  const Vec3 p0(circle.center.x(), circle.center.y(), low);
  const Vec3 p1(circle.center.x(), circle.center.y(), high);
  return {view.axes * p0, view.axes * p1, radius_m};
}

Capsule3 fit_along(std::span<const Vec3> points, const Vec3& direction) {
  const View view(points, direction);
  const Circle circle = enclosing_circle(view.points);
  Capsule3 best = close_ends(view, circle, circle.radius_m);
  for (const double factor : {1.01, 1.02, 1.05, 1.1, 1.2, 1.4, 1.7}) {
    const Capsule3 capsule = close_ends(view, circle, factor * circle.radius_m);
    if (capsule_volume_m3(capsule) < capsule_volume_m3(best)) best = capsule;
  }
  return best;
}

double distance_to_core(const Vec3& p, const Capsule3& capsule) {
  const Vec3 edge = capsule.p1 - capsule.p0;
  const double length2 = edge.squaredNorm();
  const double share =
      length2 > 0.0 ? std::clamp(edge.dot(p - capsule.p0) / length2, 0.0, 1.0) : 0.0;
  return (p - capsule.p0 - share * edge).norm();
}

}  // namespace

double capsule_volume_m3(const Capsule3& capsule) {
  const double r = capsule.radius_m;
  return std::numbers::pi * r * r * ((capsule.p1 - capsule.p0).norm() + 4.0 / 3.0 * r);
}

Capsule3 fit_capsule(std::span<const Vec3> points) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : points) mean += p / static_cast<double>(points.size());
  Mat3 spread = Mat3::Zero();
  for (const Vec3& p : points) spread += (p - mean) * (p - mean).transpose();
  Mat3 starts[2] = {Mat3::Identity(), Mat3::Identity()};
  starts[1] = Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvectors();

  Vec3 direction = Vec3::UnitZ();
  Capsule3 best = fit_along(points, direction);
  const auto improve = [&](const Vec3& along) {
    const Capsule3 capsule = fit_along(points, along);
    if (!(capsule_volume_m3(capsule) < capsule_volume_m3(best))) return false;
    best = capsule;
    direction = along;
    return true;
  };
  for (const Mat3& start : starts) {
    for (int i = 0; i < 3; ++i) (void)improve(start.col(i));
  }
  for (double step = 0.2; step > 0.003; step *= 0.5) {
    constexpr int kMaxMoves = 4;
    bool is_better = true;
    for (int i = 0; i < kMaxMoves && is_better; ++i) {
      const Vec3 u = direction.unitOrthogonal();
      const Vec3 v = direction.cross(u);
      is_better = false;
      for (const Vec3& aside : {u, Vec3(-u), v, Vec3(-v)}) {
        if (!is_better) is_better = improve((direction + step * aside).normalized());
      }
    }
  }
  for (const Vec3& p : points) best.radius_m = std::max(best.radius_m, distance_to_core(p, best));
  best.radius_m *= 1.0 + 1e-12;
  return best;
}

}  // namespace sopt
