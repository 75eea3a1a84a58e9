#include "tools/bench/bench_scaling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tools/bench/bench_scaling_report.h"

namespace sopt {
namespace {

const ScalingFigure& figure(const std::string& name, bool is_of_known_way = false) {
  const auto figures = scaling_figures();
  const auto found = std::find_if(figures.begin(), figures.end(), [&](const ScalingFigure& f) {
    return f.name == name && f.is_of_known_way == is_of_known_way;
  });
  EXPECT_NE(found, figures.end()) << name;
  return *found;
}

// Cases with horizon n and optimise time y, planned.
ScalingRun run_of(ScalingFamily family, const std::vector<Vec2>& points_us) {
  ScalingRun run;
  run.family = family;
  for (const Vec2& point : points_us) {
    ScalingCase& c = run.cases.emplace_back();
    c.size = c.plan.horizon = c.num_obstacles = static_cast<int>(point.x());
    c.plan.is_planned = true;
    c.plan.times.optimize_ns = std::llround(1e3 * point.y());
  }
  return run;
}

BenchScalingOptions small_options(ScalingFamily family, int max_size) {
  BenchScalingOptions options;
  options.families = {family};
  options.max_size = max_size;
  options.num_seeds = 2;
  options.num_repeats = 2;
  return options;
}

TEST(FitPowerTest, FindsAPlantedPower) {
  std::vector<Vec2> points;
  for (const double n : {3.0, 10.0, 70.0, 1000.0}) points.emplace_back(n, 5.0 * std::pow(n, 1.7));
  const auto fit = fit_power(points);
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->num_points, 4);
  EXPECT_NEAR(fit->exponent, 1.7, 1e-12);
  EXPECT_NEAR(fit->scale, 5.0, 1e-10);
  EXPECT_NEAR(fit->standard_error, 0.0, 1e-6);
}

// Logarithms (0, 0), (1, 1), (2, 1.5): slope 3/4, residuals -1/12, 1/6, -1/12.
TEST(FitPowerTest, TheStandardErrorIsThatOfTheSlope) {
  const double e = std::exp(1.0);
  const auto fit = fit_power(std::vector<Vec2>{{1.0, 1.0}, {e, e}, {e * e, std::exp(1.5)}});
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->exponent, 0.75, 1e-12);
  EXPECT_NEAR(fit->standard_error, std::sqrt((1.0 / 24.0) / 2.0), 1e-12);
}

TEST(FitPowerTest, LeavesOutWhatHasNoLogarithm) {
  const auto fit = fit_power(std::vector<Vec2>{{1.0, 2.0}, {2.0, 0.0}, {0.0, 9.0}, {4.0, 8.0}});
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->num_points, 2);
  EXPECT_NEAR(fit->exponent, 1.0, 1e-12);
}

TEST(FitPowerTest, ThereIsNoneForOneSize) {
  EXPECT_FALSE(fit_power({}));
  EXPECT_FALSE(fit_power(std::vector<Vec2>{{7.0, 1.0}, {7.0, 2.0}}));
}

TEST(ScalingExponentTest, TheUpperHalfShowsWhatAConstantCostHides) {
  const ScalingRun run =
      run_of(ScalingFamily::kMaze, {{10, 100}, {20, 100}, {40, 100}, {80, 200}, {160, 800}});
  const ScalingExponent e = exponent_of(run, figure("optimise"));
  ASSERT_TRUE(e.fit && e.upper_half);
  EXPECT_EQ(e.upper_half->num_points, 3);  // from 40 on
  EXPECT_NEAR(e.upper_half->exponent, 1.5, 1e-9);
  EXPECT_LT(e.fit->exponent, 0.8);
}

TEST(ScalingExponentTest, TheTargetIsLinearInTheHorizonAndBelowThatInObstacles) {
  const std::vector<Vec2> linear = {{10, 10}, {100, 105}};  // exponent 1.02
  EXPECT_TRUE(exponent_of(run_of(ScalingFamily::kCorridor, linear), figure("optimise")).is_met());
  EXPECT_FALSE(exponent_of(run_of(ScalingFamily::kField, linear), figure("optimise")).is_met());
  const std::vector<Vec2> steep = {{10, 10}, {100, 130}};  // 1.11
  EXPECT_FALSE(exponent_of(run_of(ScalingFamily::kMaze, steep), figure("optimise")).is_met());
}

TEST(ScalingExponentTest, ACaseWithoutAPlanMissesTheTarget) {
  ScalingRun run = run_of(ScalingFamily::kCorridor, {{10, 10}, {100, 100}});
  run.cases.emplace_back().size = 1000;
  const ScalingExponent e = exponent_of(run, figure("optimise"));
  EXPECT_EQ(e.fit->num_points, 2);
  EXPECT_EQ(e.num_failed, 1);
  EXPECT_FALSE(e.is_met());
  EXPECT_EQ(num_failures(std::vector{run}), 1);
}

TEST(RunBenchScalingTest, EverySizeHasAPlanFromTheKnownWayThatPassesVerify) {
  for (const ScalingFamily family : {ScalingFamily::kCorridor, ScalingFamily::kMaze}) {
    BenchScalingOptions options = small_options(family, 3000);
    options.num_seeds = 1;
    options.num_samples = 1;  // leave the sampler out
    const std::vector<ScalingRun> runs = run_bench_scaling(options);
    ASSERT_EQ(runs.at(0).cases.size(), scaling_sizes(family).size());
    for (const ScalingCase& c : runs[0].cases) {
      EXPECT_TRUE(c.known_way.is_planned) << to_string(family) << ' ' << c.size;
      EXPECT_NEAR(c.known_way.horizon / (1.0 * c.size), 1.3, 0.5);
      EXPECT_GT(c.known_way.optimizer_counts.qp_steps, 0);
      EXPECT_FALSE(c.plan.is_planned && c.size > 100);
    }
  }
}

TEST(RunBenchScalingTest, PlansTheSameWithAnyClockAndAnyNumberOfRepeats) {
  ManualClock manual(1000);
  BenchScalingOptions options = small_options(ScalingFamily::kField, 100);
  const std::vector<ScalingRun> runs = run_bench_scaling(options);
  options.clock = manual.clock();
  options.num_repeats = 1;
  const std::vector<ScalingRun> again = run_bench_scaling(options);
  ASSERT_EQ(runs.at(0).cases.size(), 6U);  // 20, 50, 100
  ASSERT_EQ(again.at(0).cases.size(), 6U);
  EXPECT_EQ(num_failures(runs), 0);
  for (std::size_t i = 0; i < 6; ++i) {
    for (const char* name : {"nodes", "edges", "rounds", "queries", "qp_steps", "iterations"}) {
      EXPECT_EQ(figure(name).value(runs[0].cases[i].plan),
                figure(name).value(again[0].cases[i].plan));
    }
    EXPECT_FALSE(runs[0].cases[i].known_way.is_planned);
  }
}

TEST(RunBenchScalingTest, StagesEndWhereTheNextBegins) {
  ManualClock manual(1000);
  BenchScalingOptions options = small_options(ScalingFamily::kMaze, 50);
  options.clock = manual.clock();
  const std::vector<ScalingRun> runs = run_bench_scaling(options);
  ASSERT_EQ(runs.at(0).cases.size(), 2U);
  for (const ScalingCase& c : runs[0].cases) {
    const StageTimes& times = c.known_way.times;
    EXPECT_EQ(times.shortcut_ns, 1000);  // two readings in a row
    EXPECT_EQ(times.reference_ns, 1000);
    EXPECT_GT(times.optimize_ns, 1000);  // a reading per sweep
    EXPECT_EQ(times.verify_ns, 1000);
    EXPECT_EQ(times.total_ns, 3000 + times.optimize_ns);
    EXPECT_EQ(figure("first path").value(c.plan),
              figure("sample").value(c.plan) + figure("shortcut").value(c.plan));
  }
}

TEST(ScalingReportTest, SaysMetOrMissedAndHowManyHaveNoPlan) {
  ScalingRun run = run_of(ScalingFamily::kCorridor, {{10, 10}, {100, 100}});
  EXPECT_NE(describe(run).find("optimise over steps: exponent 1.00 +- 0.00, target 1.1: met\n"),
            std::string::npos);
  run.cases.emplace_back().size = 1000;
  EXPECT_NE(describe(run).find("target 1.1: missed (1 of 3 without a plan)\n"), std::string::npos);
  EXPECT_NE(describe(run).find("1000   0 of 1"), std::string::npos);
}

TEST(ScalingReportTest, JsonHasNullWhereThereIsNoPlan) {
  ScalingRun run = run_of(ScalingFamily::kCorridor, {{10, 10}, {100, 100}});
  run.cases.emplace_back().size = 1000;
  const nlohmann::ordered_json document = to_json(run);
  EXPECT_EQ(document["family"], "corridor");
  EXPECT_EQ(document["cases"][0]["plan"]["optimise"], 10.0);
  EXPECT_TRUE(document["cases"][2]["plan"].is_null());
  const nlohmann::ordered_json& exponent = document["exponents"]["times of a plan"]["optimise"];
  EXPECT_NEAR(exponent["fit"]["exponent"].get<double>(), 1.0, 1e-12);
  EXPECT_EQ(exponent["is_met"], false);
  EXPECT_FALSE(document["exponents"]["times of a plan"]["verify"].contains("is_met"));
}

TEST(ScalingReportTest, ChartsNameTheExponentAndWhatIsMissing) {
  ScalingRun run = run_of(ScalingFamily::kCorridor, {{10, 10}, {100, 100}});
  run.cases.emplace_back().size = 1000;
  const std::string svg = draw(run);
  EXPECT_NE(svg.find("optimise ~ n^1.00"), std::string::npos);
  EXPECT_NE(svg.find("1 of 3 scenes without a plan"), std::string::npos);
}

}  // namespace
}  // namespace sopt
