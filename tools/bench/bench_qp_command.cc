#include "tools/bench/bench_qp_command.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "tools/bench/bench_qp_files.h"
#include "tools/bench/bench_qp_report.h"
#include "tools/bench/bench_report.h"
#include "tools/cli/option_checks.h"
#include "tools/io/file_list.h"
#include "tools/io/input_error.h"
#include "tools/io/json_fields.h"
#include "tools/io/json_text.h"
#include "tools/io/output_file.h"
#include "tools/io/qp_file.h"
#include "tools/qp/recorded_qps.h"
#include "tools/scenes/shipped_scenes.h"

namespace sopt {
namespace {

std::string all_families() { return std::string(kQpFamilies) + kRecordedFamily; }

struct BenchQpArguments {
  std::string families = all_families();
  std::vector<std::string> scenes;
  std::vector<std::string> files;
  int num_problems = 40;
  int num_repeats = 20;
  std::uint64_t seed = 1;
  std::string clock = "cpu";
  std::string json_file;
  std::string counts_file;
};

std::string check_families(const std::string& text) {
  const std::set<char> letters(text.begin(), text.end());
  const bool is_known = text.find_first_not_of(all_families()) == std::string::npos;
  if (!text.empty() && is_known && letters.size() == text.size()) return "";
  return '"' + printable(text) + "\" is not allowed; it must be different letters of " +
         all_families();
}

// What two readings in a row differ by; part of every time.
double clock_cost_us(const Clock& clock) {
  std::vector<double> differences_us;
  for (int i = 0; i < 1000; ++i) {
    const std::int64_t begin_ns = clock.now_ns();
    differences_us.push_back(1e-3 * static_cast<double>(clock.now_ns() - begin_ns));
  }
  return summarize(differences_us).median;
}

// What both kinds of run begin with.
nlohmann::ordered_json run_json(const BenchQpArguments& arguments, double clock_us) {
  return {{"schema", 1},
          {"machine", describe_machine()},
          {"options", {{"repeat", arguments.num_repeats}, {"clock", arguments.clock}}},
          {"clock_us", clock_us}};
}

void print_setup(const BenchQpArguments& arguments, double clock_us) {
  (void)std::printf("%s\neach x %d, %s, of which a reading takes %.2f us\n",
                    describe_machine().c_str(), arguments.num_repeats,
                    arguments.clock == "cpu" ? "thread CPU time" : "elapsed time", clock_us);
}

// Paths that are to be written, checked before any work.
void check_paths(const BenchQpArguments& arguments,
                 const std::vector<std::filesystem::path>& inputs) {
  std::vector<std::filesystem::path> outputs;
  for (const std::string& file : {arguments.json_file, arguments.counts_file}) {
    if (!file.empty()) outputs.emplace_back(file);
  }
  check_outputs(outputs, inputs);
}

int run_families(const BenchQpArguments& arguments, const Clock& clock) {
  std::vector<std::filesystem::path> scenes;
  if (arguments.families.find(kRecordedFamily) != std::string::npos) {
    scenes = given_or_shipped_scenes(arguments.scenes);
  } else if (!arguments.scenes.empty()) {
    throw InputError("--scenes: only family p plans scenes, and --families is " +
                     arguments.families);
  }
  check_paths(arguments, scenes);
  std::vector<QpFamily> problems;
  for (const char name : arguments.families) {
    problems.push_back(name == kRecordedFamily
                           ? make_recorded_family(scenes, arguments.seed)
                           : make_qp_family(name, arguments.num_problems, arguments.seed));
  }
  const double clock_us = clock_cost_us(clock);
  print_setup(arguments, clock_us);
  std::vector<BenchQpFamily> families;
  for (const QpFamily& family : problems) {
    families.push_back(run_bench_qp(family, arguments.num_repeats, clock));
    (void)std::fputs(describe(families.back()).c_str(), stdout);
  }
  std::vector<OutputFile> outputs;
  if (!arguments.json_file.empty()) {
    nlohmann::ordered_json document = run_json(arguments, clock_us);
    document["options"].update({{"families", arguments.families},
                                {"problems", arguments.num_problems},
                                {"seed", arguments.seed}});
    document["cases_failed"] = num_failures(families);
    for (const BenchQpFamily& family : families) document["families"].push_back(to_json(family));
    outputs.push_back({arguments.json_file, to_text(document)});
  }
  if (!arguments.counts_file.empty()) {
    outputs.push_back({arguments.counts_file, to_text(counts_json(families))});
  }
  write_files(outputs);
  return num_failures(families) == 0 ? 0 : 1;
}

int run_files(const BenchQpArguments& arguments, const Clock& clock) {
  const std::vector<std::filesystem::path> inputs = list_files(arguments.files, ".qp");
  check_paths(arguments, inputs);
  std::vector<QpProblem> problems;
  for (const std::filesystem::path& input : inputs) problems.push_back(load_qp(input));
  const double clock_us = clock_cost_us(clock);
  print_setup(arguments, clock_us);
  std::vector<BenchQpFile> files;
  for (const QpProblem& problem : problems) {
    files.push_back(bench_qp_file(problem, arguments.num_repeats, clock));
  }
  (void)std::fputs(describe(files).c_str(), stdout);
  if (!arguments.json_file.empty()) {
    nlohmann::ordered_json document = run_json(arguments, clock_us);
    document["cases_failed"] = num_failures(files);
    document.update(to_json(files));
    write_files({{arguments.json_file, to_text(document)}});
  }
  return num_failures(files) == 0 ? 0 : 1;
}

int run_bench_qp_command(const BenchQpArguments& arguments) {
  const Clock clock = arguments.clock == "cpu" ? thread_cpu_clock() : monotonic_clock();
  return arguments.files.empty() ? run_families(arguments, clock) : run_files(arguments, clock);
}

}  // namespace

void add_bench_qp_command(CLI::App& bench, int& exit_code) {
  CLI::App* const command = bench.add_subcommand(
      "qp", "Solve families of segment QPs, cold and from a similar one, or QP files");
  const auto arguments = std::make_shared<BenchQpArguments>();
  auto* const files =
      command
          ->add_option("--files", arguments->files,
                       "Instead of families: problems in the QP1 format, or folders of *.qp, each "
                       "against Cholesky of H and triangular solve of A")
          ->type_name("FILE|DIR")
          ->check(file_check());
  command
      ->add_option(
          "--families", arguments->families,
          "Letters of a, b, c, d (generated), p (recorded from plans) [" + all_families() + ']')
      ->type_name("LETTERS")
      ->check(check_families)
      ->excludes(files);
  command
      ->add_option(
          "--scenes", arguments->scenes,
          std::string("Scene files or folders of them that p plans [") + kShippedScenes + ']')
      ->type_name("FILE|DIR")
      ->check(file_check())
      ->excludes(files);
  command->add_option("--problems", arguments->num_problems, "Pairs per generated family [40]")
      ->type_name("N")
      ->check(integer_check(1, 100000))
      ->excludes(files);
  command->add_option("--repeat", arguments->num_repeats, "Timed solves per problem [20]")
      ->type_name("N")
      ->check(integer_check(1, 1000000));
  command->add_option("--seed", arguments->seed, "Of the problems, for p of the plans [1]")
      ->type_name("N")
      ->check(integer_check(0, UINT64_MAX))
      ->excludes(files);
  command->add_option("--clock", arguments->clock, "elapsed, or cpu: of the thread [cpu]")
      ->type_name("CLOCK")
      ->check(word_check({"elapsed", "cpu"}));
  command->add_option("--json", arguments->json_file, "Write all figures")
      ->type_name("FILE")
      ->check(file_check());
  command->add_option("--counts", arguments->counts_file, "Write working-set changes alone")
      ->type_name("FILE")
      ->check(file_check())
      ->excludes(files);
  command->callback([arguments, &exit_code] { exit_code = run_bench_qp_command(*arguments); });
}

}  // namespace sopt
