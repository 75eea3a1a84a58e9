// Requests of an arm that cannot be planned, as the program answers them: which joint, link and
// obstacle it is, by how much, and what is allowed.
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/system/program.h"

namespace sopt {
namespace {

using nlohmann::json;

// A ball of 50 mm on the axis of the first link's capsule, whose radius is 68 mm.
constexpr const char* kInTheArm =
    R"({"type": "sphere", "id": "lump", "position": [0.05, 0, 0.3], "radius": 0.05})";

class ArmBadInputTest : public ProgramTest {
 protected:
  // The plan file of a scene that the planner refuses.
  json refused(const std::string& status, const std::string& line) {
    write("scene.json", scene_.dump());
    const ProgramRun result = run("plan scene.json -o plan.json");
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_EQ(result.err, "");
    EXPECT_EQ(result.out.rfind(status + "  ", 0), 0U) << result.out;
    EXPECT_NE(result.out.find("  reason        " + line + "\n"), std::string::npos) << result.out;
    const json plan = json::parse(read("plan.json"));
    EXPECT_EQ(plan["status"], status);
    return plan["failure"];
  }
  void expect_error(const std::string& arguments, const std::string& line) {
    write("scene.json", scene_.dump());
    const ProgramRun result = run(arguments);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.err, "sopt: " + line + "\n");
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(files(), std::set<std::string>{"scene.json"});
  }

  json scene_ = json::parse(R"({"robot": "lr_mate_200id_7l", "start": [0, 0, 0, 0, 0],
                                "goal": [1, 0, 0, 0, 0], "obstacles": []})");
};

TEST_F(ArmBadInputTest, StartInAnObstacleNamesLinkObstacleAndDepth) {
  scene_["obstacles"].push_back(json::parse(kInTheArm));
  const json failure = refused("bad_start",
                               "start is closer than min_clearance: clearance -0.118 m of link "
                               "link_2 from obstacle \"lump\", at least 0.00012002 m needed");
  EXPECT_EQ(failure["link"], 2);
  EXPECT_EQ(failure["obstacle"], "lump");
  EXPECT_NEAR(failure["amount"].get<double>(), -0.118, 1e-12);
}

TEST_F(ArmBadInputTest, GoalInAnObstacleNamesLinkObstacleAndDepth) {
  scene_["start"][0] = 3.14159265358979323846 / 2;
  scene_["goal"][0] = 0;
  scene_["obstacles"].push_back(json::parse(kInTheArm));
  scene_["obstacles"][0]["position"] = {0.3, 0, 0.475};
  const json failure = refused("bad_goal",
                               "goal is closer than min_clearance: clearance -0.11 m of link "
                               "link_4 from obstacle \"lump\", at least 0.00012002 m needed");
  EXPECT_EQ(failure["obstacle"], "lump");
}

TEST_F(ArmBadInputTest, EndsInSelfCollisionNameBothLinksAndTheDepth) {
  const json folded = {0, 2.5, -1.2, 0, 0};
  const std::string line =
      " is in self-collision: clearance -0.0189383 m of link link_4 from link link_1, "
      "at least 0.0001 m needed";
  scene_["start"] = folded;
  json failure = refused("bad_start", "start" + line);
  EXPECT_EQ(failure["link"], 4);
  EXPECT_EQ(failure["other_link"], 1);
  EXPECT_EQ(failure["obstacle"], "self");
  std::swap(scene_["start"], scene_["goal"]);
  failure = refused("bad_goal", "goal" + line);
  EXPECT_EQ(failure["other_link"], 1);
}

TEST_F(ArmBadInputTest, EndsOutsideTheLimitsNameJointValueAndLimits) {
  const std::string limits = "from -2.9670597283903604 to 2.9670597283903604, the limits of joint ";
  scene_["start"][0] = 3.5;
  expect_error("plan scene.json -o plan.json",
               "scene.json: start[0] is 3.5; it must be " + limits + "joint_1");
  scene_["start"][0] = 0;
  scene_["goal"][0] = -3.5;
  expect_error("plan scene.json -o plan.json",
               "scene.json: goal[0] is -3.5; it must be " + limits + "joint_1");
}

TEST_F(ArmBadInputTest, AnotherRobotMustHaveAsManyJoints) {
  scene_["start"] = {0, 0, 0, 0};
  expect_error("plan scene.json --robot xarm5 -o plan.json",
               "scene.json: start has 4 elements; it must be an array of 5 numbers, one per free "
               "joint");
  expect_error("plan scene.json --robot spot.json -o plan.json",
               "--robot: \"spot.json\" is not allowed; it must be a preset (lr_mate_200id_7l, "
               "so101, wx250, xarm5) or a robot file");
}

TEST_F(ArmBadInputTest, PlansOfAnotherRobotVerifyWithThatRobotAlone) {
  write("scene.json", scene_.dump());
  ASSERT_EQ(run("plan scene.json --robot xarm5 -o plan.json").exit_code, 0);
  EXPECT_EQ(json::parse(read("plan.json"))["robot"], "xarm5");
  EXPECT_EQ(run("verify scene.json plan.json --robot xarm5").exit_code, 0);
  const ProgramRun own = run("verify scene.json plan.json");
  EXPECT_EQ(own.exit_code, 2);
  EXPECT_EQ(own.err,
            "sopt: plan.json: robot is \"xarm5\"; it must be \"lr_mate_200id_7l\", the robot of "
            "the scene\n");
}

TEST_F(ArmBadInputTest, LimitsOfTheSceneHoldInThePlan) {
  scene_["limits"] = json::parse(R"({"v_max": [0.1, null, null, null, null]})");
  write("scene.json", scene_.dump());
  ASSERT_EQ(run("plan scene.json -o plan.json").exit_code, 0);
  const json plan = json::parse(read("plan.json"));
  ASSERT_GT(plan["states"].size(), 10U);
  for (const json& state : plan["states"]) {
    EXPECT_LE(std::abs(state[5].get<double>()), 0.1 + 1e-9);
  }
  scene_.erase("limits");
  write("scene.json", scene_.dump());
  ASSERT_EQ(run("plan scene.json -o fast.json").exit_code, 0);
  scene_["limits"] = json::parse(R"({"v_max": [0.1, null, null, null, null]})");
  write("scene.json", scene_.dump());
  const ProgramRun fast = run("verify scene.json fast.json");
  EXPECT_EQ(fast.exit_code, 1);
  EXPECT_EQ(fast.out.rfind("rejected  ", 0), 0U) << fast.out;
}

// Around the obstacles with little of the joint that is dear, with a lot of it where it is cheap.
TEST_F(ArmBadInputTest, JointsThatWeighMoreMoveLess) {
  std::ifstream(std::string(SOPT_SOURCE_DIR) + "/tools/scenes/arm/arm_8_03.json") >> scene_;
  const auto travel_at = [&](double weight) {
    scene_["joint_weights"] = {weight, nullptr, 1, 1, 1};
    write("scene.json", scene_.dump());
    EXPECT_EQ(run("plan scene.json -o plan.json").exit_code, 0);
    EXPECT_EQ(run("verify scene.json plan.json").exit_code, 0);
    double travel = 0.0;
    const json states = json::parse(read("plan.json"))["states"];
    for (std::size_t t = 1; t < states.size(); ++t) {
      travel += std::abs(states[t][0].get<double>() - states[t - 1][0].get<double>());
    }
    return travel;
  };
  EXPECT_LT(travel_at(10.0), 0.7 * travel_at(0.1));
}

}  // namespace
}  // namespace sopt
