#include "tools/plan_command.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "opt/planner.h"
#include "tools/cli/algorithm_options.h"
#include "tools/cli/option_checks.h"
#include "tools/cli/planner_host.h"
#include "tools/io/input_error.h"
#include "tools/io/json_text.h"
#include "tools/io/output_file.h"
#include "tools/io/plan_file.h"
#include "tools/io/plan_picture.h"
#include "tools/io/plan_report.h"

namespace sopt {
namespace {

struct PlanArguments {
  std::string scene;
  std::string robot = "point2d";
  std::uint64_t seed = 1;
  std::optional<double> deadline_ms;
  AlgorithmOptions algorithm;
  int num_calls = 1;
  std::string plan_file;
  std::string svg_file;
  std::string csv_file;

  [[nodiscard]] std::vector<std::filesystem::path> outputs() const {
    std::vector<std::filesystem::path> files;
    for (const std::string& file : {plan_file, svg_file, csv_file}) {
      if (!file.empty()) files.emplace_back(file);
    }
    return files;
  }
};

PlanRequest<Point2> make_request(const Scene& scene, const PlanArguments& arguments) {
  PlanRequest<Point2> request = make_request(scene);
  request.seed = arguments.seed;
  if (arguments.deadline_ms) request.deadline_s = *arguments.deadline_ms / 1000.0;
  PlanOptions& options = request.options;
  apply(arguments.algorithm, options);
  if (options.speed_mps > scene.robot.v_max_mps) {
    throw InputError(format("--speed: %g is not allowed; it must be at most limits.v_max of %s, %g",
                            options.speed_mps, printable(scene.file.string(), 400).c_str(),
                            scene.robot.v_max_mps));
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

std::string trajectory_to_csv(const PlanResult<Point2>& result) {
  std::string text = "t_s,x_m,y_m,vx_mps,vy_mps\n";
  if (!result.plan) return text;
  const Trajectory<Point2>& trajectory = result.plan->trajectory();
  for (int i = 0; i <= trajectory.horizon(); ++i) {
    const Vec2& state = trajectory.states[i];
    text += format("%.17g,%.17g,%.17g,", i * trajectory.dt_s, state.x(), state.y());
    const bool is_last = i == trajectory.horizon();
    text += is_last ? ",\n"
                    : format("%.17g,%.17g\n", trajectory.inputs[i].x(), trajectory.inputs[i].y());
  }
  return text;
}

int run_plan(const PlanArguments& arguments) {
  const std::vector<std::filesystem::path> outputs = arguments.outputs();
  check_outputs(outputs, {arguments.scene});
  const Scene scene = load_scene(arguments.scene);
  const PlanRequest<Point2> request = make_request(scene, arguments);
  const auto host = std::make_unique<PlannerHost>(scene, request.options);
  Planner<Point2>& planner = host->planner();

  std::vector<StageTimes> calls;
  PlanResult<Point2> result;
  for (int i = 0; i < arguments.num_calls; ++i) {
    result = PlanResult<Point2>{};  // gives the slot back
    result = planner.plan(request);
    calls.push_back(result.times);
  }
  const StageTimes times = medians(calls);

  std::vector<OutputFile> files;
  if (!arguments.plan_file.empty()) {
    files.push_back({arguments.plan_file, plan_to_text(scene, request, result, times)});
  }
  if (!arguments.svg_file.empty()) {
    files.push_back({arguments.svg_file, draw(picture_of(scene, planner, result, times))});
  }
  if (!arguments.csv_file.empty()) {
    files.push_back({arguments.csv_file, trajectory_to_csv(result)});
  }
  write_files(files);
  std::string text = describe_plan(scene, result, times, arguments.num_calls);
  for (const OutputFile& file : files) {
    text +=
        (&file == &files.front() ? "  wrote         " : ", ") + printable(file.file.string(), 400);
  }
  if (!files.empty()) text += '\n';
  (void)std::fputs(text.c_str(), stdout);
  return result.plan ? 0 : 1;
}

void add_request_options(CLI::App& command, PlanArguments& arguments) {
  constexpr NumberRule kDeadline{1e-6, 1e9, "a number > 0, from 1e-6 to 1e9"};
  command.add_option("--robot", arguments.robot, "Robot of the scene")
      ->type_name("NAME")
      ->check(word_check({"point2d"}));
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
  command->add_option("--csv", arguments->csv_file, "Write the trajectory as a table")
      ->type_name("FILE")
      ->check(file_check());
  command->add_option("--repeat", arguments->num_calls, "Calls to take median times over [1]")
      ->type_name("N")
      ->check(integer_check(1, 1000000));
  command->callback([arguments, &exit_code] { exit_code = run_plan(*arguments); });
}

}  // namespace sopt
