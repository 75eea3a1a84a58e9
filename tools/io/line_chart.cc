#include "tools/io/line_chart.h"

#include <algorithm>
#include <optional>

#include "tools/io/chart_plot.h"
#include "tools/io/picture_style.h"

namespace sopt {
namespace {

constexpr double kGap_px = 36.0;    // between charts
constexpr double kRight_px = 20.0;  // of the plot: half of the last tick's label
constexpr double kLegendGap_px = 16.0;
constexpr double kNoteRow_px = 20.0;
constexpr int kNoteFont_px = 13;

// Measures that depend on whether a chart has the page for itself.
struct Measures {
  Vec2 plot;  // size
  int title_font_px;
  double plot_top_px;  // below the top of the title
};

using Entries = std::vector<ChartEntry>;

// Of all plots; none where a name or a look means two things.
std::optional<Entries> common_legend(std::span<const ChartPlot> plots) {
  Entries common;
  for (const ChartPlot& plot : plots) {
    for (const ChartEntry& entry : plot.entries()) {
      bool is_known = false;
      for (const ChartEntry& known : common) {
        const bool same_label = known.label == entry.label;
        if (same_label != (known.look == entry.look)) return std::nullopt;
        is_known = is_known || same_label;
      }
      if (!is_known) common.push_back(entry);
    }
  }
  return common;
}

double widest_label_px(std::span<const ChartEntry> entries) {
  double widest = 0.0;
  for (const ChartEntry& entry : entries) {
    widest = std::max(widest, LegendGrid::label_px(entry.label));
  }
  return widest;
}

LegendGrid legend_grid(const Vec2& corner, double width_px, const Entries& entries) {
  return {corner, width_px, widest_label_px(entries), static_cast<int>(entries.size())};
}

void draw_legend(const Entries& entries, LegendGrid grid, Svg& svg) {
  for (const ChartEntry& entry : entries) {
    draw_sample(grid.add(entry.label, svg), LegendGrid::kSample_px, entry.look, svg);
  }
}

// Charts of one size in rows; within each, from the top: title, plot, its labels, legend, notes.
class Page {
 public:
  Page(std::span<const LineChart> charts, int columns)
      : measures_(charts.size() == 1 ? Measures{Vec2(640.0, 400.0), 22, 38.0}
                                     : Measures{Vec2(400.0, 260.0), 16, 30.0}),
        columns_(std::clamp(columns, 1, std::max(1, static_cast<int>(charts.size())))) {
    for (const LineChart& chart : charts) plots_.emplace_back(chart, measures_.plot);
    if (charts.size() > 1) common_legend_ = common_legend(plots_);
    for (const ChartPlot& plot : plots_) left_px_ = std::max(left_px_, plot.left_px());
    cell_.x() = left_px_ + measures_.plot.x() + kRight_px;
    for (const ChartPlot& plot : plots_) cell_.x() = std::max(cell_.x(), width_px(plot));
    for (const ChartPlot& plot : plots_) cell_.y() = std::max(cell_.y(), height_px(plot));
    const int num_rows = (static_cast<int>(charts.size()) + columns_ - 1) / columns_;
    size_ = Vec2(columns_ * (cell_.x() + kGap_px) - kGap_px, num_rows * (cell_.y() + kGap_px)) +
            Vec2(2.0 * kPad_px, 2.0 * kPad_px - kGap_px);
    if (!common_legend_) return;
    size_.x() = std::max(size_.x(),
                         2.0 * kPad_px + LegendGrid::column_px(widest_label_px(*common_legend_)));
    common_legend_top_px_ = size_.y() - kPad_px + kGap_px - 10.0;
    size_.y() = common_legend_top_px_ + kPad_px +
                legend_grid(Vec2::Zero(), size_.x() - 2.0 * kPad_px, *common_legend_).height_px();
  }

  [[nodiscard]] std::string draw() const {
    Svg svg(size_.x(), size_.y());
    svg.rectangle(Vec2::Zero(), size_, fill("white"));
    for (std::size_t i = 0; i < plots_.size(); ++i) {
      const int row = static_cast<int>(i) / columns_;
      const int column = static_cast<int>(i) % columns_;
      draw_cell(
          plots_[i],
          Vec2(kPad_px + column * (cell_.x() + kGap_px), kPad_px + row * (cell_.y() + kGap_px)),
          svg);
    }
    if (common_legend_) {
      const Vec2 corner(kPad_px, common_legend_top_px_);
      draw_legend(*common_legend_, legend_grid(corner, size_.x() - 2.0 * kPad_px, *common_legend_),
                  svg);
    }
    return svg.finish();
  }

 private:
  [[nodiscard]] const Entries& own_legend(const ChartPlot& plot) const {
    static const Entries kNone;
    return common_legend_ ? kNone : plot.entries();
  }
  [[nodiscard]] LegendGrid own_legend_grid(const ChartPlot& plot, const Vec2& corner) const {
    return legend_grid(corner, cell_.x() - left_px_, own_legend(plot));
  }
  [[nodiscard]] double width_px(const ChartPlot& plot) const {
    double width = text_width_px(plot.chart().title, measures_.title_font_px, true);
    for (const std::string& note : plot.chart().notes) {
      width = std::max(width, text_width_px(note, kNoteFont_px));
    }
    return std::max(width, left_px_ + LegendGrid::column_px(widest_label_px(own_legend(plot))));
  }
  [[nodiscard]] double notes_top_px(const ChartPlot& plot) const {
    const double below_plot = measures_.plot_top_px + measures_.plot.y() + ChartPlot::below_px();
    const double legend_px = own_legend_grid(plot, Vec2::Zero()).height_px();
    return below_plot + (legend_px > 0.0 ? kLegendGap_px + legend_px : 0.0);
  }
  [[nodiscard]] double height_px(const ChartPlot& plot) const {
    return notes_top_px(plot) + kNoteRow_px * static_cast<double>(plot.chart().notes.size());
  }

  void draw_cell(const ChartPlot& plot, const Vec2& corner, Svg& svg) const {
    svg.text(corner + Vec2(0.0, 0.75 * measures_.title_font_px), plot.chart().title,
             font(measures_.title_font_px, kInkColor, true));
    const Vec2 plot_corner = corner + Vec2(left_px_, measures_.plot_top_px);
    plot.draw(plot_corner, left_px_, svg);
    const Vec2 legend_corner =
        plot_corner + Vec2(0.0, measures_.plot.y() + ChartPlot::below_px() + kLegendGap_px);
    draw_legend(own_legend(plot), own_legend_grid(plot, legend_corner), svg);
    double baseline = corner.y() + notes_top_px(plot);
    for (const std::string& note : plot.chart().notes) {
      baseline += kNoteRow_px;
      svg.text(Vec2(corner.x(), baseline), note, font(kNoteFont_px, kFaintInkColor));
    }
  }

  Measures measures_;
  int columns_;
  std::vector<ChartPlot> plots_;
  std::optional<Entries> common_legend_;  // none: one below each chart
  double left_px_ = 0.0;                  // of every plot in its cell
  Vec2 cell_ = Vec2::Zero(), size_ = Vec2::Zero();
  double common_legend_top_px_ = 0.0;
};

}  // namespace

std::string draw(const LineChart& chart) { return draw({&chart, 1}, 1); }

std::string draw(std::span<const LineChart> charts, int columns) {
  return Page(charts, columns).draw();
}

}  // namespace sopt
