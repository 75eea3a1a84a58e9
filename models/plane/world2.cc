#include "models/plane/world2.h"

#include <algorithm>
#include <cmath>

namespace sopt {
namespace {

// Relative to the polygon's extent: below it a turn counts as straight, an area as none.
constexpr double kGeometryTolerance = 1e-12;

double cross(const Vec2& a, const Vec2& b) noexcept { return a.x() * b.y() - a.y() * b.x(); }

bool all_finite(std::span<const Vec2> points) noexcept {
  return std::all_of(points.begin(), points.end(),
                     [](const Vec2& p) { return std::isfinite(p.x()) && std::isfinite(p.y()); });
}

// kOk for a convex polygon listed once, counter-clockwise.
WorldStatus check_polygon(std::span<const Vec2> v) noexcept {
  const std::size_t n = v.size();
  if (n < 3 || n > static_cast<std::size_t>(kMaxPolygonVertices)) {
    return WorldStatus::kBadVertexCount;
  }
  if (!all_finite(v)) return WorldStatus::kNotFinite;
  double extent = 0.0;
  double area2 = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    extent = std::max(extent, (v[i] - v[0]).cwiseAbs().maxCoeff());
    area2 += cross(v[i] - v[0], v[(i + 1) % n] - v[0]);
  }
  const double tolerance = kGeometryTolerance * extent * extent;
  if (std::abs(area2) <= tolerance) return WorldStatus::kDegenerate;
  const double orientation = area2 > 0.0 ? 1.0 : -1.0;
  double turning_rad = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 edge = v[(i + 1) % n] - v[i];
    const Vec2 next = v[(i + 2) % n] - v[(i + 1) % n];
    if (edge.norm() <= kGeometryTolerance * extent) return WorldStatus::kDegenerate;
    if (orientation * cross(edge, next) < -tolerance) return WorldStatus::kNotConvex;
    turning_rad += std::atan2(cross(edge, next), edge.dot(next));
  }
  constexpr double kFullTurn_rad = 6.283185307179586;
  if (std::abs(std::abs(turning_rad) - kFullTurn_rad) > 1e-6) return WorldStatus::kNotConvex;
  return orientation > 0.0 ? WorldStatus::kOk : WorldStatus::kClockwise;
}

int padded(int num_vertices) noexcept {
  return (num_vertices + kLanesDouble - 1) / kLanesDouble * kLanesDouble;
}

}  // namespace

World2::World2(Arena& arena, const WorldCapacity& capacity) noexcept
    : obstacles_(arena, capacity.max_obstacles),
      boxes_(arena, capacity.max_obstacles),
      x_(arena, capacity.max_vertices),
      y_(arena, capacity.max_vertices),
      edge_x_(arena, capacity.max_vertices),
      edge_y_(arena, capacity.max_vertices),
      inv_edge2_(arena, capacity.max_vertices),
      normal_x_(arena, capacity.max_vertices),
      normal_y_(arena, capacity.max_vertices),
      offset_(arena, capacity.max_vertices),
      broad_phase_(arena, capacity.max_obstacles) {}

std::size_t World2::required_bytes(const WorldCapacity& capacity) noexcept {
  Arena arena = Arena::measuring();
  const World2 world(arena, capacity);
  return arena.used_B();
}

WorldStatus World2::reset(const Aabb2& bounds) noexcept {
  obstacles_.clear();
  boxes_.clear();
  for (auto* array :
       {&x_, &y_, &edge_x_, &edge_y_, &inv_edge2_, &normal_x_, &normal_y_, &offset_}) {
    array->clear();
  }
  max_own_margin_m_ = kDefaultMargin;
  is_reset_ = false;
  (void)broad_phase_.build({});
  if (!bounds.lower.allFinite() || !bounds.upper.allFinite()) return WorldStatus::kNotFinite;
  if (!(bounds.lower.array() < bounds.upper.array()).all()) return WorldStatus::kBadBounds;
  bounds_ = bounds;
  is_reset_ = true;
  return WorldStatus::kOk;
}

WorldStatus World2::try_add(const Disc& disc, double margin_m) noexcept {
  if (!disc.center.allFinite() || !std::isfinite(disc.radius_m)) return WorldStatus::kNotFinite;
  if (disc.radius_m <= 0.0) return WorldStatus::kBadSize;
  return try_add_core({&disc.center, 1}, disc.radius_m, margin_m);
}

WorldStatus World2::try_add(const Box2& box, double margin_m) noexcept {
  if (!box.center.allFinite() || !box.size_m.allFinite() || !std::isfinite(box.angle_rad)) {
    return WorldStatus::kNotFinite;
  }
  if (!(box.size_m.array() > 0.0).all()) return WorldStatus::kBadSize;
  const Vec2 along = 0.5 * box.size_m.x() * Vec2(std::cos(box.angle_rad), std::sin(box.angle_rad));
  const Vec2 across =
      0.5 * box.size_m.y() * Vec2(-std::sin(box.angle_rad), std::cos(box.angle_rad));
  const std::array<Vec2, 4> vertices = {box.center - along - across, box.center + along - across,
                                        box.center + along + across, box.center - along + across};
  const WorldStatus shape = check_polygon(vertices);  // extents too far apart, or lost in rounding
  return shape == WorldStatus::kOk ? try_add_core(vertices, 0.0, margin_m) : shape;
}

WorldStatus World2::try_add(const Polygon2& polygon, double margin_m) noexcept {
  if (polygon.num_vertices < 3 || polygon.num_vertices > kMaxPolygonVertices) {
    return WorldStatus::kBadVertexCount;
  }
  const std::span<const Vec2> vertices(polygon.vertices.data(),
                                       static_cast<std::size_t>(polygon.num_vertices));
  const WorldStatus shape = check_polygon(vertices);
  return shape == WorldStatus::kOk ? try_add_core(vertices, 0.0, margin_m) : shape;
}

WorldStatus World2::try_add_core(std::span<const Vec2> vertices, double radius_m,
                                 double margin_m) noexcept {
  if (!is_reset_) return WorldStatus::kNotReset;
  if (!std::isfinite(margin_m)) return WorldStatus::kNotFinite;
  if (margin_m < 0.0 && margin_m != kDefaultMargin) return WorldStatus::kBadSize;
  const int num_vertices = static_cast<int>(vertices.size());
  const int num_padded = padded(num_vertices);
  const int first = x_.size();
  if (obstacles_.size() == obstacles_.capacity()) return WorldStatus::kTooManyObstacles;
  if (first + num_padded > x_.capacity()) return WorldStatus::kTooManyVertices;

  Aabb2 box{vertices[0], vertices[0]};
  bool fits = true;
  for (int i = 0; i < num_padded; ++i) {
    const auto i_vertex = static_cast<std::size_t>(std::min(i, num_vertices - 1));
    const Vec2& v = vertices[i_vertex];
    const Vec2 edge = vertices[(i_vertex + 1) % vertices.size()] - v;
    const double length = edge.norm();
    const Vec2 normal = length > 0.0 ? Vec2(edge.y() / length, -edge.x() / length) : Vec2::Zero();
    box.lower = box.lower.cwiseMin(v);
    box.upper = box.upper.cwiseMax(v);
    fits = x_.try_push_back(v.x()) && y_.try_push_back(v.y()) && edge_x_.try_push_back(edge.x()) &&
           edge_y_.try_push_back(edge.y()) &&
           inv_edge2_.try_push_back(length > 0.0 ? 1.0 / (length * length) : 0.0) &&
           normal_x_.try_push_back(normal.x()) && normal_y_.try_push_back(normal.y()) &&
           offset_.try_push_back(normal.dot(v)) && fits;
  }
  box.lower.array() -= radius_m;
  box.upper.array() += radius_m;
  fits = obstacles_.try_push_back({first, num_vertices, num_padded, radius_m, margin_m}) &&
         boxes_.try_push_back(box) && fits;
  max_own_margin_m_ = std::max(max_own_margin_m_, margin_m);
  return fits ? WorldStatus::kOk : WorldStatus::kTooManyObstacles;
}

void World2::build() noexcept { (void)broad_phase_.build(boxes_.span()); }

ConvexView World2::obstacle(int i) const SOPT_RT {
  const Obstacle& o = obstacles_[i];
  const int first = o.first_vertex;
  return {x_.begin() + first,
          y_.begin() + first,
          edge_x_.begin() + first,
          edge_y_.begin() + first,
          inv_edge2_.begin() + first,
          normal_x_.begin() + first,
          normal_y_.begin() + first,
          offset_.begin() + first,
          o.num_vertices,
          o.num_padded,
          o.radius_m};
}

double World2::bounds_distance(const Vec2& p, const Vec2& q) const SOPT_RT {
  const Vec2 inside = (p.cwiseMin(q) - bounds_.lower).cwiseMin(bounds_.upper - p.cwiseMax(q));
  return inside.minCoeff();
}

NearestObstacle World2::nearest(const Vec2& p, const Vec2& q, double limit_m) const SOPT_RT {
  NearestObstacle best{limit_m, kNoObstacle};
  const double to_bounds = bounds_distance(p, q);
  if (to_bounds < best.distance_m) best = {to_bounds, kBoundsObstacle};
  (void)for_each_near(p, q, limit_m, [&](int i) {
    Clearance2 c;
    if (compute_clearance_within(obstacle(i), p, q, best.distance_m, c) &&
        c.distance_m < best.distance_m) {
      best = {c.distance_m, i};
    }
    return true;
  });
  return best;
}

bool World2::is_clear(const Vec2& p, const Vec2& q, double radius_m,
                      const ClearanceRule& rule) const SOPT_RT {
  if (!std::isfinite((p + q).sum() + radius_m)) return false;
  if (bounds_distance(p, q) < radius_m + rule.required_m(kDefaultMargin)) return false;
  return for_each_near(p, q, radius_m + max_required_m(rule), [&](int i) {
    return !is_within(obstacle(i), p, q, radius_m + rule.required_m(obstacles_[i].margin_m));
  });
}

}  // namespace sopt
