#include "tools/robot_command.h"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "models/config.h"
#include "tools/cli/option_checks.h"
#include "tools/io/json_fields.h"
#include "tools/io/json_text.h"
#include "tools/io/output_file.h"
#include "tools/io/plan_report.h"
#include "tools/io/robot_file.h"
#include "tools/io/urdf_robot.h"

namespace sopt {
namespace {

struct RobotArguments {
  std::string urdf;
  std::string output;
  std::string json;
};

nlohmann::ordered_json answer_to_json(const UrdfRobot& robot) {
  nlohmann::ordered_json answer;
  answer["robot"] = robot.model.name;
  answer["active_joints"] = robot.model.active_joints;
  answer["approximations"] = nlohmann::ordered_json::array();
  for (const CapsuleApproximation& a : robot.approximations) {
    const Capsule3& c = a.capsule;
    nlohmann::ordered_json ratio;  // null where the shape encloses no volume
    if (a.volume_ratio > 0.0) ratio = a.volume_ratio;
    answer["approximations"].push_back({{"link", a.link},
                                        {"geometry", a.geometry},
                                        {"visual", a.is_visual},
                                        {"p0", {c.p0.x(), c.p0.y(), c.p0.z()}},
                                        {"p1", {c.p1.x(), c.p1.y(), c.p1.z()}},
                                        {"radius", c.radius_m},
                                        {"volume_ratio", ratio}});
  }
  return answer;
}

std::string describe(const CapsuleApproximation& a) {
  char sizes[96];
  (void)std::snprintf(sizes, sizeof sizes, "capsule %.4g x %.4g m", a.capsule.radius_m,
                      (a.capsule.p1 - a.capsule.p0).norm());
  char ratio[48] = "no volume to compare";
  if (a.volume_ratio > 0.0) {
    (void)std::snprintf(ratio, sizeof ratio, "%.2f times the volume", a.volume_ratio);
  }
  return "  " + printable(a.link) + ": " + (a.is_visual ? "visual " : "") + a.geometry + " -> " +
         sizes + ", " + ratio + '\n';
}

std::string describe(const UrdfRobot& robot) {
  std::string names;
  for (const std::string& name : robot.model.active_joints) {
    names += (names.empty() ? "" : ", ") + printable(name);
  }
  std::string text = printable(robot.model.name) + ", " + std::to_string(robot.model.links.size()) +
                     " links, " + std::to_string(robot.model.joints.size()) + " joints\n";
  text += "  active joints: " + (names.empty() ? "none" : names) + '\n';
  text += format("  acceleration limits: %g x velocity limit per second, URDF has none\n",
                 kAccelerationPerVelocity);
  text += "  self-collision: links that are no neighbours and apart at home\n";
  for (const CapsuleApproximation& a : robot.approximations) text += describe(a);
  return text;
}

int run_robot(const RobotArguments& arguments) {
  std::vector<std::filesystem::path> outputs = {arguments.output};
  if (!arguments.json.empty()) outputs.emplace_back(arguments.json);
  check_outputs(outputs, {arguments.urdf});
  const UrdfRobot robot = load_urdf(arguments.urdf);
  std::vector<OutputFile> files = {{arguments.output, to_text(robot_to_json(robot.model))}};
  if (!arguments.json.empty()) files.push_back({arguments.json, to_text(answer_to_json(robot))});
  write_files(files);
  (void)std::fputs(describe(robot).c_str(), stdout);
  return 0;
}

}  // namespace

void add_robot_command(CLI::App& app, int& exit_code) {
  const auto arguments = std::make_shared<RobotArguments>();
  CLI::App* const command = app.add_subcommand(
      "robot", "Convert a URDF to a robot file: its chain and limits, its shapes as capsules");
  command->add_option("URDF", arguments->urdf, "URDF file")->required()->type_name("FILE");
  command->add_option("-o,--output", arguments->output, "Write the robot file")
      ->required()
      ->type_name("FILE")
      ->check(file_check());
  command->add_option("--json", arguments->json, "Write what was approximated, for machines")
      ->type_name("FILE")
      ->check(file_check());
  command->callback([arguments, &exit_code] { exit_code = run_robot(*arguments); });
}

}  // namespace sopt
