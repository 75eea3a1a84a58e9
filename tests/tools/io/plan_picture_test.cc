#include "tools/io/plan_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

namespace sopt {
namespace {

class PlanPictureTest : public ::testing::Test {
 protected:
  void SetUp() override {
    scene_ = load_scene(std::filesystem::path(SOPT_SOURCE_DIR) / "tests/data/three_obstacles.json");
    picture_.scene = &scene_;
    picture_.title = "a <title>";
  }
  static std::size_t count(const std::string& text, const std::string& part) {
    std::size_t n = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
      ++n;
    }
    return n;
  }

  Scene scene_;
  PlanPicture picture_;
};

TEST_F(PlanPictureTest, ShowsOnlyWhatThereIs) {
  const std::string svg = draw(picture_);
  EXPECT_NE(svg.find("a &lt;title&gt;"), std::string::npos);
  EXPECT_NE(svg.find("3 obstacles"), std::string::npos);
  EXPECT_NE(svg.find("2 m</text>"), std::string::npos);  // scale bar
  for (const char* part : {"trees", "sampler's path", "trajectory", "swept"}) {
    EXPECT_EQ(svg.find(part), std::string::npos) << part;
  }
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST_F(PlanPictureTest, DrawsEverySegmentInAColourOtherThanItsNeighbours) {
  for (int i = 0; i <= 8; ++i) picture_.waypoints.emplace_back(1 + i, 5.5);
  picture_.segment_ends = {2, 4, 6, 8};
  picture_.path = {picture_.waypoints.front(), picture_.waypoints.back()};
  picture_.tree_from = {picture_.waypoints[0]};
  picture_.tree_to = {picture_.waypoints[1]};
  const std::string svg = draw(picture_);
  EXPECT_NE(svg.find("trajectory, 4 segments"), std::string::npos);
  EXPECT_NE(svg.find("trees, 1 edges"), std::string::npos);
  EXPECT_EQ(count(svg, "stroke-width=\"3.50\""), 4U);
  EXPECT_EQ(count(svg, "stroke=\"#0072b2\" stroke-width=\"3.50\""), 2U);
  EXPECT_EQ(count(svg, "stroke=\"#e69f00\" stroke-width=\"3.50\""), 1U);
}

TEST_F(PlanPictureTest, FailureIsRedAndMarksTheCulprit) {
  picture_.failure = "start is too close";
  const std::string innocent = draw(picture_);
  picture_.i_culprit = 1;
  const std::string guilty = draw(picture_);
  EXPECT_NE(innocent.find("start is too close"), std::string::npos);
  EXPECT_EQ(count(innocent, "#c62828"), 1U);
  EXPECT_EQ(count(guilty, "#c62828"), 2U);
}

TEST_F(PlanPictureTest, EndsFarOutsideStayOnThePage) {
  scene_.goal = Vec2(1e6, -1e6);
  const std::string svg = draw(picture_);
  EXPECT_NE(svg.find("goal (beyond the frame)"), std::string::npos);
  EXPECT_EQ(svg.find("1000000"), std::string::npos);
}

TEST_F(PlanPictureTest, PagesHaveUsableSizesForEveryShapeOfWorld) {
  for (const auto& [width, height] : {std::array{256.0, 256.0}, std::array{4.0, 12.0},
                                      std::array{1e6, 1e-3}, std::array{1e-3, 1e6}}) {
    ASSERT_EQ(scene_.world->reset({Vec2(0, 0), Vec2(width, height)}), WorldStatus::kOk);
    scene_.world->build();
    scene_.start = Vec2(0.1 * width, 0.1 * height);
    scene_.goal = Vec2(0.9 * width, 0.9 * height);
    const std::string svg = draw(picture_);
    const std::size_t at = svg.find("viewBox=\"0 0 ") + 13;
    std::size_t used = 0;
    const double page_width_px = std::stod(svg.substr(at), &used);
    const double page_height_px = std::stod(svg.substr(at + used));
    EXPECT_GT(page_width_px, 250.0);
    EXPECT_LT(page_width_px, 1100.0);
    EXPECT_GT(page_height_px, 150.0);
    EXPECT_LT(page_height_px, 1100.0);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
  }
}

TEST(SegmentEnds, AreEverySecondSplitAndTheHorizon) {
  EXPECT_EQ(segment_ends(std::array{0, 3, 6, 9, 12}, 12), (std::vector<int>{6, 12}));
  EXPECT_EQ(segment_ends(std::array{0, 3, 6, 12}, 12), (std::vector<int>{6, 12}));
  EXPECT_EQ(segment_ends({}, 5), std::vector<int>{5});
  EXPECT_EQ(segment_ends({}, 0), std::vector<int>{});
}

}  // namespace
}  // namespace sopt
