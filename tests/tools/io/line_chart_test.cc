#include "tools/io/line_chart.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "tests/tools/svg_reader.h"

namespace sopt {
namespace {

struct Rectangle {
  Vec2 corner, size;
  [[nodiscard]] bool contains(const Vec2& point) const {
    const Vec2 from_corner = point - corner;
    return (from_corner.array() >= -0.01).all() &&
           (from_corner.array() <= size.array() + 0.01).all();
  }
  [[nodiscard]] bool overlaps(const Rectangle& other) const {
    return (corner.array() < (other.corner + other.size).array()).all() &&
           (other.corner.array() < (corner + size).array()).all();
  }
};

class LineChartTest : public ::testing::Test {
 protected:
  static constexpr double kInf = std::numeric_limits<double>::infinity();
  static constexpr const char* kFirstColor = "#0072b2";

  void SetUp() override {
    chart_.title = "a title";
    chart_.x_label = "time, s";
    chart_.y_label = "length, m";
  }
  void add(const std::string& name, std::vector<Vec2> points,
           SeriesStyle style = SeriesStyle::kLine) {
    chart_.series.push_back(
        {.name = name, .points = std::move(points), .style = style, .color = ""});
  }
  void draw_chart() { elements_ = read_svg(draw(chart_)); }

  [[nodiscard]] std::vector<Rectangle> plots() const {
    std::vector<Rectangle> result;
    for (const SvgElement& element : elements_) {
      if (element.name != "rect" || element.get("fill") != "none") continue;
      result.push_back({element.vector("x", "y"), element.vector("width", "height")});
    }
    return result;
  }
  [[nodiscard]] Rectangle plot() const {
    const std::vector<Rectangle> all = plots();
    EXPECT_EQ(all.size(), 1U);
    return all.front();
  }
  [[nodiscard]] std::vector<const SvgElement*> texts(const std::string& text) const {
    std::vector<const SvgElement*> result;
    for (const SvgElement& element : elements_) {
      if (element.name == "text" && element.text == text) result.push_back(&element);
    }
    return result;
  }
  // Of the colour, inside a plot: what is in the legend lies below.
  [[nodiscard]] std::vector<const SvgElement*> drawn(const std::string& name,
                                                     const std::string& color) const {
    std::vector<const SvgElement*> result;
    for (const SvgElement& element : elements_) {
      if (element.name != name || (element.get("stroke") != color && element.get("fill") != color))
        continue;
      const Vec2 at = name == "circle" ? element.vector("cx", "cy") : element.points().front();
      if (plot().contains(at)) result.push_back(&element);
    }
    return result;
  }

  LineChart chart_;
  std::vector<SvgElement> elements_;
};

TEST_F(LineChartTest, ShowsTitleLabelsAndNotesEscaped) {
  chart_.title = "length < 3 & \"short\"";
  chart_.notes = {"first <note>", "second note"};
  add("a & b", {{0, 0}, {1, 1}});
  chart_.references = {{"best <known>", 0.5}};
  draw_chart();
  for (const char* text : {"length < 3 & \"short\"", "time, s", "length, m", "first <note>",
                           "second note", "a & b", "best <known>"}) {
    EXPECT_EQ(texts(text).size(), 1U) << text;
  }
}

TEST_F(LineChartTest, PutsEveryFinitePointInsideThePlot) {
  std::mt19937 generator(1);
  std::normal_distribution<double> normal;
  std::vector<Vec2> points = {{1.0, std::nan("")}, {kInf, 2.0}, {0.5, -kInf}};
  for (int i = 0; i < 200; ++i) points.emplace_back(normal(generator), 1e4 * normal(generator));
  add("p", points, SeriesStyle::kMarkers);
  draw_chart();
  EXPECT_EQ(drawn("circle", kFirstColor).size(), 200U);
  EXPECT_EQ(std::count_if(elements_.begin(), elements_.end(),
                          [](const SvgElement& element) { return element.name == "circle"; }),
            201);  // and the legend's
}

TEST_F(LineChartTest, PlacesPointsByTheirValues) {
  add("p", {{0, 0}, {10, 10}, {2.5, 5}}, SeriesStyle::kMarkers);
  draw_chart();
  const auto circles = drawn("circle", kFirstColor);
  ASSERT_EQ(circles.size(), 3U);
  const Rectangle area = plot();
  const auto position = [&](std::size_t i) -> Vec2 {
    return (circles[i]->vector("cx", "cy") - area.corner).cwiseQuotient(area.size);
  };
  EXPECT_TRUE(position(0).isApprox(Vec2(0.0, 1.0), 1e-3));  // y up
  EXPECT_TRUE(position(1).isApprox(Vec2(1.0, 0.0), 1e-3));
  EXPECT_TRUE(position(2).isApprox(Vec2(0.25, 0.5), 1e-3));
  const auto label = texts("4");  // of both axes
  ASSERT_EQ(label.size(), 2U);
  EXPECT_NEAR(label[0]->number("x"), area.corner.x() + 0.4 * area.size.x(), 0.1);
}

TEST_F(LineChartTest, LogarithmicAxesLeaveOutWhatIsNotPositive) {
  chart_.log_x = chart_.log_y = true;
  add("p", {{1, 1}, {10, 100}, {1000, 1e6}, {0, 5}, {5, 0}, {-1, 5}, {5, -1}},
      SeriesStyle::kMarkers);
  chart_.references = {{"zero", 0.0}};
  draw_chart();
  const auto circles = drawn("circle", kFirstColor);
  ASSERT_EQ(circles.size(), 3U);
  const double third_px = plot().size.x() / 3.0;
  EXPECT_NEAR(circles[1]->number("cx") - circles[0]->number("cx"), third_px, 0.1);
  EXPECT_NEAR(circles[2]->number("cx") - circles[1]->number("cx"), 2.0 * third_px, 0.1);
  EXPECT_TRUE(texts("zero").empty());
}

TEST_F(LineChartTest, NamesWhatItDrawsInALegendBelowThePlot) {
  add("first", {{0, 0}, {1, 1}});
  add("empty", {});
  add("without a finite point", {{kInf, 1}});
  add("last", {{0, 1}, {1, 0}}, SeriesStyle::kMarkers);
  chart_.references = {{"reference", 0.5}, {"not a number", std::nan("")}};
  draw_chart();
  for (const char* name : {"first", "last", "reference"}) {
    ASSERT_EQ(texts(name).size(), 1U) << name;
    EXPECT_GT(texts(name)[0]->number("y"), plot().corner.y() + plot().size.y() + 50.0);
  }
  for (const char* name : {"empty", "without a finite point", "not a number"}) {
    EXPECT_TRUE(texts(name).empty()) << name;
  }
}

TEST_F(LineChartTest, GivesEverySeriesALookOfItsOwn) {
  for (int i = 0; i < 40; ++i) add(std::to_string(1000 + i), {{0, i + 0.5}, {1, i + 0.5}});
  draw_chart();
  std::set<std::string> looks;
  for (const SvgElement& element : elements_) {
    if (element.get("stroke-width") != "2.20" || !plot().contains(element.points()[0])) continue;
    looks.insert(element.get("stroke") + element.get("stroke-dasharray"));
  }
  EXPECT_EQ(looks.size(), 40U);
}

TEST_F(LineChartTest, KeepsLooksWhenAnotherSeriesIsEmpty) {
  add("first", {});
  add("second", {{0, 0}, {1, 1}});
  draw_chart();
  EXPECT_TRUE(drawn("path", kFirstColor).empty());
  EXPECT_EQ(drawn("path", "#d55e00").size(), 1U);
}

TEST_F(LineChartTest, StepsHoldUntilTheNextPoint) {
  add("s", {{0, 10}, {4, 6}, {10, 0}}, SeriesStyle::kSteps);
  draw_chart();
  const auto lines = drawn("path", kFirstColor);
  ASSERT_EQ(lines.size(), 1U);
  const std::vector<Vec2> points = lines[0]->points();
  ASSERT_EQ(points.size(), 5U);
  EXPECT_EQ(points[0].y(), points[1].y());
  EXPECT_EQ(points[1].x(), points[2].x());
  EXPECT_EQ(points[2].y(), points[3].y());
  EXPECT_EQ(points[3].x(), points[4].x());
}

TEST_F(LineChartTest, DrawsALineOfOnePointAsADot) {
  for (const SeriesStyle style : {SeriesStyle::kLine, SeriesStyle::kSteps, SeriesStyle::kMarkers,
                                  SeriesStyle::kLineMarkers}) {
    chart_.series.clear();
    add("p", {{3, 7}}, style);
    draw_chart();
    EXPECT_EQ(drawn("circle", kFirstColor).size(), 1U) << static_cast<int>(style);
    EXPECT_TRUE(drawn("path", kFirstColor).empty());
  }
}

TEST_F(LineChartTest, ThinsMarkersOnLinesButKeepsTheLast) {
  std::vector<Vec2> points;
  for (int i = 0; i <= 1000; ++i) points.emplace_back(i, i % 2);
  for (Vec2& point : points) point.y() *= 1e-6;
  points.front().y() = 100.0;
  add("p", points, SeriesStyle::kLineMarkers);
  draw_chart();
  const auto markers = drawn("circle", kFirstColor);
  EXPECT_LT(markers.size(), 60U);
  EXPECT_GT(markers.size(), 20U);
  EXPECT_NEAR(markers.back()->number("cx"), plot().corner.x() + plot().size.x(), 0.01);
  EXPECT_EQ(drawn("path", kFirstColor)[0]->points().size(), 1001U);
}

TEST_F(LineChartTest, DrawsReferencesAcrossThePlotAndMakesRoomForThem) {
  add("p", {{0, 0}, {1, 10}});
  chart_.references = {{"far below", -10.0}};
  draw_chart();
  int num_found = 0;
  for (const SvgElement& element : elements_) {
    if (element.get("stroke-width") != "1.30") continue;
    const std::vector<Vec2> points = element.points();
    if (!plot().contains(points[0])) continue;
    ++num_found;
    EXPECT_EQ(points[0].y(), points[1].y());
    EXPECT_NEAR(points[1].x() - points[0].x(), plot().size.x(), 0.01);
    ASSERT_EQ(texts("−10").size(), 1U);
    EXPECT_NEAR(texts("−10")[0]->number("y"), points[0].y(), 6.0);
  }
  EXPECT_EQ(num_found, 1);
}

TEST_F(LineChartTest, SaysWhenThereIsNoData) {
  draw_chart();
  EXPECT_EQ(texts("no data").size(), 1U);
  EXPECT_EQ(draw(chart_).find("nan"), std::string::npos);
  elements_ = read_svg(draw({}, 3));
  EXPECT_TRUE(plots().empty());
}

TEST_F(LineChartTest, SurvivesExtremeNumbers) {
  for (const bool is_log : {false, true}) {
    chart_.log_x = chart_.log_y = is_log;
    for (const double size : {1e-320, 1e-300, 1e-12, 1e12, 1e300, 1.7e308}) {
      chart_.series.clear();
      add("p", {{size, size}, {0.5 * size, -size}, {-size, 0.2 * size}, {1.0, 2.0}});
      draw_chart();
      const std::string svg = draw(chart_);
      for (const char* bad : {"nan", "inf", "1000000\""}) {
        EXPECT_EQ(svg.find(bad), std::string::npos) << size << ' ' << bad;
      }
      for (const SvgElement* line : drawn("path", kFirstColor)) {
        for (const Vec2& point : line->points()) EXPECT_TRUE(plot().contains(point)) << size;
      }
    }
  }
}

TEST_F(LineChartTest, LabelsOfTicksDoNotTouch) {
  add("p", {{1e6, 0}, {1e6 + 1, 1}, {1e6 + 0.25, 0.5}});
  draw_chart();
  std::vector<double> centers;
  double widest = 0.0;
  for (const SvgElement& element : elements_) {
    if (element.name != "text" || element.text.find("×") == std::string::npos) continue;
    centers.push_back(element.number("x"));
    widest = std::max(widest, 7.0 * static_cast<double>(element.text.size() - 2));
  }
  ASSERT_GE(centers.size(), 2U);
  for (std::size_t i = 1; i < centers.size(); ++i) EXPECT_GT(centers[i] - centers[i - 1], widest);
}

TEST_F(LineChartTest, ManyChartsLieSideBySideOnOnePage) {
  add("series", {{0, 0}, {1, 1}});
  chart_.notes = {"a note that is a good deal wider than the plot it stands below, for the test"};
  const std::vector<LineChart> charts(5, chart_);
  elements_ = read_svg(draw(charts, 2));
  const std::vector<Rectangle> all = plots();
  ASSERT_EQ(all.size(), 5U);
  const Rectangle page = {Vec2::Zero(), elements_[0].vector("width", "height")};
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_TRUE(page.contains(all[i].corner) && page.contains(all[i].corner + all[i].size));
    for (std::size_t k = 0; k < i; ++k) EXPECT_FALSE(all[i].overlaps(all[k]));
  }
  EXPECT_EQ(all[0].corner.y(), all[1].corner.y());
  EXPECT_EQ(all[0].corner.x(), all[2].corner.x());
  EXPECT_EQ(texts("series").size(), 1U);  // one legend for all
  EXPECT_EQ(texts("a title").size(), 5U);
}

TEST_F(LineChartTest, ChartsWithOtherSeriesHaveLegendsOfTheirOwn) {
  add("series", {{0, 0}, {1, 1}});
  LineChart other = chart_;
  other.series[0].name = "looks the same";
  elements_ = read_svg(draw(std::vector{chart_, chart_, other}, 3));
  EXPECT_EQ(texts("series").size(), 2U);
  EXPECT_EQ(texts("looks the same").size(), 1U);
}

TEST_F(LineChartTest, KeepsTextsOnThePage) {
  const std::string wide(200, 'w');
  chart_.title = chart_.series.emplace_back().name = wide;
  chart_.series[0].points = {{0, 0}, {1, 1}};
  chart_.notes = {wide};
  draw_chart();
  EXPECT_GT(elements_[0].number("width"), 200 * 22 * 0.6);
  EXPECT_EQ(texts(wide).size(), 3U);
  for (const SvgElement* text : texts(wide)) {
    EXPECT_LT(text->number("x"), 150.0);
    EXPECT_LT(text->number("y"), elements_[0].number("height"));
  }
}

}  // namespace
}  // namespace sopt
