#include "tools/io/arm_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "tests/tools/svg_reader.h"
#include "tools/cli/planner_host.h"
#include "tools/io/arm_shape.h"

namespace sopt {
namespace {

class ArmPictureTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto file = std::filesystem::path(SOPT_SOURCE_DIR) / "tools/scenes/arm/factory.json";
    scene_ = std::get<ArmScene<5>>(load_any_scene(file));
  }

  ArmPicture plan() {
    const PlanRequest<Arm<5>> request = make_request(scene_);
    PlannerHost<Arm<5>> host(scene_, request.options);
    const PlanResult<Arm<5>> result = host.planner().plan(request);
    horizon_ = result.plan ? result.plan->trajectory().horizon() : 0;
    return picture_of(scene_, result, StageTimes{});
  }

  static int count(const std::vector<SvgElement>& elements, const std::string& name,
                   const std::string& attribute, const std::string& value) {
    return static_cast<int>(
        std::count_if(elements.begin(), elements.end(), [&](const SvgElement& element) {
          return element.name == name && element.get(attribute) == value;
        }));
  }
  static std::vector<std::string> texts(const std::vector<SvgElement>& elements) {
    std::vector<std::string> result;
    for (const SvgElement& element : elements) {
      if (element.name == "text") result.push_back(element.text);
    }
    return result;
  }
  static bool has(const std::vector<std::string>& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
  }

  ArmScene<5> scene_;
  int horizon_ = 0;
};

TEST_F(ArmPictureTest, ShowsPosesPathAndScales) {
  const ArmPicture picture = plan();
  ASSERT_GT(horizon_, 0);
  EXPECT_EQ(picture.between.size(), 4U);
  EXPECT_EQ(picture.tool_path.size(), static_cast<std::size_t>(horizon_) + 1);
  const std::string svg = draw(picture);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  const std::vector<SvgElement> elements = read_svg(svg);
  const std::vector<std::string> words = texts(elements);
  EXPECT_EQ(words[0], "factory: ok");
  for (const char* word : {"x [m]", "y [m]", "z [m]", "start, 0 s", "8 obstacles",
                           "in between, darker with time", "tool's path and its shadow"}) {
    EXPECT_TRUE(has(words, word)) << word;
  }
  EXPECT_EQ(count(elements, "g", "opacity", "0.82"), 8);  // obstacles
  const auto dotted = std::find_if(elements.begin(), elements.end(), [](const SvgElement& element) {
    return element.has("stroke-dasharray");
  });
  ASSERT_NE(dotted, elements.end());
  EXPECT_EQ(dotted->points().size(), picture.tool_path.size());
}

TEST_F(ArmPictureTest, EverythingIsOnThePage) {
  const std::vector<SvgElement> elements = read_svg(draw(plan()));
  const double width_px = elements[0].number("width");
  const double height_px = elements[0].number("height");
  EXPECT_GT(height_px, 300.0);
  EXPECT_LT(height_px, 1000.0);
  for (const SvgElement& element : elements) {
    if (element.name != "path") continue;
    for (const Vec2& p : element.points()) {
      EXPECT_GE(p.x(), 0.0);
      EXPECT_LE(p.x(), width_px);
      EXPECT_GE(p.y(), 0.0);
      EXPECT_LE(p.y(), height_px);
    }
  }
}

TEST_F(ArmPictureTest, SamePlanSameBytes) { EXPECT_EQ(draw(plan()), draw(plan())); }

TEST_F(ArmPictureTest, AFailureIsRedAndMarksTheCulprit) {
  scene_.goal = scene_.start;
  scene_.goal[0] = -0.5;  // in the front pillar
  ArmPicture picture = plan();
  EXPECT_EQ(horizon_, 0);
  EXPECT_EQ(picture.i_culprit, 1);
  EXPECT_TRUE(picture.tool_path.empty());
  const std::vector<SvgElement> guilty = read_svg(draw(picture));
  const std::vector<std::string> words = texts(guilty);
  EXPECT_EQ(words[0], "factory: bad_goal");
  EXPECT_NE(words[2].find("front_pillar"), std::string::npos);
  EXPECT_TRUE(has(words, "start"));
  EXPECT_FALSE(has(words, "tool's path and its shadow"));
  EXPECT_GT(count(guilty, "path", "stroke", "#c62828"), 0);
  picture.i_culprit = kNoObstacle;
  EXPECT_EQ(count(read_svg(draw(picture)), "path", "stroke", "#c62828"), 0);
}

TEST_F(ArmPictureTest, FarObstaclesAreCutNotShrinkingTheArm) {
  const ArmPicture picture = plan();
  const std::vector<SvgElement> before = read_svg(draw(picture));
  MemoryBlock memory(World3::required_bytes({2, 0}));
  Arena arena(memory);
  World3 plain(arena, {2, 0});
  plain.reset();
  ASSERT_EQ(plain.try_add(Box3{{Mat3::Identity(), {0, 0, -50.5}}, {1e3, 1e3, 100}}),
            WorldStatus::kOk);
  plain.build();
  ArmPicture far = picture;
  far.world = &plain;
  const auto path_px = [](const std::vector<SvgElement>& elements) {
    double length_px = 0.0;
    for (const SvgElement& element : elements) {
      if (!element.has("stroke-dasharray")) continue;
      const std::vector<Vec2> points = element.points();
      for (std::size_t i = 1; i < points.size(); ++i)
        length_px += (points[i] - points[i - 1]).norm();
    }
    return length_px;
  };
  EXPECT_GT(path_px(read_svg(draw(far))), 0.3 * path_px(before));
}

TEST_F(ArmPictureTest, AnArmWithoutCapsulesAndAnEmptyWorldStillGiveAPage) {
  MemoryBlock memory(World3::required_bytes({1, 0}));
  Arena arena(memory);
  World3 empty(arena, {1, 0});
  empty.reset();
  empty.build();
  ArmPicture picture;
  picture.world = &empty;
  picture.title = "a <title>";
  const std::string svg = draw(picture);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(texts(read_svg(svg))[0], "a <title>");
}

TEST_F(ArmPictureTest, TheToolIsTheLastLinksFarEnd) {
  const auto& arm = scene_.arm;
  ArmPose<5> pose;
  arm.forward(scene_.start, pose);
  const Vec3 tool = tool_point(arm, scene_.start);
  double reach_m = 0.0;
  for (const PlacedCapsule& placed : place_capsules(arm, scene_.start)) {
    if (placed.i_link != 5) continue;
    for (const Vec3& end : {placed.capsule.p0, placed.capsule.p1}) {
      reach_m = std::max(reach_m, (end - pose.X_WJ[5].position).norm());
    }
  }
  EXPECT_NEAR((tool - pose.X_WJ[5].position).norm(), reach_m, 0.05 * reach_m + 1e-12);
  // It is fixed to that link.
  ArmPose<5> other;
  arm.forward(scene_.goal, other);
  const Vec3 moved = tool_point(arm, scene_.goal);
  EXPECT_NEAR((pose.X_WJ[5].rotation.transpose() * (tool - pose.X_WJ[5].position) -
               other.X_WJ[5].rotation.transpose() * (moved - other.X_WJ[5].position))
                  .norm(),
              0.0, 1e-12);
}

}  // namespace
}  // namespace sopt
