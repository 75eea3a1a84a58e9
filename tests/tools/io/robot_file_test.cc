#include "tools/io/robot_file.h"

#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

#include "models/arm/arm_pairs.h"
#include "models/arm/arm_presets.h"
#include "models/space/pose3.h"
#include "tests/tools/temporary_folder.h"
#include "tools/io/input_error.h"
#include "tools/io/json_text.h"

namespace sopt {
namespace {

constexpr double kPi = 3.14159265358979323846;

std::string message_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing thrown";
}

// base -a-> one -b-> two -c-> three -d-> four, fixed tip; links of 1 m along x.
class RobotFileTest : public TemporaryFolderTest {
 protected:
  void SetUp() override {
    TemporaryFolderTest::SetUp();
    json_ = nlohmann::json::parse(R"({"name": "four", "base_link": "base", "joints": []})");
    const char* const links[] = {"base", "one", "two", "three", "four"};
    for (std::size_t j = 0; j < 4; ++j) {
      json_["joints"].push_back({{"name", std::string(1, static_cast<char>('a' + j))},
                                 {"type", "revolute"},
                                 {"parent", links[j]},
                                 {"child", links[j + 1]},
                                 {"xyz", {j == 0 ? 0.0 : 1.0, 0.0, 0.0}},
                                 {"axis", {0, j == 0 ? 0 : 1, j == 0 ? 1 : 0}},
                                 {"lower", -2.0},
                                 {"upper", 2.0},
                                 {"velocity", 2.0}});
    }
    json_["joints"].push_back({{"name", "tip"},
                               {"type", "fixed"},
                               {"parent", "four"},
                               {"child", "hand"},
                               {"xyz", {1.0, 0.0, 0.0}}});
    for (const char* link : links) {
      json_["capsules"].push_back(
          {{"link", link}, {"p0", {0.1, 0, 0}}, {"p1", {0.9, 0, 0}}, {"radius", 0.05}});
    }
  }
  [[nodiscard]] RobotModel load() const {
    return load_robot_file(write("robot.json", json_.dump()));
  }
  [[nodiscard]] std::string error_of_arm(const JointChoice& choice) const {
    const RobotModel model = load();
    return message_of([&] { (void)make_arm<4>(model, choice); });
  }
  [[nodiscard]] std::string in_file(const std::string& line) const {
    return (folder() / "robot.json").string() + ": " + line;
  }
  void add_joint(const char* name, const char* type, const char* parent, const char* child) {
    json_["joints"].push_back({{"name", name},
                               {"type", type},
                               {"parent", parent},
                               {"child", child},
                               {"xyz", {0.0, 0.0, 0.5}}});
    if (std::string(type) == "fixed") return;
    json_["joints"].back().update(
        {{"axis", {1, 0, 0}}, {"lower", -1.0}, {"upper", 1.0}, {"velocity", 1.0}});
  }

  nlohmann::json json_;
};

TEST_F(RobotFileTest, ReadsTheTree) {
  const RobotModel model = load();
  EXPECT_EQ(model.name, "four");
  EXPECT_EQ(model.links[static_cast<std::size_t>(model.i_root)], "base");
  EXPECT_EQ(model.active_joints, (std::vector<std::string>{"a", "b", "c", "d"}));
  EXPECT_EQ(model.joints[1].a_max, 10.0);
  const NamedArm<4> named = make_arm<4>(model, {});
  EXPECT_EQ(named.joint_names, model.active_joints);
  EXPECT_EQ(named.link_names, (std::vector<std::string>{"base", "one", "two", "three", "four"}));
  ArmPose<4> pose;
  named.arm.forward({0, -kPi / 2, 0, 0}, pose);
  EXPECT_LT((named.arm.capsule_W(pose, 4).p1 - Vec3(1, 0, 2.9)).norm(), 1e-14);
}

TEST_F(RobotFileTest, BothDialectsSayTheSame) {
  const NamedArm<4> expected = make_arm<4>(load(), {});
  json_["root_link"] = "base";
  json_.erase("base_link");
  for (nlohmann::json& joint : json_["joints"]) {
    joint["origin_xyz"] = joint["xyz"];
    joint.erase("xyz");
    joint["origin_rpy"] = {0, 0, 0};
  }
  for (nlohmann::json& capsule : json_["capsules"]) {
    for (const char* end : {"p0", "p1"}) {
      json_["spheres"].push_back(
          {{"link", capsule["link"]}, {"center", capsule[end]}, {"radius", 0.05}});
    }
  }
  json_.erase("capsules");
  const NamedArm<4> found = make_arm<4>(load(), {});
  ArmPose<4> pose;
  ArmPose<4> other;
  expected.arm.forward({0.1, 0.2, 0.3, 0.4}, pose);
  found.arm.forward({0.1, 0.2, 0.3, 0.4}, other);
  ASSERT_EQ(found.arm.num_capsules(), 10);
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(found.arm.capsule_W(other, 2 * i).p0, expected.arm.capsule_W(pose, i).p0);
    EXPECT_EQ(found.arm.capsule_W(other, 2 * i + 1).p1, expected.arm.capsule_W(pose, i).p1);
  }
}

TEST_F(RobotFileTest, AxesAreMadeUnit) {
  json_["joints"][1]["axis"] = {0, 5, 0};
  EXPECT_EQ(load().joints[1].axis, Vec3::UnitY());
}

TEST_F(RobotFileTest, TheFirstFreeJointIsAtMostAHundredMetresFromTheRoot) {
  json_["joints"][0]["xyz"] = {60, 0, 80};
  EXPECT_EQ((make_arm<4>(load(), {{"a", "b", "c", "d"}, {}}).joint_names.front()), "a");
  json_["joints"][0]["xyz"] = {60, 0, 81};
  const std::string line = message_of([&] {
    (void)make_arm<4>(load(), {{"a", "b", "c", "d"}, {}});
  });
  EXPECT_NE(line.find(": free joint \"a\" is 100.8"), std::string::npos) << line;
  EXPECT_NE(line.find(" m from the root link; it must be at most 100.0 m"), std::string::npos)
      << line;
}

TEST_F(RobotFileTest, BranchesGiveTheirCapsulesToTheLinkTheyHangOn) {
  add_joint("finger_joint", "prismatic", "hand", "finger");
  json_["joints"].back()["lower"] = 0.25;  // 0 is outside: stays at 0.25
  json_["joints"].back()["upper"] = 0.5;
  json_["spheres"] = {{{"link", "finger"}, {"center", {0, 0, 0}}, {"radius", 0.01}}};
  const NamedArm<4> named = make_arm<4>(load(), {{"a", "b", "c", "d"}, {}});
  ASSERT_EQ(named.arm.num_capsules(), 6);
  EXPECT_EQ(named.arm.capsule_link(5), 4);
  ArmPose<4> pose;
  named.arm.forward(Arm<4>::Config::Zero(), pose);
  EXPECT_LT((named.arm.capsule_W(pose, 5).p0 - Vec3(4.25, 0, 0.5)).norm(), 1e-14);
  const NamedArm<4> open = make_arm<4>(load(), {{"a", "b", "c", "d"}, {{"finger_joint", 0.5}}});
  open.arm.forward(Arm<4>::Config::Zero(), pose);
  EXPECT_LT((open.arm.capsule_W(pose, 5).p0 - Vec3(4.5, 0, 0.5)).norm(), 1e-14);
}

TEST_F(RobotFileTest, LockedJointsAreFoldedIntoTheNextOrigin) {
  add_joint("e", "revolute", "hand", "five");
  json_["capsules"].push_back(
      {{"link", "five"}, {"p0", {0, 0, 0}}, {"p1", {0, 0, 1}}, {"radius", 0.1}});
  const RobotModel model = load();
  EXPECT_EQ(count_free_joints(model, {}), 5);
  const NamedArm<5> whole = make_arm<5>(model, {});
  const NamedArm<4> locked = make_arm<4>(model, {{"a", "c", "d", "e"}, {{"b", 0.7}}});
  ArmPose<5> pose;
  ArmPose<4> other;
  whole.arm.forward((Arm<5>::Config() << 0.1, 0.7, 0.3, 0.4, 0.5).finished(), pose);
  locked.arm.forward({0.1, 0.3, 0.4, 0.5}, other);
  for (int i = 0; i < 6; ++i) {
    EXPECT_LT((whole.arm.capsule_W(pose, i).p0 - locked.arm.capsule_W(other, i).p0).norm(), 1e-14);
    EXPECT_LT((whole.arm.capsule_W(pose, i).p1 - locked.arm.capsule_W(other, i).p1).norm(), 1e-14);
  }
  EXPECT_EQ(locked.link_names, (std::vector<std::string>{"base", "one", "three", "four", "five"}));
}

// Rigidly joined links with different partners stay apart: `hand` may touch `three`, not `base`.
TEST_F(RobotFileTest, PairsOfLinksBecomePairsOfBodies) {
  json_["capsules"].push_back(
      {{"link", "hand"}, {"p0", {0, 0, 0}}, {"p1", {0.1, 0, 0}}, {"radius", 0.02}});
  json_["self_collision_link_pairs"] = nlohmann::json::parse(
      R"([["hand", "base"], ["base", "hand"], ["four", "two"], ["four", "base"],
          ["four", "hand"]])");
  const NamedArm<4> named = make_arm<4>(load(), {});
  EXPECT_EQ(named.arm.num_bodies(), 6);
  std::set<std::pair<double, double>> radii;
  for (const auto& pair : named.arm.self_collision_pairs()) {
    const ArmBody& a = named.arm.body(pair.i_body_a);
    const ArmBody& b = named.arm.body(pair.i_body_b);
    EXPECT_LT(a.i_link, b.i_link);
    EXPECT_EQ(b.last - b.first, 1);
    radii.emplace(a.i_link, named.arm.capsule_J(b.first).radius_m);
  }
  EXPECT_EQ(radii, (std::set<std::pair<double, double>>{{0, 0.02}, {0, 0.05}, {2, 0.05}}));
}

TEST_F(RobotFileTest, WithoutPairsLinksThatAreApartAreChecked) {
  json_["capsules"][0]["p1"] = {1.1, 0, 0};  // touches the link after the next
  const NamedArm<4> named = make_arm<4>(load(), {});
  EXPECT_EQ(named.arm.self_collision_pairs().size(), 5U);  // 0-3, 0-4, 1-3, 1-4, 2-4
  json_["self_collision_link_pairs"] = nlohmann::json::array();
  EXPECT_TRUE(make_arm<4>(load(), {}).arm.self_collision_pairs().empty());
}

TEST_F(RobotFileTest, SaysWhyJointsMakeNoArm) {
  add_joint("side", "revolute", "two", "branch");
  const auto error = [this](std::vector<std::string> free,
                            std::map<std::string, double> locked = {}) {
    return error_of_arm({std::move(free), std::move(locked)});
  };
  EXPECT_EQ(error({"a", "b", "c", "x"}),
            in_file("has no joint \"x\"; it must be one of a, b, c, d, side"));
  EXPECT_EQ(error({"a", "b", "c", "tip"}),
            in_file("free joint \"tip\" is fixed; it must be one that moves"));
  EXPECT_EQ(error({"a", "b", "c", "c"}),
            in_file("free joint \"c\" is named twice; it must be named once"));
  EXPECT_EQ(error({"a", "b", "c", "d"}, {{"a", 0.0}}),
            in_file("joint \"a\" is free and locked; it must be one of both"));
  EXPECT_EQ(error({"a", "b", "c"}),
            in_file("has 3 free joints; there must be 4 to 8, lock others with locked_joints"));
  EXPECT_EQ(error({"b", "a", "c", "d"}),
            in_file("free joint \"b\" is not the first of its chain; free joints must lie on one "
                    "chain, in its order"));
  EXPECT_EQ(error({"a", "b", "c", "side"}),
            in_file("free joint \"side\" does not follow \"c\"; free joints must lie on one chain, "
                    "in its order"));
  EXPECT_EQ(error({"a", "b", "c", "d"}, {{"side", 1.5}}),
            in_file("locked joint \"side\" is at 1.5; it must be within its limits, -1.0 to 1.0"));
  EXPECT_EQ(error({"a", "b", "c", "d"}, {{"tip", 0.0}}),
            in_file("locked joint \"tip\" is fixed; it must be one that moves"));
  EXPECT_EQ(error({"a", "b", "c", "d"}, {{"y", 0.0}}),
            in_file("has no joint \"y\"; it must be one of a, b, c, d, side"));
}

TEST_F(RobotFileTest, SaysWhenAnArmIsTooLarge) {
  for (int i = 0; i < kMaxLinkCapsules; ++i) json_["capsules"].push_back(json_["capsules"][0]);
  EXPECT_EQ(error_of_arm({}), in_file("has 133 capsules and spheres; it must have at most 128"));
}

TEST_F(RobotFileTest, EachBrokenRuleHasItsLine) {
  for (const nlohmann::json& bad : nlohmann::json::parse(read_file(data_file("bad_robots.json")))) {
    const std::filesystem::path file = write("robot.json", json_.patch(bad["patch"]).dump());
    EXPECT_EQ(message_of([&] { (void)load_robot_file(file); }),
              in_file(bad["line"].get<std::string>()))
        << bad["case"];
  }
}

TEST_F(RobotFileTest, NumbersThatAreNotNumbersAreNotJson) {
  std::string text = json_.dump();
  text.replace(text.find("2.0"), 3, "NaN");
  const std::string line = message_of([&] { (void)load_robot_file(write("robot.json", text)); });
  EXPECT_NE(line.find("not valid JSON"), std::string::npos) << line;
  text.replace(text.find("NaN"), 3, "1e999");
  const std::string overflow =
      message_of([&] { (void)load_robot_file(write("robot.json", text)); });
  EXPECT_NE(overflow.find("it must be a finite number"), std::string::npos) << overflow;
}

TEST_F(RobotFileTest, WrittenFilesReadTheSame) {
  json_["joints"][2]["rpy"] = {0.3, -1.2, 2.9};
  json_["joints"][3]["type"] = "continuous";
  json_["joints"][3].erase("lower");
  json_["joints"][3].erase("upper");
  json_["joints"][1]["weight"] = 0.3;
  json_["self_collision_link_pairs"] =
      nlohmann::json::parse(R"([["hand", "base"], ["four", "two"]])");
  const RobotModel model = load();
  const RobotModel copy = load_robot_file(write("copy.json", to_text(robot_to_json(model))));
  EXPECT_EQ(copy.links, model.links);
  EXPECT_EQ(copy.active_joints, model.active_joints);
  EXPECT_EQ(copy.pairs, model.pairs);
  ASSERT_EQ(copy.joints.size(), model.joints.size());
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    EXPECT_EQ(copy.joints[j].kind, model.joints[j].kind);
    EXPECT_EQ(copy.joints[j].lower, model.joints[j].lower);
    EXPECT_EQ(copy.joints[j].a_max, model.joints[j].a_max);
    EXPECT_EQ(copy.joints[j].weight, j == 1 ? 0.3 : 1.0);
    EXPECT_EQ(copy.joints[j].origin.position, model.joints[j].origin.position);
    EXPECT_LT((copy.joints[j].origin.rotation - model.joints[j].origin.rotation).norm(), 1e-15);
  }
  ASSERT_EQ(copy.capsules.size(), model.capsules.size());
  EXPECT_EQ(copy.capsules[3].capsule.p1, model.capsules[3].capsule.p1);
}

TEST(RotationTest, AnglesComeBack) {
  for (const Vec3& rpy : {Vec3(0.1, 0.2, 0.3), Vec3(-3.0, 1.5, 2.0), Vec3(3.1, -1.5, -3.1),
                          Vec3(0.4, kPi / 2, 0.9), Vec3(0.4, -kPi / 2, 0.9)}) {
    const Mat3 rotation = rotation_from_rpy(rpy);
    EXPECT_LT((rotation_from_rpy(rpy_from_rotation(rotation)) - rotation).norm(), 1e-15);
  }
}

class SharedRobotTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::is_directory(folder_)) GTEST_SKIP() << folder_ << " is absent";
  }
  const std::filesystem::path folder_ =
      std::filesystem::path(SOPT_SOURCE_DIR) / "../shared/data/robots";
};

TEST_F(SharedRobotTest, EveryFileMakesAnArm) {
  const std::map<std::string, int> num_joints = {
      {"fetch", 8}, {"panda", 7}, {"ur5", 6},  {"openmanipulator_x", 4}, {"so101", 5}, {"vx300", 5},
      {"wx200", 5}, {"wx250", 5}, {"xarm5", 5}};
  for (const auto& [name, count] : num_joints) {
    const RobotModel model = load_robot_file(folder_ / (name + ".json"));
    ASSERT_EQ(count_free_joints(model, {}), count) << name;
    std::size_t num_pairs = 0;
    switch (count) {
      case 4:
        num_pairs = make_arm<4>(model, {}).arm.self_collision_pairs().size();
        break;
      case 5:
        num_pairs = make_arm<5>(model, {}).arm.self_collision_pairs().size();
        break;
      case 6:
        num_pairs = make_arm<6>(model, {}).arm.self_collision_pairs().size();
        break;
      case 7:
        num_pairs = make_arm<7>(model, {}).arm.self_collision_pairs().size();
        break;
      default:
        num_pairs = make_arm<8>(model, {}).arm.self_collision_pairs().size();
        break;
    }
    EXPECT_GT(num_pairs, 0U) << name;
  }
}

TEST_F(SharedRobotTest, PresetsAreTheirFiles) {
  const std::pair<const char*, Arm<5>> presets[] = {
      {"so101.json", so_101()}, {"wx250.json", widowx_250()}, {"xarm5.json", xarm5()}};
  for (const auto& [file, preset] : presets) {
    const NamedArm<5> named = make_arm<5>(load_robot_file(folder_ / file), {});
    EXPECT_EQ(named.arm.a_max(), preset.a_max());
    EXPECT_EQ(named.arm.self_collision_pairs().size(), preset.self_collision_pairs().size());
    const Arm<5>::Config q = 0.5 * preset.lower() + 0.3 * preset.upper();
    ArmPose<5> pose;
    ArmPose<5> other;
    preset.forward(q, pose);
    named.arm.forward(q, other);
    for (int i = 0; i < preset.num_capsules(); ++i) {
      EXPECT_EQ(named.arm.capsule_W(other, i).p1, preset.capsule_W(pose, i).p1) << file;
    }
  }
}

template <int N>
double self_clearance_m(const Arm<N>& arm, const typename Arm<N>::Config& q) {
  ArmPose<N> pose;
  arm.forward(q, pose);
  double clearance_m = std::numeric_limits<double>::infinity();
  for (const auto& pair : arm.self_collision_pairs()) {
    const ArmBody& a = arm.body(pair.i_body_a);
    const ArmBody& b = arm.body(pair.i_body_b);
    for (int i = a.first; i < a.last; ++i) {
      for (int j = b.first; j < b.last; ++j) {
        const Convex3 one = to_convex(arm.capsule_W(pose, i));
        clearance_m =
            std::min(clearance_m, compute_clearance(one, arm.capsule_W(pose, j)).distance_m);
      }
    }
  }
  return clearance_m;
}

// Start and goal of the public scenes are free of self-collision, with wrist 3 locked too.
template <int N>
void expect_ends_apart(const nlohmann::json& scene, const RobotModel& model) {
  JointChoice choice{scene["joints"].get<std::vector<std::string>>(), {}};
  if (scene.contains("locked_joints")) {
    choice.locked_joints = scene["locked_joints"].get<std::map<std::string, double>>();
  }
  const NamedArm<N> named = make_arm<N>(model, choice);
  for (const char* end : {"start", "goal"}) {
    typename Arm<N>::Config q;
    for (int j = 0; j < N; ++j) q[j] = scene[end][static_cast<std::size_t>(j)].get<double>();
    // Two ends of the Fetch scenes are 3e-6 rad outside.
    const typename Arm<N>::Config inside =
        q.cwiseMax(named.arm.lower()).cwiseMin(named.arm.upper());
    EXPECT_LT((q - inside).norm(), 1e-5) << scene["name"] << ' ' << end;
    EXPECT_GT(self_clearance_m(named.arm, q), 0.0) << scene["name"] << ' ' << end;
    EXPECT_LT(self_clearance_m(named.arm, q), 0.3) << scene["name"] << ' ' << end;
  }
}

TEST_F(SharedRobotTest, EndsOfSharedScenesAreFreeOfSelfCollision) {
  int num_scenes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "../scenes")) {
    const nlohmann::json scene = nlohmann::json::parse(std::ifstream(entry.path()));
    if (!scene.contains("joints")) continue;
    const RobotModel model =
        load_robot_file(folder_ / "../scenes" / scene["robot_file"].get<std::string>());
    switch (scene["joints"].size()) {
      case 5:
        expect_ends_apart<5>(scene, model);
        break;
      case 6:
        expect_ends_apart<6>(scene, model);
        break;
      case 7:
        expect_ends_apart<7>(scene, model);
        break;
      default:
        expect_ends_apart<8>(scene, model);
        break;
    }
    ++num_scenes;
  }
  EXPECT_EQ(num_scenes, 28);
}

}  // namespace
}  // namespace sopt
