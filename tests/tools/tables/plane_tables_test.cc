#include "tools/tables/plane_tables.h"

#include <gtest/gtest.h>

namespace sopt {
namespace {

std::vector<std::filesystem::path> one_scene() {
  return {SOPT_SOURCE_DIR "/tools/scenes/plane/plane_12.json"};
}

PlanOptions options_of(const TableRun& run) {
  PlanOptions options;
  apply(run.choices, options);
  return options;
}

TEST(PlaneTablesTest, ColumnsAreThoseOfThePaper) {
  const int num_segments[] = {1, 3, 5, 7, 9, 7, 9};
  for (const TableMode& mode : list_plane_tables().modes) {
    ASSERT_EQ(mode.columns.size(), kPlaneColumns.size());
    for (std::size_t i = 0; i < kPlaneColumns.size(); ++i) {
      const PlanOptions options = options_of(mode.columns[i]);
      EXPECT_EQ(options.num_segments, num_segments[i]);
      EXPECT_EQ(options.merge != MergeRule::kOff, i >= 5) << mode.letter << ' ' << i;
      EXPECT_EQ(mode.columns[i].label, kPlaneColumns[i].label);
    }
  }
}

TEST(PlaneTablesTest, ModesAreThePaperWithEitherQpAndTheDefaults) {
  const Tables tables = list_plane_tables();
  ASSERT_EQ(tables.modes.size(), 3U);
  const PlanOptions a = options_of(tables.modes[0].columns[5]);
  EXPECT_EQ(a.solver, WindowSolver::kDense);
  EXPECT_EQ(a.rows, RowMode::kLabelMap);
  EXPECT_EQ(a.merge, MergeRule::kPrinted);
  EXPECT_FALSE(a.accept);
  const PlanOptions b = options_of(tables.modes[1].columns[5]);
  EXPECT_EQ(b.solver, WindowSolver::kClosedForm);
  EXPECT_EQ(b.rows, RowMode::kLabelMap);
  const PlanOptions c = options_of(tables.modes[2].columns[5]);
  EXPECT_EQ(c.rows, RowMode::kEdge);
  EXPECT_EQ(c.merge, MergeRule::kPaired);
  EXPECT_TRUE(c.accept);
}

TEST(PlaneTablesTest, EverySwitchDiffersFromTheDefaultsInOneChoice) {
  const Tables tables = list_plane_tables();
  const auto defaults = to_json(tables.switches.front().choices);
  for (std::size_t i = 1; i + 1 < tables.switches.size(); ++i) {
    const auto choices = to_json(tables.switches[i].choices);
    int num_different = 0;
    for (const auto& [name, value] : choices.items()) num_different += value != defaults[name];
    EXPECT_EQ(num_different, 1) << tables.switches[i].label;
  }
  const PlanOptions last = options_of(tables.switches.back());
  EXPECT_EQ(last.steps_per_window, PlanOptions::paper().steps_per_window);
}

TEST(PlaneTablesTest, ACaseHasWhatItsColumnAsksFor) {
  const Tables tables = run_plane_tables(one_scene(), 2);
  EXPECT_EQ(tables.num_scenes, 1);
  EXPECT_EQ(num_unplanned(tables), 0);
  ASSERT_EQ(tables.rrt_star.cases.size(), 2U);
  for (const TableCase& c : tables.rrt_star.cases) {
    EXPECT_EQ(c.iterations, 0);
    EXPECT_DOUBLE_EQ(c.length, c.sampled_length);
    EXPECT_DOUBLE_EQ(c.total.serial_us, c.sample.serial_us);
  }
  const int num_segments[] = {1, 3, 5, 7, 9, 7, 9};
  for (const TableMode& mode : tables.modes) {
    for (std::size_t i = 0; i < kPlaneColumns.size(); ++i) {
      ASSERT_EQ(mode.columns[i].cases.size(), 2U);
      for (const TableCase& c : mode.columns[i].cases) {
        EXPECT_EQ(c.segments_initial, num_segments[i]) << mode.letter;
        EXPECT_GT(c.iterations, 0);
        EXPECT_GT(c.optimize.critical_us, 0.0);
        EXPECT_LE(c.optimize.critical_us, c.optimize.serial_us);
        EXPECT_GT(c.sample.critical_us, 0.0);
        EXPECT_LE(c.sample.critical_us, c.sample.serial_us);
        EXPECT_LE(c.total.critical_us, c.total.serial_us);
      }
    }
  }
}

TEST(PlaneTablesTest, EitherQpTakesTheSameSweepsToTheSameLength) {
  const Tables tables = run_plane_tables(one_scene(), 1);
  for (std::size_t i = 0; i < kPlaneColumns.size(); ++i) {
    const TableCase& dense = tables.modes[0].columns[i].cases.front();
    const TableCase& kernel = tables.modes[1].columns[i].cases.front();
    EXPECT_EQ(dense.iterations, kernel.iterations);
    EXPECT_NEAR(dense.length, kernel.length, 1e-6);
  }
}

TEST(PlaneTablesTest, CasesWithoutAPlanAreCounted) {
  Tables tables = list_plane_tables();
  tables.rrt_star.cases.resize(2);
  tables.modes[1].columns[3].cases.resize(1);
  tables.switches[4].cases.resize(1);
  EXPECT_EQ(num_unplanned(tables), 4);
  tables.rrt_star.cases[0].has_plan = true;
  EXPECT_EQ(num_unplanned(tables), 3);
}

}  // namespace
}  // namespace sopt
