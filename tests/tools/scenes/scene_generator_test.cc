#include "tools/scenes/scene_generator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "tools/io/scene_file.h"

namespace sopt {
namespace {

class SceneGeneratorTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { scenes() = generate_scenes(); }
  static std::vector<GeneratedScene>& scenes() {
    static std::vector<GeneratedScene> instance;
    return instance;
  }
  static std::filesystem::path shipped(const std::string& file) {
    return std::filesystem::path(SOPT_SOURCE_DIR) / "tools/scenes" / file;
  }
};

GeneratedObstacle wall(double left_m, double bottom_m, double right_m, double top_m) {
  GeneratedObstacle obstacle;
  obstacle.kind = GeneratedObstacle::Kind::kPolygon;
  obstacle.outline_m = {{left_m, bottom_m}, {right_m, bottom_m}, {right_m, top_m}, {left_m, top_m}};
  return obstacle;
}

// 4 m x 4 m, cut by a wall that leaves `gap_m` at the top.
GeneratedScene scene_with_gap(double gap_m) {
  GeneratedScene scene;
  scene.size_m = {4.0, 4.0};
  scene.radius_m = 0.1;
  scene.start_m = {1.0, 1.0};
  scene.goal_m = {3.0, 3.0};
  scene.obstacles.push_back(wall(1.9, -1.0, 2.1, 4.0 - gap_m));
  return scene;
}

TEST_F(SceneGeneratorTest, GeneratedBytesAreTheShippedFiles) {
  for (const GeneratedScene& scene : scenes()) {
    std::ifstream in(shipped(scene.file), std::ios::binary);
    ASSERT_TRUE(in) << scene.file;
    const std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    EXPECT_EQ(bytes, to_json_text(scene)) << scene.file;
  }
}

TEST_F(SceneGeneratorTest, TheBenchmarkFolderHoldsTheGeneratedScenesAndNothingElse) {
  std::set<std::string> generated;
  for (std::size_t i = 0; i < 25; ++i) generated.insert(scenes()[i].file);
  std::set<std::string> found;
  for (const auto& entry : std::filesystem::directory_iterator(shipped("plane"))) {
    found.insert("plane/" + entry.path().filename().string());
  }
  EXPECT_EQ(found, generated);
}

TEST_F(SceneGeneratorTest, GeneratingTwiceGivesTheSameScenes) {
  const std::vector<GeneratedScene> again = generate_scenes();
  ASSERT_EQ(again.size(), scenes().size());
  for (std::size_t i = 0; i < again.size(); ++i) {
    EXPECT_EQ(to_json_text(again[i]), to_json_text(scenes()[i]));
  }
}

TEST_F(SceneGeneratorTest, ThereAre25ScenesWith5To20ObstaclesAndTheLongOne) {
  ASSERT_EQ(scenes().size(), 26U);
  for (std::size_t i = 0; i < 25; ++i) {
    EXPECT_GE(scenes()[i].obstacles.size(), 5U);
    EXPECT_LE(scenes()[i].obstacles.size(), 20U);
    EXPECT_GE(scenes()[i].size_m[0], 20.0);
    EXPECT_LE(scenes()[i].size_m[0], 30.0);
  }
  EXPECT_EQ(scenes().front().obstacles.size(), 5U);
  EXPECT_EQ(scenes()[24].obstacles.size(), 20U);
  EXPECT_EQ(scenes().back().name, "plane_long");
  EXPECT_GE(scenes().back().obstacles.size(), 15U);
}

TEST_F(SceneGeneratorTest, EveryShippedSceneLoadsAsGenerated) {
  for (const GeneratedScene& generated : scenes()) {
    const Scene scene = load_scene(shipped(generated.file));
    EXPECT_EQ(scene.name, generated.name);
    EXPECT_EQ(scene.robot.radius_m, generated.radius_m);
    EXPECT_EQ(scene.start, Vec2(generated.start_m[0], generated.start_m[1]));
    EXPECT_EQ(scene.goal, Vec2(generated.goal_m[0], generated.goal_m[1]));
    EXPECT_EQ(scene.world->num_obstacles(), static_cast<int>(generated.obstacles.size()));
  }
}

TEST_F(SceneGeneratorTest, TheLibraryAgreesThatTheEndsAreClearAndTheLineIsBlocked) {
  for (const GeneratedScene& generated : scenes()) {
    const Scene scene = load_scene(shipped(generated.file));
    constexpr double kFar_m = 100.0;
    for (const Vec2& end : {scene.start, scene.goal}) {
      EXPECT_GE(scene.robot.clearance(*scene.world, end, kFar_m).distance_m, 0.3 - 1e-9)
          << generated.name;
    }
    EXPECT_LT(scene.world->nearest(scene.start, scene.goal, kFar_m).distance_m, 0.0)
        << generated.name;
  }
}

TEST_F(SceneGeneratorTest, ItsPointDistancesAgreeWithTheLibrary) {
  for (const GeneratedScene& generated : scenes()) {
    const Scene scene = load_scene(shipped(generated.file));
    for (int i = 0; i < 400; ++i) {
      // A lattice of irrational slope: no two points on one line with the axes.
      const double x = std::fmod(0.618033988749895 * i, 1.0) * generated.size_m[0];
      const double y = (i + 0.5) / 400.0 * generated.size_m[1];
      double expected_m = std::min({x, y, generated.size_m[0] - x, generated.size_m[1] - y});
      for (const GeneratedObstacle& obstacle : generated.obstacles) {
        expected_m = std::min(expected_m, signed_distance_m(obstacle, x, y));
      }
      const Vec2 point(x, y);
      EXPECT_NEAR(scene.world->nearest(point, point, 100.0).distance_m, expected_m, 1e-9)
          << generated.name << " at " << x << ' ' << y;
    }
  }
}

TEST_F(SceneGeneratorTest, TheFloodPassesAGapThatIsWideEnough) {
  EXPECT_TRUE(is_solvable(scene_with_gap(0.5)));
}

TEST_F(SceneGeneratorTest, TheFloodStopsAtAGapBelowTheInflatedDiameter) {
  EXPECT_FALSE(is_solvable(scene_with_gap(2.0 * (0.1 + 0.05))));
  EXPECT_FALSE(is_solvable(scene_with_gap(0.0)));
}

TEST_F(SceneGeneratorTest, TheFloodRefusesAnEndInAnObstacle) {
  GeneratedScene scene = scene_with_gap(1.0);
  scene.obstacles.push_back(wall(2.8, 2.8, 3.2, 3.2));
  EXPECT_FALSE(is_solvable(scene));
}

}  // namespace
}  // namespace sopt
