#include "tools/bench/bench_command.h"

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "tools/bench/bench_improve_command.h"
#include "tools/bench/bench_plan.h"
#include "tools/bench/bench_qp_command.h"
#include "tools/bench/bench_report.h"
#include "tools/bench/bench_scaling_command.h"
#include "tools/cli/option_checks.h"
#include "tools/io/input_error.h"
#include "tools/io/json_text.h"
#include "tools/io/output_file.h"
#include "tools/scenes/shipped_scenes.h"

namespace sopt {
namespace {

struct BenchArguments {
  std::vector<std::string> scenes;
  BenchPlanOptions options;
  std::string clock = "elapsed";
  std::string json_file;
  bool by_segments = false;
};

int run_by_segments(const BenchScenes& scenes, const BenchArguments& arguments) {
  std::vector<SegmentsRun> runs;
  int failures = 0;
  for (const char* const label : {"3", "5", "7", "9", "auto"}) {
    BenchPlanOptions options = arguments.options;
    options.algorithm.segments = label;
    // Or a small number of segments would be raised.
    if (options.algorithm.segments != "auto" && !options.algorithm.max_window) {
      options.algorithm.max_window = kLongestWindow;
    }
    runs.push_back({options, run_bench(scenes, options)});
    failures += num_failures(runs.back().run);
  }
  if (!arguments.json_file.empty()) {
    write_files({{arguments.json_file, to_text(to_json(runs))}});
  }
  (void)std::fputs(describe_by_segments(runs).c_str(), stdout);
  return failures == 0 ? 0 : 1;
}

int run_bench_plan(BenchArguments arguments) {
  arguments.options.cpu_time = arguments.clock == "cpu";
  const std::vector<std::filesystem::path> files = given_or_shipped_scenes(arguments.scenes);
  std::vector<std::filesystem::path> outputs;
  if (!arguments.json_file.empty()) outputs.emplace_back(arguments.json_file);
  check_outputs(outputs, files);
  const BenchScenes scenes = load_bench_scenes(files);
  (void)std::printf("%s\n%zu scenes x %d seeds x %d, %s\n", describe_machine().c_str(),
                    files.size(), arguments.options.num_seeds, arguments.options.num_repeats,
                    arguments.options.cpu_time ? "thread CPU time" : "elapsed time");
  if (arguments.by_segments) return run_by_segments(scenes, arguments);
  const BenchRun run = run_bench(scenes, arguments.options);
  if (!outputs.empty()) {
    write_files({{arguments.json_file, to_text(to_json(run, arguments.options))}});
  }
  (void)std::fputs(describe_run(run).c_str(), stdout);
  return num_failures(run) == 0 ? 0 : 1;
}

}  // namespace

void add_bench_command(CLI::App& app, int& exit_code) {
  CLI::App* const bench = app.add_subcommand("bench", "Measure");
  bench->require_subcommand(1);
  CLI::App* const command = bench->add_subcommand("plan", "Plan every scene with every seed");
  const auto arguments = std::make_shared<BenchArguments>();
  command
      ->add_option("SCENE", arguments->scenes,
                   std::string("Scene files or folders of them [") + kShippedScenes + ']')
      ->type_name("FILE|DIR");
  command->add_option("--seeds", arguments->options.num_seeds, "Seeds per scene, from 1 [16]")
      ->type_name("N")
      ->check(integer_check(1, 1000000));
  command->add_option("--repeat", arguments->options.num_repeats, "Calls per seed [1]")
      ->type_name("N")
      ->check(integer_check(1, 1000000));
  command->add_option("--clock", arguments->clock, "elapsed, or cpu: of the thread [elapsed]")
      ->type_name("CLOCK")
      ->check(word_check({"elapsed", "cpu"}));
  command->add_option("--json", arguments->json_file, "Write all figures and cases")
      ->type_name("FILE")
      ->check(file_check());
  auto* const converged = command->add_flag("--converged", arguments->options.compare_converged,
                                            "Compare with 200 sweeps");
  command->add_flag("--by-segments", arguments->by_segments, "Run with 3, 5, 7, 9, auto segments")
      ->excludes(converged);
  add_algorithm_options(*command, arguments->options.algorithm);
  command->callback([arguments, &exit_code] { exit_code = run_bench_plan(*arguments); });
  add_bench_qp_command(*bench, exit_code);
  add_bench_improve_command(*bench, exit_code);
  add_bench_scaling_command(*bench, exit_code);
}

}  // namespace sopt
