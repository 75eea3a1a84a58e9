#include "tools/io/space_page.h"

#include <algorithm>
#include <cmath>

#include "tools/io/picture_style.h"
#include "tools/io/plan_report.h"

namespace sopt {
namespace {

constexpr double kLabels_px = 44.0;  // beside the floor
constexpr const char* kGridColor = "#dde2e8";
constexpr const char* kShadowColor = "#c3cad3";

double nice_step(double length_m) {
  const double unit = std::pow(10.0, std::floor(std::log10(length_m)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * unit >= length_m) return factor * unit;
  }
  return 10.0 * unit;
}

}  // namespace

Aabb3 joined(const Aabb3& a, const Aabb3& b) {
  return {a.lower.cwiseMin(b.lower), a.upper.cwiseMax(b.upper)};
}

SpacePage::SpacePage(const SpaceView& view, std::span<const Aabb3> boxes, const Vec2& corner,
                     const Vec2& room)
    : view_(view), corner_(corner) {
  constexpr double kLeastSize_m = 1e-3;
  constexpr double kCells = 14.0;  // about as many along the longest side
  Aabb3 box = boxes.front();
  for (const Aabb3& other : boxes) box = joined(box, other);
  step_m_ = nice_step(std::max(kLeastSize_m, (box.upper - box.lower).maxCoeff()) / kCells);
  first_ = (box.lower / step_m_).array().floor().cast<int>();
  num_cells_ = (box.upper / step_m_).array().ceil().cast<int>() - first_.array();
  num_cells_ = num_cells_.cwiseMax(1);
  const Aabb2 seen = seen_box(boxes);
  const Vec2 extent = seen.upper - seen.lower;
  const Vec2 inner = room - Vec2(2.0 * kLabels_px, kLabels_px);
  scale_ = (inner.array() / extent.array()).minCoeff();
  size_ = Vec2(room.x(), scale_ * extent.y() + kLabels_px);
  origin_ = corner_ + Vec2(0.5 * (room.x() - scale_ * extent.x()), 0.0) - scale_ * seen.lower;
}

// Around the boxes, the floor and the scale upwards.
Aabb2 SpacePage::seen_box(std::span<const Aabb3> boxes) const {
  const Vec2 first = view_.at(front_corner());
  Aabb2 seen = {first, first};
  const auto include = [&](const Aabb3& box) {
    for (int k = 0; k < 8; ++k) {
      const Vec2 p = view_.at(Vec3(((k & 1) != 0 ? box.upper : box.lower).x(),
                                   ((k & 2) != 0 ? box.upper : box.lower).y(),
                                   ((k & 4) != 0 ? box.upper : box.lower).z()));
      seen = {seen.lower.cwiseMin(p), seen.upper.cwiseMax(p)};
    }
  };
  for (const Aabb3& box : boxes) include(box);
  const Vec3 front = front_corner();
  const Vec3 back = corner_at(false, false);
  include({front.cwiseMin(back), front.cwiseMax(back)});
  const Vec3 left = left_corner();
  include({left, {left.x(), left.y(), value(2, num_cells_.z())}});
  return seen;
}

Vec3 SpacePage::corner_at(bool near_x, bool near_y) const {
  const bool upper_x = (view_.toward_viewer().x() > 0.0) == near_x;
  const bool upper_y = (view_.toward_viewer().y() > 0.0) == near_y;
  return {value(0, upper_x ? num_cells_.x() : 0), value(1, upper_y ? num_cells_.y() : 0),
          value(2, 0)};
}

Vec3 SpacePage::left_corner() const {
  const Vec3 along_x = corner_along(0);
  const Vec3 along_y = corner_along(1);
  return view_.at(along_x).x() < view_.at(along_y).x() ? along_x : along_y;
}

std::vector<Vec2> SpacePage::at(std::span<const Vec2> seen) const {
  std::vector<Vec2> page;
  for (const Vec2& p : seen) page.push_back(at(p));
  return page;
}

std::vector<Vec2> SpacePage::at(std::span<const Vec3> points) const { return at(view_.at(points)); }

void SpacePage::draw_floor(std::span<const Vec3> path, Svg& svg) const {
  std::vector<Vec2> from;
  std::vector<Vec2> to;
  for (int axis = 0; axis < 2; ++axis) {
    for (int i = 0; i <= num_cells_[axis]; ++i) {
      Vec3 p(value(0, 0), value(1, 0), value(2, 0));
      p[axis] = value(axis, i);
      from.push_back(at(p));
      p[1 - axis] = value(1 - axis, num_cells_[1 - axis]);
      to.push_back(at(p));
    }
  }
  svg.lines(from, to, stroke(kGridColor, 1.0));
  std::vector<Vec2> shadow;
  for (const Vec3& p : path) shadow.push_back(at(Vec3(p.x(), p.y(), value(2, 0))));
  svg.polyline(shadow, false, stroke(kShadowColor, 2.0));
}

void SpacePage::draw_scales(Svg& svg) const {
  const Vec3 front = front_corner();
  for (int axis = 0; axis < 2; ++axis) {
    const bool is_left = at(corner_along(axis)).x() < at(front).x();
    draw_scale(front, axis, Vec2(is_left ? -10.0 : 10.0, 8.0), svg);
  }
  draw_scale(left_corner(), 2, Vec2(-10.0, 0.0), svg);
}

// Numbers along the line through `from`, `aside` of it, and the axis' name.
void SpacePage::draw_scale(const Vec3& from, int axis, const Vec2& aside, Svg& svg) const {
  const std::string anchor = aside.x() > 0.0 ? " text-anchor=\"start\"" : " text-anchor=\"end\"";
  const int every = num_cells_[axis] > 8 ? 2 : 1;
  const auto on_scale = [&](int i) {
    Vec3 p = from;
    p[axis] = value(axis, i);
    return at(p);
  };
  const Vec2 begin = on_scale(0);
  const Vec2 end = on_scale(num_cells_[axis]);
  svg.line(begin, end, stroke(kFaintInkColor, 1.2));
  const int i_first = axis == 2 ? 1 : 0;  // room for the other scale that begins here
  for (int i = i_first; i <= num_cells_[axis]; ++i) {
    if ((first_[axis] + i) % every != 0) continue;
    svg.line(on_scale(i), on_scale(i) + 0.4 * aside, stroke(kFaintInkColor, 1.0));
    svg.text(on_scale(i) + aside + Vec2(0.0, 4.5), format("%.6g", value(axis, i)),
             font(12, kFaintInkColor) + anchor);
  }
  const Vec2 middle = 0.5 * (begin + end);
  svg.text(axis == 2 ? Vec2(end + Vec2(0.0, -12.0)) : Vec2(middle + 3.8 * aside),
           format("%c [m]", "xyz"[axis]), font(13, kInkColor, true) + " text-anchor=\"middle\"");
}

}  // namespace sopt
