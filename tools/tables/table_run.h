// A table of the paper made again: every scene with every seed, planned by RRT* alone, by the
// table's columns in several modes, and by the defaults with one of the paper's choices at a time.
// For one scene and seed all of them run in turn, so that a machine that changes its speed changes
// it for all.
#pragma once

#include <string>
#include <vector>

#include "tools/cli/algorithm_options.h"
#include "tools/io/arm_scene.h"
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

// One making of the table.
struct TableMode {
  char letter = '?';
  std::string name;
  std::vector<TableRun> columns;  // as the paper's
};

struct Tables {
  const PaperTable* paper = &kPlaneTable;
  PlanOptions defaults, paper_choices;  // of the robot, for reports
  int num_scenes = 0;
  int num_seeds = 0;
  TableRun rrt_star;               // the sampler alone
  std::vector<TableMode> modes;    // A, B, ..
  std::vector<TableRun> switches;  // the first one: the defaults as they are
};

// Without cases.
[[nodiscard]] TableRun sampler_alone();
[[nodiscard]] TableMode make_mode(char letter, const char* name, const AlgorithmOptions& choices,
                                  const PaperTable& paper);
// The paper's choices with either QP, and the defaults: A, B, C.
[[nodiscard]] std::vector<TableMode> list_modes(const PaperTable& paper);

// Plans `scene` with seeds 1 .. num_seeds. Throws what TimedPlanner throws.
void add_cases(const AnyScene& scene, Tables& tables);

// Cases without any plan.
[[nodiscard]] int num_unplanned(const Tables& tables);
[[nodiscard]] int num_unplanned(const std::vector<Tables>& families);

}  // namespace sopt
