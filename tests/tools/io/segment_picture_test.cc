#include "tools/io/segment_picture.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/tools/svg_reader.h"

namespace sopt {
namespace {

class SegmentPictureTest : public ::testing::Test {
 protected:
  void SetUp() override {
    scene_ = load_scene(std::filesystem::path(SOPT_SOURCE_DIR) / "tests/data/three_obstacles.json");
    picture_.scene = &scene_;
    picture_.title = "the first <sweeps>";
    for (int i = 0; i <= 12; ++i) {
      const double s = i / 12.0;
      waypoints_.emplace_back((1.0 - s) * scene_.start + s * scene_.goal);
    }
    whole_ = {.title = "all splits",
              .waypoints = waypoints_,
              .previous = {},
              .splits = {0, 3, 6, 9, 12},
              .window_ends = {}};
    odd_ = {.title = "odd",
            .waypoints = waypoints_,
            .previous = waypoints_,
            .splits = {0, 3, 6, 9, 12},
            .window_ends = {6, 12}};
    even_ = odd_;
    even_.window_ends = {3, 9, 12};
  }
  void draw_panels(std::vector<SegmentPanel> panels) {
    picture_.panels = std::move(panels);
    elements_ = read_svg(draw(picture_));
  }
  [[nodiscard]] std::vector<SvgElement> named(const std::string& name, const std::string& attribute,
                                              const std::string& value) const {
    std::vector<SvgElement> result;
    std::copy_if(elements_.begin(), elements_.end(), std::back_inserter(result),
                 [&](const SvgElement& element) {
                   return element.name == name && element.get(attribute) == value;
                 });
    return result;
  }
  [[nodiscard]] std::vector<SvgElement> windows() const {
    return named("path", "stroke-width", "3.00");
  }
  [[nodiscard]] std::size_t num_dots() const { return named("circle", "r", "2.6").size(); }
  [[nodiscard]] std::size_t num_rings() const { return named("circle", "r", "5.6").size(); }
  [[nodiscard]] bool has_text(const std::string& text) const {
    return std::any_of(elements_.begin(), elements_.end(), [&](const SvgElement& element) {
      return element.name == "text" && element.text == text;
    });
  }

  Scene scene_;
  std::vector<Vec2> waypoints_;
  SegmentPanel whole_, odd_, even_;
  SegmentPicture picture_;
  std::vector<SvgElement> elements_;
};

TEST_F(SegmentPictureTest, WholeTrajectoryIsOneLineWithItsSplits) {
  draw_panels({whole_});
  ASSERT_EQ(windows().size(), 1U);
  EXPECT_EQ(windows()[0].points().size(), 13U);
  EXPECT_EQ(num_dots(), 3U + 1U);  // start and goal have signs of their own; one in the legend
  EXPECT_EQ(num_rings(), 0U);
  EXPECT_TRUE(has_text("the first <sweeps>"));
  EXPECT_TRUE(has_text("all splits"));
  EXPECT_TRUE(has_text("trajectory"));
  EXPECT_TRUE(has_text("split point"));
  EXPECT_FALSE(has_text("before the sweep"));
  EXPECT_FALSE(has_text("fixed during the sweep"));
}

TEST_F(SegmentPictureTest, WindowsJoinAtRingsAndDifferInColour) {
  draw_panels({even_});
  const std::vector<SvgElement> drawn = windows();
  ASSERT_EQ(drawn.size(), 3U);
  EXPECT_EQ(drawn[0].points().size(), 4U);
  EXPECT_EQ(drawn[1].points().size(), 7U);
  EXPECT_EQ(drawn[2].points().size(), 4U);
  EXPECT_NE(drawn[0].get("stroke"), drawn[1].get("stroke"));
  EXPECT_NE(drawn[1].get("stroke"), drawn[2].get("stroke"));
  const std::vector<SvgElement> rings = named("circle", "r", "5.6");
  ASSERT_EQ(rings.size(), 2U + 1U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(drawn[i].points().back(), drawn[i + 1].points().front());
    EXPECT_TRUE(rings[i].vector("cx", "cy").isApprox(drawn[i].points().back(), 1e-3));
  }
  EXPECT_EQ(named("path", "stroke-dasharray", "2 5").size(), 2U);  // the legend's too
  EXPECT_TRUE(has_text("before the sweep"));
  EXPECT_TRUE(has_text("fixed during the sweep"));
}

TEST_F(SegmentPictureTest, PanelsLieSideBySideWithoutOverlap) {
  for (const int columns : {1, 2, 3, 4, 9}) {
    picture_.columns = columns;
    draw_panels({whole_, odd_, even_, odd_});
    const std::vector<SvgElement> bounds = named("rect", "stroke-width", "1.50");
    ASSERT_EQ(bounds.size(), 4U);
    for (std::size_t i = 1; i < 4; ++i) {
      const Vec2 before = bounds[i - 1].vector("x", "y") + bounds[i - 1].vector("width", "height");
      const Vec2 corner = bounds[i].vector("x", "y");
      const bool new_row = static_cast<int>(i) % std::min(columns, 4) == 0;
      EXPECT_GT(new_row ? corner.y() - before.y() : corner.x() - before.x(), 10.0);
      const Vec2 end = corner + bounds[i].vector("width", "height");
      EXPECT_LT(end.x(), elements_[0].number("width"));
      EXPECT_LT(end.y(), elements_[0].number("height"));
    }
    EXPECT_EQ(windows().size(), 1U + 2U + 3U + 2U);
    EXPECT_EQ(num_dots(), 4U * 3U + 2U);
  }
}

TEST_F(SegmentPictureTest, EveryPanelShowsTheScene) {
  draw_panels({whole_});
  const auto num_shapes = [this] { return named("g", "fill", "#a3acb8").size(); };
  EXPECT_EQ(num_shapes(), 1U);
  draw_panels({whole_, odd_, even_});
  EXPECT_EQ(num_shapes(), 3U);
  EXPECT_EQ(std::count_if(elements_.begin(), elements_.end(),
                          [](const SvgElement& element) { return element.text == "S"; }),
            3 + 1);
}

TEST_F(SegmentPictureTest, IgnoresIndicesThatNameNoWaypoint) {
  odd_.window_ends = {-4, 0, 6, 6, 2, 12, 90};
  odd_.splits = {-1, 3, 1000};
  draw_panels({odd_});
  std::size_t num_points = 0;
  for (const SvgElement& window : windows()) num_points += window.points().size() - 1;
  EXPECT_EQ(num_points, 12U);
  EXPECT_EQ(num_dots(), 1U + 2U);  // two in the legend: alone and in a ring
}

TEST_F(SegmentPictureTest, DrawsNoTrajectoryWhereThereIsNone) {
  draw_panels({});
  EXPECT_TRUE(windows().empty());
  draw_panels({{.title = "nothing",
                .waypoints = {},
                .previous = {},
                .splits = {0, 3},
                .window_ends = {3}}});
  EXPECT_TRUE(windows().empty());
  draw_panels({{.title = "a point",
                .waypoints = {scene_.start},
                .previous = {},
                .splits = {0},
                .window_ends = {0}}});
  EXPECT_EQ(draw(picture_).find("nan"), std::string::npos);
}

}  // namespace
}  // namespace sopt
