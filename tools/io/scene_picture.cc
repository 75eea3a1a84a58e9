#include "tools/io/scene_picture.h"

#include <array>
#include <cmath>
#include <cstdio>

#include "tools/io/picture_style.h"

namespace sopt {

Aabb2 view_of(const Scene& scene) {
  constexpr double kMostGrowth = 0.25;
  const Aabb2& bounds = scene.world->bounds();
  const Vec2 growth = kMostGrowth * (bounds.upper - bounds.lower);
  const Vec2 around = Vec2::Constant(1.5 * scene.robot.radius_m);
  Aabb2 view = bounds;
  for (const Vec2& end : {scene.start, scene.goal}) {
    const bool inside =
        (end.array() >= bounds.lower.array()).all() && (end.array() <= bounds.upper.array()).all();
    if (inside) continue;
    view.lower = view.lower.cwiseMin(end - around).cwiseMax(bounds.lower - growth);
    view.upper = view.upper.cwiseMax(end + around).cwiseMin(bounds.upper + growth);
  }
  return view;
}

SceneMap::SceneMap(const Aabb2& view, const Vec2& corner, const Vec2& room)
    : view_(view), corner_(corner) {
  const Vec2 extent = view.upper - view.lower;
  scale_ = (room.array() / extent.array()).minCoeff();
  size_ = scale_ * extent;
}

std::vector<Vec2> SceneMap::at(std::span<const Vec2> world) const {
  std::vector<Vec2> page;
  page.reserve(world.size());
  for (const Vec2& point : world) page.push_back(at(point));
  return page;
}

void draw_obstacles(const World2& world, int i_culprit, const SceneMap& map, Svg& svg) {
  svg.begin_group(fill(kObstacleColor));
  for (int i = 0; i < world.num_obstacles(); ++i) {
    const ConvexView shape = world.obstacle(i);
    const std::string culprit = i == i_culprit
                                    ? fill("#f2b8b5") + attribute("stroke", kFailureColor) +
                                          attribute("stroke-width", "2.5")
                                    : "";
    std::vector<Vec2> outline;
    for (int k = 0; k < shape.num_vertices; ++k) {
      outline.push_back(map.at(Vec2(shape.x[k], shape.y[k])));
    }
    if (outline.size() == 1) {
      svg.circle(outline[0], map.px(shape.radius_m), culprit);
    } else {
      svg.polyline(outline, true, culprit);
    }
  }
  svg.end_group();
}

void draw_bounds(const World2& world, int i_culprit, const SceneMap& map, Svg& svg) {
  const Aabb2& bounds = world.bounds();
  const Vec2 corner = map.at(Vec2(bounds.lower.x(), bounds.upper.y()));
  const Vec2 opposite = map.at(Vec2(bounds.upper.x(), bounds.lower.y()));
  const bool is_culprit = i_culprit == kBoundsObstacle;
  svg.rectangle(corner, opposite - corner,
                stroke(is_culprit ? kFailureColor : kInkColor, is_culprit ? 3.0 : 1.5));
}

void draw_end(const Vec2& at, double radius_px, bool is_start, Svg& svg) {
  const char* const color = is_start ? "#009e73" : "#d55e00";
  if (radius_px > 0.0) {
    svg.circle(at, radius_px,
               fill(color) + attribute("fill-opacity", "0.25") + attribute("stroke", color) +
                   attribute("stroke-width", "1.5"));
  }
  const std::string marker =
      fill(color) + attribute("stroke", "white") + attribute("stroke-width", "1.5");
  if (is_start) {
    svg.circle(at, 8.0, marker);
  } else {
    const std::array<Vec2, 4> diamond = {at + Vec2(0.0, -10.5), at + Vec2(10.5, 0.0),
                                         at + Vec2(0.0, 10.5), at + Vec2(-10.5, 0.0)};
    svg.polyline(diamond, true, marker);
  }
  svg.text(at + Vec2(0.0, 3.8), is_start ? "S" : "G",
           font(11, "white", true) + " text-anchor=\"middle\"");
}

void draw_scale_bar(const SceneMap& map, Svg& svg) {
  const double longest_m = map.size().x() / 3.0 / map.px(1.0);
  double length_m = std::pow(10.0, std::floor(std::log10(longest_m)));
  if (5.0 * length_m <= longest_m) {
    length_m *= 5.0;
  } else if (2.0 * length_m <= longest_m) {
    length_m *= 2.0;
  }
  char label[32];
  (void)std::snprintf(label, sizeof label, "%g m", length_m);
  const Vec2 left = map.corner() + Vec2(0.0, map.size().y() + 18.0);
  const Vec2 right = left + Vec2(map.px(length_m), 0.0);
  const std::string style = stroke(kInkColor, 2.0);
  svg.line(left, right, style);
  for (const Vec2& end : {left, right}) svg.line(end - Vec2(0, 5), end + Vec2(0, 5), style);
  svg.text(0.5 * (left + right) + Vec2(0.0, 19.0), label,
           font(13, kInkColor) + " text-anchor=\"middle\"");
}

}  // namespace sopt
