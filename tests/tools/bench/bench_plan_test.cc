#include "tools/bench/bench_plan.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tools/bench/bench_report.h"

namespace sopt {
namespace {

const std::filesystem::path kFolder(SOPT_SOURCE_DIR);
const std::filesystem::path kPlane = kFolder / "tests/data/three_obstacles.json";
const std::filesystem::path kArm2 = kFolder / "tools/scenes/arm/arm_2_01.json";
const std::filesystem::path kArm8 = kFolder / "tools/scenes/arm/arm_8_01.json";

BenchPlanOptions options_with(int num_seeds, int num_repeats = 1) {
  BenchPlanOptions options;
  options.num_seeds = num_seeds;
  options.num_repeats = num_repeats;
  return options;
}

TEST(BenchPlanTest, PlansArmsAsItDoesInThePlane) {
  const BenchRun run = run_bench(load_bench_scenes({kArm2, kArm8}), options_with(2, 2));
  EXPECT_EQ(run.kind, SceneKind::kArm);
  EXPECT_EQ(run.world_build_us.size(), 2U);
  ASSERT_EQ(run.cases.size(), 8U);
  for (std::size_t i = 0; i < run.cases.size(); ++i) {
    const BenchCase& c = run.cases[i];
    EXPECT_EQ(c.scene, i < 4 ? "arm_2_01" : "arm_8_01");
    EXPECT_EQ(c.seed, i / 2 % 2 + 1);
    EXPECT_EQ(c.status, PlanStatus::kOk);
    EXPECT_TRUE(c.has_path);
    EXPECT_EQ(c.num_allocations, 0);
    EXPECT_GT(c.path_length, 1.0);
    EXPECT_GE(c.sampler_path_length, c.path_length);
    EXPECT_GT(c.horizon, 2);
    EXPECT_EQ(c.reference_ratio, 0.0);
  }
  EXPECT_EQ(run.cases[0].path_length, run.cases[1].path_length);
  EXPECT_NE(run.cases[0].path_length, run.cases[2].path_length);
}

TEST(BenchPlanTest, OptionsReachArms) {
  BenchPlanOptions options = options_with(1);
  options.algorithm.segments = "3";
  options.algorithm.max_window = kLongestWindow;
  options.algorithm.no_merge = true;
  const BenchRun run = run_bench(load_bench_scenes({kArm8}), options);
  EXPECT_EQ(run.cases.front().segments_initial, 3);
  EXPECT_EQ(run.cases.front().segments_final, 3);
}

TEST(BenchPlanTest, ComparesArmsWithTheConvergedOptimum) {
  BenchPlanOptions options = options_with(1);
  options.compare_converged = true;
  const BenchRun run = run_bench(load_bench_scenes({kArm2}), options);
  EXPECT_NEAR(run.cases.front().length_ratio, 1.0, 0.2);
}

TEST(BenchPlanTest, RelatesLengthsToTheScenesReference) {
  const std::filesystem::path file =
      kFolder / "../shared/data/scenes/mbm_panda_table_under_pick_0001.json";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
  const BenchRun run = run_bench(load_bench_scenes({file}), options_with(1));
  const AnyScene any = load_any_scene(file);
  const auto reference = std::visit([](const auto& scene) { return reference_of(scene); }, any);
  ASSERT_TRUE(reference);
  EXPECT_DOUBLE_EQ(run.cases.front().reference_ratio, run.cases.front().path_length / *reference);
}

// --- reports

TEST(BenchPlanReportTest, NamesUnitsFailuresAndFirstPaths) {
  BenchRun run;
  run.kind = SceneKind::kArm;
  run.cases.resize(4);
  for (std::size_t i = 0; i < 3; ++i) run.cases[i].has_path = true;
  for (std::size_t i = 0; i < 2; ++i) run.cases[i].status = PlanStatus::kOk;
  run.cases[2].status = PlanStatus::kCapacity;
  run.cases[3].status = PlanStatus::kNoPath;
  run.cases[1].num_allocations = 7;
  run.cases[0].path_length = 4.0;
  EXPECT_EQ(num_without_path(run), 1);
  EXPECT_EQ(num_failures(run), 2);
  const std::string text = describe_run(run);
  EXPECT_NE(text.find("\nfirst path 3 of 4 (75.00 %)\nsuccess 2 of 4 (50.00 %)\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("\npath_length [rad] "), std::string::npos) << text;
  const nlohmann::ordered_json document = to_json(run, BenchPlanOptions{});
  EXPECT_EQ(document.at("length_unit"), "rad");
  EXPECT_EQ(document.at("cases_without_path"), 1);
  EXPECT_EQ(document.at("summary").at("allocations").at("max"), 7.0);
  EXPECT_EQ(document.at("cases").at(3).at("has_path"), false);
  run.kind = SceneKind::kPlane;
  EXPECT_NE(describe_run(run).find("\npath_length [m] "), std::string::npos);
  EXPECT_EQ(to_json(run, BenchPlanOptions{}).at("length_unit"), "m");
}

TEST(BenchPlanReportTest, BySegmentsHasTheUnitOfTheScenes) {
  SegmentsRun run;
  run.run.kind = SceneKind::kArm;
  run.run.cases.resize(1);
  EXPECT_NE(describe_by_segments({run}).find("length [rad]"), std::string::npos);
  run.run.kind = SceneKind::kPlane;
  EXPECT_NE(describe_by_segments({run}).find("length [m]"), std::string::npos);
}

TEST(BenchPlanReportTest, OfARunInThePlaneSaysWhatItDid) {
  const BenchRun run = run_bench(load_bench_scenes({kPlane}), options_with(2));
  EXPECT_EQ(run.kind, SceneKind::kPlane);
  EXPECT_EQ(num_without_path(run), 0);
  EXPECT_EQ(num_failures(run), 0);
  EXPECT_EQ(to_json(run, options_with(2)).at("scenes").at(0).at("scene"), "three_obstacles");
}

}  // namespace
}  // namespace sopt
