#include "tools/io/space_view.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

#include "models/space/clearance3.h"

namespace sopt {
namespace {

constexpr int kCirclePoints = 36;

Vec3 light_direction(const SpaceView& view) {
  return (0.45 * view.toward_viewer() - 0.35 * view.right() + 0.9 * Vec3::UnitZ()).normalized();
}

double light_on(const Vec3& normal, const SpaceView& view) {
  return std::max(0.0, normal.dot(light_direction(view)));
}

std::vector<Vec3> circle(const Vec3& center, const Vec3& a, const Vec3& b) {
  std::vector<Vec3> points;
  for (int i = 0; i < kCirclePoints; ++i) {
    const double turn_rad = 2.0 * std::numbers::pi * i / kCirclePoints;
    points.push_back(center + std::cos(turn_rad) * a + std::sin(turn_rad) * b);
  }
  return points;
}

void append(std::vector<Vec3>& points, const std::vector<Vec3>& more) {
  points.insert(points.end(), more.begin(), more.end());
}

std::vector<Vec2> outline_of(const std::vector<Vec3>& points, const SpaceView& view) {
  return convex_outline(view.at(points));
}

SeenShape see_round(const Convex3& shape, const SpaceView& view) {
  const auto around_ends = [&](double radius_m, const Vec3& offset) {
    const Capsule3 core = to_capsule(shape);
    std::vector<Vec3> points;
    for (const Vec3& end : {core.p0, core.p1}) {
      append(points, circle(end + offset, radius_m * view.right(), radius_m * view.up()));
    }
    return outline_of(points, view);
  };
  const Vec3 offset = shape.radius_m * (0.25 * view.up() - 0.2 * view.right());
  return {around_ends(shape.radius_m, Vec3::Zero()),
          {{around_ends(0.55 * shape.radius_m, offset), 0.95}}};
}

SeenShape see_box(const Convex3& box, const SpaceView& view) {
  SeenShape seen;
  std::vector<Vec3> corners;
  for (int k = 0; k < 3; ++k) {
    const Vec3 normal = box.axes.col(k) * (view.nearness(box.axes.col(k)) < 0.0 ? -1.0 : 1.0);
    const Vec3 middle = box.center + box.half_m[k] * normal;
    const Vec3 a = box.half_m[(k + 1) % 3] * box.axes.col((k + 1) % 3);
    const Vec3 b = box.half_m[(k + 2) % 3] * box.axes.col((k + 2) % 3);
    const std::vector<Vec3> face = {middle + a + b, middle - a + b, middle - a - b, middle + a - b};
    seen.faces.push_back({view.at(face), light_on(normal, view)});
    append(corners, face);
  }
  seen.silhouette = outline_of(corners, view);
  return seen;
}

SeenShape see_cylinder(const Convex3& cylinder, const SpaceView& view) {
  const Vec3 axis = cylinder.axes.col(2) * (view.nearness(cylinder.axes.col(2)) < 0.0 ? -1.0 : 1.0);
  const Vec3 a = cylinder.half_m.x() * cylinder.axes.col(0);
  const Vec3 b = cylinder.half_m.x() * cylinder.axes.col(1);
  const Vec3 half = cylinder.half_m.z() * axis;
  const std::vector<Vec3> near_end = circle(cylinder.center + half, a, b);
  std::vector<Vec3> rims = circle(cylinder.center - half, a, b);
  append(rims, near_end);
  return {outline_of(rims, view), {{view.at(near_end), light_on(axis, view)}}};
}

SeenShape see_hull(const Convex3& shape, const SpaceView& view) {
  const HullData& hull = *shape.hull;
  std::vector<Vec3> vertices;
  for (int i = 0; i < hull.num_vertices; ++i)
    vertices.emplace_back(hull.x[i], hull.y[i], hull.z[i]);
  SeenShape seen;
  double size_m = 0.0;
  for (const Vec3& vertex : vertices) size_m = std::max(size_m, vertex.norm());
  for (int i = 0; i < hull.num_planes; ++i) {
    if (view.nearness(hull.normal[i]) <= 0.0) continue;
    std::vector<Vec3> face;
    for (const Vec3& vertex : vertices) {
      const bool is_on = hull.normal[i].dot(vertex) > hull.offset[i] - 1e-6 * size_m;
      if (is_on) face.push_back(shape.center + vertex);
    }
    seen.faces.push_back({outline_of(face, view), light_on(hull.normal[i], view)});
  }
  for (Vec3& vertex : vertices) vertex += shape.center;
  seen.silhouette = outline_of(vertices, view);
  return seen;
}

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

// Of a shape on the page.
Aabb2 page_box(const Convex3& shape, const SpaceView& view) {
  const Vec3 across = core_support(shape, view.right());
  const Vec3 back = core_support(shape, -view.right());
  const Vec3 top = core_support(shape, view.up());
  const Vec3 bottom = core_support(shape, -view.up());
  const Vec2 center = view.at(shape.center);
  const Vec2 radius = Vec2::Constant(shape.radius_m);
  return {center + Vec2(view.at(back).x(), view.at(top).y()) - radius,
          center + Vec2(view.at(across).x(), view.at(bottom).y()) + radius};
}

// How near it comes to the viewer at its middle.
double front(const PaintItem& item, const SpaceView& view) {
  return view.nearness(item.shape.center) + item.shape.radius_m;
}

// > 0: b hides a, < 0: a hides b, 0: neither.
int compare(const PaintItem& a, const PaintItem& b, const SpaceView& view) {
  constexpr double kSideBySide = 1e-9;
  const Clearance3 clearance = compute_clearance(a.shape, b.shape);
  if (clearance.distance_m < -1e-6) {
    if (a.rank != b.rank) return a.rank < b.rank ? 1 : -1;
    if (a.shape.is_round() && b.shape.is_round()) return 0;
  }
  const double nearer = view.nearness(clearance.normal);
  return nearer > kSideBySide ? 1 : nearer < -kSideBySide ? -1 : 0;
}

// Who hides whom, and what of that is still to be painted.
class PaintQueue {
 public:
  PaintQueue(std::span<const PaintItem> items, const SpaceView& view)
      : items_(items), view_(view), hidden_by_(items.size()), num_behind_(items.size(), 0) {
    std::vector<Aabb2> boxes;
    for (const PaintItem& item : items) boxes.push_back(page_box(item.shape, view));
    for (std::size_t b = 0; b < items.size(); ++b) {
      for (std::size_t a = 0; a < b; ++a) {
        if (items[a].group == items[b].group || !overlap(boxes[a], boxes[b])) continue;
        const int order = compare(items[a], items[b], view);
        if (order != 0) add(order > 0 ? a : b, order > 0 ? b : a);
      }
    }
    for (std::size_t i = 0; i < items.size(); ++i) waiting_.push_back(i);
  }

  [[nodiscard]] bool is_empty() const { return waiting_.empty(); }

  // One that hides nothing unpainted: of the group when there is one, else the farthest. In a ring
  // the farthest of all.
  std::size_t take(int group) {
    const auto best = std::min_element(
        waiting_.begin(), waiting_.end(),
        [&](std::size_t a, std::size_t b) { return key(a, group) < key(b, group); });
    const std::size_t i = *best;
    waiting_.erase(best);
    for (const std::size_t front : hidden_by_[i]) --num_behind_[front];
    return i;
  }

 private:
  static bool overlap(const Aabb2& a, const Aabb2& b) {
    return (a.lower.array() < b.upper.array()).all() && (b.lower.array() < a.upper.array()).all();
  }
  void add(std::size_t back, std::size_t front) {
    hidden_by_[back].push_back(front);
    ++num_behind_[front];
  }
  [[nodiscard]] std::tuple<bool, bool, double> key(std::size_t i, int group) const {
    const bool is_blocked = num_behind_[i] > 0;
    return {is_blocked, is_blocked || items_[i].group != group, front(items_[i], view_)};
  }

  std::span<const PaintItem> items_;
  const SpaceView& view_;
  std::vector<std::vector<std::size_t>> hidden_by_;
  std::vector<int> num_behind_;
  std::vector<std::size_t> waiting_;
};

}  // namespace

SpaceView::SpaceView(int i_corner) {
  const double azimuth_rad = std::numbers::pi * (0.25 + 0.5 * i_corner);
  toward_viewer_ = Vec3(std::numbers::sqrt2 * std::cos(azimuth_rad),
                        std::numbers::sqrt2 * std::sin(azimuth_rad), 1.0)
                       .normalized();
  right_ = Vec3::UnitZ().cross(toward_viewer_).normalized();
  up_ = toward_viewer_.cross(right_);
}

std::vector<Vec2> SpaceView::at(std::span<const Vec3> points) const {
  std::vector<Vec2> page;
  page.reserve(points.size());
  for (const Vec3& point : points) page.push_back(at(point));
  return page;
}

// Andrew's monotone chain.
std::vector<Vec2> convex_outline(std::vector<Vec2> points) {
  std::sort(points.begin(), points.end(), [](const Vec2& a, const Vec2& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  });
  // Less is rounding.
  Aabb2 box = points.empty() ? Aabb2{} : Aabb2{points.front(), points.front()};
  for (const Vec2& p : points) box = {box.lower.cwiseMin(p), box.upper.cwiseMax(p)};
  const double least_turn = 1e-12 * (box.upper - box.lower).squaredNorm();
  std::vector<Vec2> outline;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t first = outline.size();
    for (const Vec2& point : points) {
      while (outline.size() >= first + 2 && cross(outline.back() - outline[outline.size() - 2],
                                                  point - outline.back()) <= least_turn) {
        outline.pop_back();
      }
      outline.push_back(point);
    }
    if (!outline.empty()) outline.pop_back();  // begins the other half
    std::reverse(points.begin(), points.end());
  }
  return outline;
}

SeenShape see(const Convex3& shape, const SpaceView& view) {
  switch (shape.kind) {
    case CoreKind::kPoint:
    case CoreKind::kSegment:
      break;
    case CoreKind::kBox:
      return see_box(shape, view);
    case CoreKind::kCylinder:
      return see_cylinder(shape, view);
    case CoreKind::kHull:
      return see_hull(shape, view);
  }
  return see_round(shape, view);
}

std::vector<int> paint_order(std::span<const PaintItem> items, const SpaceView& view) {
  PaintQueue queue(items, view);
  std::vector<int> order;
  int group = std::numeric_limits<int>::min();
  while (!queue.is_empty()) {
    const std::size_t i = queue.take(group);
    group = items[i].group;
    order.push_back(static_cast<int>(i));
  }
  return order;
}

}  // namespace sopt
