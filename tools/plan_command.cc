#include "tools/plan_command.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "opt/planner.h"
#include "tools/cli/algorithm_options.h"
#include "tools/cli/option_checks.h"
#include "tools/cli/planner_host.h"
#include "tools/io/arm_picture.h"
#include "tools/io/html_page.h"
#include "tools/io/input_error.h"
#include "tools/io/json_text.h"
#include "tools/io/output_file.h"
#include "tools/io/plan_file.h"
#include "tools/io/plan_page.h"
#include "tools/io/plan_picture.h"
#include "tools/io/plan_report.h"

namespace sopt {
namespace {

struct PlanArguments {
  std::string scene;
  std::string robot;  // the scene's when empty
  std::uint64_t seed = 1;
  std::optional<double> deadline_ms;
  AlgorithmOptions algorithm;
  int num_calls = 1;
  std::string plan_file;
  std::string svg_file;
  std::string html_file;
  std::string csv_file;

  [[nodiscard]] std::vector<std::filesystem::path> outputs() const {
    std::vector<std::filesystem::path> files;
    for (const std::string& file : {plan_file, svg_file, html_file, csv_file}) {
      if (!file.empty()) files.emplace_back(file);
    }
    return files;
  }
};

// The fastest that --speed may ask for.
double speed_limit(const Scene& scene) { return scene.robot.v_max_mps; }
template <int N>
double speed_limit(const ArmScene<N>& /*scene*/) {
  return std::numeric_limits<double>::infinity();  // joints have limits of their own
}

template <class Robot>
PlanRequest<Robot> make_request(const SceneOf<Robot>& scene, const PlanArguments& arguments) {
  PlanRequest<Robot> request = make_request(scene);
  request.seed = arguments.seed;
  if (arguments.deadline_ms) request.deadline_s = *arguments.deadline_ms / 1000.0;
  PlanOptions& options = request.options;
  apply(arguments.algorithm, options);
  if (options.speed_mps > speed_limit(scene)) {
    throw InputError(format("--speed: %g is not allowed; it must be at most limits.v_max of %s, %g",
                            options.speed_mps, printable(scene.file.string(), 400).c_str(),
                            speed_limit(scene)));
  }
  if (options.margin_m < options.min_clearance_m) {
    throw InputError(format("--margin: %g is not allowed; it must be at least min_clearance, %g",
                            options.margin_m, options.min_clearance_m));
  }
  return request;
}

std::int64_t median(std::vector<StageTimes>& calls, std::int64_t StageTimes::*stage) {
  const auto middle = calls.begin() + static_cast<std::ptrdiff_t>(calls.size() / 2);
  std::nth_element(
      calls.begin(), middle, calls.end(),
      [stage](const StageTimes& a, const StageTimes& b) { return a.*stage < b.*stage; });
  return *middle.*stage;
}

StageTimes medians(std::vector<StageTimes> calls) {
  StageTimes result;
  for (const auto stage :
       {&StageTimes::sample_ns, &StageTimes::shortcut_ns, &StageTimes::reference_ns,
        &StageTimes::optimize_ns, &StageTimes::verify_ns, &StageTimes::total_ns}) {
    result.*stage = median(calls, stage);
  }
  return result;
}

void add_columns(std::string& text, const char* name, const char* unit, int num) {
  for (int i = 0; i < num; ++i) text += format(",%s%d_%s", name, i + 1, unit);
}

std::string csv_header(const Scene& /*scene*/) { return "t_s,x_m,y_m,vx_mps,vy_mps\n"; }
template <int N>
std::string csv_header(const ArmScene<N>& /*scene*/) {
  std::string text = "t_s";
  add_columns(text, "theta", "rad", N);
  add_columns(text, "omega", "radps", N);
  add_columns(text, "alpha", "radps2", N);
  return text + '\n';
}

template <class Robot>
std::string trajectory_to_csv(const SceneOf<Robot>& scene, const PlanResult<Robot>& result) {
  std::string text = csv_header(scene);
  if (!result.plan) return text;
  const Trajectory<Robot>& trajectory = result.plan->trajectory();
  for (int i = 0; i <= trajectory.horizon(); ++i) {
    text += format("%.17g", i * trajectory.dt_s);
    for (const double value : trajectory.states[i]) text += format(",%.17g", value);
    for (int k = 0; k < static_cast<int>(Robot::Input::SizeAtCompileTime); ++k) {
      text += i == trajectory.horizon() ? "," : format(",%.17g", trajectory.inputs[i][k]);
    }
    text += '\n';
  }
  return text;
}

// The picture of the plane is a map, that of space an isometric view.
std::string draw_plan(const Scene& scene, const Planner<Point2>& planner,
                      const PlanResult<Point2>& result, const StageTimes& times) {
  return draw(picture_of(scene, planner, result, times));
}
template <int N>
std::string draw_plan(const ArmScene<N>& scene, const Planner<Arm<N>>& /*planner*/,
                      const PlanResult<Arm<N>>& result, const StageTimes& times) {
  return draw(picture_of(scene, result, times));
}

template <class Robot>
int plan_scene(const PlanArguments& arguments, const SceneOf<Robot>& scene) {
  const PlanRequest<Robot> request = make_request<Robot>(scene, arguments);
  const auto host = std::make_unique<PlannerHost<Robot>>(scene, request.options);
  Planner<Robot>& planner = host->planner();

  std::vector<StageTimes> calls;
  PlanResult<Robot> result;
  for (int i = 0; i < arguments.num_calls; ++i) {
    result = PlanResult<Robot>{};  // gives the slot back
    result = planner.plan(request);
    calls.push_back(result.times);
  }
  const StageTimes times = medians(calls);

  std::vector<OutputFile> files;
  if (!arguments.plan_file.empty()) {
    files.push_back({arguments.plan_file, plan_to_text<Robot>(scene, request, result, times)});
  }
  if (!arguments.svg_file.empty()) {
    files.push_back({arguments.svg_file, draw_plan(scene, planner, result, times)});
  }
  if (!arguments.html_file.empty()) {
    files.push_back({arguments.html_file, html_page(page_of(scene, request, result, times))});
  }
  if (!arguments.csv_file.empty()) {
    files.push_back({arguments.csv_file, trajectory_to_csv<Robot>(scene, result)});
  }
  write_files(files);
  std::string text = describe_plan<Robot>(scene, result, times, arguments.num_calls);
  for (const OutputFile& file : files) {
    text +=
        (&file == &files.front() ? "  wrote         " : ", ") + printable(file.file.string(), 400);
  }
  if (!files.empty()) text += '\n';
  (void)std::fputs(text.c_str(), stdout);
  return result.plan ? 0 : 1;
}

int run_plan(const PlanArguments& arguments) {
  check_outputs(arguments.outputs(), {arguments.scene, arguments.robot});
  const AnyScene any = load_any_scene(arguments.scene, arguments.robot);
  return std::visit(
      [&](const auto& scene) {
        return plan_scene<std::decay_t<decltype(robot_of(scene))>>(arguments, scene);
      },
      any);
}

void add_request_options(CLI::App& command, PlanArguments& arguments) {
  constexpr NumberRule kDeadline{1e-6, 1e9, "a number > 0, from 1e-6 to 1e9"};
  command.add_option("--robot", arguments.robot, "Robot in place of the scene's")
      ->type_name("NAME|FILE")
      ->check(file_check());
  command.add_option("--seed", arguments.seed, "Seed of the random numbers [1]")
      ->type_name("N")
      ->check(integer_check(0, UINT64_MAX));
  command
      .add_option("--deadline-ms", arguments.deadline_ms,
                  "Answer within this time of the call [none: the work budget bounds it]")
      ->type_name("T")
      ->check(number_check(kDeadline));
  add_algorithm_options(command, arguments.algorithm);
}

}  // namespace

void add_plan_command(CLI::App& app, int& exit_code) {
  const auto arguments = std::make_shared<PlanArguments>();
  CLI::App* const command =
      app.add_subcommand("plan",
                         "Plan, verify and report; options go before the scene's own "
                         "values, those before the defaults in brackets");
  command->add_option("SCENE", arguments->scene, "Scene file")->required()->type_name("FILE");
  add_request_options(*command, *arguments);
  command->add_option("-o", arguments->plan_file, "Write the plan, or why there is none")
      ->type_name("PLAN.json")
      ->check(file_check());
  command->add_option("--svg", arguments->svg_file, "Draw the plan")
      ->type_name("FILE")
      ->check(file_check());
  command
      ->add_option("--html", arguments->html_file,
                   "Show the plan in a page of its own: scene, motion, plots")
      ->type_name("FILE")
      ->check(file_check());
  command->add_option("--csv", arguments->csv_file, "Write the trajectory as a table")
      ->type_name("FILE")
      ->check(file_check());
  command->add_option("--repeat", arguments->num_calls, "Calls to take median times over [1]")
      ->type_name("N")
      ->check(integer_check(1, 1000000));
  command->callback([arguments, &exit_code] { exit_code = run_plan(*arguments); });
}

}  // namespace sopt
