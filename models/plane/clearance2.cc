#include "models/plane/clearance2.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "models/simd.h"

namespace sopt {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kTouching_m = 1e-9;

// The segment, splatted over lanes where the loops want it so.
struct Segment {
  Vec2 p, q, d;
  double length2, inv_length2;  // inv_length2 is 0 for a point

  Segment(const Vec2& from, const Vec2& to) noexcept
      : p(from), q(to), d(to - from), length2(d.squaredNorm()) {
    inv_length2 = length2 > 0.0 ? 1.0 / length2 : 0.0;
  }
  [[nodiscard]] bool is_point() const noexcept { return length2 == 0.0; }
};

double max_lane(V4d v) noexcept { return std::max(std::max(v[0], v[1]), std::max(v[2], v[3])); }
double min_lane(V4d v) noexcept { return std::min(std::min(v[0], v[1]), std::min(v[2], v[3])); }

V4d clamp01(V4d v) noexcept { return min4(max4(v, splat4(0.0)), splat4(1.0)); }

// Separation along the best face normal: max_i min(n_i.p, n_i.q) - offset_i.
struct FaceSeparation {
  double value = -kInfinity;
  int i_face = 0;
};

double best_face_value(const ConvexView& o, const Segment& s) noexcept {
  V4d best = splat4(-kInfinity);
  for (int i = 0; i < o.num_padded; i += kLanesDouble) {
    const V4d nx = load4(o.normal_x + i);
    const V4d ny = load4(o.normal_y + i);
    const V4d at_p = nx * s.p.x() + ny * s.p.y();
    const V4d at_q = nx * s.q.x() + ny * s.q.y();
    best = max4(best, min4(at_p, at_q) - load4(o.offset + i));
  }
  return max_lane(best);
}

FaceSeparation best_face(const ConvexView& o, const Segment& s) noexcept {
  FaceSeparation best;
  for (int i = 0; i < o.num_vertices; ++i) {
    const double at_p = o.normal_x[i] * s.p.x() + o.normal_y[i] * s.p.y();
    const double at_q = o.normal_x[i] * s.q.x() + o.normal_y[i] * s.q.y();
    const double value = std::min(at_p, at_q) - o.offset[i];
    if (value > best.value) best = {value, i};
  }
  return best;
}

// Range of the obstacle's vertices along the segment's left normal, relative to the segment.
struct SideRange {
  double lower, upper;

  // Separation along the segment's normal; -inf for a point, which has no such axis.
  [[nodiscard]] double separation() const noexcept { return std::max(lower, -upper); }
};

SideRange side_range(const ConvexView& o, const Segment& s) noexcept {
  if (s.is_point()) return {-kInfinity, kInfinity};
  V4d lower = splat4(kInfinity);
  V4d upper = splat4(-kInfinity);
  for (int i = 0; i < o.num_padded; i += kLanesDouble) {
    const V4d side = s.d.x() * (load4(o.y + i) - s.p.y()) - s.d.y() * (load4(o.x + i) - s.p.x());
    lower = min4(lower, side);
    upper = max4(upper, side);
  }
  const double scale = std::sqrt(s.inv_length2);
  return {min_lane(lower) * scale, max_lane(upper) * scale};
}

V4d vertex_to_segment2(const ConvexView& o, const Segment& s, int i) noexcept {
  const V4d rx = load4(o.x + i) - s.p.x();
  const V4d ry = load4(o.y + i) - s.p.y();
  const V4d t = clamp01((rx * s.d.x() + ry * s.d.y()) * s.inv_length2);
  const V4d wx = rx - t * s.d.x();
  const V4d wy = ry - t * s.d.y();
  return wx * wx + wy * wy;
}

V4d point_to_edge2(const ConvexView& o, const Vec2& p, int i) noexcept {
  const V4d ex = load4(o.edge_x + i);
  const V4d ey = load4(o.edge_y + i);
  const V4d rx = p.x() - load4(o.x + i);
  const V4d ry = p.y() - load4(o.y + i);
  const V4d t = clamp01((rx * ex + ry * ey) * load4(o.inv_edge2 + i));
  const V4d wx = rx - t * ex;
  const V4d wy = ry - t * ey;
  return wx * wx + wy * wy;
}

double min_feature_distance2(const ConvexView& o, const Segment& s) noexcept {
  V4d best = splat4(kInfinity);
  for (int i = 0; i < o.num_padded; i += kLanesDouble) {
    best = min4(best, vertex_to_segment2(o, s, i));
    best = min4(best, min4(point_to_edge2(o, s.p, i), point_to_edge2(o, s.q, i)));
  }
  return min_lane(best);
}

// The closest pair of points of the two cores, when they are apart.
struct ClosestPair {
  double distance2 = kInfinity;
  Vec2 on_core = Vec2::Zero();
  Vec2 on_segment = Vec2::Zero();
};

Vec2 closest_on_segment(const Segment& s, const Vec2& point) noexcept {
  const double t = std::clamp((point - s.p).dot(s.d) * s.inv_length2, 0.0, 1.0);
  return t == 1.0 ? s.q : Vec2(s.p + t * s.d);
}

Vec2 closest_on_edge(const ConvexView& o, int i, const Vec2& point) noexcept {
  const Vec2 from(o.x[i], o.y[i]);
  const Vec2 edge(o.edge_x[i], o.edge_y[i]);
  return from + std::clamp((point - from).dot(edge) * o.inv_edge2[i], 0.0, 1.0) * edge;
}

// Index of the smallest value over all lanes of all blocks, first one wins.
struct LaneMinimum {
  V4d value = splat4(kInfinity);
  V4d index = splat4(0.0);

  void update(V4d candidate, int i_block) noexcept {
    const double first = i_block;
    const V4d lanes{first, first + 1.0, first + 2.0, first + 3.0};
    index = candidate < value ? lanes : index;
    value = min4(candidate, value);
  }
  [[nodiscard]] double min_value() const noexcept { return min_lane(value); }
  [[nodiscard]] int arg_min() const noexcept {
    int best = 0;
    for (int lane = 1; lane < kLanesDouble; ++lane) {
      if (value[lane] < value[best]) best = lane;
    }
    return static_cast<int>(index[best]);
  }
};

ClosestPair closest_pair(const ConvexView& o, const Segment& s) noexcept {
  LaneMinimum vertex;
  LaneMinimum from_p;
  LaneMinimum from_q;
  for (int i = 0; i < o.num_padded; i += kLanesDouble) {
    vertex.update(vertex_to_segment2(o, s, i), i);
    from_p.update(point_to_edge2(o, s.p, i), i);
    from_q.update(point_to_edge2(o, s.q, i), i);
  }
  ClosestPair pair;
  if (vertex.min_value() <= std::min(from_p.min_value(), from_q.min_value())) {
    const int i = vertex.arg_min();
    pair.on_core = Vec2(o.x[i], o.y[i]);
    pair.on_segment = closest_on_segment(s, pair.on_core);
  } else {
    const bool at_p = from_p.min_value() <= from_q.min_value();
    pair.on_segment = at_p ? s.p : s.q;
    pair.on_core = closest_on_edge(o, (at_p ? from_p : from_q).arg_min(), pair.on_segment);
  }
  pair.distance2 = (pair.on_segment - pair.on_core).squaredNorm();
  return pair;
}

Clearance2 from_pair(const ConvexView& o, const ClosestPair& pair) noexcept {
  const double distance = std::sqrt(pair.distance2);
  Clearance2 c;
  c.distance_m = distance - o.radius_m;
  c.normal = (pair.on_segment - pair.on_core) / distance;
  c.on_obstacle = pair.on_core + o.radius_m * c.normal;
  c.on_segment = pair.on_segment;
  return c;
}

// Cores overlap or touch: the axis of least penetration.
Clearance2 from_axes(const ConvexView& o, const Segment& s, const SideRange& side) noexcept {
  Clearance2 c;
  const FaceSeparation face = o.num_vertices > 1 ? best_face(o, s) : FaceSeparation{-kInfinity, 0};
  const Vec2 left =
      s.is_point() ? Vec2::UnitX() : Vec2(Vec2(-s.d.y(), s.d.x()) * std::sqrt(s.inv_length2));
  if (s.is_point() && o.num_vertices == 1) {
    c.normal = Vec2::UnitX();
    c.distance_m = -o.radius_m;
    c.on_segment = s.p;
  } else if (face.value >= side.separation()) {
    c.normal = Vec2(o.normal_x[face.i_face], o.normal_y[face.i_face]);
    c.distance_m = face.value - o.radius_m;
    const double rise_m = c.normal.dot(s.d);
    if (std::abs(rise_m) > kTouching_m) {
      c.on_segment = rise_m > 0.0 ? s.p : s.q;
    } else {
      // Parallel to the face: the part of the segment that is beside it.
      const Vec2 middle(o.x[face.i_face] + 0.5 * o.edge_x[face.i_face],
                        o.y[face.i_face] + 0.5 * o.edge_y[face.i_face]);
      c.on_segment = closest_on_segment(s, middle);
    }
  } else {
    // lower > -upper: most of the obstacle is to the left, so the way out is to the right.
    c.normal = side.lower > -side.upper ? Vec2(-left) : left;
    c.distance_m = side.separation() - o.radius_m;
    int i_support = 0;
    for (int i = 1; i < o.num_vertices; ++i) {
      const Vec2 step(o.x[i] - o.x[i_support], o.y[i] - o.y[i_support]);
      if (c.normal.dot(step) > 0.0) i_support = i;
    }
    c.on_segment = closest_on_segment(s, Vec2(o.x[i_support], o.y[i_support]));
  }
  c.on_obstacle = c.on_segment - c.distance_m * c.normal;
  return c;
}

}  // namespace

bool compute_clearance_within(const ConvexView& obstacle, const Vec2& p, const Vec2& q,
                              double limit_m, Clearance2& out) SOPT_RT {
  const Segment s(p, q);
  const double core_limit = limit_m + obstacle.radius_m;
  double face = -kInfinity;
  if (obstacle.num_vertices > 1) {
    face = best_face_value(obstacle, s);
    if (face > core_limit) return false;
  }
  // A polygon and a segment are apart exactly when a face normal or the segment's normal separates
  // them. A single vertex is apart unless it lies on the segment.
  if (obstacle.num_vertices == 1 || face > 0.0 || side_range(obstacle, s).separation() > 0.0) {
    const ClosestPair pair = closest_pair(obstacle, s);
    if (pair.distance2 > core_limit * core_limit || core_limit < 0.0) return false;
    if (pair.distance2 > kTouching_m * kTouching_m) {
      out = from_pair(obstacle, pair);
      return true;
    }
  }
  const Clearance2 overlap = from_axes(obstacle, s, side_range(obstacle, s));
  if (overlap.distance_m > limit_m) return false;
  out = overlap;
  return true;
}

Clearance2 compute_clearance(const ConvexView& obstacle, const Vec2& p, const Vec2& q) SOPT_RT {
  Clearance2 result;
  const bool found = compute_clearance_within(obstacle, p, q, kInfinity, result);
  if (!found) result.distance_m = kInfinity;  // only for coordinates that are not numbers
  return result;
}

bool is_within(const ConvexView& obstacle, const Vec2& p, const Vec2& q, double radius_m) SOPT_RT {
  const Segment s(p, q);
  const double limit = radius_m + obstacle.radius_m;
  if (obstacle.num_vertices == 1) {
    const Vec2 center(obstacle.x[0], obstacle.y[0]);
    return (closest_on_segment(s, center) - center).squaredNorm() < limit * limit;
  }
  const double face = best_face_value(obstacle, s);
  if (face >= limit) return false;
  const double side = side_range(obstacle, s).separation();
  if (side >= limit) return false;
  if (face <= 0.0 && side <= 0.0) return true;
  return min_feature_distance2(obstacle, s) < limit * limit;
}

}  // namespace sopt
