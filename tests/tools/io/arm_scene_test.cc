#include "tools/io/arm_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "models/arm/arm_presets.h"
#include "models/space/pose3.h"
#include "tests/tools/temporary_folder.h"
#include "tools/io/input_error.h"

namespace sopt {
namespace {

using nlohmann::json;

constexpr const char* kPresetScene = R"({
  "name": "five_shapes", "robot": "lr_mate_200id_7l",
  "start": [0, 0.5, 0.5, 0, 0.25], "goal": [1, 0.5, 0.5, 0, 0.25],
  "obstacles": [
    {"type": "box", "id": "crate", "position": [1, 0, 0], "size": [0.2, 0.4, 0.6],
     "quaternion_xyzw": [0, 0, 0.7071, 0.7071]},
    {"type": "cylinder", "position": [0, 1, 0], "radius": 0.1, "height": 0.5},
    {"type": "sphere", "position": [0, -1, 0], "radius": 0.2, "margin": 0.1},
    {"type": "capsule", "p0": [-1, 0, 0], "p1": [-1, 0, 0.5], "radius": 0.1},
    {"type": "hull", "vertices": [[2, 0, 0], [2.5, 0, 0], [2, 0.5, 0], [2, 0, 0.5]]}]
})";

constexpr const char* kRobot = R"({
  "name": "crane", "joints": [
    {"name": "lift", "type": "prismatic", "parent": "floor", "child": "post", "axis": [0, 0, 1],
     "lower": 0, "upper": 0.4, "velocity": 0.1},
    {"name": "turn", "type": "continuous", "parent": "post", "child": "plate", "axis": [0, 0, 1],
     "velocity": 1},
    {"name": "elbow", "type": "revolute", "parent": "plate", "child": "upper", "xyz": [0.3, 0, 0],
     "axis": [0, 1, 0], "lower": -2, "upper": 2, "velocity": 1},
    {"name": "wrist", "type": "revolute", "parent": "upper", "child": "fore", "xyz": [0.3, 0, 0],
     "axis": [0, 1, 0], "lower": -2, "upper": 2, "velocity": 1},
    {"name": "flange", "type": "revolute", "parent": "fore", "child": "hand", "xyz": [0.2, 0, 0],
     "axis": [1, 0, 0], "lower": -3, "upper": 3, "velocity": 1}],
  "capsules": [{"link": "upper", "p0": [0, 0, 0], "p1": [0.3, 0, 0], "radius": 0.05}]
})";

constexpr const char* kFileScene = R"({
  "robot": "my crane", "robot_file": "robots/crane.json",
  "joints": ["lift", "turn", "elbow", "wrist"], "locked_joints": {"flange": 0.5},
  "start": [0, 0, 0, 0], "goal": [0.4, 7, 1, -1], "obstacles": []
})";

class ArmSceneTest : public TemporaryFolderTest {
 protected:
  void SetUp() override {
    TemporaryFolderTest::SetUp();
    std::filesystem::create_directory(folder() / "robots");
    write("robots/crane.json", kRobot);
  }
  [[nodiscard]] AnyScene load(const json& scene) const {
    return load_any_scene(write("scene.json", scene.dump()));
  }
  [[nodiscard]] ArmScene<5> load_preset() const { return std::get<ArmScene<5>>(load(preset_)); }
  [[nodiscard]] ArmScene<4> load_file() const { return std::get<ArmScene<4>>(load(file_)); }

  json preset_ = json::parse(kPresetScene);
  json file_ = json::parse(kFileScene);
};

TEST_F(ArmSceneTest, ReadsEveryShapeInItsOrder) {
  const ArmScene<5> scene = load_preset();
  EXPECT_EQ(scene.name, "five_shapes");
  EXPECT_EQ(scene.robot_name, "lr_mate_200id_7l");
  ASSERT_EQ(scene.world->num_obstacles(), 5);
  EXPECT_EQ(scene.world->obstacle(0).kind, CoreKind::kBox);
  EXPECT_EQ(scene.world->obstacle(1).kind, CoreKind::kCylinder);
  EXPECT_EQ(scene.world->obstacle(1).half_m, Vec3(0.1, 0.1, 0.25));
  EXPECT_EQ(scene.world->obstacle(2).kind, CoreKind::kPoint);
  EXPECT_EQ(scene.world->obstacle(2).center, Vec3(0, -1, 0));
  EXPECT_EQ(scene.world->obstacle(3).kind, CoreKind::kSegment);
  EXPECT_EQ(scene.world->obstacle(3).radius_m, 0.1);
  EXPECT_EQ(scene.world->obstacle(4).kind, CoreKind::kHull);
  EXPECT_EQ(scene.world->obstacle_margin_m(2), 0.1);
  EXPECT_EQ(scene.world->obstacle_margin_m(0), kDefaultMargin);
  EXPECT_EQ(scene.obstacle_ids, (std::vector<std::string>{"crate", "", "", "", ""}));
  EXPECT_EQ(obstacle_name(scene, 0), "obstacle \"crate\"");
  EXPECT_EQ(obstacle_name(scene, 4), "obstacle 4");
}

TEST_F(ArmSceneTest, NormalisesRoundedQuaternions) {
  const ArmScene<5> scene = load_preset();
  const Aabb3& box = scene.world->obstacle_box(0);  // turned by 90 degrees about z
  EXPECT_NEAR((box.lower - Vec3(0.8, -0.1, -0.3)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((box.upper - Vec3(1.2, 0.1, 0.3)).norm(), 0.0, 1e-12);
}

TEST_F(ArmSceneTest, LeavesTheBroadPhaseBuilt) {
  const ArmScene<5> scene = load_preset();
  const Capsule3 near_cylinder{Vec3(0, 0.8, 0), Vec3(0, 0.8, 0), 0.0};
  EXPECT_EQ(scene.world->nearest(near_cylinder, 1.0).i_obstacle, 1);
}

TEST_F(ArmSceneTest, PresetsComeByName) {
  for (const auto& [name, arm] :
       std::map<std::string, Arm<5>>{{"lr_mate_200id_7l", lr_mate_200id_7l()},
                                     {"so101", so_101()},
                                     {"wx250", widowx_250()},
                                     {"xarm5", xarm5()}}) {
    preset_["robot"] = name;
    preset_["start"] = preset_["goal"] = {0, 0, 0, 0, 0};
    const ArmScene<5> scene = load_preset();
    EXPECT_EQ(scene.arm.lower(), arm.lower()) << name;
    EXPECT_EQ(scene.arm.num_capsules(), arm.num_capsules()) << name;
    EXPECT_EQ(scene.joint_names.back(), "joint_5");
    EXPECT_EQ(scene.link_names.front(), "base");
    EXPECT_EQ(scene.link_names.size(), 6U);
  }
}

TEST_F(ArmSceneTest, RobotFilesAreRelativeToTheScene) {
  const ArmScene<4> scene = load_file();
  EXPECT_EQ(scene.name, "scene");
  EXPECT_EQ(scene.robot_name, "my crane");
  EXPECT_EQ(scene.joint_names, (std::vector<std::string>{"lift", "turn", "elbow", "wrist"}));
  EXPECT_EQ(scene.link_names.back(), "fore");
  EXPECT_EQ(scene.goal, Eigen::Vector4d(0.4, 7, 1, -1));
  EXPECT_EQ(scene.world->num_obstacles(), 0);
}

TEST_F(ArmSceneTest, JointsAreTheRobotsOwnWhenTheSceneNamesNone) {
  file_.erase("joints");
  file_.erase("locked_joints");
  file_["start"] = file_["goal"] = {0, 0, 0, 0, 0};
  EXPECT_EQ(std::get<ArmScene<5>>(load(file_)).joint_names.back(), "flange");
}

TEST_F(ArmSceneTest, TheBaseMayStandAHundredMetresAway) {
  preset_["base"] = {{"position", {60, 0, -80}}};
  EXPECT_EQ(load_preset().arm.kinematics().X_WB.position, Vec3(60, 0, -80));
}

TEST_F(ArmSceneTest, TheBaseMovesTheWholeArmAndNothingElse) {
  ArmScene<5> at_origin = load_preset();
  preset_["base"] = {{"position", {1, 2, 3}}, {"quaternion_xyzw", {0, 0.6, 0, 0.8}}};
  const ArmScene<5> moved = load_preset();
  const Pose3 X_WB{Eigen::Quaterniond(0.8, 0, 0.6, 0).toRotationMatrix(), Vec3(1, 2, 3)};
  const Arm<5>::Config q(0.3, -0.2, 0.7, 1.1, -0.4);
  ArmPose<5> pose;
  ArmPose<5> moved_pose;
  at_origin.arm.forward(q, pose);
  moved.arm.forward(q, moved_pose);
  ASSERT_EQ(moved.arm.num_capsules(), at_origin.arm.num_capsules());
  for (int i = 0; i < moved.arm.num_capsules(); ++i) {
    const Capsule3 expected = at_origin.arm.capsule_W(pose, i);
    const Capsule3 found = moved.arm.capsule_W(moved_pose, i);
    EXPECT_NEAR((found.p0 - transform(X_WB, expected.p0)).norm(), 0.0, 1e-14);
    EXPECT_NEAR((found.p1 - transform(X_WB, expected.p1)).norm(), 0.0, 1e-14);
    EXPECT_EQ(found.radius_m, expected.radius_m);
  }
  ASSERT_EQ(moved.arm.self_collision_pairs().size(), at_origin.arm.self_collision_pairs().size());
  for (std::size_t i = 0; i < moved.arm.self_collision_pairs().size(); ++i) {
    const auto& expected = at_origin.arm.self_collision_pairs()[i];
    EXPECT_EQ(moved.arm.self_collision_pairs()[i].i_body_a, expected.i_body_a);
    EXPECT_EQ(moved.arm.self_collision_pairs()[i].i_body_b, expected.i_body_b);
  }
  EXPECT_EQ(moved.arm.upper(), at_origin.arm.upper());
  EXPECT_EQ(moved.world->obstacle(0).center, at_origin.world->obstacle(0).center);
}

TEST_F(ArmSceneTest, ArmsHaveDefaultsOfTheirOwn) {
  const ArmScene<5> scene = load_preset();
  const PlanRequest<Arm<5>> request = make_request(scene);
  EXPECT_EQ(request.options.speed_mps, 1.0);
  EXPECT_EQ(request.options.dt_s, 0.05);
  EXPECT_EQ(request.options.margin_m, 0.02);
  EXPECT_EQ(request.options.min_clearance_m, 1e-4);
  EXPECT_EQ(request.start, scene.start);
  EXPECT_EQ(request.goal, scene.goal);
  EXPECT_EQ(request.world, scene.world.get());
  EXPECT_FALSE(scene.reference_length);
}

TEST_F(ArmSceneTest, OptionalFieldsReachTheRequest) {
  preset_["speed"] = 0.5;
  preset_["dt"] = 0.1;
  preset_["margin"] = 0.03;
  preset_["min_clearance"] = 0.002;
  preset_["start_velocity"] = preset_["goal_velocity"] = {0, 0, 0, 0, 0};
  preset_["reference_length"] = 3.5;
  preset_["obstacles"][1]["velocity"] = {0, 0, 0};
  preset_["obstacles"][1]["x_note"] = "mine";
  const ArmScene<5> scene = load_preset();
  EXPECT_EQ(scene.options.speed_mps, 0.5);
  EXPECT_EQ(scene.options.dt_s, 0.1);
  EXPECT_EQ(scene.options.margin_m, 0.03);
  EXPECT_EQ(scene.options.min_clearance_m, 0.002);
  EXPECT_EQ(scene.reference_length.value(), 3.5);
}

TEST_F(ArmSceneTest, LimitsReplaceTheRobotsWhereTheyAreNumbers) {
  file_["limits"] =
      json::parse(R"({"lower": [0.1, null, null, null], "upper": [null, null, 1, null],
      "v_max": [null, 0.5, null, null], "a_max": [70, null, null, 0.1], "x_note": "slow"})");
  file_["start"] = {0.1, 0, 0, 0};
  file_["base"] = {{"position", {1, 2, 3}}};
  const ArmScene<4> scene = load_file();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(scene.arm.lower(), Eigen::Vector4d(0.1, -kInfinity, -2, -2));
  EXPECT_EQ(scene.arm.upper(), Eigen::Vector4d(0.4, kInfinity, 1, 2));
  EXPECT_EQ(scene.arm.v_max(), Eigen::Vector4d(0.1, 0.5, 1, 1));
  EXPECT_EQ(scene.arm.a_max(), Eigen::Vector4d(70, 5, 5, 0.1));
  EXPECT_EQ(scene.arm.kinematics().X_WB.position, Vec3(1, 2, 3));
  EXPECT_EQ(scene.arm.num_capsules(), 1);
}

TEST_F(ArmSceneTest, WeightsReplaceTheRobotsWhereTheyAreNumbers) {
  EXPECT_EQ(load_file().arm.weights(), Eigen::Vector4d::Ones());
  json robot = json::parse(kRobot);
  robot["joints"][0]["weight"] = 2.5;
  robot["joints"][1]["weight"] = 0.5;
  write("robots/crane.json", robot.dump());
  EXPECT_EQ(load_file().arm.weights(), Eigen::Vector4d(2.5, 0.5, 1, 1));
  file_["joint_weights"] = json::parse("[null, 3, 0.001, 1000]");
  EXPECT_EQ(load_file().arm.weights(), Eigen::Vector4d(2.5, 3, 0.001, 1000));
  file_["base"] = {{"position", {1, 2, 3}}};
  file_["limits"] = json::parse(R"({"v_max": [null, 0.5, null, null]})");
  EXPECT_EQ(load_file().arm.weights(), Eigen::Vector4d(2.5, 3, 0.001, 1000));
}

TEST_F(ArmSceneTest, APresetInPlaceOfTheRobotHasAllItsJoints) {
  file_["start"] = file_["goal"] = {0, 0.1, 0.1, 0, 0};
  const AnyScene scene = load_any_scene(write("scene.json", file_.dump()), "xarm5");
  EXPECT_EQ(std::get<ArmScene<5>>(scene).robot_name, "xarm5");
  EXPECT_EQ(std::get<ArmScene<5>>(scene).arm.v_max(), xarm5().v_max());
}

TEST_F(ArmSceneTest, ARobotFileInPlaceOfTheRobotTakesTheScenesJoints) {
  json robot = json::parse(kRobot);
  robot["name"] = "slow crane";
  robot["joints"][0]["velocity"] = 0.01;
  const std::string slow = write("slow.json", robot.dump());
  const AnyScene any = load_any_scene(write("scene.json", file_.dump()), slow);
  const auto& scene = std::get<ArmScene<4>>(any);
  EXPECT_EQ(scene.robot_name, "slow crane");
  EXPECT_EQ(scene.arm.v_max()[0], 0.01);
  EXPECT_EQ(scene.joint_names.back(), "wrist");
  preset_["start"] = preset_["goal"] = {0, 0, 0, 0, 0};
  const AnyScene of_preset = load_any_scene(write("preset.json", preset_.dump()), slow);
  EXPECT_EQ(std::get<ArmScene<5>>(of_preset).joint_names.back(), "flange");
}

TEST_F(ArmSceneTest, RefusesRobotsThatDoNotFitTheScene) {
  const std::string arm = write("arm.json", file_.dump());
  const std::string plane = data_file("three_obstacles.json");
  const std::string crane = folder() / "robots/crane.json";
  const auto refusal = [](const std::string& scene, const std::string& robot) -> std::string {
    try {
      (void)load_any_scene(scene, robot);
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing was wrong";
  };
  constexpr const char* kArms = "a preset (lr_mate_200id_7l, so101, wx250, xarm5) or a robot file";
  EXPECT_EQ(refusal(plane, "xarm5"),
            "--robot: \"xarm5\" is not allowed; it must be \"point2d\", as " + plane +
                " is of the plane");
  EXPECT_EQ(refusal(arm, "point2d"),
            std::string("--robot: \"point2d\" is not allowed; it must be ") + kArms);
  EXPECT_EQ(refusal(arm, "none.json"),
            std::string("--robot: \"none.json\" is not allowed; it must be ") + kArms);
  EXPECT_EQ(refusal(arm, "xarm5"),
            arm + ": start has 4 elements; it must be an array of 5 numbers, one per free joint");
  file_["joints"][0] = "knee";
  EXPECT_EQ(refusal(write("arm.json", file_.dump()), crane),
            arm + ": --robot, joints and locked_joints do not fit: " + crane +
                ": has no joint \"knee\"; it must be one of lift, turn, elbow, wrist, flange");
  EXPECT_EQ(refusal(plane, "point2d"), "nothing was wrong");
}

TEST_F(ArmSceneTest, EndsBarelyOutsideTheLimitsAreMovedOntoThem) {
  file_["start"] = {-0.9e-5, 0, 2 + 0.9e-5, 0};
  EXPECT_EQ(load_file().start, Eigen::Vector4d(0, 0, 2, 0));
  file_["start"] = {-1.1e-5, 0, 0, 0};
  EXPECT_THROW((void)load_file(), InputError);
}

TEST_F(ArmSceneTest, FullWorldFits) {
  const auto max_obstacles = static_cast<std::size_t>(World3Capacity{}.max_obstacles);
  file_["obstacles"] = std::vector<json>(max_obstacles, preset_["obstacles"][1]);
  EXPECT_EQ(load_file().world->num_obstacles(), static_cast<int>(max_obstacles));
}

TEST_F(ArmSceneTest, TooManyObstaclesAreRefused) {
  file_["obstacles"] = std::vector<json>(1025, preset_["obstacles"][1]);
  try {
    (void)load_file();
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(),
              (folder() / "scene.json").string() +
                  ": obstacles has 1025 elements; it must be an array of at most 1024 obstacles");
  }
}

TEST_F(ArmSceneTest, TooManyHullsAreRefused) {
  file_["obstacles"] = std::vector<json>(129, preset_["obstacles"][4]);
  try {
    (void)load_file();
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(), (folder() / "scene.json").string() +
                                ": obstacles[128].vertices is one too many; it must be among at "
                                "most 128 hulls");
  }
}

TEST_F(ArmSceneTest, PlanarScenesAreStillRead) {
  const AnyScene scene = load_any_scene(data_file("three_obstacles.json"));
  EXPECT_EQ(std::get<Scene>(scene).world->num_obstacles(), 3);
}

TEST_F(ArmSceneTest, EveryRuleIsNamedInOneLine) {
  const json cases = json::parse(read_file(data_file("bad_arm_scenes.json")));
  for (const json& bad : cases) {
    const json& good = bad["base"] == "file" ? file_ : preset_;
    std::string line = "nothing was wrong";
    try {
      (void)load(good.patch(bad["patch"]));
    } catch (const InputError& error) {
      line = error.what();
    }
    for (auto at = line.find(folder()); at != std::string::npos; at = line.find(folder())) {
      line.erase(at, folder().string().size() + 1);
    }
    EXPECT_EQ(line, bad["line"]) << bad["case"];
  }
  EXPECT_GE(cases.size(), 50U);
}

TEST_F(ArmSceneTest, SharedArmScenesLoadUnchanged) {
  const std::filesystem::path shared =
      std::filesystem::path(SOPT_SOURCE_DIR) / "../shared/data/scenes";
  if (!std::filesystem::is_directory(shared)) GTEST_SKIP() << shared << " is absent";
  std::map<std::size_t, int> num_scenes;  // by the number of joints
  for (const auto& entry : std::filesystem::directory_iterator(shared)) {
    const json file = json::parse(read_file(entry.path()));
    if (file.contains("configuration")) {
      EXPECT_THROW((void)load_any_scene(entry.path()), InputError) << entry.path();
      continue;
    }
    const AnyScene any = load_any_scene(entry.path());
    if (file["robot"] == "point2d") continue;
    std::visit(
        [&](const auto& scene) {
          if constexpr (!std::is_same_v<std::decay_t<decltype(scene)>, Scene>) {
            ++num_scenes[scene.joint_names.size()];
            EXPECT_EQ(scene.world->num_obstacles(), file["num_obstacles"]) << entry.path();
            EXPECT_TRUE(scene.arm.within_limits(scene.start)) << entry.path();
            EXPECT_TRUE(scene.arm.within_limits(scene.goal)) << entry.path();
            EXPECT_EQ(scene.reference_length.value(), file["reference_length"]);
            EXPECT_EQ(scene.joint_names, file["joints"]);
          }
        },
        any);
  }
  EXPECT_EQ(num_scenes, (std::map<std::size_t, int>{{5, 7}, {6, 7}, {7, 7}, {8, 7}}));
}

}  // namespace
}  // namespace sopt
