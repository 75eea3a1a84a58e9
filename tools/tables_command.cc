#include "tools/tables_command.h"

#include <cstdio>
#include <filesystem>
#include <memory>
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
#include "tools/tables/plane_tables.h"
#include "tools/tables/tables_figures.h"
#include "tools/tables/tables_report.h"

namespace sopt {
namespace {

struct TablesArguments {
  std::string robot;
  std::vector<std::string> scenes;
  int num_seeds = 8;
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

int run_tables(const TablesArguments& arguments) {
  const std::vector<std::filesystem::path> scenes = given_or_shipped_scenes(arguments.scenes);
  std::vector<std::filesystem::path> outputs;
  if (!arguments.json_file.empty()) outputs.emplace_back(arguments.json_file);
  if (!arguments.svg_folder.empty()) {
    make_folder(arguments.svg_folder);
    for (const std::string& name : figure_names(scenes.size())) {
      outputs.push_back(std::filesystem::path(arguments.svg_folder) / name);
    }
  }
  check_outputs(outputs, scenes);
  (void)std::printf("%s\n%zu scenes x %d seeds, thread CPU time, medians of %d calls\n",
                    describe_machine().c_str(), scenes.size(), arguments.num_seeds, kNumTimedCalls);
  const PlaneTables tables = run_plane_tables(scenes, arguments.num_seeds);
  const TablesSummary summary = summarize(tables);
  (void)std::fputs(describe(tables, summary).c_str(), stdout);

  std::vector<OutputFile> files;
  if (!arguments.json_file.empty()) {
    nlohmann::ordered_json document = {{"schema", 1}, {"machine", describe_machine()}};
    document.update(to_json(tables, summary));
    files.push_back({arguments.json_file, to_text(document)});
  }
  if (!arguments.svg_folder.empty()) {
    for (const TableFigure& figure : draw_figures(scenes)) {
      files.push_back({std::filesystem::path(arguments.svg_folder) / figure.name, figure.svg});
    }
  }
  write_files(files);
  return num_unplanned(tables) == 0 ? 0 : 1;
}

}  // namespace

void add_tables_command(CLI::App& app, int& exit_code) {
  const auto arguments = std::make_shared<TablesArguments>();
  CLI::App* const command = app.add_subcommand(
      "tables", "Make the paper's table and figures again, with its choices and with the defaults");
  command->add_option("ROBOT", arguments->robot, "plane")
      ->required()
      ->type_name("")
      ->check(word_check({"plane"}));
  command
      ->add_option("SCENE", arguments->scenes,
                   std::string("Scene files or folders of them [") + kShippedScenes + ']')
      ->type_name("FILE|DIR");
  command->add_option("--seeds", arguments->num_seeds, "Seeds per scene, from 1 [8]")
      ->type_name("N")
      ->check(integer_check(1, 1000000));
  command->add_option("--json", arguments->json_file, "Write all figures of the tables")
      ->type_name("FILE")
      ->check(file_check());
  command->add_option("--svg-dir", arguments->svg_folder, "Draw the figures into this folder")
      ->type_name("DIR")
      ->check(file_check());
  command->callback([arguments, &exit_code] { exit_code = run_tables(*arguments); });
}

}  // namespace sopt
