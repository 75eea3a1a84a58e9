// The cases behind `sopt tables plane`: every scene with every seed, planned by RRT* alone, by the
// columns of [Leu22, Table I] in three modes, and by the defaults with one of the paper's choices
// at a time. For one scene and seed all of them run in turn, so that a machine that changes its
// speed changes it for all.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/cli/algorithm_options.h"
#include "tools/tables/paper_table.h"
#include "tools/tables/timed_planner.h"

namespace sopt {

// Cases of one column or row, in the order of scenes and seeds.
struct TableRun {
  std::string label;
  AlgorithmOptions choices;
  bool optimizes = true;
  std::vector<TableCase> cases;
};

// One making of Table I.
struct TableMode {
  char letter = '?';
  std::string name;
  std::array<TableRun, kNumTableColumns> columns;  // as kPaperColumns
};

struct PlaneTables {
  int num_scenes = 0;
  int num_seeds = 0;
  TableRun rrt_star;               // the sampler alone
  std::vector<TableMode> modes;    // A, B, C
  std::vector<TableRun> switches;  // the first one: the defaults as they are
};

// Without cases.
[[nodiscard]] PlaneTables list_plane_tables();

// Throws what load_scene and TimedPlanner throw.
[[nodiscard]] PlaneTables run_plane_tables(const std::vector<std::filesystem::path>& scenes,
                                           int num_seeds);

// Cases without any plan.
[[nodiscard]] int num_unplanned(const PlaneTables& tables);

}  // namespace sopt
