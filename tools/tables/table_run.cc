#include "tools/tables/table_run.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <variant>

namespace sopt {
namespace {

// All of `tables`, which may be constant.
template <class AnyTables>
auto list_runs(AnyTables& tables) {
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
  c.length = c.sampled_length;
}

template <class Robot>
void add_cases_of(const SceneOf<Robot>& scene, Tables& tables) {
  TimedPlanner<Robot> planner(scene);
  const std::vector<TableRun*> runs = list_runs(tables);
  for (int seed = 1; seed <= tables.num_seeds; ++seed) {
    for (TableRun* const run : runs) {
      PlanRequest<Robot> request =
          planner.make_request(run->choices, static_cast<std::uint64_t>(seed));
      if (!run->optimizes) request.options.max_iterations = 0;
      run->cases.push_back(planner.measure(request));
      if (!run->optimizes) take_sampling_alone(run->cases.back());
    }
  }
}

}  // namespace

TableRun sampler_alone() {
  TableRun run;
  run.label = "RRT*";
  run.choices.sampler = "rrt_star";
  run.choices.no_shortcut = true;
  run.choices.no_lattice = true;
  run.optimizes = false;
  return run;
}

TableMode make_mode(char letter, const char* name, const AlgorithmOptions& choices,
                    const PaperTable& paper) {
  TableMode mode{letter, name, {}};
  for (const PaperColumn& column : paper.columns) {
    TableRun& run = mode.columns.emplace_back();
    run.label = column.label;
    run.choices = choices;
    run.choices.segments = std::to_string(column.num_segments);
    run.choices.no_merge = !column.merges;
    run.choices.max_window = kLongestWindow;  // or few segments would be raised to more
  }
  return mode;
}

std::vector<TableMode> list_modes(const PaperTable& paper) {
  AlgorithmOptions dense, kernel;
  dense.paper = true;
  kernel.paper = true;
  kernel.qp = "kernel";
  return {make_mode('A', "the paper's choices with its dense QP", dense, paper),
          make_mode('B', "the paper's choices with the kernel QP", kernel, paper),
          make_mode('C', "the defaults", {}, paper)};
}

void add_cases(const AnyScene& scene, Tables& tables) {
  std::visit(
      [&](const auto& typed) {
        add_cases_of<std::decay_t<decltype(robot_of(typed))>>(typed, tables);
      },
      scene);
}

int num_unplanned(const Tables& tables) {
  std::ptrdiff_t count = 0;
  for (const TableRun* const run : list_runs(tables)) {
    count += std::count_if(run->cases.begin(), run->cases.end(),
                           [](const TableCase& c) { return !c.has_plan; });
  }
  return static_cast<int>(count);
}

int num_unplanned(const std::vector<Tables>& families) {
  int count = 0;
  for (const Tables& tables : families) count += num_unplanned(tables);
  return count;
}

}  // namespace sopt
