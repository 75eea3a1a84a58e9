#include "tools/tables/plane_tables.h"

namespace sopt {
namespace {

std::vector<TableRun> list_switches() {
  std::vector<TableRun> switches;
  const auto add = [&](const char* label, auto choose) {
    TableRun& run = switches.emplace_back();
    run.label = label;
    run.choices.max_window = PlannerSettings().max_window;
    choose(run.choices);
  };
  using Choices = AlgorithmOptions;
  add("defaults", [](Choices&) {});
  add("--sampler rrt_star", [](Choices& c) { c.sampler = "rrt_star"; });
  add("--no-shortcut", [](Choices& c) { c.no_shortcut = true; });
  add("--no-lattice", [](Choices& c) { c.no_lattice = true; });
  add("--rows waypoint", [](Choices& c) { c.rows = "waypoint"; });
  add("--rows label_map", [](Choices& c) { c.rows = "label_map"; });
  add("--qp dense", [](Choices& c) { c.qp = "dense"; });
  add("--start zero_input", [](Choices& c) { c.start = "zero_input"; });
  add("--no-accept", [](Choices& c) { c.no_accept = true; });
  add("--merge-rule printed", [](Choices& c) { c.merge_rule = "printed"; });
  add("--resample rediscretise", [](Choices& c) { c.resample = "rediscretise"; });
  add("--paper (all of these)", [](Choices& c) { c.paper = true; });
  return switches;
}

}  // namespace

Tables list_plane_tables() {
  Tables tables;
  tables.paper_choices = paper_options<Point2>();
  tables.rrt_star = sampler_alone();
  tables.modes = list_modes(*tables.paper);
  tables.switches = list_switches();
  return tables;
}

Tables run_plane_tables(const std::vector<std::filesystem::path>& scenes, int num_seeds) {
  Tables tables = list_plane_tables();
  tables.num_scenes = static_cast<int>(scenes.size());
  tables.num_seeds = num_seeds;
  for (const std::filesystem::path& file : scenes) add_cases(load_scene(file), tables);
  return tables;
}

}  // namespace sopt
