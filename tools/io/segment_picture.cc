#include "tools/io/segment_picture.h"

#include <algorithm>
#include <functional>
#include <span>

#include "tools/io/picture_style.h"
#include "tools/io/scene_picture.h"

namespace sopt {
namespace {

constexpr double kGap_px = 22.0;         // between panels
constexpr double kPanelTitle_px = 26.0;  // above a map
constexpr double kScaleBar_px = 46.0;
constexpr double kLine_px = 3.0;
constexpr int kTitleFont_px = 22;
constexpr int kDetailsFont_px = 14;
constexpr int kPanelFont_px = 15;
constexpr double kContent_px = 952.0;  // width of a row of panels
constexpr double kMinPanel_px = 220.0;

std::string previous_style() {
  return stroke(kFaintInkColor, 1.4) + attribute("stroke-dasharray", "2 5");
}

void draw_split(const Vec2& at, Svg& svg) { svg.circle(at, 2.6, fill(kInkColor)); }

void draw_fixed_end(const Vec2& at, Svg& svg) {
  svg.circle(at, 5.6,
             fill("white") + attribute("stroke", kInkColor) + attribute("stroke-width", "1.5"));
}

// Those of `indices` between start and goal.
std::vector<std::size_t> interior(const std::vector<int>& indices, std::size_t num_waypoints) {
  std::vector<std::size_t> result;
  for (const int index : indices) {
    if (index <= 0 || static_cast<std::size_t>(index) + 1 >= num_waypoints) continue;
    result.push_back(static_cast<std::size_t>(index));
  }
  return result;
}

void draw_trajectory(const SegmentPanel& panel, const SceneMap& map, Svg& svg) {
  const std::vector<Vec2> points = map.at(panel.waypoints);
  const std::vector<std::size_t> fixed = interior(panel.window_ends, points.size());
  svg.polyline(map.at(panel.previous), false, previous_style());
  std::size_t first = 0;
  for (std::size_t i = 0; i <= fixed.size() && !points.empty(); ++i) {
    const std::size_t last = i < fixed.size() ? fixed[i] : points.size() - 1;
    if (last < first) continue;
    svg.polyline(std::span(points).subspan(first, last - first + 1), false,
                 stroke(kSegmentColors[i % kSegmentColors.size()], kLine_px));
    first = last;
  }
  for (const std::size_t end : fixed) draw_fixed_end(points[end], svg);
  for (const std::size_t split : interior(panel.splits, points.size())) {
    draw_split(points[split], svg);
  }
}

void draw_panel(const Scene& scene, const SegmentPanel& panel, const SceneMap& map, Svg& svg) {
  svg.text(map.corner() - Vec2(0.0, 9.0), panel.title, font(kPanelFont_px, kInkColor, true));
  svg.begin_clip(map.corner(), map.size());
  draw_obstacles(*scene.world, kNoObstacle, map, svg);
  draw_trajectory(panel, map, svg);
  svg.end_group();
  draw_bounds(*scene.world, kNoObstacle, map, svg);
  draw_end(map.at_or_on_frame(scene.start), 0.0, true, svg);
  draw_end(map.at_or_on_frame(scene.goal), 0.0, false, svg);
}

struct Entry {
  std::string label;
  std::function<void(const Vec2& left, Svg& svg)> draw_sample;  // kSample_px wide
};

const Vec2 kAcross(LegendGrid::kSample_px, 0.0);
const Vec2 kMiddle = 0.5 * kAcross;

void draw_colors(const Vec2& left, std::size_t num_colors, Svg& svg) {
  const Vec2 part = kAcross / static_cast<double>(num_colors);
  for (std::size_t i = 0; i < num_colors; ++i) {
    svg.rectangle(left + static_cast<double>(i) * part - Vec2(0.0, 2.0), part + Vec2(0.0, 4.0),
                  fill(kSegmentColors[i]));
  }
}

// Of what the panels show.
std::vector<Entry> legend_of(const std::vector<SegmentPanel>& panels) {
  const auto any = [&](auto member) {
    return std::any_of(panels.begin(), panels.end(),
                       [&](const SegmentPanel& panel) { return !(panel.*member).empty(); });
  };
  const bool has_windows = any(&SegmentPanel::window_ends);
  const bool has_splits = any(&SegmentPanel::splits);
  std::vector<Entry> entries = {
      {"start", [](const Vec2& left, Svg& svg) { draw_end(left + kMiddle, 0.0, true, svg); }},
      {"goal", [](const Vec2& left, Svg& svg) { draw_end(left + kMiddle, 0.0, false, svg); }}};
  if (any(&SegmentPanel::waypoints)) {
    const std::size_t num_colors = has_windows ? kSegmentColors.size() : 1;
    entries.push_back({has_windows ? "trajectory, by window" : "trajectory",
                       [=](const Vec2& left, Svg& svg) { draw_colors(left, num_colors, svg); }});
  }
  if (any(&SegmentPanel::previous)) {
    entries.push_back({"before the sweep", [](const Vec2& left, Svg& svg) {
                         svg.line(left, left + kAcross, previous_style());
                       }});
  }
  if (has_splits) {
    entries.push_back(
        {"split point", [](const Vec2& left, Svg& svg) { draw_split(left + kMiddle, svg); }});
  }
  if (has_windows) {
    entries.push_back({"fixed during the sweep", [=](const Vec2& left, Svg& svg) {
                         draw_fixed_end(left + kMiddle, svg);
                         if (has_splits) draw_split(left + kMiddle, svg);
                       }});
  }
  return entries;
}

// Panels of one size in rows, below them scale bar and legend.
class Layout {
 public:
  Layout(const SegmentPicture& picture, const std::vector<Entry>& entries)
      : view_(view_of(*picture.scene)), num_panels_(static_cast<int>(picture.panels.size())) {
    columns_ = std::clamp(picture.columns, 1, std::max(1, num_panels_));
    const int num_rows = (num_panels_ + columns_ - 1) / columns_;
    room_.x() = std::max(kMinPanel_px, (kContent_px + kGap_px) / columns_ - kGap_px);
    top_px_ = (picture.details.empty() ? 56.0 : 82.0) + kPanelTitle_px;
    const Vec2 map_size = SceneMap(view_, Vec2::Zero(), room_).size();
    pitch_ = map_size + Vec2(kGap_px, kGap_px + kPanelTitle_px);
    double widest_title = std::max(text_width_px(picture.title, kTitleFont_px, true),
                                   text_width_px(picture.details, kDetailsFont_px));
    for (const SegmentPanel& panel : picture.panels) {
      const double title_px = text_width_px(panel.title, kPanelFont_px, true);
      pitch_.x() = std::max(pitch_.x(), title_px + kGap_px);
    }
    double widest_label = 0.0;
    for (const Entry& entry : entries) {
      widest_label = std::max(widest_label, LegendGrid::label_px(entry.label));
    }
    const double width_px = std::max(
        {columns_ * pitch_.x() - kGap_px, widest_title, LegendGrid::column_px(widest_label)});
    const double below_px = top_px_ + num_rows * pitch_.y() - kGap_px - kPanelTitle_px;
    legend_ = LegendGrid(Vec2(kPad_px, below_px + kScaleBar_px + 10.0), width_px, widest_label,
                         static_cast<int>(entries.size()));
    page_ = Vec2(width_px + 2.0 * kPad_px,
                 below_px + kScaleBar_px + 10.0 + legend_.height_px() + 0.5 * kPad_px);
  }

  // Of panel i, row by row.
  [[nodiscard]] SceneMap map(int i) const {
    const int i_row = i / columns_;
    return {view_, Vec2(kPad_px + pitch_.x() * (i % columns_), top_px_ + pitch_.y() * i_row),
            room_};
  }
  // Of the first panel in the last row.
  [[nodiscard]] SceneMap last_row() const {
    return map(num_panels_ == 0 ? 0 : (num_panels_ - 1) / columns_ * columns_);
  }
  [[nodiscard]] const LegendGrid& legend() const { return legend_; }
  [[nodiscard]] const Vec2& page() const { return page_; }

 private:
  Aabb2 view_;
  int num_panels_;
  int columns_ = 1;
  Vec2 room_ = Vec2(0.0, 640.0);
  double top_px_ = 0.0;  // of the first row's maps
  Vec2 pitch_ = Vec2::Zero(), page_ = Vec2::Zero();
  LegendGrid legend_;
};

}  // namespace

std::string draw(const SegmentPicture& picture) {
  const std::vector<Entry> entries = legend_of(picture.panels);
  const Layout layout(picture, entries);
  Svg svg(layout.page().x(), layout.page().y());
  svg.rectangle(Vec2::Zero(), layout.page(), fill("white"));
  svg.text(Vec2(kPad_px, 38.0), picture.title, font(kTitleFont_px, kInkColor, true));
  svg.text(Vec2(kPad_px, 64.0), picture.details, font(kDetailsFont_px, kFaintInkColor));
  for (std::size_t i = 0; i < picture.panels.size(); ++i) {
    draw_panel(*picture.scene, picture.panels[i], layout.map(static_cast<int>(i)), svg);
  }
  draw_scale_bar(layout.last_row(), svg);
  LegendGrid legend = layout.legend();
  for (const Entry& entry : entries) entry.draw_sample(legend.add(entry.label, svg), svg);
  return svg.finish();
}

}  // namespace sopt
