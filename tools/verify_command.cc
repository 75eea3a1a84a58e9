#include "tools/verify_command.h"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <type_traits>
#include <variant>

#include "opt/verify/verify.h"
#include "tools/cli/option_checks.h"
#include "tools/io/json_fields.h"
#include "tools/io/json_text.h"
#include "tools/io/output_file.h"
#include "tools/io/plan_file.h"
#include "tools/io/plan_report.h"

namespace sopt {
namespace {

struct VerifyArguments {
  std::string scene;
  std::string plan;
  std::string robot;  // the scene's when empty
  std::string json;
};

template <class Robot>
nlohmann::ordered_json answer_to_json(const SceneOf<Robot>& scene,
                                      const VerifyResult<Robot>& result) {
  nlohmann::ordered_json answer;
  answer["scene"] = scene.name;
  answer["verified"] = result.plan.has_value();
  if (result.plan) {
    answer["certificate"] = certificate_to_json(scene.obstacle_ids, result.plan->certificate());
  } else {
    const Violation& violation = result.violation;
    answer["violation"] = {{"kind", to_string(violation.kind)},
                           {"step", violation.step},
                           {"t_s", violation.t_s},
                           {"link", violation.i_link},
                           {"obstacle", obstacle_to_json(scene.obstacle_ids, violation.i_obstacle)},
                           {"amount", violation.amount}};
    if (violation.i_joint != kNoJoint) answer["violation"]["joint"] = violation.i_joint;
    if (violation.i_other_link != kNoLink) {
      answer["violation"]["other_link"] = violation.i_other_link;
    }
  }
  return answer;
}

template <class Robot>
int verify_plan(const VerifyArguments& arguments, const SceneOf<Robot>& scene) {
  const ReceivedPlan<Robot> received = load_plan<Robot>(arguments.plan, scene.robot_name);
  VerifyProblem<Robot> problem;
  problem.start = scene.start;
  problem.goal = scene.goal;
  problem.world = scene.world.get();
  problem.min_clearance_m = make_request(scene).options.min_clearance_m;
  const VerifyResult<Robot> result = verify(robot_of(scene), received.trajectory, problem);

  if (!arguments.json.empty()) {
    write_files({{arguments.json, to_text(answer_to_json<Robot>(scene, result))}});
  }
  std::string text = (result.plan ? "verified  " : "rejected  ") + printable(received.scene_name) +
                     ", " + std::to_string(received.trajectory.horizon()) + " steps\n";
  if (received.scene_name != scene.name) {
    text += "  note          the scene here is " + printable(scene.name) + '\n';
  }
  if (result.plan) {
    text += describe_certificate<Robot>(scene, result.plan->certificate());
  } else if (received.trajectory.horizon() == 0) {
    text += "  the file holds no plan, its status is " + received.status + '\n';
  } else {
    text +=
        "  " + describe_violation<Robot>(scene, result.violation, problem.min_clearance_m) + '\n';
  }
  (void)std::fputs(text.c_str(), stdout);
  return result.plan ? 0 : 1;
}

int run_verify(const VerifyArguments& arguments) {
  if (!arguments.json.empty()) {
    check_outputs({arguments.json}, {arguments.scene, arguments.plan, arguments.robot});
  }
  const AnyScene any = load_any_scene(arguments.scene, arguments.robot);
  return std::visit(
      [&](const auto& scene) {
        return verify_plan<std::decay_t<decltype(robot_of(scene))>>(arguments, scene);
      },
      any);
}

}  // namespace

void add_verify_command(CLI::App& app, int& exit_code) {
  const auto arguments = std::make_shared<VerifyArguments>();
  CLI::App* const command =
      app.add_subcommand("verify",
                         "Check a plan file against its scene, independently of the "
                         "planner: prints the certificate or the first violation");
  command->add_option("SCENE", arguments->scene, "Scene file")->required()->type_name("FILE");
  command->add_option("PLAN", arguments->plan, "Plan file, as written by sopt plan -o")
      ->required()
      ->type_name("FILE");
  command
      ->add_option("--robot", arguments->robot, "Robot in place of the scene's, as it was planned")
      ->type_name("NAME|FILE")
      ->check(file_check());
  command->add_option("--json", arguments->json, "Write the answer for machines")
      ->type_name("FILE")
      ->check(file_check());
  command->callback([arguments, &exit_code] { exit_code = run_verify(*arguments); });
}

}  // namespace sopt
