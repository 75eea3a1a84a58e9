#include "tests/support/oracle2.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

namespace sopt::oracle {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kNumSamples = 64;  // along a segment, before refinement
constexpr int kNumDirections = 360;

[[nodiscard]] double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

[[nodiscard]] Vec2 along(const Vec2& p, const Vec2& q, double s) { return (1.0 - s) * p + s * q; }

[[nodiscard]] double point_segment_distance(const Vec2& z, const Vec2& a, const Vec2& b) {
  const double length2 = (b - a).squaredNorm();
  double s = length2 > 0.0 ? (z - a).dot(b - a) / length2 : 0.0;
  s = std::clamp(s, 0.0, 1.0);
  return (z - along(a, b, s)).norm();
}

// Crossing number: edges that a ray in +x meets.
[[nodiscard]] bool is_inside(const std::vector<Vec2>& vertices, const Vec2& z) {
  bool inside = false;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vec2& a = vertices[i];
    const Vec2& b = vertices[(i + 1) % vertices.size()];
    if ((a.y() > z.y()) == (b.y() > z.y())) continue;
    const double x = a.x() + (z.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
    if (z.x() < x) inside = !inside;
  }
  return inside;
}

// Minimum of a convex function on [low, high].
template <class F>
double golden_section(const F& f, double low, double high, double* at) {
  const double ratio = 0.5 * (std::sqrt(5.0) - 1.0);
  double a = high - ratio * (high - low);
  double b = low + ratio * (high - low);
  double value_a = f(a);
  double value_b = f(b);
  for (int i = 0; i < 80; ++i) {
    if (value_a < value_b) {
      high = b;
      b = a;
      value_b = value_a;
      a = high - ratio * (high - low);
      value_a = f(a);
    } else {
      low = a;
      a = b;
      value_a = value_b;
      b = low + ratio * (high - low);
      value_b = f(b);
    }
  }
  *at = value_a < value_b ? a : b;
  return std::min(value_a, value_b);
}

// How far the outline reaches beyond the segment's near side along unit n: the length of a
// translation along n that takes the segment out.
[[nodiscard]] double overlap_along(const Outline& outline, const Vec2& p, const Vec2& q,
                                   const Vec2& n) {
  double reach = -std::numeric_limits<double>::infinity();
  for (const Vec2& v : outline.vertices) reach = std::max(reach, n.dot(v));
  return reach + outline.radius_m - std::min(n.dot(p), n.dot(q));
}

// Distance between the circles around segment and outline: never more than the distance.
[[nodiscard]] double distance_bound(const Outline& outline, const Vec2& p, const Vec2& q) {
  const Vec2& center = outline.vertices[0];
  double reach = outline.radius_m;
  for (const Vec2& v : outline.vertices) reach = std::max(reach, (v - center).norm());
  return (0.5 * (p + q) - center).norm() - 0.5 * (q - p).norm() - reach;
}

[[nodiscard]] std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

}  // namespace

Outline outline_of(const Shape& shape) {
  Outline outline;
  if (const auto* disc = std::get_if<Disc>(&shape)) {
    outline.vertices = {disc->center};
    outline.radius_m = disc->radius_m;
  } else if (const auto* box = std::get_if<Box2>(&shape)) {
    const double c = std::cos(box->angle_rad);
    const double s = std::sin(box->angle_rad);
    for (const auto& [sx, sy] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
      const double x = sx * box->size_m.x();
      const double y = sy * box->size_m.y();
      outline.vertices.emplace_back(box->center.x() + c * x - s * y,
                                    box->center.y() + s * x + c * y);
    }
  } else {
    const auto& polygon = std::get<Polygon2>(shape);
    outline.vertices.assign(polygon.vertices.begin(),
                            polygon.vertices.begin() + polygon.num_vertices);
  }
  return outline;
}

double point_distance(const Outline& outline, const Vec2& z) {
  const auto& v = outline.vertices;
  if (v.size() == 1) return (z - v[0]).norm() - outline.radius_m;
  double distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < v.size(); ++i) {
    distance = std::min(distance, point_segment_distance(z, v[i], v[(i + 1) % v.size()]));
  }
  return (is_inside(v, z) ? -distance : distance) - outline.radius_m;
}

double min_point_distance(const Outline& outline, const Vec2& p, const Vec2& q, double* s_at) {
  const auto value = [&](double s) { return point_distance(outline, along(p, q, s)); };
  int i_best = 0;
  double best = value(0.0);
  for (int i = 1; i <= kNumSamples; ++i) {
    const double d = value(static_cast<double>(i) / kNumSamples);
    if (d < best) {
      best = d;
      i_best = i;
    }
  }
  double at = static_cast<double>(i_best) / kNumSamples;
  double refined_at = at;
  const double refined = golden_section(value, std::max(0.0, at - 1.0 / kNumSamples),
                                        std::min(1.0, at + 1.0 / kNumSamples), &refined_at);
  if (refined < best) {
    best = refined;
    at = refined_at;
  }
  if (s_at != nullptr) *s_at = at;
  return best;
}

double overlap_depth(const Outline& outline, const Vec2& p, const Vec2& q) {
  double depth = std::numeric_limits<double>::infinity();
  const auto try_direction = [&](const Vec2& d) {
    const double length = d.norm();
    if (length > 0.0) depth = std::min(depth, overlap_along(outline, p, q, d / length));
  };
  for (int i = 0; i < kNumDirections; ++i) {
    const double angle = 2.0 * kPi * i / kNumDirections;
    try_direction({std::cos(angle), std::sin(angle)});
  }
  std::vector<Vec2> sides = {q - p};
  for (const Vec2& a : outline.vertices) {
    for (const Vec2& b : outline.vertices) sides.push_back(b - a);
  }
  for (const Vec2& side : sides) {
    try_direction({side.y(), -side.x()});
    try_direction({-side.y(), side.x()});
  }
  return depth;
}

double segment_distance(const Outline& outline, const Vec2& p, const Vec2& q) {
  // Rounding with a disc shifts the signed distance of the core by the radius.
  const Outline core = {outline.vertices, 0.0};
  const double apart = min_point_distance(core, p, q);
  if (apart > 0.0) return apart - outline.radius_m;
  if (core.vertices.size() == 1) return -outline.radius_m;
  return -overlap_depth(core, p, q) - outline.radius_m;
}

double wall_distance(const Aabb2& bounds, const Vec2& z) {
  return std::min({z.x() - bounds.lower.x(), bounds.upper.x() - z.x(), z.y() - bounds.lower.y(),
                   bounds.upper.y() - z.y()});
}

double scene_distance(const Scene& scene, const Vec2& p, const Vec2& q, int* i_nearest) {
  double distance = std::min(wall_distance(scene.bounds, p), wall_distance(scene.bounds, q));
  int i_best = kBoundsObstacle;
  for (int i = 0; i < static_cast<int>(scene.obstacles.size()); ++i) {
    const Outline outline = outline_of(scene.obstacles[static_cast<std::size_t>(i)].shape);
    if (distance_bound(outline, p, q) >= distance) continue;
    const double d = min_point_distance(outline, p, q);
    if (d < distance) {
      distance = d;
      i_best = i;
    }
  }
  if (i_nearest != nullptr) *i_nearest = i_best;
  return distance;
}

Polygon2 random_polygon(Random& random, const Vec2& center, double size_m, double thinness) {
  Polygon2 polygon;
  polygon.num_vertices = 3 + random.index(kMaxPolygonVertices - 2);
  const double a = random.uniform(0.3, 1.0) * size_m;
  const double b = a * std::pow(thinness, random.uniform(0.0, 1.0));
  const double turn = random.uniform(0.0, 2.0 * kPi);
  // One vertex somewhere in each equal slice, off its borders: the outline turns left everywhere.
  const double slice = 2.0 * kPi / polygon.num_vertices;
  for (int i = 0; i < polygon.num_vertices; ++i) {
    const double angle = slice * (i + random.uniform(0.1, 0.9));
    const double x = a * std::cos(angle);
    const double y = b * std::sin(angle);
    polygon.vertices[static_cast<std::size_t>(i)] =
        center +
        Vec2(std::cos(turn) * x - std::sin(turn) * y, std::sin(turn) * x + std::cos(turn) * y);
  }
  return polygon;
}

Polygon2 random_grid_polygon(Random& random, int reach) {
  const auto less = [](const Vec2& a, const Vec2& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  };
  for (;;) {
    std::vector<Vec2> points;
    for (int i = 3 + random.index(14); i > 0; --i) {
      const int x = random.index(2 * reach + 1) - reach;
      points.emplace_back(x, random.index(2 * reach + 1) - reach);
    }
    std::sort(points.begin(), points.end(), less);
    points.erase(std::unique(points.begin(), points.end()), points.end());
    // Monotone chain: lower hull left to right, then upper hull back.
    std::vector<Vec2> hull;
    for (int pass = 0; pass < 2; ++pass) {
      const std::size_t base = hull.size();
      for (const Vec2& z : points) {
        while (hull.size() >= base + 2 &&
               cross(hull[hull.size() - 1] - hull[hull.size() - 2], z - hull.back()) <= 0.0) {
          hull.pop_back();
        }
        hull.push_back(z);
      }
      hull.pop_back();
      std::reverse(points.begin(), points.end());
    }
    if (hull.size() < 3 || hull.size() > kMaxPolygonVertices) continue;
    Polygon2 polygon;
    polygon.num_vertices = static_cast<int>(hull.size());
    std::copy(hull.begin(), hull.end(), polygon.vertices.begin());
    return polygon;
  }
}

Shape random_shape(Random& random, const Vec2& center, double size_m) {
  switch (random.index(3)) {
    case 0:
      return Disc{center, random.uniform(0.1, 1.0) * size_m};
    case 1: {
      const double width = random.uniform(0.1, 2.0) * size_m;
      const double height = random.uniform(0.1, 2.0) * size_m;
      return Box2{center, {width, height}, random.uniform(-kPi, kPi)};
    }
    default:
      return random_polygon(random, center, size_m, 0.05);
  }
}

Scene random_scene(Random& random, const Aabb2& bounds, int num_obstacles, double size_m) {
  Scene scene;
  scene.bounds = bounds;
  for (int i = 0; i < num_obstacles; ++i) {
    const Vec2 center = random.point(bounds);
    scene.obstacles.push_back({random_shape(random, center, size_m), kDefaultMargin});
  }
  return scene;
}

WorldStatus fill(const Scene& scene, World2& world) {
  WorldStatus status = world.reset(scene.bounds);
  for (const Obstacle& obstacle : scene.obstacles) {
    if (status != WorldStatus::kOk) return status;
    status = std::visit([&](const auto& shape) { return world.try_add(shape, obstacle.margin_m); },
                        obstacle.shape);
  }
  if (status == WorldStatus::kOk) world.build();
  return status;
}

std::string to_text(const Vec2& z) { return "[" + number(z.x()) + "," + number(z.y()) + "]"; }

std::string to_text(const Shape& shape) {
  if (const auto* disc = std::get_if<Disc>(&shape)) {
    return R"({"type":"disc","center":)" + to_text(disc->center) + R"(,"radius":)" +
           number(disc->radius_m) + "}";
  }
  if (const auto* box = std::get_if<Box2>(&shape)) {
    return R"({"type":"box","center":)" + to_text(box->center) + R"(,"size":)" +
           to_text(box->size_m) + R"(,"angle":)" + number(box->angle_rad) + "}";
  }
  const auto& polygon = std::get<Polygon2>(shape);
  std::string text = R"({"type":"polygon","vertices":[)";
  for (int i = 0; i < polygon.num_vertices; ++i) {
    text += (i > 0 ? "," : "") + to_text(polygon.vertices[static_cast<std::size_t>(i)]);
  }
  return text + "]}";
}

std::string to_text(const Scene& scene) {
  const Aabb2& bounds = scene.bounds;
  std::string text = R"("bounds":[)" + number(bounds.lower.x()) + "," + number(bounds.lower.y()) +
                     "," + number(bounds.upper.x()) + "," + number(bounds.upper.y()) +
                     R"(],"obstacles":[)";
  for (std::size_t i = 0; i < scene.obstacles.size(); ++i) {
    text += (i > 0 ? ",\n  " : "\n  ") + to_text(scene.obstacles[i].shape);
  }
  return text + "]";
}

}  // namespace sopt::oracle
