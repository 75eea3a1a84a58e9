#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "models/arm/arm_presets.h"
#include "tools/io/arm_scene.h"
#include "tools/scenes/arm_scene_check.h"
#include "tools/scenes/arm_scene_generator.h"

namespace sopt {
namespace {

using Config = Arm<5>::Config;

class ArmScenesTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { scenes() = generate_arm_scenes(); }
  static std::vector<GeneratedArmScene>& scenes() {
    static std::vector<GeneratedArmScene> instance;
    return instance;
  }
  static std::filesystem::path shipped(const std::string& file) {
    return std::filesystem::path(SOPT_SOURCE_DIR) / "tools/scenes" / file;
  }
  static ArmScene<5> load(const GeneratedArmScene& scene) {
    return std::get<ArmScene<5>>(load_any_scene(shipped(scene.file)));
  }
  static Vec3 tip_W(const Arm<5>& arm, const Config& q) {
    ArmPose<5> pose;
    arm.forward(q, pose);
    return pose.X_WJ[5].position;
  }
};

TEST_F(ArmScenesTest, GeneratedBytesAreTheShippedFiles) {
  std::set<std::string> generated;
  for (const GeneratedArmScene& scene : scenes()) {
    generated.insert(scene.file);
    std::ifstream in(shipped(scene.file), std::ios::binary);
    ASSERT_TRUE(in) << scene.file;
    const std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    EXPECT_EQ(bytes, to_json_text(scene)) << scene.file;
  }
  std::set<std::string> found;
  for (const auto& entry : std::filesystem::directory_iterator(shipped("arm"))) {
    found.insert("arm/" + entry.path().filename().string());
  }
  EXPECT_EQ(found, generated);
}

TEST_F(ArmScenesTest, ThereAre20With2ObstaclesAnd20With7To9AndTheFactory) {
  ASSERT_EQ(scenes().size(), 41U);
  std::set<std::uint64_t> seeds;
  for (std::size_t i = 0; i < 40; ++i) {
    const std::size_t num_obstacles = scenes()[i].obstacles.size();
    EXPECT_GE(num_obstacles, i < 20 ? 2U : 7U) << scenes()[i].name;
    EXPECT_LE(num_obstacles, i < 20 ? 2U : 9U) << scenes()[i].name;
    seeds.insert(scenes()[i].seed);
  }
  EXPECT_EQ(seeds.size(), 40U);
  EXPECT_EQ(scenes().back().name, "factory");
}

TEST_F(ArmScenesTest, AllShapesOccur) {
  std::set<std::string> types;
  for (const GeneratedArmScene& scene : scenes()) {
    for (const auto& obstacle : scene.obstacles) types.insert(obstacle["type"]);
  }
  EXPECT_EQ(types, (std::set<std::string>{"box", "capsule", "cylinder", "sphere"}));
}

TEST_F(ArmScenesTest, EndsAreClearAndTheTipTravelsAndTheStraightMotionIsBlocked) {
  for (const GeneratedArmScene& generated : scenes()) {
    const ArmScene<5> scene = load(generated);
    EXPECT_EQ(scene.name, generated.name);
    EXPECT_EQ(scene.start, generated.start);
    EXPECT_EQ(scene.goal, generated.goal);
    const ArmSceneCheck check(scene.arm, *scene.world);
    EXPECT_GE(check.clearance_m(scene.start), 0.03) << scene.name;
    EXPECT_GE(check.clearance_m(scene.goal), 0.03) << scene.name;
    EXPECT_GT((tip_W(scene.arm, scene.goal) - tip_W(scene.arm, scene.start)).norm(), 0.6);
    EXPECT_TRUE(check.motion_is_blocked(scene.start, scene.goal)) << scene.name;
    EXPECT_FALSE(check.motion_is_clear(scene.start, scene.goal, 0.0)) << scene.name;
  }
}

TEST_F(ArmScenesTest, EverySceneIsSolvableWithTheDefaultMargin) {
  for (const GeneratedArmScene& generated : scenes()) {
    const ArmScene<5> scene = load(generated);
    const ArmSceneCheck check(scene.arm, *scene.world);
    EXPECT_TRUE(check.is_solvable(scene.start, scene.goal, PlanOptions::arm().margin_m, 7))
        << scene.name;
  }
}

TEST_F(ArmScenesTest, TheFactoryArmReachesFromOutsideIntoTheCar) {
  const ArmScene<5> scene = load(scenes().back());
  EXPECT_EQ(scene.obstacle_ids.front(), "sill");
  const Vec3 outside = tip_W(scene.arm, scene.start);
  const Vec3 inside = tip_W(scene.arm, scene.goal);
  const double frame_x_m = scene.world->obstacle(1).center.x();
  EXPECT_LT(outside.x(), frame_x_m - 0.1);
  EXPECT_GT(inside.x(), frame_x_m + 0.1);
}

// A wall between two configurations that differ in the first joint only.
class ArmSceneCheckTest : public ::testing::Test {
 protected:
  ArmSceneCheckTest()
      : memory_(World3::required_bytes({4, 1})), arena_(memory_), world_(arena_, {4, 1}) {
    world_.reset();
  }
  void add_wall(double height_m) {
    const Box3 wall{{Mat3::Identity(), {0.7, 0.0, 0.0}}, {0.8, 0.05, height_m}};
    ASSERT_EQ(world_.try_add(wall), WorldStatus::kOk);
    world_.build();
  }

  Arm<5> arm_ = lr_mate_200id_7l();
  MemoryBlock memory_;
  Arena arena_;
  World3 world_;
  // Upper arm and forearm horizontal.
  Config start_{-0.9, 1.5708, 1.5708, 0.0, 0.0};
  Config goal_{0.9, 1.5708, 1.5708, 0.0, 0.0};
};

TEST_F(ArmSceneCheckTest, AWallThatTheArmCanPassOverIsSolvable) {
  add_wall(0.6);
  const ArmSceneCheck check(arm_, world_);
  EXPECT_TRUE(check.motion_is_blocked(start_, goal_));
  EXPECT_FALSE(check.motion_is_clear(start_, goal_, 0.0));
  EXPECT_TRUE(check.is_solvable(start_, goal_, 0.02, 1));
}

TEST_F(ArmSceneCheckTest, ABoxAroundTheGoalIsNotSolvable) {
  ArmPose<5> pose;
  arm_.forward(goal_, pose);
  const Box3 box{{Mat3::Identity(), pose.X_WJ[5].position}, {0.2, 0.2, 0.2}};
  ASSERT_EQ(world_.try_add(box), WorldStatus::kOk);
  world_.build();
  const ArmSceneCheck check(arm_, world_);
  EXPECT_LT(check.clearance_m(goal_), 0.0);
  EXPECT_FALSE(check.is_solvable(start_, goal_, 0.02, 1));
}

TEST_F(ArmSceneCheckTest, AClearMotionKeepsItsMarginAtTenTimesTheResolution) {
  add_wall(0.3);
  const ArmSceneCheck check(arm_, world_);
  const Config up(0.0, 0.0, 0.2, 0.0, 0.0);
  const Config down(1.2, 0.5, 0.5, 1.0, -1.0);
  ASSERT_TRUE(check.motion_is_clear(up, down, 0.05));
  for (int i = 0; i <= 1500; ++i) {
    EXPECT_GE(check.clearance_m(up + i / 1500.0 * (down - up)), 0.05) << i;
  }
}

}  // namespace
}  // namespace sopt
