#include "tools/tables_command.h"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "tools/bench/bench_report.h"
#include "tools/cli/option_checks.h"
#include "tools/io/input_error.h"
#include "tools/io/json_fields.h"
#include "tools/io/json_text.h"
#include "tools/io/output_file.h"
#include "tools/scenes/shipped_scenes.h"
#include "tools/tables/arm_tables.h"
#include "tools/tables/plane_tables.h"
#include "tools/tables/tables_figures.h"
#include "tools/tables/tables_report.h"

namespace sopt {
namespace {

constexpr int kPlaneSeeds = 8;
constexpr int kArmSeeds = 3;

struct TablesArguments {
  std::string robot;
  std::vector<std::string> scenes;
  std::optional<int> num_seeds;
  std::string json_file;
  std::string svg_folder;
};

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!std::filesystem::is_directory(folder)) {
    throw InputError("--svg-dir: " + printable(folder.string(), 400) +
                     " is not a folder and cannot be made one");
  }
}

// Before any work.
void check_figure_outputs(const TablesArguments& arguments,
                          const std::vector<std::filesystem::path>& scenes,
                          const std::vector<std::string>& figure_names) {
  std::vector<std::filesystem::path> outputs;
  if (!arguments.json_file.empty()) outputs.emplace_back(arguments.json_file);
  if (!arguments.svg_folder.empty()) {
    make_folder(arguments.svg_folder);
    for (const std::string& name : figure_names) {
      outputs.push_back(std::filesystem::path(arguments.svg_folder) / name);
    }
  }
  check_outputs(outputs, scenes);
}

template <class Draw>
void write_outputs(const TablesArguments& arguments, const nlohmann::ordered_json& tables,
                   Draw draw_figures) {
  std::vector<OutputFile> files;
  if (!arguments.json_file.empty()) {
    nlohmann::ordered_json document = {{"schema", 1}, {"machine", describe_machine()}};
    document.update(tables);
    files.push_back({arguments.json_file, to_text(document)});
  }
  if (!arguments.svg_folder.empty()) {
    for (const TableFigure& figure : draw_figures()) {
      files.push_back({std::filesystem::path(arguments.svg_folder) / figure.name, figure.svg});
    }
  }
  write_files(files);
}

// The exit code. `make_tables(num_seeds)` plans; `draw_figures()` is called when asked for.
template <class Make, class Draw>
int run(const TablesArguments& arguments, std::size_t num_scenes, int num_seeds, Make make_tables,
        Draw draw_figures) {
  (void)std::printf("%s\n%zu scenes x %d seeds, thread CPU time, medians of %d calls\n",
                    describe_machine().c_str(), num_scenes, num_seeds, kNumTimedCalls);
  const auto tables = make_tables(num_seeds);
  const auto summary = summarize(tables);
  (void)std::fputs(describe(tables, summary).c_str(), stdout);
  write_outputs(arguments, to_json(tables, summary), draw_figures);
  return num_unplanned(tables) == 0 ? 0 : 1;
}

int run_plane(const TablesArguments& arguments) {
  const std::vector<std::filesystem::path> scenes = given_or_shipped_scenes(arguments.scenes);
  check_figure_outputs(arguments, scenes, plane_figure_names(scenes.size()));
  return run(
      arguments, scenes.size(), arguments.num_seeds.value_or(kPlaneSeeds),
      [&](int num_seeds) { return run_plane_tables(scenes, num_seeds); },
      [&] { return draw_plane_figures(scenes); });
}

int run_arm(const TablesArguments& arguments) {
  const std::vector<std::filesystem::path> scenes = list_arm_scenes(arguments.scenes);
  check_figure_outputs(arguments, scenes, arm_figure_names());
  const std::vector<ArmFamily> families = group_arm_scenes(scenes);
  return run(
      arguments, scenes.size(), arguments.num_seeds.value_or(kArmSeeds),
      [&](int num_seeds) { return run_arm_tables(families, num_seeds); },
      [&] { return draw_arm_figures(scenes); });
}

}  // namespace

void add_tables_command(CLI::App& app, int& exit_code) {
  const auto arguments = std::make_shared<TablesArguments>();
  CLI::App* const command = app.add_subcommand(
      "tables",
      "Make the paper's tables and figures again, with its choices and with the defaults");
  command->add_option("ROBOT", arguments->robot, "plane or arm")
      ->required()
      ->type_name("")
      ->check(word_check({"plane", "arm"}));
  command
      ->add_option("SCENE", arguments->scenes,
                   std::string("Scene files or folders of them; arms: with 2 or with 7 to 9 "
                               "obstacles [") +
                       kShippedScenes + "; arm_* of " + kArmScenes + ']')
      ->type_name("FILE|DIR");
  command->add_option("--seeds", arguments->num_seeds, "Seeds per scene, from 1 [8; arms 3]")
      ->type_name("N")
      ->check(integer_check(1, 1000000));
  command->add_option("--json", arguments->json_file, "Write all figures of the tables")
      ->type_name("FILE")
      ->check(file_check());
  command->add_option("--svg-dir", arguments->svg_folder, "Draw the figures into this folder")
      ->type_name("DIR")
      ->check(file_check());
  command->callback([arguments, &exit_code] {
    exit_code = arguments->robot == "arm" ? run_arm(*arguments) : run_plane(*arguments);
  });
}

}  // namespace sopt
