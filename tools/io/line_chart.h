// Charts as SVG documents: series of points over linear or logarithmic axes, horizontal reference
// lines, legend and notes below the plot, where they cover no data. A series is known by its colour
// (Okabe and Ito's, for colour-blind readers too) and by its dashes or its markers (for print
// without colour), both by its place among the series of its chart.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "models/plane/convex2.h"

namespace sopt {

enum class SeriesStyle {
  kLine,         // dashed, from the second line on
  kSteps,        // as kLine; y holds until the next x
  kMarkers,      // no line
  kLineMarkers,  // solid line; where points crowd not every one has a marker
};

struct ChartSeries {
  std::string name;
  std::vector<Vec2> points;  // joined in this order; those an axis cannot show are left out
  SeriesStyle style = SeriesStyle::kLine;
  std::string color;  // empty: by its place; "#rrggbb" ties a fit to its data
};

struct ReferenceLine {
  std::string label;
  double y = 0.0;
};

struct LineChart {
  std::string title;
  std::string x_label, y_label;  // with units
  bool log_x = false, log_y = false;
  std::vector<ChartSeries> series;  // one without points is neither drawn nor in the legend
  std::vector<ReferenceLine> references;
  std::vector<std::string> notes;  // a line each, below everything
};

// The whole SVG document.
[[nodiscard]] std::string draw(const LineChart& chart);

// Small multiples, row by row, `columns` >= 1. One legend for all charts where each name and each
// look mean the same thing in every chart; else one below each.
[[nodiscard]] std::string draw(std::span<const LineChart> charts, int columns);

}  // namespace sopt
