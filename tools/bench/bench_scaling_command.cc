#include "tools/bench/bench_scaling_command.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "tools/bench/bench_report.h"
#include "tools/bench/bench_scaling.h"
#include "tools/bench/bench_scaling_report.h"
#include "tools/cli/option_checks.h"
#include "tools/io/json_text.h"
#include "tools/io/output_file.h"

namespace sopt {
namespace {

struct BenchScalingArguments {
  BenchScalingOptions options;
  std::vector<std::string> families;
  std::string clock = "cpu";
  std::string json_file;
  std::string svg_folder;
};

std::vector<ScalingFamily> families_of(const std::vector<std::string>& names) {
  std::vector<ScalingFamily> result;
  for (const ScalingFamily family : BenchScalingOptions{}.families) {
    const bool is_named = std::find(names.begin(), names.end(), to_string(family)) != names.end();
    if (names.empty() || is_named) result.push_back(family);
  }
  return result;
}

std::filesystem::path svg_file(const BenchScalingArguments& arguments, ScalingFamily family) {
  return std::filesystem::path(arguments.svg_folder) /
         (std::string("scaling_") + to_string(family) + ".svg");
}

nlohmann::ordered_json document_of(const BenchScalingArguments& arguments,
                                   const std::vector<ScalingRun>& runs) {
  nlohmann::ordered_json document = {{"schema", 1}, {"machine", describe_machine()}};
  document["options"] = {{"clock", arguments.clock},
                         {"seeds", arguments.options.num_seeds},
                         {"repeat", arguments.options.num_repeats},
                         {"samples", nullptr}};
  if (arguments.options.num_samples)
    document["options"]["samples"] = *arguments.options.num_samples;
  document["cases_failed"] = num_failures(runs);
  for (const ScalingRun& run : runs) document["families"].push_back(to_json(run));
  return document;
}

int run_bench_scaling_command(BenchScalingArguments arguments) {
  BenchScalingOptions& options = arguments.options;
  options.families = families_of(arguments.families);
  options.clock = arguments.clock == "cpu" ? thread_cpu_clock() : monotonic_clock();
  std::vector<std::filesystem::path> paths;
  if (!arguments.json_file.empty()) paths.emplace_back(arguments.json_file);
  for (const ScalingFamily family : options.families) {
    if (!arguments.svg_folder.empty()) paths.push_back(svg_file(arguments, family));
  }
  check_outputs(paths, {});
  (void)std::printf("%s\n%d scenes of each size x %d, %s\n", describe_machine().c_str(),
                    options.num_seeds, options.num_repeats,
                    arguments.clock == "cpu" ? "thread CPU time" : "elapsed time");
  const std::vector<ScalingRun> runs = run_bench_scaling(options);
  std::vector<OutputFile> outputs;
  if (!arguments.json_file.empty()) {
    outputs.push_back({arguments.json_file, to_text(document_of(arguments, runs))});
  }
  for (const ScalingRun& run : runs) {
    (void)std::fputs(describe(run).c_str(), stdout);
    if (!arguments.svg_folder.empty()) {
      outputs.push_back({svg_file(arguments, run.family), draw(run)});
    }
  }
  write_files(outputs);
  return num_failures(runs) == 0 ? 0 : 1;
}

}  // namespace

void add_bench_scaling_command(CLI::App& bench, int& exit_code) {
  CLI::App* const command = bench.add_subcommand(
      "scaling", "Fit how planning grows with the horizon and with the number of obstacles");
  const auto arguments = std::make_shared<BenchScalingArguments>();
  command
      ->add_option("--families", arguments->families,
                   "Some of corridor, maze, field, with commas between [all]")
      ->type_name("NAMES")
      ->delimiter(',')
      ->check(word_check({"corridor", "maze", "field"}));
  command->add_option("--max-size", arguments->options.max_size, "Leave out larger sizes [5000]")
      ->type_name("N")
      ->check(integer_check(50, 1000000));
  command->add_option("--seeds", arguments->options.num_seeds, "Scenes of each size [5]")
      ->type_name("N")
      ->check(integer_check(1, 1000000));
  command->add_option("--repeat", arguments->options.num_repeats, "Timed calls per scene [3]")
      ->type_name("N")
      ->check(integer_check(1, 1000000));
  command
      ->add_option("--samples", arguments->options.num_samples,
                   "Samples per stream and batch [20000]")
      ->type_name("N")
      ->check(integer_check(1, 1000000));
  command->add_option("--clock", arguments->clock, "elapsed, or cpu: of the thread [cpu]")
      ->type_name("CLOCK")
      ->check(word_check({"elapsed", "cpu"}));
  command->add_option("--json", arguments->json_file, "Write exponents and cases")
      ->type_name("FILE")
      ->check(file_check());
  command->add_option("--svg-dir", arguments->svg_folder, "Draw a chart of each family")
      ->type_name("DIR")
      ->check(file_check());
  command->callback([arguments, &exit_code] { exit_code = run_bench_scaling_command(*arguments); });
}

}  // namespace sopt
