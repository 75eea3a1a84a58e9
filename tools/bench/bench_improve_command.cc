#include "tools/bench/bench_improve_command.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "tools/bench/bench_improve.h"
#include "tools/bench/bench_report.h"
#include "tools/cli/option_checks.h"
#include "tools/io/json_text.h"
#include "tools/io/output_file.h"
#include "tools/scenes/shipped_scenes.h"

namespace sopt {
namespace {

struct BenchImproveArguments {
  std::vector<std::string> scenes;
  BenchImproveOptions options;
  std::string clock = "cpu";
  std::string json_file;
  std::string svg_file;
};

nlohmann::ordered_json document_of(const BenchImproveArguments& arguments,
                                   const std::vector<ImproveScene>& scenes) {
  nlohmann::ordered_json document = {{"schema", 1}, {"machine", describe_machine()}};
  document["options"] = {{"clock", arguments.clock}, {"seeds", arguments.options.num_seeds}};
  document.update(to_json(scenes, arguments.options.budgets_ms));
  return document;
}

int run_bench_improve_command(BenchImproveArguments arguments) {
  BenchImproveOptions& options = arguments.options;
  std::vector<double>& budgets_ms = options.budgets_ms;
  std::sort(budgets_ms.begin(), budgets_ms.end());
  budgets_ms.erase(std::unique(budgets_ms.begin(), budgets_ms.end()), budgets_ms.end());
  options.clock = arguments.clock == "cpu" ? thread_cpu_clock() : monotonic_clock();
  const std::vector<std::filesystem::path> files = given_or_shipped_scenes(arguments.scenes);
  std::vector<std::filesystem::path> paths;
  for (const std::string& file : {arguments.json_file, arguments.svg_file}) {
    if (!file.empty()) paths.emplace_back(file);
  }
  check_outputs(paths, files);
  const BenchScenes bench_scenes = load_bench_scenes(files);
  (void)std::printf("%s\n%zu scenes x %d seeds, %s\n", describe_machine().c_str(), files.size(),
                    options.num_seeds,
                    arguments.clock == "cpu" ? "thread CPU time" : "elapsed time");
  const std::vector<ImproveScene> scenes = run_bench_improve(bench_scenes, options);
  (void)std::fputs(describe(scenes, budgets_ms).c_str(), stdout);
  std::vector<OutputFile> outputs;
  if (!arguments.json_file.empty()) {
    outputs.push_back({arguments.json_file, to_text(document_of(arguments, scenes))});
  }
  if (!arguments.svg_file.empty()) {
    outputs.push_back({arguments.svg_file, draw(scenes, budgets_ms)});
  }
  write_files(outputs);
  return num_failures(scenes) == 0 ? 0 : 1;
}

}  // namespace

void add_bench_improve_command(CLI::App& bench, int& exit_code) {
  CLI::App* const command =
      bench.add_subcommand("improve", "Measure how much shorter plans get with --improve-ms");
  const auto arguments = std::make_shared<BenchImproveArguments>();
  command
      ->add_option("SCENE", arguments->scenes,
                   std::string("Scene files or folders of them [") + kShippedScenes + ']')
      ->type_name("FILE|DIR");
  command
      ->add_option("--budgets-ms", arguments->options.budgets_ms,
                   "Budgets after the first plan, with commas between [0,1,2,5,..,200]")
      ->type_name("LIST")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(number_check({0.0, 1e9, "a number from 0 to 1e9"}));
  command->add_option("--seeds", arguments->options.num_seeds, "Seeds per scene, from 1 [8]")
      ->type_name("N")
      ->check(integer_check(1, 1000000));
  command->add_option("--clock", arguments->clock, "elapsed, or cpu: of the thread [cpu]")
      ->type_name("CLOCK")
      ->check(word_check({"elapsed", "cpu"}));
  command->add_option("--json", arguments->json_file, "Write curves and records")
      ->type_name("FILE")
      ->check(file_check());
  command->add_option("--svg", arguments->svg_file, "Draw the curves")
      ->type_name("FILE")
      ->check(file_check());
  command->callback([arguments, &exit_code] { exit_code = run_bench_improve_command(*arguments); });
}

}  // namespace sopt
