// The public robot files, read and moved here without the program's reader and without the
// library's frames: at random configurations every sphere and capsule of the file must lie where
// the arm made of it has one of the same size.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/arm_oracle.h"
#include "tools/io/robot_file.h"

namespace sopt {
namespace {

using nlohmann::json;
using oracle::Mat4;
using oracle::Random;

Vec3 vector_of(const json& object, const std::string& a, const std::string& b) {
  const std::string& name = object.contains(a) ? a : b;
  if (!object.contains(name)) return Vec3::Zero();
  const json& v = object[name];
  return {v[0].get<double>(), v[1].get<double>(), v[2].get<double>()};
}

Mat4 motion_of(const json& joint, double q) {
  const std::string type = joint["type"].get<std::string>();
  if (type == "fixed") return Mat4::Identity();
  const Vec3 axis = vector_of(joint, "axis", "axis").normalized();
  if (type == "prismatic") return oracle::to_matrix({Mat3::Identity(), q * axis});
  return oracle::to_matrix({oracle::rotation_about(axis, q), Vec3::Zero()});
}

Mat4 origin_of(const json& joint) {
  const Vec3 rpy = vector_of(joint, "rpy", "origin_rpy");
  const Mat3 rotation = oracle::rotation_about(Vec3::UnitZ(), rpy.z()) *
                        oracle::rotation_about(Vec3::UnitY(), rpy.y()) *
                        oracle::rotation_about(Vec3::UnitX(), rpy.x());
  return oracle::to_matrix({rotation, vector_of(joint, "xyz", "origin_xyz")});
}

// All links' frames; joints in any order. Joints without an angle stay at 0 or the limit next to
// it.
std::map<std::string, Mat4> frames_of(const json& file, const std::map<std::string, double>& q) {
  const char* const root = file.contains("base_link") ? "base_link" : "root_link";
  std::map<std::string, Mat4> frames = {{file[root].get<std::string>(), Mat4::Identity()}};
  for (std::size_t pass = 0; pass < file["joints"].size(); ++pass) {
    for (const json& joint : file["joints"]) {
      const auto parent = frames.find(joint["parent"].get<std::string>());
      if (parent == frames.end()) continue;
      const auto at = q.find(joint["name"].get<std::string>());
      double angle = 0.0;
      if (at != q.end()) {
        angle = at->second;
      } else if (joint.contains("lower")) {
        angle = std::clamp(0.0, joint["lower"].get<double>(), joint["upper"].get<double>());
      }
      frames[joint["child"].get<std::string>()] =
          parent->second * origin_of(joint) * motion_of(joint, angle);
    }
  }
  return frames;
}

std::vector<Capsule3> capsules_of(const json& file, const std::map<std::string, double>& q) {
  const std::map<std::string, Mat4> frames = frames_of(file, q);
  std::vector<Capsule3> all;
  const auto place = [&](const json& shape, const char* p0, const char* p1) {
    const Mat4& frame = frames.at(shape["link"].get<std::string>());
    all.push_back({oracle::transform(frame, vector_of(shape, p0, p0)),
                   oracle::transform(frame, vector_of(shape, p1, p1)),
                   shape["radius"].get<double>()});
  };
  for (const json& shape : file.value("capsules", json::array())) place(shape, "p0", "p1");
  for (const json& shape : file.value("spheres", json::array())) place(shape, "center", "center");
  return all;
}

// How far the arm's capsule that is most like `wanted` is from it.
double difference(const std::vector<Capsule3>& found, const Capsule3& wanted) {
  double least = std::numeric_limits<double>::infinity();
  for (const Capsule3& c : found) {
    if (c.radius_m != wanted.radius_m) continue;
    least = std::min(least, std::max((c.p0 - wanted.p0).norm(), (c.p1 - wanted.p1).norm()));
  }
  return least;
}

template <int N>
void expect_moves_as_its_file(const std::filesystem::path& path) {
  SCOPED_TRACE(path);
  const json file = json::parse(std::ifstream(path));
  const NamedArm<N> named = make_arm<N>(load_robot_file(path), {});
  Random random(N);
  for (int round = 0; round < 50; ++round) {
    const typename Arm<N>::Config q = oracle::random_configuration(random, named.arm);
    std::map<std::string, double> angles;
    for (int j = 0; j < N; ++j) angles[named.joint_names[static_cast<std::size_t>(j)]] = q[j];
    ArmPose<N> pose;
    named.arm.forward(q, pose);
    std::vector<Capsule3> found;
    for (int i = 0; i < named.arm.num_capsules(); ++i) {
      found.push_back(named.arm.capsule_W(pose, i));
    }
    const std::vector<Capsule3> wanted = capsules_of(file, angles);
    ASSERT_EQ(found.size(), wanted.size());
    for (const Capsule3& capsule : wanted) ASSERT_LT(difference(found, capsule), 1e-13);
  }
}

TEST(ArmRobotFiles, MoveAsTheirNumbersSay) {
  const auto folder = std::filesystem::path(SOPT_SOURCE_DIR) / "../shared/data/robots";
  if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << folder << " is absent";
  expect_moves_as_its_file<4>(folder / "openmanipulator_x.json");
  for (const char* name : {"so101", "vx300", "wx200", "wx250", "xarm5"}) {
    expect_moves_as_its_file<5>(folder / (std::string(name) + ".json"));
  }
  expect_moves_as_its_file<6>(folder / "ur5.json");
  expect_moves_as_its_file<7>(folder / "panda.json");
  expect_moves_as_its_file<8>(folder / "fetch.json");
}

}  // namespace
}  // namespace sopt
