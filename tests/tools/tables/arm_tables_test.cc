#include "tools/tables/arm_tables.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tools/io/input_error.h"

namespace sopt {
namespace {

std::filesystem::path scene(const char* name) {
  return std::string(SOPT_SOURCE_DIR "/tools/scenes/arm/") + name;
}

PlanOptions options_of(const TableRun& run) {
  PlanOptions options = PlanOptions::arm();
  apply(run.choices, options, paper_options<Arm<5>>());
  return options;
}

TEST(ArmTablesTest, ColumnsAreThoseOfThePaper) {
  const int num_segments[] = {1, 3, 5, 7, 9, 5, 7, 9};
  for (const PaperTable* const paper : {&kArmFewTable, &kArmManyTable}) {
    const Tables tables = list_arm_tables(*paper);
    ASSERT_EQ(tables.modes.size(), 4U);
    for (const TableMode& mode : tables.modes) {
      ASSERT_EQ(mode.columns.size(), 8U);
      for (std::size_t i = 0; i < mode.columns.size(); ++i) {
        const PlanOptions options = options_of(mode.columns[i]);
        EXPECT_EQ(options.num_segments, num_segments[i]);
        EXPECT_EQ(options.merge != MergeRule::kOff, i >= 5) << mode.letter << ' ' << i;
        EXPECT_EQ(options.max_window, kLongestWindow);
        EXPECT_EQ(mode.columns[i].label, paper->columns[i].label);
      }
    }
  }
}

TEST(ArmTablesTest, ModesAreThePaperWithEitherQpAndTheDefaultsWithAndWithoutTheCheck) {
  const Tables tables = list_arm_tables(kArmFewTable);
  const PlanOptions a = options_of(tables.modes[0].columns[5]);
  EXPECT_EQ(a.solver, WindowSolver::kDense);
  EXPECT_EQ(a.merge, MergeRule::kPrinted);
  EXPECT_EQ(a.rows, RowMode::kWaypoint);
  EXPECT_EQ(a.resampling, Resampling::kOff);
  EXPECT_TRUE(a.zero_input_start);
  EXPECT_FALSE(a.shortcut);
  EXPECT_FALSE(a.accept);
  EXPECT_EQ(options_of(tables.modes[1].columns[5]).solver, WindowSolver::kClosedForm);
  EXPECT_TRUE(options_of(tables.modes[2].columns[5]).accept);
  EXPECT_FALSE(options_of(tables.modes[3].columns[5]).accept);
  EXPECT_TRUE(options_of(tables.modes[3].columns[5]).shortcut);
}

TEST(ArmTablesTest, EverySwitchDiffersFromTheDefaultsInOneChoice) {
  const Tables tables = list_arm_tables(kArmManyTable);
  const auto report = [&](const TableRun& run) {
    return to_json(run.choices, tables.defaults, tables.paper_choices);
  };
  const auto defaults = report(tables.switches.front());
  for (std::size_t i = 1; i + 1 < tables.switches.size(); ++i) {
    int num_different = 0;
    const auto choices = report(tables.switches[i]);
    for (const auto& [name, value] : choices.items()) num_different += value != defaults[name];
    EXPECT_EQ(num_different, 1) << tables.switches[i].label;
  }
  EXPECT_EQ(options_of(tables.switches.back()).steps_per_window,
            PlanOptions::paper().steps_per_window);
}

TEST(ArmTablesTest, ScenesAreGroupedByTheirNumberOfObstacles) {
  const std::vector<ArmFamily> families =
      group_arm_scenes({scene("arm_8_01.json"), scene("arm_2_03.json"), scene("arm_8_02.json")});
  ASSERT_EQ(families.size(), 2U);
  EXPECT_EQ(families[0].paper, &kArmFewTable);
  EXPECT_EQ(families[0].scenes, std::vector{scene("arm_2_03.json")});
  EXPECT_EQ(families[1].paper, &kArmManyTable);
  EXPECT_EQ(families[1].scenes, (std::vector{scene("arm_8_01.json"), scene("arm_8_02.json")}));
  EXPECT_EQ(group_arm_scenes({scene("arm_2_03.json")}).size(), 1U);
}

TEST(ArmTablesTest, ShippedScenesAreTwentyOfEachFamily) {
  const std::vector<std::filesystem::path> files =
      list_arm_scenes({SOPT_SOURCE_DIR "/tools/scenes/arm"});
  EXPECT_EQ(std::count(files.begin(), files.end(), scene("factory.json")), 1);  // was asked for
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(SOPT_SOURCE_DIR);
  const std::vector<ArmFamily> families = group_arm_scenes(list_arm_scenes({}));
  std::filesystem::current_path("tools");
  EXPECT_THROW((void)list_arm_scenes({}), InputError);
  std::filesystem::current_path(before);
  ASSERT_EQ(families.size(), 2U);
  EXPECT_EQ(families[0].scenes.size(), 20U);
  EXPECT_EQ(families[1].scenes.size(), 20U);
}

// Of both families once: what a column asks for, and the same sweeps by either QP.
TEST(ArmTablesTest, ACaseHasWhatItsColumnAsksFor) {
  const std::vector<Tables> all =
      run_arm_tables(group_arm_scenes({scene("arm_2_05.json"), scene("arm_8_04.json")}), 1);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(num_unplanned(all), 0);
  const int num_segments[] = {1, 3, 5, 7, 9, 5, 7, 9};
  for (const Tables& tables : all) {
    EXPECT_EQ(tables.num_scenes, 1);
    ASSERT_EQ(tables.rrt_star.cases.size(), 1U);
    EXPECT_EQ(tables.rrt_star.cases[0].iterations, 0);
    EXPECT_DOUBLE_EQ(tables.rrt_star.cases[0].length, tables.rrt_star.cases[0].sampled_length);
    for (const TableMode& mode : tables.modes) {
      for (std::size_t i = 0; i < mode.columns.size(); ++i) {
        ASSERT_EQ(mode.columns[i].cases.size(), 1U);
        const TableCase& c = mode.columns[i].cases[0];
        EXPECT_EQ(c.segments_initial, num_segments[i]) << mode.letter;
        EXPECT_GT(c.iterations, 0);
        EXPECT_GT(c.optimize.critical_us, 0.0);
        EXPECT_LE(c.optimize.critical_us, c.optimize.serial_us);
        EXPECT_LE(c.total.critical_us, c.total.serial_us);
      }
    }
    for (std::size_t i = 0; i < 8; ++i) {
      const TableCase& dense = tables.modes[0].columns[i].cases[0];
      const TableCase& kernel = tables.modes[1].columns[i].cases[0];
      EXPECT_EQ(dense.iterations, kernel.iterations) << i;
      EXPECT_NEAR(dense.length, kernel.length, 1e-4) << i;
    }
  }
}

}  // namespace
}  // namespace sopt
