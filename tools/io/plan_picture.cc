#include "tools/io/plan_picture.h"

#include <algorithm>
#include <cstdio>

#include "tools/io/json_fields.h"
#include "tools/io/picture_style.h"
#include "tools/io/plan_file.h"
#include "tools/io/plan_report.h"
#include "tools/io/scene_picture.h"
#include "tools/io/svg.h"

namespace sopt {
namespace {

constexpr double kLegendWidth_px = 236.0;
constexpr double kLegendRow_px = 26.0;
constexpr double kScaleBarHeight_px = 46.0;
constexpr double kWideAspect = 1.5;  // from here on the legend lies below the map

constexpr const char* kTreeColor = "#b9d3e8";

// Where everything is on the page, and the map from world to page.
class Layout {
 public:
  explicit Layout(const PlanPicture& picture)
      : legend_below_(is_wide(view_of(*picture.scene))),
        map_(view_of(*picture.scene), Vec2(kPad_px, picture.failure.empty() ? 84.0 : 110.0),
             legend_below_ ? Vec2(952.0, 640.0) : Vec2(692.0, 860.0)) {
    const double header_px = map_.corner().y();
    const double below_map = header_px + map_.size().y() + kScaleBarHeight_px;
    legend_ = legend_below_ ? Vec2(kPad_px, below_map + 14.0)
                            : Vec2(2.0 * kPad_px + map_.size().x(), header_px);
    const double legend_height = kLegendRow_px * (legend_below_ ? 3.0 : 8.0);
    const double right =
        legend_below_ ? map_.corner().x() + map_.size().x() : legend_.x() + kLegendWidth_px;
    page_ = {std::max(right, widest_text(picture)) + kPad_px,
             std::max(below_map, legend_.y() + legend_height) + 10.0};
  }

  // Corner of legend entry i.
  [[nodiscard]] Vec2 legend_row(int i) const {
    constexpr int kRows = 3;
    if (!legend_below_) return legend_ + Vec2(0.0, kLegendRow_px * i);
    const int i_column = i / kRows;
    return legend_ + Vec2(map_.size().x() / 3.0 * i_column, kLegendRow_px * (i % kRows));
  }
  [[nodiscard]] const SceneMap& map() const { return map_; }
  [[nodiscard]] const Vec2& page() const { return page_; }

 private:
  static bool is_wide(const Aabb2& view) {
    const Vec2 extent = view.upper - view.lower;
    return extent.x() > kWideAspect * extent.y();
  }
  // Right end of the header; widths of letters as in DejaVu Sans, the widest of the fonts.
  static double widest_text(const PlanPicture& picture) {
    const auto width_px = [](const std::string& text, double letter_px) {
      return letter_px * static_cast<double>(text.size());
    };
    return kPad_px + std::max({width_px(picture.title, 15.0), width_px(picture.details, 8.2),
                               width_px(picture.failure, 11.5)});
  }

  bool legend_below_;
  SceneMap map_;
  Vec2 legend_ = Vec2::Zero(), page_ = Vec2::Zero();
};

void draw_trajectory(const PlanPicture& picture, const SceneMap& map, Svg& svg) {
  const std::vector<Vec2> points = map.at(picture.waypoints);
  const double swept_px = 2.0 * map.px(picture.scene->robot.radius_m);
  if (swept_px > 4.0) {
    svg.polyline(points, false, stroke("#0072b2", swept_px) + attribute("stroke-opacity", "0.12"));
  }
  std::size_t first = 0;
  std::vector<Vec2> joints;
  for (std::size_t i = 0; i < picture.segment_ends.size(); ++i) {
    const auto last = static_cast<std::size_t>(picture.segment_ends[i]);
    svg.polyline(std::span(points).subspan(first, last - first + 1), false,
                 stroke(kSegmentColors[i % kSegmentColors.size()], 3.5));
    if (last + 1 < points.size()) joints.push_back(points[last]);
    first = last;
  }
  for (const Vec2& joint : joints) {
    svg.circle(joint, 3.0,
               fill("white") + attribute("stroke", kInkColor) + attribute("stroke-width", "1.2"));
  }
}

class Legend {
 public:
  Legend(const Layout& layout, Svg& svg) : layout_(layout), svg_(svg) {}

  // Left end of a 34 px wide sample, at mid height of its row; the label stands beside it.
  Vec2 add(std::string_view label) {
    const Vec2 row = layout_.legend_row(num_rows_++);
    svg_.text(row + Vec2(44.0, 14.0), label, font(14, kInkColor));
    return row + Vec2(0.0, 9.5);
  }

 private:
  const Layout& layout_;
  Svg& svg_;
  int num_rows_ = 0;
};

void draw_legend(const PlanPicture& picture, const Layout& layout, Svg& svg) {
  constexpr double kWidth_px = 34.0;
  const SceneMap& map = layout.map();
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
    return map.is_beyond(end) ? label + " (beyond the frame)" : label;
  };
  draw_end(legend.add(end_label(start, picture.scene->start)) + middle, 0.0, true, svg);
  draw_end(legend.add(end_label("goal", picture.scene->goal)) + middle, 0.0, false, svg);
  (void)std::snprintf(text, sizeof text, "%d obstacle%s", num_obstacles,
                      num_obstacles == 1 ? "" : "s");
  svg.rectangle(legend.add(text) - Vec2(0.0, 7.0), Vec2(kWidth_px, 14.0), fill(kObstacleColor));
  if (!picture.tree_from.empty()) {
    (void)std::snprintf(text, sizeof text, "trees, %zu edges", picture.tree_from.size());
    const Vec2 at = legend.add(text);
    svg.line(at, at + across, stroke(kTreeColor, 1.5));
  }
  if (!picture.path.empty()) {
    const Vec2 at = legend.add("sampler's path");
    svg.line(at, at + across, stroke(kFaintInkColor, 1.6) + attribute("stroke-dasharray", "2 5"));
  }
  if (picture.waypoints.empty()) return;
  const std::size_t num_segments = picture.segment_ends.size();
  (void)std::snprintf(text, sizeof text, "trajectory, %zu segment%s", num_segments,
                      num_segments == 1 ? "" : "s");
  const Vec2 at = legend.add(text);
  const std::size_t num_shown = std::clamp(num_segments, std::size_t{1}, kSegmentColors.size());
  for (std::size_t i = 0; i < num_shown; ++i) {
    const double length_px = kWidth_px / static_cast<double>(num_shown);
    svg.rectangle(at + Vec2(length_px * static_cast<double>(i), -2.0), Vec2(length_px, 4.0),
                  fill(kSegmentColors[i]));
  }
  if (2.0 * map.px(radius_m) > 4.0) {
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
  const SceneMap& map = layout.map();
  Svg svg(layout.page().x(), layout.page().y());
  svg.rectangle(Vec2::Zero(), layout.page(), fill("white"));
  svg.text(Vec2(kPad_px, 38.0), picture.title, font(22, kInkColor, true));
  svg.text(Vec2(kPad_px, 64.0), picture.details, font(14, kFaintInkColor));
  if (!picture.failure.empty()) {
    svg.text(Vec2(kPad_px, 92.0), picture.failure, font(17, kFailureColor, true));
  }
  svg.begin_clip(map.corner(), map.size());
  svg.lines(map.at(picture.tree_from), map.at(picture.tree_to), stroke(kTreeColor, 0.8));
  draw_obstacles(*picture.scene->world, picture.i_culprit, map, svg);
  if (!picture.waypoints.empty()) draw_trajectory(picture, map, svg);
  svg.polyline(map.at(picture.path), false,
               stroke(kFaintInkColor, 1.6) + attribute("stroke-dasharray", "2 5"));
  svg.end_group();
  draw_bounds(*picture.scene->world, picture.i_culprit, map, svg);
  const double radius_px = map.px(picture.scene->robot.radius_m);
  draw_end(map.at_or_on_frame(picture.scene->start), radius_px, true, svg);
  draw_end(map.at_or_on_frame(picture.scene->goal), radius_px, false, svg);
  draw_scale_bar(map, svg);
  draw_legend(picture, layout, svg);
  return svg.finish();
}

PlanPicture picture_of(const Scene& scene, const Planner<Point2>& planner,
                       const PlanResult<Point2>& result, const StageTimes& times) {
  PlanPicture picture;
  picture.scene = &scene;
  picture.title = printable(scene.name) + ": " + to_string(result.status);
  picture.details = describe_figures(result, times);
  picture.failure = describe_failure<Point2>(scene, result);
  for (int i = 0; i < planner.num_streams(); ++i) {
    const SamplerStream<Point2>& stream = planner.stream(i);
    for (int node = 0; node < stream.num_nodes(); ++node) {
      if (stream.parent(node) < 0) continue;
      picture.tree_from.push_back(stream.node(stream.parent(node)));
      picture.tree_to.push_back(stream.node(node));
    }
  }
  if (result.path != nullptr) {
    picture.path.assign(result.path->vertices.begin(), result.path->vertices.end());
  }
  if (result.plan) {
    const Trajectory<Point2>& trajectory = result.plan->trajectory();
    picture.waypoints.assign(trajectory.states.begin(), trajectory.states.end());
    picture.segment_ends = segment_ends(result.splits, trajectory.horizon());
  } else {
    picture.i_culprit = result.failure.i_obstacle;
  }
  return picture;
}

}  // namespace sopt
