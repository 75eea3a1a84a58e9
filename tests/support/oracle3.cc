#include "tests/support/oracle3.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>

namespace sopt::oracle {
namespace {

Vec3 local(const Pose3& pose, const Vec3& z) {
  return pose.rotation.transpose() * (z - pose.position);
}

double distance_to_segment(const Vec3& z, const Vec3& p, const Vec3& q) {
  const Vec3 d = q - p;
  const double t = d.squaredNorm() > 0.0 ? (z - p).dot(d) / d.squaredNorm() : 0.0;
  return (z - p - std::clamp(t, 0.0, 1.0) * d).norm();
}

double reach_along(const Solid& s, const Vec3& n) {
  if (s.kind == SolidKind::kCylinder) {
    const Vec3 axis = s.cylinder.pose.rotation.col(2);
    const double along = n.dot(axis);
    return n.dot(s.cylinder.pose.position) + 0.5 * s.cylinder.height_m * std::abs(along) +
           s.cylinder.radius_m * n.cross(axis).norm();
  }
  double reach = -1e300;
  for (const Vec3& v : s.points()) reach = std::max(reach, n.dot(v));
  return reach + s.radius_m();
}

// How far z is beyond any plane through three points that has all others on one side.
double beyond_hull(const std::vector<Vec3>& v, const Vec3& z) {
  double beyond = -1e300;
  for (std::size_t i = 0; i < v.size(); ++i) {
    for (std::size_t j = i + 1; j < v.size(); ++j) {
      for (std::size_t k = j + 1; k < v.size(); ++k) {
        const Vec3 cross = (v[j] - v[i]).cross(v[k] - v[i]);
        if (cross.norm() < 1e-9) continue;
        for (const double side : {1.0, -1.0}) {
          const Vec3 n = side * cross.normalized();
          double reach = -1e300;
          for (const Vec3& w : v) reach = std::max(reach, n.dot(w));
          if (reach - n.dot(v[i]) < 1e-10) beyond = std::max(beyond, n.dot(z) - reach);
        }
      }
    }
  }
  return std::max(beyond, 0.0);
}

// Differences of all pairs of points; normals of all triples.
struct Directions {
  std::vector<Vec3> pairs;
  std::vector<Vec3> normals;
};

void add_direction(std::vector<Vec3>& list, const Vec3& d) {
  if (d.norm() < 1e-9) return;
  const Vec3 unit = d.normalized();
  for (const Vec3& other : list) {
    if (other.cross(unit).norm() < 1e-14) return;
  }
  list.push_back(unit);
}

Directions directions_of(const Solid& s) {
  Directions all;
  if (s.kind == SolidKind::kCylinder) {
    all.normals.push_back(s.cylinder.pose.rotation.col(2));
    all.pairs.push_back(s.cylinder.pose.rotation.col(2));
  }
  const std::vector<Vec3> v = s.points();
  for (std::size_t i = 0; i < v.size(); ++i) {
    for (std::size_t j = i + 1; j < v.size(); ++j) {
      add_direction(all.pairs, v[j] - v[i]);
      for (std::size_t k = j + 1; k < v.size(); ++k) {
        add_direction(all.normals, (v[j] - v[i]).cross(v[k] - v[i]));
      }
    }
  }
  return all;
}

double both_ways(const Solid& a, const Solid& b, const Vec3& n) {
  return std::max(gap_along(a, b, n), gap_along(a, b, -n));
}

// Widest gap over the directions across `axis`: sampled, then every local best narrowed down.
double widest_across(const Solid& a, const Solid& b, const Vec3& axis) {
  constexpr int kNumSamples = 720;
  constexpr double kTurn = 6.283185307179586;
  const Vec3 u = axis.unitOrthogonal();
  const Vec3 w = axis.cross(u);
  const auto gap = [&](double i) {
    const double angle = kTurn * i / kNumSamples;
    return gap_along(a, b, std::cos(angle) * u + std::sin(angle) * w);
  };
  double best = -1e300;
  for (int i = 0; i < kNumSamples; ++i) {
    if (gap(i) < std::max(gap(i - 1), gap(i + 1))) continue;
    double low = i - 1;
    double high = i + 1;
    for (int step = 0; step < 60; ++step) {
      const double third = (high - low) / 3.0;
      const bool rises = gap(low + third) < gap(high - third);
      (rises ? low : high) = rises ? low + third : high - third;
    }
    best = std::max(best, gap(0.5 * (low + high)));
  }
  return best;
}

Mat3 grid_rotation(Random& random) {
  const Vec3 x = (random.chance(0.5) ? 1.0 : -1.0) * Vec3::Unit(random.index(3));
  Vec3 y = x;
  while (std::abs(y.dot(x)) > 0.5)
    y = (random.chance(0.5) ? 1.0 : -1.0) * Vec3::Unit(random.index(3));
  Mat3 r;
  r << x, y, x.cross(y);
  return r;
}

std::string to_text(const Vec3& v) {
  char text[96];
  std::snprintf(text, sizeof text, "(%.17g, %.17g, %.17g)", v.x(), v.y(), v.z());
  return text;
}

std::string to_text(const Pose3& pose) {
  return "at " + to_text(pose.position) + " axes " + to_text(Vec3(pose.rotation.col(0))) + " " +
         to_text(Vec3(pose.rotation.col(1)));
}

}  // namespace

std::vector<Vec3> Solid::points() const {
  switch (kind) {
    case SolidKind::kSphere:
      return {sphere.center};
    case SolidKind::kCapsule:
      return {capsule.p0, capsule.p1};
    case SolidKind::kHull:
      return hull;
    case SolidKind::kCylinder:
      return {};
    case SolidKind::kBox:
      break;
  }
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) {
    const Vec3 sign((i & 1) != 0 ? 0.5 : -0.5, (i & 2) != 0 ? 0.5 : -0.5,
                    (i & 4) != 0 ? 0.5 : -0.5);
    corners.push_back(box.pose.position + box.pose.rotation * sign.cwiseProduct(box.size_m));
  }
  return corners;
}

double Solid::radius_m() const {
  if (kind == SolidKind::kSphere) return sphere.radius_m;
  return kind == SolidKind::kCapsule ? capsule.radius_m : 0.0;
}

bool try_make(const Solid& solid, HullData& storage, Convex3& out) {
  switch (solid.kind) {
    case SolidKind::kSphere:
      return try_make_convex(solid.sphere, out) == WorldStatus::kOk;
    case SolidKind::kCapsule:
      return try_make_convex(solid.capsule, out) == WorldStatus::kOk;
    case SolidKind::kBox:
      return try_make_convex(solid.box, out) == WorldStatus::kOk;
    case SolidKind::kCylinder:
      return try_make_convex(solid.cylinder, out) == WorldStatus::kOk;
    case SolidKind::kHull:
      return try_make_convex(Hull3{solid.hull}, storage, out) == WorldStatus::kOk;
  }
  return false;
}

WorldStatus add_to(World3& world, const Solid& solid, double margin_m) {
  switch (solid.kind) {
    case SolidKind::kSphere:
      return world.try_add(solid.sphere, margin_m);
    case SolidKind::kCapsule:
      return world.try_add(solid.capsule, margin_m);
    case SolidKind::kBox:
      return world.try_add(solid.box, margin_m);
    case SolidKind::kCylinder:
      return world.try_add(solid.cylinder, margin_m);
    case SolidKind::kHull:
      return world.try_add(Hull3{solid.hull}, margin_m);
  }
  return WorldStatus::kNotReset;
}

double excess(const Solid& s, const Vec3& z) {
  if (s.is_round()) {
    const std::vector<Vec3> v = s.points();
    return std::max(0.0, distance_to_segment(z, v.front(), v.back()) - s.radius_m());
  }
  if (s.kind == SolidKind::kBox) {
    return (local(s.box.pose, z).cwiseAbs() - 0.5 * s.box.size_m).cwiseMax(0.0).norm();
  }
  if (s.kind == SolidKind::kHull) return beyond_hull(s.hull, z);
  const Vec3 at = local(s.cylinder.pose, z);
  const double across = std::max(0.0, std::hypot(at.x(), at.y()) - s.cylinder.radius_m);
  return std::hypot(across, std::max(0.0, std::abs(at.z()) - 0.5 * s.cylinder.height_m));
}

double gap_along(const Solid& a, const Solid& b, const Vec3& n) {
  return -reach_along(b, -n) - reach_along(a, n);
}

double widest_gap(const Solid& a, const Solid& b) {
  const bool has_cylinder = a.kind == SolidKind::kCylinder || b.kind == SolidKind::kCylinder;
  double best = both_ways(a, b, Vec3::UnitX());
  const Directions of_a = directions_of(a);
  const Directions of_b = directions_of(b);
  for (const Directions* own : {&of_a, &of_b}) {
    for (const Vec3& n : own->normals) best = std::max(best, both_ways(a, b, n));
    for (const Vec3& d : own->pairs) best = std::max(best, both_ways(a, b, d.unitOrthogonal()));
    for (const Vec3& d : own->pairs) {
      if (has_cylinder) best = std::max(best, widest_across(a, b, d));
    }
  }
  for (const Vec3& p : of_a.pairs) {
    for (const Vec3& q : of_b.pairs) {
      const Vec3 cross = p.cross(q);
      if (cross.norm() > 1e-10) best = std::max(best, both_ways(a, b, cross.normalized()));
    }
  }
  return best;
}

Solid moved(const Solid& solid, const Pose3& motion) {
  const auto move = [&](Vec3& z) { z = motion.rotation * z + motion.position; };
  Solid s = solid;
  move(s.sphere.center);
  move(s.capsule.p0);
  move(s.capsule.p1);
  for (Pose3* pose : {&s.box.pose, &s.cylinder.pose}) {
    move(pose->position);
    pose->rotation = (motion.rotation * pose->rotation).eval();
  }
  for (Vec3& v : s.hull) move(v);
  return s;
}

Mat3 random_rotation(Random& random) {
  Eigen::Vector4d q;
  do {
    for (int i = 0; i < 4; ++i) q[i] = random.uniform(-1.0, 1.0);
  } while (q.squaredNorm() > 1.0 || q.squaredNorm() < 0.01);
  return Eigen::Quaterniond(q.normalized()).toRotationMatrix();
}

Vec3 random_vector(Random& random, double reach) {
  Vec3 v;
  for (int i = 0; i < 3; ++i) v[i] = random.uniform(-reach, reach);
  return v;
}

Solid random_solid(Random& random, SolidKind kind, double reach_m, bool on_grid) {
  const auto place = [&] {
    const Vec3 z = random_vector(random, reach_m);
    return on_grid ? Vec3(z.array().round()) : z;
  };
  const auto size = [&] { return on_grid ? 1.0 + random.index(2) : random.uniform(0.05, 2.0); };
  Solid s;
  s.kind = kind;
  s.sphere = {place(), 0.5 * size()};
  s.capsule.p0 = place();
  const Vec3 along = random_vector(random, 1.5);
  s.capsule.p1 = s.capsule.p0 + (on_grid ? Vec3(along.array().round()) : along);
  s.capsule.radius_m = on_grid ? 0.5 : random.uniform(0.01, 0.5);
  const Mat3 rotation = on_grid ? grid_rotation(random) : random_rotation(random);
  s.box = {{rotation, place()}, {size(), size(), size()}};
  s.cylinder = {{rotation, place()}, 0.5 * size(), size()};
  const Vec3 middle = place();
  const int num_vertices = 5 + random.index(6);
  for (int i = 0; i < num_vertices; ++i) {
    const Vec3 v = random_vector(random, 1.0);
    s.hull.push_back(middle + (on_grid ? Vec3((1.5 * v).array().round()) : v));
  }
  return s;
}

std::string to_text(const Solid& s) {
  char text[64];
  switch (s.kind) {
    case SolidKind::kSphere:
    case SolidKind::kCapsule:
      std::snprintf(text, sizeof text, " radius %.17g", s.radius_m());
      return "capsule " + to_text(s.points().front()) + " to " + to_text(s.points().back()) + text;
    case SolidKind::kBox:
      return "box " + to_text(s.box.size_m) + " " + to_text(s.box.pose);
    case SolidKind::kCylinder:
      std::snprintf(text, sizeof text, "radius %.17g height %.17g ", s.cylinder.radius_m,
                    s.cylinder.height_m);
      return "cylinder " + std::string(text) + to_text(s.cylinder.pose);
    case SolidKind::kHull:
      break;
  }
  std::string list = "hull";
  for (const Vec3& v : s.hull) list += " " + to_text(v);
  return list;
}

}  // namespace sopt::oracle
