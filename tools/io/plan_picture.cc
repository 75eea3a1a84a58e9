#include "tools/io/plan_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "tools/io/json_fields.h"
#include "tools/io/svg.h"

namespace sopt {
namespace {

constexpr double kPad_px = 24.0;
constexpr double kLegendWidth_px = 236.0;
constexpr double kLegendRow_px = 26.0;
constexpr double kScaleBarHeight_px = 46.0;
constexpr double kWideAspect = 1.5;  // from here on the legend lies below the map

constexpr const char* kInk = "#1f2933";
constexpr const char* kObstacle = "#a3acb8";
constexpr const char* kTree = "#b9d3e8";
constexpr const char* kPath = "#52606d";
constexpr const char* kFailure = "#c62828";
constexpr const char* kStart = "#009e73";
constexpr const char* kGoal = "#d55e00";
constexpr std::array<const char*, 3> kSegments = {"#0072b2", "#e69f00", "#cc79a7"};

std::string attribute(const char* name, std::string_view value) {
  return std::string(name) + "=\"" + std::string(value) + "\" ";
}
std::string fill(std::string_view color) { return attribute("fill", color); }
std::string stroke(std::string_view color, double width_px) {
  char width[32];
  (void)std::snprintf(width, sizeof width, "%.2f", width_px);
  return "fill=\"none\" stroke-linejoin=\"round\" stroke-linecap=\"round\" " +
         attribute("stroke", color) + attribute("stroke-width", width);
}
std::string font(int size_px, std::string_view color, bool bold = false) {
  return attribute("font-size", std::to_string(size_px)) + fill(color) +
         (bold ? "font-weight=\"bold\"" : "");
}

// Where everything is on the page, and the map from world to page.
class Layout {
 public:
  explicit Layout(const PlanPicture& picture) : view_(view_of(*picture.scene)) {
    const Vec2 extent = view_.upper - view_.lower;
    legend_below_ = extent.x() > kWideAspect * extent.y();
    const Vec2 room = legend_below_ ? Vec2(952.0, 640.0) : Vec2(692.0, 860.0);
    scale_ = (room.array() / extent.array()).minCoeff();
    map_size_ = scale_ * extent;
    const double header_px = picture.failure.empty() ? 84.0 : 110.0;
    map_corner_ = Vec2(kPad_px, header_px);
    const double below_map = header_px + map_size_.y() + kScaleBarHeight_px;
    legend_ = legend_below_ ? Vec2(kPad_px, below_map + 14.0)
                            : Vec2(2.0 * kPad_px + map_size_.x(), header_px);
    const double legend_height = kLegendRow_px * (legend_below_ ? 3.0 : 8.0);
    const double right =
        legend_below_ ? map_corner_.x() + map_size_.x() : legend_.x() + kLegendWidth_px;
    page_ = {std::max(right, widest_text(picture)) + kPad_px,
             std::max(below_map, legend_.y() + legend_height) + 10.0};
  }

  [[nodiscard]] Vec2 at(const Vec2& world) const {
    return {map_corner_.x() + scale_ * (world.x() - view_.lower.x()),
            map_corner_.y() + scale_ * (view_.upper.y() - world.y())};
  }
  // As `at`, moved onto the map's frame when it lies beyond.
  [[nodiscard]] Vec2 at_or_on_frame(const Vec2& world) const {
    return at(world.cwiseMax(view_.lower).cwiseMin(view_.upper));
  }
  [[nodiscard]] std::vector<Vec2> at(std::span<const Vec2> world) const {
    std::vector<Vec2> page;
    page.reserve(world.size());
    for (const Vec2& point : world) page.push_back(at(point));
    return page;
  }
  [[nodiscard]] bool is_beyond(const Vec2& world) const {
    return (world.array() < view_.lower.array()).any() ||
           (world.array() > view_.upper.array()).any();
  }
  [[nodiscard]] double px(double length_m) const { return scale_ * length_m; }
  // Corner of legend entry i.
  [[nodiscard]] Vec2 legend_row(int i) const {
    constexpr int kRows = 3;
    if (!legend_below_) return legend_ + Vec2(0.0, kLegendRow_px * i);
    const int i_column = i / kRows;
    return legend_ + Vec2(map_size_.x() / 3.0 * i_column, kLegendRow_px * (i % kRows));
  }
  [[nodiscard]] const Vec2& page() const { return page_; }
  [[nodiscard]] const Vec2& map_corner() const { return map_corner_; }
  [[nodiscard]] const Vec2& map_size() const { return map_size_; }

 private:
  // Right end of the header; widths of letters as in DejaVu Sans, the widest of the fonts.
  static double widest_text(const PlanPicture& picture) {
    const auto width_px = [](const std::string& text, double letter_px) {
      return letter_px * static_cast<double>(text.size());
    };
    return kPad_px + std::max({width_px(picture.title, 15.0), width_px(picture.details, 8.2),
                               width_px(picture.failure, 11.5)});
  }

  // The bounds, grown to show a start or goal that lies a little outside.
  static Aabb2 view_of(const Scene& scene) {
    constexpr double kMostGrowth = 0.25;
    const Aabb2& bounds = scene.world->bounds();
    const Vec2 growth = kMostGrowth * (bounds.upper - bounds.lower);
    const Vec2 around = Vec2::Constant(1.5 * scene.robot.radius_m);
    Aabb2 view = bounds;
    for (const Vec2& end : {scene.start, scene.goal}) {
      const bool inside = (end.array() >= bounds.lower.array()).all() &&
                          (end.array() <= bounds.upper.array()).all();
      if (inside) continue;
      view.lower = view.lower.cwiseMin(end - around).cwiseMax(bounds.lower - growth);
      view.upper = view.upper.cwiseMax(end + around).cwiseMin(bounds.upper + growth);
    }
    return view;
  }

  Aabb2 view_;
  double scale_ = 1.0;  // pixels per metre
  bool legend_below_ = false;
  Vec2 map_corner_ = Vec2::Zero(), map_size_ = Vec2::Zero(), legend_ = Vec2::Zero();
  Vec2 page_ = Vec2::Zero();
};

void draw_obstacles(const PlanPicture& picture, const Layout& layout, Svg& svg) {
  const World2& world = *picture.scene->world;
  svg.begin_group(fill(kObstacle));
  for (int i = 0; i < world.num_obstacles(); ++i) {
    const ConvexView shape = world.obstacle(i);
    const std::string culprit =
        i == picture.i_culprit
            ? fill("#f2b8b5") + attribute("stroke", kFailure) + attribute("stroke-width", "2.5")
            : "";
    std::vector<Vec2> outline;
    for (int k = 0; k < shape.num_vertices; ++k) {
      outline.push_back(layout.at(Vec2(shape.x[k], shape.y[k])));
    }
    if (outline.size() == 1) {
      svg.circle(outline[0], layout.px(shape.radius_m), culprit);
    } else {
      svg.polyline(outline, true, culprit);
    }
  }
  svg.end_group();
}

void draw_bounds(const PlanPicture& picture, const Layout& layout, Svg& svg) {
  const Aabb2& bounds = picture.scene->world->bounds();
  const Vec2 corner = layout.at(Vec2(bounds.lower.x(), bounds.upper.y()));
  const Vec2 opposite = layout.at(Vec2(bounds.upper.x(), bounds.lower.y()));
  const bool is_culprit = picture.i_culprit == kBoundsObstacle;
  svg.rectangle(corner, opposite - corner,
                stroke(is_culprit ? kFailure : kInk, is_culprit ? 3.0 : 1.5));
}

void draw_trajectory(const PlanPicture& picture, const Layout& layout, Svg& svg) {
  const std::vector<Vec2> points = layout.at(picture.waypoints);
  const double swept_px = 2.0 * layout.px(picture.scene->robot.radius_m);
  if (swept_px > 4.0) {
    svg.polyline(points, false, stroke("#0072b2", swept_px) + attribute("stroke-opacity", "0.12"));
  }
  std::size_t first = 0;
  std::vector<Vec2> joints;
  for (std::size_t i = 0; i < picture.segment_ends.size(); ++i) {
    const auto last = static_cast<std::size_t>(picture.segment_ends[i]);
    svg.polyline(std::span(points).subspan(first, last - first + 1), false,
                 stroke(kSegments[i % kSegments.size()], 3.5));
    if (last + 1 < points.size()) joints.push_back(points[last]);
    first = last;
  }
  for (const Vec2& joint : joints) {
    svg.circle(joint, 3.0,
               fill("white") + attribute("stroke", kInk) + attribute("stroke-width", "1.2"));
  }
}

void draw_end(const Vec2& at, double radius_px, bool is_start, Svg& svg) {
  const char* const color = is_start ? kStart : kGoal;
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

void draw_scale_bar(const Layout& layout, Svg& svg) {
  const double longest_m = layout.map_size().x() / 3.0 / layout.px(1.0);
  double length_m = std::pow(10.0, std::floor(std::log10(longest_m)));
  if (5.0 * length_m <= longest_m) {
    length_m *= 5.0;
  } else if (2.0 * length_m <= longest_m) {
    length_m *= 2.0;
  }
  char label[32];
  (void)std::snprintf(label, sizeof label, "%g m", length_m);
  const Vec2 left = layout.map_corner() + Vec2(0.0, layout.map_size().y() + 18.0);
  const Vec2 right = left + Vec2(layout.px(length_m), 0.0);
  const std::string style = stroke(kInk, 2.0);
  svg.line(left, right, style);
  for (const Vec2& end : {left, right}) svg.line(end - Vec2(0, 5), end + Vec2(0, 5), style);
  svg.text(0.5 * (left + right) + Vec2(0.0, 19.0), label,
           font(13, kInk) + " text-anchor=\"middle\"");
}

class Legend {
 public:
  Legend(const Layout& layout, Svg& svg) : layout_(layout), svg_(svg) {}

  // Left end of a 34 px wide sample, at mid height of its row; the label stands beside it.
  Vec2 add(std::string_view label) {
    const Vec2 row = layout_.legend_row(num_rows_++);
    svg_.text(row + Vec2(44.0, 14.0), label, font(14, kInk));
    return row + Vec2(0.0, 9.5);
  }

 private:
  const Layout& layout_;
  Svg& svg_;
  int num_rows_ = 0;
};

void draw_legend(const PlanPicture& picture, const Layout& layout, Svg& svg) {
  constexpr double kWidth_px = 34.0;
  const Vec2 across(kWidth_px, 0.0);
  const Vec2 middle(0.5 * kWidth_px, 0.0);
  const int num_obstacles = picture.scene->world->num_obstacles();
  const double radius_m = picture.scene->robot.radius_m;
  char text[80];
  Legend legend(layout, svg);
  std::string start = "start";
  if (radius_m > 0.0) {
    (void)std::snprintf(text, sizeof text, ", robot radius %g m", radius_m);
    start += text;
  }
  const auto end_label = [&](const std::string& label, const Vec2& end) {
    return layout.is_beyond(end) ? label + " (beyond the frame)" : label;
  };
  draw_end(legend.add(end_label(start, picture.scene->start)) + middle, 0.0, true, svg);
  draw_end(legend.add(end_label("goal", picture.scene->goal)) + middle, 0.0, false, svg);
  (void)std::snprintf(text, sizeof text, "%d obstacle%s", num_obstacles,
                      num_obstacles == 1 ? "" : "s");
  svg.rectangle(legend.add(text) - Vec2(0.0, 7.0), Vec2(kWidth_px, 14.0), fill(kObstacle));
  if (!picture.tree_from.empty()) {
    (void)std::snprintf(text, sizeof text, "trees, %zu edges", picture.tree_from.size());
    const Vec2 at = legend.add(text);
    svg.line(at, at + across, stroke(kTree, 1.5));
  }
  if (!picture.path.empty()) {
    const Vec2 at = legend.add("sampler's path");
    svg.line(at, at + across, stroke(kPath, 1.6) + attribute("stroke-dasharray", "2 5"));
  }
  if (picture.waypoints.empty()) return;
  const std::size_t num_segments = picture.segment_ends.size();
  (void)std::snprintf(text, sizeof text, "trajectory, %zu segment%s", num_segments,
                      num_segments == 1 ? "" : "s");
  const Vec2 at = legend.add(text);
  const std::size_t num_shown = std::clamp(num_segments, std::size_t{1}, kSegments.size());
  for (std::size_t i = 0; i < num_shown; ++i) {
    const double length_px = kWidth_px / static_cast<double>(num_shown);
    svg.rectangle(at + Vec2(length_px * static_cast<double>(i), -2.0), Vec2(length_px, 4.0),
                  fill(kSegments[i]));
  }
  if (2.0 * layout.px(radius_m) > 4.0) {
    svg.rectangle(legend.add("swept by the robot") - Vec2(0.0, 7.0), Vec2(kWidth_px, 14.0),
                  fill("#0072b2") + attribute("fill-opacity", "0.12"));
  }
}

}  // namespace

std::vector<int> segment_ends(std::span<const int> splits, int horizon) {
  std::vector<int> ends;
  for (std::size_t i = 2; i < splits.size(); i += 2) {
    if (splits[i] > 0 && splits[i] < horizon) ends.push_back(splits[i]);
  }
  if (horizon > 0) ends.push_back(horizon);
  return ends;
}

std::string draw(const PlanPicture& picture) {
  const Layout layout(picture);
  Svg svg(layout.page().x(), layout.page().y());
  svg.rectangle(Vec2::Zero(), layout.page(), fill("white"));
  svg.text(Vec2(kPad_px, 38.0), picture.title, font(22, kInk, true));
  svg.text(Vec2(kPad_px, 64.0), picture.details, font(14, kPath));
  if (!picture.failure.empty()) {
    svg.text(Vec2(kPad_px, 92.0), picture.failure, font(17, kFailure, true));
  }
  svg.begin_clip(layout.map_corner(), layout.map_size());
  svg.lines(layout.at(picture.tree_from), layout.at(picture.tree_to), stroke(kTree, 0.8));
  draw_obstacles(picture, layout, svg);
  if (!picture.waypoints.empty()) draw_trajectory(picture, layout, svg);
  svg.polyline(layout.at(picture.path), false,
               stroke(kPath, 1.6) + attribute("stroke-dasharray", "2 5"));
  svg.end_group();
  draw_bounds(picture, layout, svg);
  const double radius_px = layout.px(picture.scene->robot.radius_m);
  draw_end(layout.at_or_on_frame(picture.scene->start), radius_px, true, svg);
  draw_end(layout.at_or_on_frame(picture.scene->goal), radius_px, false, svg);
  draw_scale_bar(layout, svg);
  draw_legend(picture, layout, svg);
  return svg.finish();
}

}  // namespace sopt
