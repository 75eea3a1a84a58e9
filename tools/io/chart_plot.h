// The plot of one chart: grid, axes with ticks and labels, reference lines, series. What surrounds
// it (title, legend, notes, other charts) is laid out by line_chart.
#pragma once

#include <string>
#include <vector>

#include "tools/io/chart_axis.h"
#include "tools/io/line_chart.h"
#include "tools/io/svg.h"

namespace sopt {

// How a series or a reference line is known in the plot and in the legend.
struct ChartLook {
  std::string color;
  std::string dash;  // stroke-dasharray; empty: solid
  double width_px = 2.2;
  int i_marker = -1;  // -1: none
  bool has_line = true;
  bool operator==(const ChartLook&) const = default;
};

// The sample lies to the right of `left`, `width_px` wide.
void draw_sample(const Vec2& left, double width_px, const ChartLook& look, Svg& svg);

struct ChartEntry {
  std::string label;
  ChartLook look;
};

class ChartPlot {
 public:
  // `chart` is to outlive the plot.
  ChartPlot(const LineChart& chart, const Vec2& size_px);

  [[nodiscard]] const LineChart& chart() const { return *chart_; }
  // What the legend names: series and reference lines that are drawn.
  [[nodiscard]] const std::vector<ChartEntry>& entries() const { return entries_; }
  // Room for labels to the left of the plot and below it.
  [[nodiscard]] double left_px() const;
  [[nodiscard]] static constexpr double below_px() { return 52.0; }

  // `corner` of the plot's rectangle; the y label is centred 14 px right of `corner` - `left_px`.
  void draw(const Vec2& corner, double left_px, Svg& svg) const;

 private:
  [[nodiscard]] std::vector<Vec2> shown(const ChartSeries& series) const;
  [[nodiscard]] std::vector<double> coordinates(int i_axis) const;
  [[nodiscard]] Vec2 at(const Vec2& corner, const Vec2& point) const;
  void choose_looks();

  void draw_grid(const Vec2& corner, Svg& svg) const;
  void draw_axes(const Vec2& corner, double left_px, Svg& svg) const;
  void draw_ticks(const Vec2& origin, Svg& svg) const;
  void draw_series(std::size_t i, const Vec2& corner, Svg& svg) const;

  const LineChart* chart_;
  Vec2 size_;
  ChartAxis x_, y_;
  std::vector<ChartLook> series_looks_, reference_looks_;
  std::vector<ChartEntry> entries_;
};

}  // namespace sopt
