#include "models/arm/arm_presets.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "models/arm/arm_pairs.h"
#include "models/space/pose3.h"
#include "tests/support/arm_oracle.h"

namespace sopt {
namespace {

using oracle::Mat4;
using oracle::Random;

constexpr double kPi = std::numbers::pi;

std::vector<std::pair<int, int>> link_pairs(const Arm<5>& arm) {
  std::vector<std::pair<int, int>> pairs;
  for (const auto& pair : arm.self_collision_pairs()) {
    pairs.emplace_back(arm.body(pair.i_body_a).i_link, arm.body(pair.i_body_b).i_link);
  }
  return pairs;
}

// R_z(theta + q) T_z(d) T_x(a) R_x(alpha)
Mat4 dh_row(double theta, double d, double a, double alpha) {
  const Mat3 turn = oracle::rotation_about(Vec3::UnitZ(), theta);
  const Mat3 twist = oracle::rotation_about(Vec3::UnitX(), alpha);
  return oracle::to_matrix({turn, Vec3(0, 0, d)}) * oracle::to_matrix({twist, Vec3(a, 0, 0)});
}

TEST(ArmPresetsTest, LrMateFollowsItsDenavitHartenbergTable) {
  const double rows[5][4] = {{0, 0, 0.050, -kPi / 2},
                             {-kPi / 2, 0, 0.440, kPi},
                             {0, 0, 0.035, -kPi / 2},
                             {0, -0.420, 0, kPi / 2},
                             {0, 0, 0, -kPi / 2}};
  const Arm<5> arm = lr_mate_200id_7l();
  Random random(1);
  for (int round = 0; round < 100; ++round) {
    const Arm<5>::Config q = oracle::random_configuration(random, arm);
    ArmPose<5> pose;
    arm.forward(q, pose);
    Mat4 frame = Mat4::Identity();
    for (int i = 0; i < 5; ++i) {
      // Joint i + 1 turns about z of frame i; the row's end is where link i + 1 ends.
      EXPECT_NEAR((pose.X_WJ[std::size_t(i) + 1].position - frame.topRightCorner<3, 1>()).norm(),
                  0.0, 1e-14);
      EXPECT_NEAR((pose.X_WJ[std::size_t(i) + 1].rotation.col(2) - frame.block<3, 1>(0, 2)).norm(),
                  0.0, 1e-14);
      frame = frame * dh_row(rows[i][0] + q[i], rows[i][1], rows[i][2], rows[i][3]);
    }
    EXPECT_NEAR((arm.capsule_W(pose, 3).p1 - frame.topRightCorner<3, 1>()).norm(), 0.0, 1e-14);
  }
}

TEST(ArmPresetsTest, LrMateStandsUprightAtZeroWithItsForearmAhead) {
  const Arm<5> arm = lr_mate_200id_7l();
  ArmPose<5> pose;
  arm.forward(Arm<5>::Config::Zero(), pose);
  ASSERT_EQ(arm.num_capsules(), 4);
  const Vec3 ends[4] = {{0.05, 0, 0}, {0.05, 0, 0.44}, {0.05, 0, 0.475}, {0.47, 0, 0.475}};
  const double radii_m[4] = {0.13, 0.068, 0.01, 0.06};
  for (int i = 0; i < 4; ++i) {
    const Capsule3 capsule = arm.capsule_W(pose, i);
    EXPECT_EQ(arm.capsule_link(i), i + 1);
    EXPECT_EQ(capsule.radius_m, radii_m[i]);
    EXPECT_NEAR((capsule.p0 - (i == 0 ? Vec3(0, 0, 0) : ends[i - 1])).norm(), 0.0, 1e-15) << i;
    EXPECT_NEAR((capsule.p1 - ends[i]).norm(), 0.0, 1e-15) << i;
  }
}

TEST(ArmPresetsTest, LrMateLimitsAndExampleQuery) {
  const Arm<5> arm = lr_mate_200id_7l();
  const double degree = kPi / 180.0;
  const double lower[5] = {-170, -100, -72, -190, -125};
  const double upper[5] = {170, 145, 240, 190, 125};
  const double speed[5] = {370, 310, 410, 550, 545};
  for (int j = 0; j < 5; ++j) {
    EXPECT_NEAR(arm.lower()[j], lower[j] * degree, 1e-15);
    EXPECT_NEAR(arm.upper()[j], upper[j] * degree, 1e-15);
    EXPECT_NEAR(arm.v_max()[j], speed[j] * degree, 1e-14);
    EXPECT_DOUBLE_EQ(arm.a_max()[j], 5.0 * arm.v_max()[j]);
  }
  EXPECT_TRUE(arm.within_limits({0.421, 0, -0.0092, -0.001, -1.5786}));
  EXPECT_TRUE(arm.within_limits({-1.409, 0.8873, 0.4008, 0, 0.443}));
}

TEST(ArmPresetsTest, PairsAreApartAtHomeAndNoNeighbours) {
  EXPECT_EQ(link_pairs(lr_mate_200id_7l()), (std::vector<std::pair<int, int>>{{1, 3}, {1, 4}}));
  for (const Arm<5>& arm : {so_101(), widowx_250(), xarm5()}) {
    EXPECT_GE(link_pairs(arm).size(), 5U);
    ArmPose<5> pose;
    arm.forward(home_configuration(arm), pose);
    for (const auto& [a, b] : link_pairs(arm)) {
      EXPECT_GE(b - a, 2);
      EXPECT_GT(
          compute_clearance(to_convex(arm.capsule_W(pose, a)), arm.capsule_W(pose, b)).distance_m,
          0.0);
    }
  }
}

// The public robot files, read here without the program's reader.
struct FileArm {
  ArmDescription<5> description;
  std::vector<LinkCapsule> capsules;
};

Vec3 to_vector(const nlohmann::json& json) {
  return {json[0].get<double>(), json[1].get<double>(), json[2].get<double>()};
}

FileArm read_file_arm(const std::filesystem::path& file) {
  const nlohmann::json json = nlohmann::json::parse(std::ifstream(file));
  std::map<std::string, int> links = {{json["base_link"].get<std::string>(), 0}};
  FileArm arm;
  for (const nlohmann::json& joint : json["joints"]) {
    const auto i = links.size() - 1;
    links[joint["child"].get<std::string>()] = static_cast<int>(links.size());
    const Vec3 rpy = to_vector(joint["rpy"]);
    ArmJoint& out = arm.description.joints[i];
    out.origin.rotation = oracle::rotation_about(Vec3::UnitZ(), rpy.z()) *
                          oracle::rotation_about(Vec3::UnitY(), rpy.y()) *
                          oracle::rotation_about(Vec3::UnitX(), rpy.x());
    out.origin.position = to_vector(joint["xyz"]);
    out.axis = to_vector(joint["axis"]);
    out.lower = joint["lower"].get<double>();
    out.upper = joint["upper"].get<double>();
    out.v_max = joint["velocity"].get<double>();
  }
  for (const nlohmann::json& capsule : json["capsules"]) {
    arm.capsules.push_back({links.at(capsule["link"].get<std::string>()), to_vector(capsule["p0"]),
                            to_vector(capsule["p1"]), capsule["radius"].get<double>()});
  }
  return arm;
}

TEST(ArmPresetsTest, AgreeWithThePublicRobotFiles) {
  const auto folder = std::filesystem::path(SOPT_SOURCE_DIR) / "../shared/data/robots";
  if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << folder << " is absent";
  const std::pair<const char*, Arm<5>> presets[] = {
      {"so101.json", so_101()}, {"wx250.json", widowx_250()}, {"xarm5.json", xarm5()}};
  Random random(2);
  for (const auto& [file, arm] : presets) {
    const FileArm expected = read_file_arm(folder / file);
    ASSERT_EQ(arm.num_capsules(), static_cast<int>(expected.capsules.size())) << file;
    for (int j = 0; j < 5; ++j) {
      EXPECT_EQ(arm.lower()[j], expected.description.joints[std::size_t(j)].lower) << file;
      EXPECT_EQ(arm.upper()[j], expected.description.joints[std::size_t(j)].upper) << file;
      EXPECT_EQ(arm.v_max()[j], expected.description.joints[std::size_t(j)].v_max) << file;
    }
    for (int round = 0; round < 100; ++round) {
      const Arm<5>::Config q = oracle::random_configuration(random, arm);
      const std::vector<Mat4> frames = oracle::link_frames<5>(expected.description, q);
      ArmPose<5> pose;
      arm.forward(q, pose);
      for (int l = 0; l <= 5; ++l) {
        const Mat4 found = oracle::to_matrix(arm.link_pose(pose, l));
        EXPECT_LT((found - frames[std::size_t(l)]).cwiseAbs().maxCoeff(), 1e-14) << file;
      }
      for (int i = 0; i < arm.num_capsules(); ++i) {
        const LinkCapsule& source = expected.capsules[std::size_t(i)];
        const Mat4& frame = frames[std::size_t(source.i_link)];
        const Capsule3 found = arm.capsule_W(pose, i);
        EXPECT_LT((found.p0 - oracle::transform(frame, source.p0)).norm(), 1e-14) << file;
        EXPECT_LT((found.p1 - oracle::transform(frame, source.p1)).norm(), 1e-14) << file;
        EXPECT_EQ(found.radius_m, source.radius_m) << file;
      }
    }
  }
}

}  // namespace
}  // namespace sopt
