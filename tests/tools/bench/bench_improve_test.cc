#include "tools/bench/bench_improve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/tools/temporary_folder.h"
#include "tools/bench/bench_improve_command.h"
#include "tools/io/input_error.h"

namespace sopt {
namespace {

const std::filesystem::path kSceneFile =
    std::filesystem::path(SOPT_SOURCE_DIR) / "tests/data/three_obstacles.json";
const std::vector<double> kBudgets_ms = {0.0, 1.0, 5.0};

// Records as (ms after the call, length).
ImproveCase case_of(const std::vector<std::pair<double, double>>& records) {
  ImproveCase c;
  c.status = records.empty() ? PlanStatus::kNoPath : PlanStatus::kOk;
  for (const auto& [time_ms, length] : records) {
    c.improvements.push_back({std::llround(1e6 * time_ms), length});
  }
  return c;
}

// Three seeds, one of them without a plan.
ImproveScene scene_of(std::optional<double> reference) {
  return {
      "hall",
      reference,
      {case_of({{3.0, 12.0}, {4.0, 11.0}, {8.001, 10.0}}), case_of({{1.0, 10.2}}), case_of({})}};
}

// --- curves

TEST(LengthRatiosTest, AreThoseOfTheLastPlanWithinTheBudgetAfterTheFirst) {
  const ImproveScene scene = scene_of(10.0);
  EXPECT_EQ(length_ratios(scene, 0.0), (std::vector<double>{1.2, 1.02}));
  EXPECT_EQ(length_ratios(scene, 0.999), (std::vector<double>{1.2, 1.02}));
  EXPECT_EQ(length_ratios(scene, 1.0), (std::vector<double>{1.1, 1.02}));
  EXPECT_EQ(length_ratios(scene, 5.0), (std::vector<double>{1.1, 1.02}));
  EXPECT_EQ(length_ratios(scene, 5.1), (std::vector<double>{1.0, 1.02}));
}

TEST(LengthRatiosTest, AreRelativeToTheBestPlanWithoutAReference) {
  ImproveScene scene = scene_of(std::nullopt);
  EXPECT_EQ(scene.unit_length(), 10.0);
  EXPECT_EQ(length_ratios(scene, 0.0), (std::vector<double>{1.2, 1.02}));
  EXPECT_EQ(scene_of(20.0).unit_length(), 20.0);
  EXPECT_EQ(scene.num_planned(), 2);
  EXPECT_EQ(num_failures({scene, scene}), 2);
}

TEST(LengthRatiosTest, HaveNoUnitWithoutALength) {
  EXPECT_EQ((ImproveScene{"void", std::nullopt, {case_of({})}}).unit_length(), std::nullopt);
  EXPECT_EQ((ImproveScene{"still", std::nullopt, {case_of({{1.0, 0.0}})}}).unit_length(),
            std::nullopt);
}

// --- measuring

class RunBenchImproveTest : public ::testing::Test {
 protected:
  static std::vector<ImproveScene> run(std::vector<double> budgets_ms) {
    ManualClock manual(1000);
    BenchImproveOptions options;
    options.budgets_ms = std::move(budgets_ms);
    options.num_seeds = 3;
    options.clock = manual.clock();
    return run_bench_improve(load_bench_scenes({kSceneFile, kSceneFile}), options);
  }
};

TEST_F(RunBenchImproveTest, PlansEverySceneOncePerSeed) {
  const std::vector<ImproveScene> scenes = run(kBudgets_ms);
  ASSERT_EQ(scenes.size(), 2U);
  for (const ImproveScene& scene : scenes) {
    EXPECT_EQ(scene.name, "three_obstacles");
    EXPECT_FALSE(scene.reference_length);
    ASSERT_EQ(scene.cases.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
      const ImproveCase& c = scene.cases[i];
      EXPECT_EQ(c.seed, i + 1);
      EXPECT_EQ(c.status, PlanStatus::kOk);
      ASSERT_FALSE(c.improvements.empty());
      EXPECT_GE(c.improvements.back().path_length, 8.0);
    }
  }
  EXPECT_EQ(num_failures(scenes), 0);
}

TEST_F(RunBenchImproveTest, KnowsTheFirstPlanWithoutAnyBudget) {
  const std::vector<ImproveScene> without = run({0.0});
  const std::vector<ImproveScene> with = run(kBudgets_ms);
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_EQ(without[0].cases[i].improvements.size(), 1U);
    EXPECT_EQ(without[0].cases[i].improvements.front().path_length,
              with[0].cases[i].improvements.front().path_length);
  }
}

TEST_F(RunBenchImproveTest, PlansArmsRelativeToTheirReference) {
  ManualClock manual(1000);
  BenchImproveOptions options;
  options.budgets_ms = {0.0, 1.0};
  options.num_seeds = 2;
  options.clock = manual.clock();
  const std::filesystem::path folder(SOPT_SOURCE_DIR);
  std::vector<std::filesystem::path> files = {folder / "tools/scenes/arm/arm_2_01.json"};
  const auto known = folder / "../shared/data/scenes/mbm_panda_table_under_pick_0001.json";
  if (std::filesystem::exists(known)) files.push_back(known);
  const std::vector<ImproveScene> scenes = run_bench_improve(load_bench_scenes(files), options);
  EXPECT_EQ(scenes[0].name, "arm_2_01");
  EXPECT_FALSE(scenes[0].reference_length);
  EXPECT_EQ(num_failures(scenes), 0);
  for (const ImproveScene& scene : scenes) {
    ASSERT_EQ(scene.cases.size(), 2U);
    for (const double ratio : length_ratios(scene, 1.0)) EXPECT_LT(ratio, 3.0);
  }
  if (files.size() == 1) GTEST_SKIP() << "no " << known;
  EXPECT_TRUE(scenes[1].reference_length);
}

// --- reports

TEST(ImproveReportTest, TellsMedianWorstMeanAndShare) {
  ImproveScene other{"yard", 10.0, {case_of({{1.0, 10.4}, {1.5, 10.3}})}};
  const std::string text = describe({scene_of(10.0), other}, kBudgets_ms);
  const auto expect_line = [&text](const std::string& line) {
    EXPECT_NE(text.find('\n' + line + '\n'), std::string::npos) << line << "\nin\n" << text;
  };
  expect_line("median over seeds      planned        0        1        5");
  expect_line("hall                    2/3      1.0200   1.0200   1.0200");
  expect_line("yard                    1/1      1.0400   1.0300   1.0300");
  expect_line("mean over scenes                 1.0300   1.0250   1.0250");
  expect_line("hall                    2/3      1.2000   1.1000   1.1000");
  expect_line("mean over scenes                 1.1200   1.0650   1.0650");
  expect_line("share of cases <= 1.03            25.0%    50.0%    50.0%");
  EXPECT_EQ(text.find('*'), std::string::npos);
}

TEST(ImproveReportTest, MarksWhatHasNoReferenceAndWhatHasNoPlan) {
  const ImproveScene none{"void", 10.0, {case_of({})}};
  const std::string text = describe({scene_of(std::nullopt), none}, kBudgets_ms);
  EXPECT_NE(text.find("\nhall *"), std::string::npos);
  EXPECT_NE(text.find("\n* without a reference"), std::string::npos);
  EXPECT_NE(text.find("\nvoid                    0/1           -        -        -\n"),
            std::string::npos)
      << text;
}

TEST(ImproveReportTest, JsonHasCurvesAndRecords) {
  const ImproveScene none{"void", std::nullopt, {case_of({})}};
  const nlohmann::ordered_json document = to_json({scene_of(10.0), none}, kBudgets_ms);
  EXPECT_EQ(document["budgets_ms"], kBudgets_ms);
  EXPECT_EQ(document["cases_failed"], 2);
  EXPECT_EQ(document["mean_worst"], (std::vector<double>{1.2, 1.1, 1.1}));
  EXPECT_EQ(document["share_good"][0], 0.25);
  const nlohmann::ordered_json& hall = document["scenes"][0];
  EXPECT_EQ(hall["unit"], "reference");
  EXPECT_EQ(hall["unit_length"], 10.0);
  EXPECT_EQ(hall["planned"], 2);
  EXPECT_EQ(hall["median"], (std::vector<double>{1.02, 1.02, 1.02}));
  EXPECT_EQ(hall["worst"], (std::vector<double>{1.2, 1.1, 1.1}));
  EXPECT_EQ(hall["cases"][0]["improvements"][1], (std::vector<double>{4.0, 11.0}));
  EXPECT_TRUE(hall["cases"][2]["improvements"].empty());
  EXPECT_EQ(document["scenes"][1]["unit"], "best_seen");
  EXPECT_TRUE(document["scenes"][1]["unit_length"].is_null());
  EXPECT_TRUE(document["scenes"][1]["median"][0].is_null());
}

TEST(ImproveReportTest, ChartsHaveASeriesPerSceneAndSayWhatIsMissing) {
  std::vector<ImproveScene> scenes(9, scene_of(10.0));
  for (std::size_t i = 0; i < scenes.size(); ++i) scenes[i].name = "scene_" + std::to_string(i);
  const std::string svg = draw(scenes, kBudgets_ms);
  for (const ImproveScene& scene : scenes) {
    EXPECT_NE(svg.find('>' + scene.name + '<'), std::string::npos) << scene.name;
    EXPECT_NE(svg.find(scene.name + ": 1 of 3 seeds without a plan"), std::string::npos);
  }
  EXPECT_NE(svg.find("(2 of 2)"), std::string::npos);
  EXPECT_EQ(svg.find("best plan of all seeds"), std::string::npos);
  const std::string marked = draw({scene_of(std::nullopt)}, kBudgets_ms);
  EXPECT_NE(marked.find(">* without a reference: relative to the best plan of all seeds<"),
            std::string::npos);
  EXPECT_EQ(marked.find("(1 of 1)"), std::string::npos);
}

// Which is where the axis ends: at 0.5 ms when 1 ms comes next, at 2 ms when 4 ms does.
TEST(ImproveReportTest, ChartsHaveTheFirstPlanAtTheLeftEdge) {
  const ImproveScene soon{"hall", 10.0, {case_of({{1.0, 12.0}, {1.9, 11.0}})}};
  EXPECT_TRUE(draw({soon}, {0.0, 1.0, 5.0}) == draw({soon}, {0.5, 1.0, 5.0}));
  EXPECT_FALSE(draw({soon}, {0.0, 1.0, 5.0}) == draw({soon}, {1.0, 5.0}));
  const ImproveScene late{"hall", 10.0, {case_of({{1.0, 12.0}, {4.5, 11.0}})}};
  EXPECT_TRUE(draw({late}, {0.0, 4.0, 5.0}) == draw({late}, {2.0, 4.0, 5.0}));
  EXPECT_NE(draw({late}, {0.0}).find(">hall<"), std::string::npos);
}

// --- the command

class BenchImproveCommandTest : public TemporaryFolderTest {
 protected:
  // The exit code; -1: the arguments were refused.
  int run(const std::string& arguments) {
    CLI::App app;
    int exit_code = -1;
    add_bench_improve_command(app, exit_code);
    testing::internal::CaptureStdout();
    try {
      app.parse("improve " + arguments);
    } catch (const CLI::ParseError&) {
      exit_code = -1;
    } catch (const InputError&) {
      exit_code = 2;
    }
    output_ = testing::internal::GetCapturedStdout();
    return exit_code;
  }

  std::string output_;
};

TEST_F(BenchImproveCommandTest, WritesCurvesAndAChart) {
  const std::string json = (folder() / "improve.json").string();
  const std::string svg = (folder() / "improve.svg").string();
  EXPECT_EQ(run("--budgets-ms 5,0,1,5 " + kSceneFile.string() + " --seeds 2 --json " + json +
                " --svg " + svg),
            0);
  EXPECT_EQ(files(), (std::set<std::string>{"improve.json", "improve.svg"}));
  const auto document = nlohmann::json::parse(read_file(json));
  EXPECT_EQ(document["options"]["clock"], "cpu");
  EXPECT_EQ(document["options"]["seeds"], 2);
  EXPECT_EQ(document["budgets_ms"], kBudgets_ms);  // in order, each once
  ASSERT_EQ(document["scenes"].size(), 1U);
  EXPECT_EQ(document["scenes"][0]["cases"].size(), 2U);
  EXPECT_NE(output_.find("1 scenes x 2 seeds, thread CPU time\n"), std::string::npos);
  EXPECT_NE(output_.find("three_obstacles *"), std::string::npos);
}

TEST_F(BenchImproveCommandTest, AnswersOneWhenThereIsNoPlan) {
  const std::filesystem::path sealed = write("sealed.json", R"({"robot": "point2d", "radius": 0.2,
      "bounds": [0, 0, 10, 6], "start": [1, 3], "goal": [9, 3],
      "obstacles": [{"type": "box", "center": [5, 3], "size": [1, 6]}]})");
  EXPECT_EQ(run(sealed.string() + " --budgets-ms 1 --seeds 1"), 1);
  EXPECT_NE(output_.find(" 0/1 "), std::string::npos);
}

TEST_F(BenchImproveCommandTest, RefusesWhatItDoesNotKnow) {
  const std::string scene = kSceneFile.string();
  EXPECT_EQ(run(scene + " --budgets-ms 1,-1"), -1);
  EXPECT_EQ(run(scene + " --budgets-ms 1,two"), -1);
  EXPECT_EQ(run(scene + " --budgets-ms nan"), -1);
  EXPECT_EQ(run(scene + " --budgets-ms 1e10"), -1);
  EXPECT_EQ(run(scene + " --budgets-ms"), -1);
  EXPECT_EQ(run(scene + " --budgets-ms ''"), -1);
  EXPECT_EQ(run(scene + " --seeds 0"), -1);
  EXPECT_EQ(run(scene + " --clock sundial"), -1);
  EXPECT_EQ(run(scene + " --json " + scene), 2);
  EXPECT_EQ(run((folder() / "missing.json").string()), 2);
}

}  // namespace
}  // namespace sopt
