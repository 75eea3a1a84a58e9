#include "tools/io/chart_plot.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <iterator>

#include "tools/io/picture_style.h"

namespace sopt {
namespace {

constexpr const char* kGridColor = "#e1e5ea";
constexpr const char* kMinorGridColor = "#f2f4f6";
constexpr std::array<const char*, 8> kColors = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                "#e69f00", "#56b4e9", "#1f2933", "#8a7a00"};
// Five and seven have no factor in common with the eight colours: no two series look alike.
constexpr std::array<const char*, 5> kDashes = {"", "8 6", "0.5 5", "10 5.5 0.5 5.5", "18 6"};
constexpr int kNumMarkers = 7;
constexpr std::array<const char*, 3> kReferenceDashes = {"5 4", "0.5 4", "9 4 0.5 4"};

constexpr int kTickFont_px = 13;
constexpr int kLabelFont_px = 14;

std::string line_style(const ChartLook& look) {
  return stroke(look.color, look.width_px) +
         (look.dash.empty() ? "" : attribute("stroke-dasharray", look.dash));
}

void draw_marker(const Vec2& at, const ChartLook& look, Svg& svg) {
  const std::string filled =
      fill(look.color) + attribute("stroke", "white") + attribute("stroke-width", "0.8");
  const auto polygon = [&](std::span<const Vec2> corners) {
    std::vector<Vec2> points(corners.begin(), corners.end());
    for (Vec2& point : points) point += at;
    svg.polyline(points, true, filled);
  };
  const auto strokes = [&](const Vec2& arm) {
    const Vec2 across(-arm.y(), arm.x());
    svg.lines(std::array{Vec2(at - arm), Vec2(at - across)},
              std::array{Vec2(at + arm), Vec2(at + across)}, stroke(look.color, 2.0));
  };
  switch (look.i_marker) {
    case 0:
      return svg.circle(at, 4.2, filled);
    case 1:
      return polygon(std::array{Vec2(-4, -4), Vec2(4, -4), Vec2(4, 4), Vec2(-4, 4)});
    case 2:
      return polygon(std::array{Vec2(-4.8, 3.8), Vec2(0, -5), Vec2(4.8, 3.8)});
    case 3:
      return polygon(std::array{Vec2(0, -5.6), Vec2(5.6, 0), Vec2(0, 5.6), Vec2(-5.6, 0)});
    case 4:
      return polygon(std::array{Vec2(-4.8, -3.8), Vec2(4.8, -3.8), Vec2(0, 5)});
    case 5:
      return strokes(Vec2(3.4, 3.4));
    case 6:
      return strokes(Vec2(4.6, 0.0));
    default:
      return;
  }
}

}  // namespace

void draw_sample(const Vec2& left, double width_px, const ChartLook& look, Svg& svg) {
  if (look.has_line) svg.line(left, left + Vec2(width_px, 0.0), line_style(look));
  draw_marker(left + Vec2(0.5 * width_px, 0.0), look, svg);
}

ChartPlot::ChartPlot(const LineChart& chart, const Vec2& size_px)
    : chart_(&chart),
      size_(size_px),
      x_(coordinates(0), chart.log_x, static_cast<int>(size_px.x() / 52.0)),
      y_(coordinates(1), chart.log_y, static_cast<int>(size_px.y() / 42.0)) {
  choose_looks();
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    if (shown(chart.series[i]).empty()) continue;
    entries_.push_back({chart.series[i].name, series_looks_[i]});
  }
  for (std::size_t i = 0; i < chart.references.size(); ++i) {
    if (!ChartAxis::can_show(chart.references[i].y, chart.log_y)) continue;
    entries_.push_back({chart.references[i].label, reference_looks_[i]});
  }
}

void ChartPlot::choose_looks() {
  std::size_t num_colors = 0;
  std::size_t num_dashed = 0;
  int num_marked = 0;
  for (const ChartSeries& series : chart_->series) {
    ChartLook look;
    look.color = series.color.empty() ? kColors[num_colors++ % kColors.size()] : series.color;
    look.has_line = series.style != SeriesStyle::kMarkers;
    if (series.style == SeriesStyle::kLine || series.style == SeriesStyle::kSteps) {
      look.dash = kDashes[num_dashed++ % kDashes.size()];
    } else {
      look.i_marker = num_marked++ % kNumMarkers;
    }
    series_looks_.push_back(look);
  }
  for (std::size_t i = 0; i < chart_->references.size(); ++i) {
    reference_looks_.push_back({.color = kInkColor,
                                .dash = kReferenceDashes[i % kReferenceDashes.size()],
                                .width_px = 1.3});
  }
}

double ChartPlot::left_px() const {
  double widest = 0.0;
  for (const Tick& tick : y_.ticks()) {
    widest = std::max(widest, text_width_px(tick.label, kTickFont_px));
  }
  return widest + 36.0;
}

std::vector<Vec2> ChartPlot::shown(const ChartSeries& series) const {
  std::vector<Vec2> points;
  std::copy_if(series.points.begin(), series.points.end(), std::back_inserter(points),
               [this](const Vec2& point) {
                 return ChartAxis::can_show(point.x(), chart_->log_x) &&
                        ChartAxis::can_show(point.y(), chart_->log_y);
               });
  return points;
}

std::vector<double> ChartPlot::coordinates(int i_axis) const {
  std::vector<double> values;
  for (const ChartSeries& series : chart_->series) {
    for (const Vec2& point : shown(series)) values.push_back(point[i_axis]);
  }
  for (const ReferenceLine& line : chart_->references) {
    if (i_axis == 1) values.push_back(line.y);
  }
  return values;
}

Vec2 ChartPlot::at(const Vec2& corner, const Vec2& point) const {
  return corner +
         Vec2(size_.x() * x_.position(point.x()), size_.y() * (1.0 - y_.position(point.y())));
}

void ChartPlot::draw(const Vec2& corner, double left_px, Svg& svg) const {
  draw_grid(corner, svg);
  draw_axes(corner, left_px, svg);
  for (std::size_t i = 0; i < chart_->references.size(); ++i) {
    const double y = chart_->references[i].y;
    if (!ChartAxis::can_show(y, chart_->log_y)) continue;
    const Vec2 left = corner + Vec2(0.0, size_.y() * (1.0 - y_.position(y)));
    svg.line(left, left + Vec2(size_.x(), 0.0), line_style(reference_looks_[i]));
  }
  for (std::size_t i = 0; i < chart_->series.size(); ++i) draw_series(i, corner, svg);
  if (entries_.empty()) {
    svg.text(corner + 0.5 * size_, "no data",
             font(kLabelFont_px, kFaintInkColor) + " text-anchor=\"middle\"");
  }
}

void ChartPlot::draw_grid(const Vec2& corner, Svg& svg) const {
  for (const bool is_minor : {true, false}) {
    std::vector<Vec2> from, to;
    const auto add = [&](const Vec2& begin, const Vec2& along) {
      from.push_back(corner + begin);
      to.push_back(corner + begin + along);
    };
    for (const Tick& tick : x_.ticks()) {
      if (tick.label.empty() != is_minor) continue;
      add(Vec2(size_.x() * x_.position(tick.value), 0.0), Vec2(0.0, size_.y()));
    }
    for (const Tick& tick : y_.ticks()) {
      if (tick.label.empty() != is_minor) continue;
      add(Vec2(0.0, size_.y() * (1.0 - y_.position(tick.value))), Vec2(size_.x(), 0.0));
    }
    svg.lines(from, to, stroke(is_minor ? kMinorGridColor : kGridColor, 1.0));
  }
  svg.rectangle(corner, size_, stroke(kGridColor, 1.0));
}

void ChartPlot::draw_axes(const Vec2& corner, double left_px, Svg& svg) const {
  const Vec2 origin = corner + Vec2(0.0, size_.y());
  draw_ticks(origin, svg);
  svg.polyline(std::array{corner, origin, Vec2(corner + size_)}, false, stroke(kInkColor, 1.5));
  const std::string centred = font(kLabelFont_px, kInkColor) + " text-anchor=\"middle\"";
  svg.text(origin + Vec2(0.5 * size_.x(), 46.0), chart_->x_label, centred);
  char turned[80];
  (void)std::snprintf(turned, sizeof turned, "transform=\"translate(%.2f %.2f) rotate(-90)\"",
                      corner.x() - left_px + 14.0, corner.y() + 0.5 * size_.y());
  svg.begin_group(turned);
  svg.text(Vec2::Zero(), chart_->y_label, centred);
  svg.end_group();
}

void ChartPlot::draw_ticks(const Vec2& origin, Svg& svg) const {
  const std::string tick_font = font(kTickFont_px, kInkColor);
  std::vector<Vec2> from, to;
  double free_from_px = 0.0;  // where the next label may begin
  for (const Tick& tick : x_.ticks()) {
    from.emplace_back(origin + Vec2(size_.x() * x_.position(tick.value), 0.0));
    to.emplace_back(from.back() + Vec2(0.0, tick.label.empty() ? 3.0 : 6.0));
    const double half_px = 0.5 * text_width_px(tick.label, kTickFont_px);
    if (tick.label.empty() || from.back().x() - half_px < free_from_px) continue;
    free_from_px = from.back().x() + half_px + 8.0;
    svg.text(from.back() + Vec2(0.0, 21.0), tick.label, tick_font + " text-anchor=\"middle\"");
  }
  for (const Tick& tick : y_.ticks()) {
    from.emplace_back(origin - Vec2(0.0, size_.y() * y_.position(tick.value)));
    to.emplace_back(from.back() - Vec2(tick.label.empty() ? 3.0 : 6.0, 0.0));
    if (tick.label.empty()) continue;
    svg.text(from.back() + Vec2(-10.0, 4.6), tick.label, tick_font + " text-anchor=\"end\"");
  }
  svg.lines(from, to, stroke(kInkColor, 1.0));
}

void ChartPlot::draw_series(std::size_t i, const Vec2& corner, Svg& svg) const {
  constexpr double kMarkerSpacing_px = 14.0;
  const ChartLook& look = series_looks_[i];
  const bool is_steps = chart_->series[i].style == SeriesStyle::kSteps;
  std::vector<Vec2> points, corners;
  for (const Vec2& point : shown(chart_->series[i])) {
    points.push_back(at(corner, point));
    if (is_steps && points.size() > 1) {
      corners.emplace_back(points.back().x(), points[points.size() - 2].y());
    }
    corners.push_back(points.back());
  }
  if (look.has_line && points.size() > 1) svg.polyline(corners, false, line_style(look));
  if (look.has_line && look.i_marker < 0 && points.size() == 1) {
    svg.circle(points[0], 3.0, fill(look.color));  // a line of one point would not show
  }
  Vec2 previous(-1e9, -1e9);
  for (const Vec2& point : points) {
    if (look.i_marker < 0) break;
    const bool is_crowded = look.has_line && (point - previous).norm() < kMarkerSpacing_px;
    if (is_crowded && &point != &points.back()) continue;
    draw_marker(point, look, svg);
    previous = point;
  }
}

}  // namespace sopt
