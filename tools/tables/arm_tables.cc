#include "tools/tables/arm_tables.h"

#include <algorithm>
#include <variant>

#include "tools/io/file_list.h"
#include "tools/io/input_error.h"
#include "tools/io/json_fields.h"
#include "tools/io/plan_report.h"

namespace sopt {
namespace {

std::vector<TableRun> list_switches() {
  std::vector<TableRun> switches;
  const auto add = [&](const char* label, auto choose) {
    TableRun& run = switches.emplace_back();
    run.label = label;
    run.choices.max_window = PlannerSettings::arm().max_window;
    choose(run.choices);
  };
  using Choices = AlgorithmOptions;
  add("defaults", [](Choices&) {});
  add("--sampler rrt_star", [](Choices& c) { c.sampler = "rrt_star"; });
  add("--no-shortcut", [](Choices& c) { c.no_shortcut = true; });
  add("--qp dense", [](Choices& c) { c.qp = "dense"; });
  add("--start zero_input", [](Choices& c) { c.start = "zero_input"; });
  add("--no-accept", [](Choices& c) { c.no_accept = true; });
  add("--merge-rule printed", [](Choices& c) { c.merge_rule = "printed"; });
  add("--resample off", [](Choices& c) { c.resample = "off"; });
  add("--paper (all of these)", [](Choices& c) { c.paper = true; });
  return switches;
}

bool is_family(const PaperTable& paper, int num_obstacles) {
  return &paper == &kArmFewTable ? num_obstacles == 2 : num_obstacles >= 7 && num_obstacles <= 9;
}

int count_obstacles(const std::filesystem::path& file) {
  const AnyScene scene = load_any_scene(file);
  if (std::holds_alternative<Scene>(scene)) {
    throw InputError(printable(file.string(), 400) + ": robot: point2d is not an arm");
  }
  return std::visit([](const auto& typed) { return typed.world->num_obstacles(); }, scene);
}

}  // namespace

Tables list_arm_tables(const PaperTable& paper) {
  Tables tables;
  tables.paper = &paper;
  tables.defaults = PlanOptions::arm();
  tables.paper_choices = PlanOptions::paper_arm();
  tables.rrt_star = sampler_alone();
  tables.modes = list_modes(paper);
  AlgorithmOptions unchecked;
  unchecked.no_accept = true;
  tables.modes.push_back(
      make_mode('D', "the defaults without their window check", unchecked, paper));
  tables.switches = list_switches();
  return tables;
}

std::vector<std::filesystem::path> list_arm_scenes(const std::vector<std::string>& arguments) {
  if (!arguments.empty()) return list_files(arguments, ".json");
  if (!std::filesystem::is_directory(kArmScenes)) {
    throw InputError(
        format("SCENE: none given, and there is no folder %s here; give scene files "
               "or a folder of them",
               kArmScenes));
  }
  std::vector<std::filesystem::path> files = list_files({kArmScenes}, ".json");
  std::erase_if(files, [](const auto& file) { return !file.stem().string().starts_with("arm_"); });
  return files;
}

std::vector<ArmFamily> group_arm_scenes(const std::vector<std::filesystem::path>& scenes) {
  std::vector<ArmFamily> families = {{&kArmFewTable, {}}, {&kArmManyTable, {}}};
  for (const std::filesystem::path& file : scenes) {
    const int num_obstacles = count_obstacles(file);
    const auto family = std::ranges::find_if(
        families, [&](const ArmFamily& f) { return is_family(*f.paper, num_obstacles); });
    if (family == families.end()) {
      throw InputError(
          format("%s: obstacles: %d is not allowed; the paper's table has scenes with "
                 "2 and with 7 to 9",
                 printable(file.string(), 400).c_str(), num_obstacles));
    }
    family->scenes.push_back(file);
  }
  std::erase_if(families, [](const ArmFamily& family) { return family.scenes.empty(); });
  return families;
}

std::vector<Tables> run_arm_tables(const std::vector<ArmFamily>& families, int num_seeds) {
  std::vector<Tables> result;
  for (const ArmFamily& family : families) {
    Tables& tables = result.emplace_back(list_arm_tables(*family.paper));
    tables.num_scenes = static_cast<int>(family.scenes.size());
    tables.num_seeds = num_seeds;
    for (const std::filesystem::path& file : family.scenes) {
      add_cases(load_any_scene(file), tables);
    }
  }
  return result;
}

}  // namespace sopt
