#include "tools/io/urdf_robot.h"

#include <cmath>
#include <cstring>
#include <functional>
#include <numbers>

#include "tests/support/arm_oracle.h"
#include "tests/tools/temporary_folder.h"
#include "tools/io/capsule_fit.h"
#include "tools/io/input_error.h"
#include "tools/io/json_text.h"
#include "tools/io/mesh_file.h"
#include "tools/io/robot_file.h"

namespace sopt {
namespace {

using oracle::Mat4;
using oracle::Random;

std::string message_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing thrown";
}

bool is_inside(const Vec3& p, const Capsule3& capsule) {
  const Vec3 edge = capsule.p1 - capsule.p0;
  const double length2 = edge.squaredNorm();
  const double share = length2 > 0.0 ? edge.dot(p - capsule.p0) / length2 : 0.0;
  return (p - capsule.p0 - std::clamp(share, 0.0, 1.0) * edge).norm() <= capsule.radius_m + 1e-12;
}

// A wedge of 2 x 1 x 1 m: volume 1, with a face of four corners.
constexpr const char* kWedgeObj = R"(# comment
v 0 0 0
v 2 0 0
v 2 1 0
v 0 1 0
v 0 0 1
v 0 1 1
vn 0 0 1
f 4//1 3//1 2//1 1//1
f 1 2 5
f 3 4 6
f 2 3 6 5
f -6 -2 -1 -3
)";

class UrdfRobotTest : public TemporaryFolderTest {
 protected:
  void SetUp() override {
    TemporaryFolderTest::SetUp();
    text_ = read_file(data_file("four_joints.urdf"));
    std::filesystem::create_directories(folder() / "four_joints/urdf");
    std::filesystem::create_directories(folder() / "four_joints/meshes");
    write("four_joints/meshes/wedge.obj", kWedgeObj);
  }
  void replace(const std::string& what, const std::string& by) {
    const std::size_t place = text_.find(what);
    ASSERT_NE(place, std::string::npos) << what;
    text_.replace(place, what.size(), by);
  }
  [[nodiscard]] UrdfRobot load() const {
    return load_urdf(write("four_joints/urdf/robot.urdf", text_));
  }
  // Without the file's name.
  [[nodiscard]] std::string error() const {
    const std::string line = message_of([this] { (void)load(); });
    const std::string file = (folder() / "four_joints/urdf/robot.urdf").string() + ": ";
    return line.starts_with(file) ? line.substr(file.size()) : line;
  }
  void expect_error(const std::string& what, const std::string& by, const std::string& line) {
    const std::string kept = text_;
    replace(what, by);
    EXPECT_EQ(error(), line);
    text_ = kept;
  }

  std::string text_;
};

TEST_F(UrdfRobotTest, ReadsTheChainUpToItsFingers) {
  const RobotModel model = load().model;
  EXPECT_EQ(model.name, "four_joints");
  EXPECT_EQ(model.active_joints, (std::vector<std::string>{"turn", "lift", "elbow", "wrist"}));
  const NamedArm<4> named = make_arm<4>(model, {});
  EXPECT_EQ(named.arm.joint(0).kind, JointKind::kContinuous);
  EXPECT_EQ(named.arm.lower()[1], -0.1);
  EXPECT_EQ(named.arm.v_max()[2], 3.0);
  EXPECT_EQ(named.arm.a_max()[2], 15.0);
}

TEST_F(UrdfRobotTest, FramesAreProductsOfItsNumbers) {
  const NamedArm<4> named = make_arm<4>(load().model, {});
  const Arm<4>::Config q(0.4, 0.2, -1.1, 0.7);
  const auto origin = [](const Vec3& xyz, const Vec3& rpy) {
    return oracle::to_matrix({oracle::rotation_about(Vec3::UnitZ(), rpy.z()) *
                                  oracle::rotation_about(Vec3::UnitY(), rpy.y()) *
                                  oracle::rotation_about(Vec3::UnitX(), rpy.x()),
                              xyz});
  };
  const auto turn = [](const Vec3& axis, double angle) {
    return oracle::to_matrix({oracle::rotation_about(axis.normalized(), angle), Vec3::Zero()});
  };
  const Mat4 hand = origin({0, 0, 0.5}, {0.1, 0.2, 0.3}) * turn({0, 0, 1}, q[0]) *
                    origin({0.2, 0, 0.1}, {1.5708, 0, 0}) * origin({0, 0, q[1]}, {0, 0, 0}) *
                    origin({0, 0.3, 0.5}, {0, -0.7, 0}) * turn({1, 1, 0}, q[2]) *
                    origin({0.4, 0, 0}, {0, 0, 0}) * origin({0, 0, 0.1}, {0, 0, 0}) *
                    turn({0, 1, 0}, q[3]);
  ArmPose<4> pose;
  named.arm.forward(q, pose);
  EXPECT_LT((oracle::to_matrix(named.arm.link_pose(pose, 4)) - hand).norm(), 1e-13);
}

TEST_F(UrdfRobotTest, RobotFilesMadeOfItMoveTheSame) {
  const RobotModel model = load().model;
  const NamedArm<4> expected = make_arm<4>(model, {});
  const NamedArm<4> found =
      make_arm<4>(load_robot_file(write("robot.json", to_text(robot_to_json(model)))), {});
  EXPECT_EQ(found.joint_names, expected.joint_names);
  ASSERT_EQ(found.arm.num_capsules(), expected.arm.num_capsules());
  Random random(1);
  for (int round = 0; round < 100; ++round) {
    const Arm<4>::Config q = oracle::random_configuration(random, expected.arm);
    ArmPose<4> pose;
    ArmPose<4> other;
    expected.arm.forward(q, pose);
    found.arm.forward(q, other);
    for (int i = 0; i < expected.arm.num_capsules(); ++i) {
      EXPECT_LT((found.arm.capsule_W(other, i).p0 - expected.arm.capsule_W(pose, i).p0).norm(),
                1e-14);
      EXPECT_LT((found.arm.capsule_W(other, i).p1 - expected.arm.capsule_W(pose, i).p1).norm(),
                1e-14);
    }
  }
}

TEST_F(UrdfRobotTest, SaysWhatItApproximated) {
  const std::vector<CapsuleApproximation> found = load().approximations;
  ASSERT_EQ(found.size(), 4U);
  EXPECT_EQ(found[0].geometry, "cylinder 0.1 x 0.6");
  EXPECT_EQ(found[1].geometry, "box 0.1 x 0.2 x 0.9");
  EXPECT_EQ(found[2].geometry, "sphere 0.15");
  EXPECT_EQ(found[3].geometry, "mesh wedge.obj, 6 vertices");
  EXPECT_FALSE(found[1].is_visual);
  EXPECT_TRUE(found[2].is_visual);
  EXPECT_EQ(found[3].link, "forearm");
  EXPECT_GT(found[0].volume_ratio, 1.0);
  EXPECT_LT(found[0].volume_ratio, 1.3);
  EXPECT_EQ(found[2].volume_ratio, 1.0);
  EXPECT_NEAR(found[3].volume_ratio, capsule_volume_m3(found[3].capsule) / 0.125, 1e-12);
}

TEST_F(UrdfRobotTest, CapsulesContainTheirShapes) {
  const std::vector<CapsuleApproximation> found = load().approximations;
  for (int i = 0; i < 360; ++i) {
    const double angle = i * std::numbers::pi / 180.0;
    for (const double z : {-0.2, 0.4}) {
      EXPECT_TRUE(is_inside({0.1 * std::cos(angle), 0.1 * std::sin(angle), z}, found[0].capsule));
    }
  }
  const Mat3 turned = oracle::rotation_about(Vec3::UnitY(), 0.5);
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner((i & 1) != 0 ? 0.05 : -0.05, (i & 2) != 0 ? 0.1 : -0.1,
                      (i & 4) != 0 ? 0.45 : -0.45);
    EXPECT_TRUE(is_inside(Vec3(0.1, 0, 0) + turned * corner, found[1].capsule));
  }
  EXPECT_LT((found[2].capsule.p0 - Vec3(0, 0, 0.3)).norm(), 1e-15);
  EXPECT_EQ(found[2].capsule.radius_m, 0.15);
  for (const Vec3& v : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 0.5, 0), Vec3(0, 0.5, 0.5)}) {
    EXPECT_TRUE(is_inside(v, found[3].capsule));
  }
}

TEST_F(UrdfRobotTest, NamesWhatIsNotSupported) {
  constexpr const char* kSupported =
      "; supported are revolute, continuous, prismatic and fixed joints that mimic no other";
  expect_error("<limit lower=\"0\" upper=\"0.1\" effort=\"1\" velocity=\"1\"/>",
               "<limit lower=\"0\" upper=\"0.1\" effort=\"1\" velocity=\"1\"/>"
               "<mimic joint=\"wrist\"/>",
               std::string("joint \"left_finger\" is a mimic of \"wrist\"") + kSupported);
  expect_error("name=\"elbow\" type=\"revolute\"", "name=\"elbow\" type=\"floating\"",
               std::string("joint \"elbow\" is floating") + kSupported);
  expect_error("name=\"elbow\" type=\"revolute\"", "name=\"elbow\" type=\"planar\"",
               std::string("joint \"elbow\" is planar") + kSupported);
  expect_error("wedge.obj", "wedge.dae",
               "link \"forearm\": mesh \"package://four_joints/meshes/wedge.dae\" is not found; it "
               "must lie beside the URDF file or in the package around it");
}

TEST_F(UrdfRobotTest, NamesWhatIsWrong) {
  expect_error("lower=\"-2\" upper=\"1\"", "lower=\"2\" upper=\"1\"",
               "joint \"elbow\": lower is 2.0; it must be at most upper, 1.0");
  expect_error("<axis xyz=\"1 1 0\"/>", "<axis xyz=\"0 0 0\"/>",
               "joint \"elbow\": axis is zero; it must have a direction");
  expect_error("<limit effort=\"1\" velocity=\"2\"/>", "",
               "joint \"turn\": limit is missing; it must give a velocity > 0");
  expect_error("velocity=\"0.5\"", "velocity=\"0\"",
               "joint \"lift\": velocity is 0.0; it must be > 0, from 1e-9 to 1e6");
  expect_error("radius=\"0.15\"", "radius=\"-0.15\"",
               "link \"upper_arm\": sphere radius is -0.15; it must be > 0, from 1e-9 to 1e6");
  expect_error("size=\"0.1 0.2 0.9\"", "size=\"0.1 0 0.9\"",
               "link \"shoulder\": box size is 0.0; it must be > 0, from 1e-9 to 1e6");
  expect_error("<origin xyz=\"0.4 0 0\"/>", "<origin xyz=\"4e9 0 0\"/>",
               "joint \"flange\": origin is 4000000000.0; it must be a number from -1e6 to 1e6");
  expect_error("scale=\"0.5 0.5 0.5\"", "scale=\"0.5 0 0.5\"",
               "link \"forearm\": mesh scale has a 0; it must have none");
}

// The parser leaves such shapes out and goes on, which would leave the arm without them.
TEST_F(UrdfRobotTest, RefusesShapesThatTheParserLeavesOut) {
  const std::string in_upper_arm = "; Could not parse visual element for Link [upper_arm]";
  expect_error("radius=\"0.15\"", "radius=\"nan\"",
               "not a valid URDF: radius [nan] is not a valid float" + in_upper_arm);
  expect_error("radius=\"0.15\"", "",
               "not a valid URDF: Sphere shape must have a radius attribute" + in_upper_arm);
  expect_error("<sphere radius=\"0.15\"/>", "<cone radius=\"0.15\"/>",
               "not a valid URDF: Unknown geometry type 'cone'" + in_upper_arm);
  expect_error("length=\"0.6\"", "length=\"inf\"",
               "not a valid URDF: length [inf] is not a valid float; Could not parse collision "
               "element for Link [base]");
  expect_error("size=\"0.1 0.2 0.9\"", "size=\"0.1 0.2\"",
               "not a valid URDF: Parser found 2 elements but 3 expected while parsing vector [0.1 "
               "0.2]; Could not parse collision element for Link [shoulder]");
}

// What the parser itself refuses is passed on in its words.
TEST_F(UrdfRobotTest, RefusesWhatIsNoTree) {
  struct Case {
    const char* what;
    const char* by;
    const char* line;  // how it begins
  };
  constexpr Case kCases[] = {
      {"<parent link=\"base\"/>", "<parent link=\"hand\"/>",
       "has links that do not hang on the root link \"base\"; joints must be a tree"},
      {"<parent link=\"base\"/>", "<parent link=\"nowhere\"/>", "not a valid URDF: "},
      {"<child link=\"left\"/>", "<child link=\"right\"/>", "not a valid URDF: "},
      {"<child link=\"left\"/>", "<child link=\"base\"/>",
       "has links that do not hang on the root link \"left\"; joints must be a tree"},
      {"</robot>", "<link name=\"alone\"/></robot>", "not a valid URDF: "},
      {"name=\"elbow\" type=\"revolute\"", "name=\"elbow\" type=\"ball\"",
       "not a valid URDF: Joint [elbow] has no known type [ball]"},
      {"name=\"lift\"", "name=\"turn\"", "not a valid URDF: joint 'turn' is not unique."},
      {"lower=\"-2\"", "lower=\"nan\"", "not a valid URDF: lower value (nan)"},
      {"velocity=\"2\"", "velocity=\"fast\"", "not a valid URDF: velocity value (fast)"},
      {"</robot>", "", "not a valid URDF: "},
      {"<robot name=\"four_joints\">", "<robot>", "not a valid URDF: "}};
  for (const Case& bad : kCases) {
    const std::string kept = text_;
    replace(bad.what, bad.by);
    EXPECT_TRUE(error().starts_with(bad.line)) << bad.by << " answers: " << error();
    text_ = kept;
  }
  text_ = "<robot name=\"one\"><link name=\"a\"/></robot>";
  EXPECT_EQ(error(), "has no joints; it must have at least one");
}

TEST_F(UrdfRobotTest, RefusesDeepNestingBeforeTheParserSeesIt) {
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "<a>";
  text_ = deep;
  EXPECT_EQ(error(), "nests elements deeper than 100 levels, the limit");
}

class MeshFileTest : public TemporaryFolderTest {};

TEST_F(MeshFileTest, ReadsObj) {
  const Mesh mesh = load_mesh(write("wedge.obj", kWedgeObj));
  EXPECT_EQ(mesh.vertices.size(), 6U);
  EXPECT_EQ(mesh.triangles.size(), 8U);
  EXPECT_NEAR(mesh_volume_m3(mesh), 1.0, 1e-15);
}

// A tetrahedron with corners at the origin and at 1 m on each axis.
constexpr float kTetrahedron[4][3][3] = {{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}},
                                         {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}},
                                         {{0, 0, 0}, {0, 0, 1}, {0, 1, 0}},
                                         {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

TEST_F(MeshFileTest, ReadsStlInBothForms) {
  std::string binary(84, ' ');
  std::string text = "solid t\n";
  const std::uint32_t num_triangles = 4;
  std::memcpy(binary.data() + 80, &num_triangles, 4);
  for (const auto& triangle : kTetrahedron) {
    binary.append(12, '\0');
    binary.append(reinterpret_cast<const char*>(&triangle[0][0]), sizeof triangle);
    binary.append(2, '\0');
    text += "facet normal 0 0 0\n outer loop\n";
    for (const auto& v : triangle) {
      text += "  vertex " + std::to_string(v[0]) + ' ' + std::to_string(v[1]) + ' ' +
              std::to_string(v[2]) + '\n';
    }
    text += " endloop\nendfacet\n";
  }
  binary.replace(0, 5, "solid");  // some writers do
  for (const auto& file : {write("b.stl", binary), write("t.STL", text + "endsolid t\n")}) {
    const Mesh mesh = load_mesh(file);
    EXPECT_EQ(mesh.vertices.size(), 4U) << file;
    EXPECT_EQ(mesh.triangles.size(), 4U) << file;
    EXPECT_NEAR(mesh_volume_m3(mesh), 1.0 / 6.0, 1e-15) << file;
  }
}

TEST_F(MeshFileTest, VerticesAlongSeamsCountOnce) {
  const std::string doubled = std::string("v 0 0 0\n") + kWedgeObj + "f 1 1 1\n";
  const Mesh mesh = load_mesh(write("wedge.obj", doubled));
  EXPECT_EQ(mesh.vertices.size(), 6U);
}

TEST_F(MeshFileTest, OpenSurfacesHaveNoVolume) {
  Mesh mesh = load_mesh(write("wedge.obj", kWedgeObj));
  mesh.triangles.pop_back();
  EXPECT_EQ(mesh_volume_m3(mesh), 0.0);
}

TEST_F(MeshFileTest, RefusesBrokenFiles) {
  for (const auto& [name, text] : std::vector<std::pair<const char*, std::string>>{
           {"a.stl", "shape"},
           {"b.stl", "solid t\nvertex 1 2"},
           {"c.stl", "solid t"},
           {"d.stl", "solid t vertex 0 0 0 vertex 1 0 0"},
           {"e.stl", std::string(90, '\1')},
           {"f.obj", ""},
           {"g.obj", "v 1 2\n"},
           {"h.obj", "v 1 2 3\nf 1 2 3\n"},
           {"i.obj", "v 1 2 3\nf 0 1 1\n"},
           {"j.obj", "v nan 0 0\n"},
           {"k.obj", "v 1e7 0 0\n"},
           {"l.dae", "<COLLADA/>"}}) {
    const std::string line = message_of([&, file = write(name, text)] { (void)load_mesh(file); });
    EXPECT_NE(line.find("; it must be"), std::string::npos) << name << ' ' << line;
  }
}

TEST(CapsuleFitTest, ContainsItsPointsAndIsTight) {
  Random random(5);
  for (int round = 0; round < 50; ++round) {
    const Vec3 p0 = oracle::random_vector(random, 1.0);
    const Vec3 axis = oracle::random_axis(random);
    const double length_m = random.uniform(0.0, 2.0);
    const Capsule3 drawn{p0, p0 + length_m * axis, random.uniform(0.05, 0.3)};
    std::vector<Vec3> points;
    for (int i = 0; i < 400; ++i) {
      Vec3 out = oracle::random_vector(random, 1.0);
      while (out.norm() < 0.1) out = oracle::random_vector(random, 1.0);
      const double share = random.chance(0.4) ? random.index(2) : random.uniform(0.0, 1.0);
      points.push_back(drawn.p0 + share * (drawn.p1 - drawn.p0) +
                       drawn.radius_m * out.normalized());
    }
    const Capsule3 found = fit_capsule(points);
    for (const Vec3& p : points) EXPECT_TRUE(is_inside(p, found));
    EXPECT_LT(capsule_volume_m3(found), 1.15 * capsule_volume_m3(drawn)) << round;
  }
}

TEST(CapsuleFitTest, TakesDegeneratePoints) {
  EXPECT_LT(capsule_volume_m3(fit_capsule(std::vector<Vec3>{{1, 2, 3}})), 1e-30);
  const Capsule3 line = fit_capsule(std::vector<Vec3>{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}});
  EXPECT_LT(line.radius_m, 1e-9);
  EXPECT_NEAR((line.p1 - line.p0).norm(), std::sqrt(12.0), 1e-9);
}

}  // namespace
}  // namespace sopt
