#include "tests/support/convergence_oracle.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <variant>

#include "tests/support/test_problem.h"

namespace sopt::oracle {
namespace {

using Index = Eigen::Index;

Vec2 closest_on(const Vec2& a, const Vec2& b, const Vec2& z) {
  const double length2 = (b - a).squaredNorm();
  const double s = length2 > 0.0 ? (z - a).dot(b - a) / length2 : 0.0;
  return a + std::clamp(s, 0.0, 1.0) * (b - a);
}

// --- cones in the plane

struct ActiveRow {
  Vec2 normal = Vec2::UnitX();
  double slack_m = 0.0;
};

struct Split2 {
  Vec2 rest = Vec2::Zero();   // g minus its nearest point in the cone
  double weighted_slack = 0;  // sum of lambda_i slack_i
};

// Two generators are enough in the plane.
Split2 split_over_cone(const Vec2& g, const std::vector<ActiveRow>& rows) {
  Split2 best{g, 0.0};
  const auto consider = [&](const Vec2& rest, double weighted_slack) {
    if (rest.norm() < best.rest.norm()) best = {rest, weighted_slack};
  };
  for (const ActiveRow& a : rows) {
    const double share = std::max(0.0, a.normal.dot(g));
    consider(g - share * a.normal, share * a.slack_m);
    for (const ActiveRow& b : rows) {
      const double det = a.normal.x() * b.normal.y() - a.normal.y() * b.normal.x();
      if (std::abs(det) < 1e-6) continue;
      const double u = (g.x() * b.normal.y() - g.y() * b.normal.x()) / det;
      const double v = (a.normal.x() * g.y() - a.normal.y() * g.x()) / det;
      if (u < 0.0 || v < 0.0) continue;
      consider(g - u * a.normal - v * b.normal, u * a.slack_m + v * b.slack_m);
    }
  }
  return best;
}

// max over |v| = 1 of min n . v: the cosine of half the angle that the normals span.
double regularity_of(const std::vector<ActiveRow>& rows) {
  if (rows.empty()) return 1.0;
  constexpr double kTurn = 2.0 * std::numbers::pi;
  std::vector<double> angles;
  for (const ActiveRow& row : rows) {
    angles.push_back(std::atan2(row.normal.y(), row.normal.x()));
  }
  std::sort(angles.begin(), angles.end());
  double widest_gap = angles.front() + kTurn - angles.back();
  for (std::size_t i = 1; i < angles.size(); ++i) {
    widest_gap = std::max(widest_gap, angles[i] - angles[i - 1]);
  }
  return std::cos(0.5 * (kTurn - widest_gap));
}

// Rows of one edge that either end keeps with at most `active_m` to spare, given to both ends.
void add_edge_rows(const Scene& scene, double radius_m, const ClearanceRule& rule, const Vec2& p,
                   const Vec2& q, double active_m, std::vector<ActiveRow>& at_p,
                   std::vector<ActiveRow>& at_q) {
  const auto add = [&](const Vec2& n, double bound) {
    if (n.dot(p) - bound <= active_m) at_p.push_back({n, n.dot(p) - bound});
    if (n.dot(q) - bound <= active_m) at_q.push_back({n, n.dot(q) - bound});
  };
  const double wall_m = radius_m + rule.required_m(kDefaultMargin);
  for (const int axis : {0, 1}) {
    const Vec2 inwards = Vec2::Unit(axis);
    add(inwards, scene.bounds.lower[axis] + wall_m);
    add(-inwards, -scene.bounds.upper[axis] + wall_m);
  }
  for (const Obstacle& obstacle : scene.obstacles) {
    const double inset_m = radius_m + rule.required_m(obstacle.margin_m);
    const Plane plane = separating_plane(outline_of(obstacle.shape), p, q);
    if (plane.distance_m - inset_m <= active_m) add(plane.normal, plane.offset + inset_m);
  }
}

// sum of r . A^-1 r over both coordinates, A = tridiag(-1, 2, -1): Thomas' algorithm.
double inverse_energy(const std::vector<Vec2>& r) {
  std::vector<Vec2> y = r;
  std::vector<double> pivot(r.size(), 2.0);
  for (std::size_t i = 1; i < r.size(); ++i) {
    pivot[i] = 2.0 - 1.0 / pivot[i - 1];
    y[i] += y[i - 1] / pivot[i - 1];
  }
  double sum = 0.0;  // r' A^-1 r = |D^-1/2 L^-1 r|^2
  for (std::size_t i = 0; i < r.size(); ++i) sum += y[i].squaredNorm() / pivot[i];
  return sum;
}

// --- random references

// Least distance to `shape` above what the profile asks for, and the direction from it to there.
struct Nearest {
  double slack_m = std::numeric_limits<double>::infinity();
  Vec2 direction = Vec2::Zero();
};

Nearest nearest_to(const ClearReference& c, const Shape& shape) {
  const Outline outline = outline_of(shape);
  Nearest nearest;
  for (int t = 0; t < c.horizon(); ++t) {
    const auto i = static_cast<std::size_t>(t);
    if (point_distance({outline.vertices, 0.0}, c.states[i]) <= 0.0) return {-1.0, {}};
    const Plane plane = separating_plane(outline, c.states[i], c.states[i + 1]);
    const double wanted_m =
        c.robot.radius_m + c.profile.at_step(t, c.horizon()).required_m(kDefaultMargin);
    // Not apart: the closest features of an overlap do not separate.
    const double apart_m =
        std::min(plane.normal.dot(c.states[i]), plane.normal.dot(c.states[i + 1]));
    if (apart_m < plane.offset) return {-1.0, {}};
    if (plane.distance_m - wanted_m < nearest.slack_m) {
      nearest = {plane.distance_m - wanted_m, plane.normal};
    }
  }
  return nearest;
}

Shape moved(Shape shape, const Vec2& by) {
  if (auto* disc = std::get_if<Disc>(&shape)) disc->center += by;
  if (auto* box = std::get_if<Box2>(&shape)) box->center += by;
  if (auto* polygon = std::get_if<Polygon2>(&shape)) {
    for (int i = 0; i < polygon->num_vertices; ++i) {
      polygon->vertices[static_cast<std::size_t>(i)] += by;
    }
  }
  return shape;
}

// Obstacles that the reference clears; about half of them by next to nothing.
void add_obstacles(Random& random, ClearReference& c, int num_tries) {
  static constexpr double kGaps_m[] = {1e-12, 1e-9, 1e-6, 1e-3, 0.03};
  const double size_m = random.uniform(0.2, 1.5);
  for (int i = 0; i < num_tries; ++i) {
    Shape shape = random_shape(random, random.point(c.scene.bounds), size_m);
    Nearest nearest = nearest_to(c, shape);
    if (nearest.slack_m > 0.0 && random.chance(0.6)) {
      shape = moved(shape, (nearest.slack_m - kGaps_m[random.index(5)]) * nearest.direction);
      nearest = nearest_to(c, shape);
    }
    if (nearest.slack_m > 0.0) c.scene.obstacles.push_back({shape, kDefaultMargin});
  }
}

// --- interface maps

// W without its first and last index, every second one from w(first) on, with both ends.
std::vector<int> nodes_of(std::span<const int> splits, std::size_t first) {
  std::vector<int> nodes = {splits.front()};
  for (std::size_t i = first; i + 1 < splits.size(); i += 2) nodes.push_back(splits[i]);
  nodes.push_back(splits.back());
  return nodes;
}

// Linear interpolation between the inner nodes of `from` (0 at its ends) at those of `to`.
Eigen::MatrixXd interpolation(const std::vector<int>& from, const std::vector<int>& to) {
  const auto columns = static_cast<Index>(from.size()) - 2;
  Eigen::MatrixXd map = Eigen::MatrixXd::Zero(static_cast<Index>(to.size()) - 2, columns);
  for (Index i = 0; i < map.rows(); ++i) {
    const int t = to[static_cast<std::size_t>(i) + 1];
    const auto after = std::upper_bound(from.begin(), from.end(), t);
    const Index k = after - from.begin();  // t lies between nodes k - 1 and k
    const double share = static_cast<double>(t - *(after - 1)) / (*after - *(after - 1));
    if (k - 2 >= 0) map(i, k - 2) = 1.0 - share;
    if (k - 1 < columns) map(i, k - 1) = share;
  }
  return map;
}

}  // namespace

double energy_distance2(std::span<const Vec2> a, std::span<const Vec2> b) {
  double sum = 0.0;
  for (std::size_t t = 1; t < a.size(); ++t) {
    sum += ((a[t] - b[t]) - (a[t - 1] - b[t - 1])).squaredNorm();
  }
  return sum;
}

double line_cost(std::span<const Vec2> states, double ds_m) {
  return (states.back() - states.front()).squaredNorm() /
         (static_cast<double>(states.size() - 1) * ds_m);
}

double support_of(const Outline& outline, const Vec2& n) {
  double reach = -std::numeric_limits<double>::infinity();
  for (const Vec2& v : outline.vertices) reach = std::max(reach, n.dot(v));
  return reach + outline.radius_m * n.norm();
}

Plane separating_plane(const Outline& outline, const Vec2& p, const Vec2& q) {
  const auto& v = outline.vertices;
  Vec2 shortest = Vec2::Constant(std::numeric_limits<double>::infinity());
  const auto consider = [&](const Vec2& from, const Vec2& to) {
    if ((to - from).squaredNorm() < shortest.squaredNorm()) shortest = to - from;
  };
  for (std::size_t i = 0; i < v.size(); ++i) {
    consider(v[i], closest_on(p, q, v[i]));
    const Vec2& next = v[(i + 1) % v.size()];
    consider(closest_on(v[i], next, p), p);
    consider(closest_on(v[i], next, q), q);
  }
  Plane plane;
  plane.normal = shortest.normalized();
  plane.offset = support_of(outline, plane.normal);
  plane.distance_m = shortest.norm() - outline.radius_m;
  return plane;
}

Optimality optimality_of(const Scene& scene, std::span<const Vec2> states, double radius_m,
                         const MarginProfile& profile, double ds_m, double active_m) {
  const auto horizon = static_cast<int>(states.size()) - 1;
  std::vector<std::vector<ActiveRow>> rows(states.size());
  for (std::size_t t = 0; t + 1 < states.size(); ++t) {
    add_edge_rows(scene, radius_m, profile.at_step(static_cast<int>(t), horizon), states[t],
                  states[t + 1], active_m, rows[t], rows[t + 1]);
  }
  Optimality result;
  std::vector<Vec2> rest;
  double weighted_slack = 0.0;
  for (std::size_t t = 1; t + 1 < states.size(); ++t) {
    const Vec2 gradient = (2.0 / ds_m) * (2.0 * states[t] - states[t - 1] - states[t + 1]);
    const Split2 split = split_over_cone(gradient, rows[t]);
    rest.push_back(split.rest);
    weighted_slack += split.weighted_slack;
    result.regularity = std::min(result.regularity, regularity_of(rows[t]));
  }
  result.cost_gap = 0.25 * ds_m * inverse_energy(rest) + weighted_slack;
  return result;
}

Contraction contraction_of(std::span<const int> splits) {
  const std::vector<int> odd = nodes_of(splits, 2);
  const std::vector<int> even = nodes_of(splits, 1);
  Contraction result;
  result.map = interpolation(even, odd) * interpolation(odd, even);
  if (result.map.rows() == 0) return result;
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(result.map);
  Index i_slow = 0;
  result.factor = solver.eigenvalues().real().maxCoeff(&i_slow);
  result.slow_mode = solver.eigenvectors().col(i_slow).real();
  Index i_largest = 0;
  result.slow_mode.cwiseAbs().maxCoeff(&i_largest);
  result.slow_mode /= result.slow_mode[i_largest];
  return result;
}

std::vector<double> interpolate(std::span<const int> splits, const Eigen::VectorXd& values) {
  const std::vector<int> nodes = nodes_of(splits, 2);
  std::vector<double> result = {0.0};
  for (std::size_t k = 1; k < nodes.size(); ++k) {
    const double before = k > 1 ? values[static_cast<Index>(k) - 2] : 0.0;
    const double after = k + 1 < nodes.size() ? values[static_cast<Index>(k) - 1] : 0.0;
    const int n = nodes[k] - nodes[k - 1];
    for (int i = 1; i <= n; ++i) result.push_back(before + (after - before) * i / n);
  }
  return result;
}

ClearReference random_clear_reference(Random& random) {
  static constexpr double kExtent_m = 10.0;
  static constexpr double kRadii_m[] = {0.0, 0.05, 0.2};
  ClearReference c;
  c.scene.bounds = {Vec2::Zero(), Vec2::Constant(kExtent_m)};
  c.robot.radius_m = kRadii_m[random.index(3)];
  c.profile = plain_profile(random.chance(0.2) ? 1e-4 : random.uniform(1e-4, 0.3));
  if (random.chance(0.3)) {
    c.profile.num_start_steps = 1 + random.index(5);
    c.profile.start_cap_m = random.uniform(1e-4, 0.2);
    c.profile.num_goal_steps = 1 + random.index(5);
    c.profile.goal_cap_m = random.uniform(1e-4, 0.2);
  }
  const double wall_m = c.robot.radius_m + c.profile.rule.margin_m;
  const double inset_m = wall_m + (random.chance(0.3) ? 1e-12 : 0.3);
  const Aabb2 inner = {Vec2::Constant(inset_m), Vec2::Constant(kExtent_m - inset_m)};
  std::vector<Vec2> way = random_polyline(random, inner, 2 + random.index(4));
  if (random.chance(0.3)) way.back().x() = inner.upper.x();
  c.ds_m = random.uniform(0.2, 0.6);
  c.states = cut_into_steps(way, c.ds_m);
  if (random.chance(0.4)) {
    const double noise_m = random.uniform(0.0, 0.5) * c.ds_m;
    const Aabb2 noise = {Vec2::Constant(-noise_m), Vec2::Constant(noise_m)};
    for (Vec2& z : c.states) {
      z = (z + random.point(noise)).cwiseMax(inner.lower).cwiseMin(inner.upper);
    }
  }
  add_obstacles(random, c, random.index(30));
  return c;
}

std::string to_text(const ClearReference& c) {
  const MarginProfile& p = c.profile;
  char rest[300];
  std::snprintf(rest, sizeof rest,
                ",\"radius\":%.17g,\"margin\":%.17g,\"caps\":[%.17g,%d,%.17g,%d],\"ds\":%.17g}",
                c.robot.radius_m, p.rule.margin_m, p.start_cap_m, p.num_start_steps, p.goal_cap_m,
                p.num_goal_steps, c.ds_m);
  return "{" + oracle::to_text(c.scene) + ",\"states\":" + oracle::to_text(c.states) + rest;
}

}  // namespace sopt::oracle
