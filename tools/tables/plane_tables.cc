#include "tools/tables/plane_tables.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace sopt {
namespace {

constexpr const char* kNumSegments[kNumTableColumns] = {"1", "3", "5", "7", "9", "7", "9"};
constexpr std::size_t kNumFixed = 5;  // the columns before those that merge

TableMode make_mode(char letter, const char* name, const AlgorithmOptions& choices) {
  TableMode mode{letter, name, {}};
  for (std::size_t i = 0; i < kNumTableColumns; ++i) {
    TableRun& column = mode.columns[i];
    column.label = kPaperColumns[i].label;
    column.choices = choices;
    column.choices.segments = kNumSegments[i];
    column.choices.no_merge = i < kNumFixed;
    column.choices.max_window = kLongestWindow;  // or few segments would be raised to more
  }
  return mode;
}

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

// All of `tables`, which may be constant.
template <class Tables>
auto list_runs(Tables& tables) {
  std::vector<decltype(&tables.rrt_star)> runs = {&tables.rrt_star};
  for (auto& mode : tables.modes) {
    for (auto& column : mode.columns) runs.push_back(&column);
  }
  for (auto& run : tables.switches) runs.push_back(&run);
  return runs;
}

void take_sampling_alone(TableCase& c) {
  c.total = c.sample;
  c.optimize = {};
  c.length_m = c.sampled_length_m;
}

}  // namespace

PlaneTables list_plane_tables() {
  PlaneTables tables;
  tables.rrt_star.label = kPaperRrtStar.label;
  tables.rrt_star.choices.sampler = "rrt_star";
  tables.rrt_star.choices.no_shortcut = true;
  tables.rrt_star.choices.no_lattice = true;
  tables.rrt_star.optimizes = false;
  AlgorithmOptions paper;
  paper.paper = true;
  tables.modes.push_back(make_mode('A', "the paper's choices with its dense QP", paper));
  paper.qp = "kernel";
  tables.modes.push_back(make_mode('B', "the paper's choices with the kernel QP", paper));
  tables.modes.push_back(make_mode('C', "the defaults", {}));
  tables.switches = list_switches();
  return tables;
}

PlaneTables run_plane_tables(const std::vector<std::filesystem::path>& scenes, int num_seeds) {
  PlaneTables tables = list_plane_tables();
  tables.num_scenes = static_cast<int>(scenes.size());
  tables.num_seeds = num_seeds;
  const std::vector<TableRun*> runs = list_runs(tables);
  for (const std::filesystem::path& file : scenes) {
    const Scene scene = load_scene(file);
    TimedPlanner planner(scene);
    for (int seed = 1; seed <= num_seeds; ++seed) {
      for (TableRun* const run : runs) {
        PlanRequest<Point2> request =
            planner.make_request(run->choices, static_cast<std::uint64_t>(seed));
        if (!run->optimizes) request.options.max_iterations = 0;
        run->cases.push_back(planner.measure(request));
        if (!run->optimizes) take_sampling_alone(run->cases.back());
      }
    }
  }
  return tables;
}

int num_unplanned(const PlaneTables& tables) {
  std::ptrdiff_t count = 0;
  for (const TableRun* const run : list_runs(tables)) {
    count += std::count_if(run->cases.begin(), run->cases.end(),
                           [](const TableCase& c) { return !c.has_plan; });
  }
  return static_cast<int>(count);
}

}  // namespace sopt
