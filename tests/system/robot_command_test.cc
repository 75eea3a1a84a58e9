#include "tools/robot_command.h"

#include <nlohmann/json.hpp>

#include "tests/tools/temporary_folder.h"
#include "tools/io/input_error.h"
#include "tools/io/robot_file.h"

namespace sopt {
namespace {

class RobotCommandTest : public TemporaryFolderTest {
 protected:
  void SetUp() override {
    TemporaryFolderTest::SetUp();
    std::string text = read_file(data_file("four_joints.urdf"));
    const std::string mesh =
        R"(<mesh filename="package://four_joints/meshes/wedge.obj" scale="0.5 0.5 0.5"/>)";
    text.replace(text.find(mesh), mesh.size(), R"(<sphere radius="0.1"/>)");
    urdf_ = write("robot.urdf", text);
  }
  int run(std::vector<std::string> arguments) const {
    CLI::App app;
    int exit_code = -1;
    add_robot_command(app, exit_code);
    std::reverse(arguments.begin(), arguments.end());
    app.parse(arguments);
    return exit_code;
  }

  std::filesystem::path urdf_;
};

TEST_F(RobotCommandTest, WritesTheRobotAndWhatItApproximated) {
  testing::internal::CaptureStdout();
  const int exit_code =
      run({"robot", urdf_, "-o", folder() / "robot.json", "--json", folder() / "answer.json"});
  const std::string text = testing::internal::GetCapturedStdout();
  EXPECT_EQ(exit_code, 0);
  EXPECT_NE(text.find("active joints: turn, lift, elbow, wrist\n"), std::string::npos) << text;
  EXPECT_NE(text.find("upper_arm: visual sphere 0.15 -> capsule 0.15 x 0 m, 1.00 times the volume"),
            std::string::npos)
      << text;
  EXPECT_EQ(count_free_joints(load_robot_file(folder() / "robot.json"), {}), 4);
  const auto answer = nlohmann::json::parse(read_file(folder() / "answer.json"));
  EXPECT_EQ(answer["approximations"].size(), 4U);
  EXPECT_EQ(answer["approximations"][2]["visual"], true);
  EXPECT_EQ(answer["approximations"][3]["volume_ratio"], 1.0);
}

TEST_F(RobotCommandTest, WritesNothingWhenTheRobotIsInvalid) {
  const std::filesystem::path bad = write("bad.urdf", "<robot name=\"r\"/>");
  EXPECT_THROW(run({"robot", bad, "-o", folder() / "robot.json"}), InputError);
  EXPECT_THROW(run({"robot", urdf_, "-o", urdf_}), InputError);
  EXPECT_EQ(files(), (std::set<std::string>{"bad.urdf", "robot.urdf"}));
}

}  // namespace
}  // namespace sopt
