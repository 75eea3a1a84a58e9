// The paper's choices [Leu22] in the optimiser and in the planner: together, each alone, and in
// every combination. Whatever they are, what leaves the planner is checked by the oracle.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "opt/planner.h"
#include "opt/reference.h"
#include "opt/segmented_optimizer.h"
#include "tests/support/planner_fixture.h"
#include "tests/support/test_problem.h"

namespace sopt::oracle {
namespace {

PlannerSettings dense_settings() {
  PlannerSettings settings = small_settings();
  settings.dense_solver = true;
  return settings;
}

// --- numbers that have one home

TEST(PaperOptions, AreThePapersChoices) {
  constexpr PlanOptions kPaper = PlanOptions::paper();
  EXPECT_EQ(kPaper.sampler, SamplerMode::kRrtStar);
  EXPECT_FALSE(kPaper.shortcut);
  EXPECT_FALSE(kPaper.lattice);
  EXPECT_EQ(kPaper.steps_per_window, 30);
  EXPECT_EQ(kPaper.merge, MergeRule::kPrinted);
  EXPECT_EQ(kPaper.resampling, Resampling::kRediscretize);
  EXPECT_EQ(kPaper.rows, RowMode::kLabelMap);
  EXPECT_EQ(kPaper.solver, WindowSolver::kDense);
  EXPECT_FALSE(kPaper.accept);
  EXPECT_TRUE(kPaper.zero_input_start);
  EXPECT_EQ(kPaper.max_iterations, 20);
}

TEST(ChooseNumSegments, TakesOneForEveryThirtyStepsInPaperMode) {
  const PlanOptions paper = PlanOptions::paper();
  for (const auto& [horizon, num_segments] :
       {std::pair(2, 1), {3, 1}, {4, 2}, {30, 2}, {60, 2}, {61, 3}, {90, 3}, {91, 4}, {600, 20}}) {
    EXPECT_EQ(choose_num_segments(paper, horizon, 60), num_segments) << horizon;
  }
}

TEST(ChooseNumSegments, TakesWhatIsGivenAsFarAsItFits) {
  PlanOptions options;
  for (const auto& [wanted, num_segments] : {std::pair(1, 4), {4, 4}, {7, 7}, {500, 100}}) {
    options.num_segments = wanted;
    EXPECT_EQ(choose_num_segments(options, 200, 50), num_segments) << wanted;
  }
  options.num_segments = 1;
  EXPECT_EQ(choose_num_segments(options, 1, 60), 1);
}

TEST(ChooseNumSegments, NeverAsksForWindowsBeyondTheLongest) {
  InArena<Splits> splits(1000);
  InArena<FixedVector<Window>> windows(1000);
  Random random(1);
  for (int round = 0; round < 2000; ++round) {
    const int horizon = 2 + random.index(900);
    const int max_window = 4 + random.index(57);
    PlanOptions options = random.chance(0.5) ? PlanOptions::paper() : PlanOptions();
    options.num_segments = random.chance(0.5) ? 0 : 1 + random.index(40);
    ASSERT_TRUE(splits->try_reset(horizon, choose_num_segments(options, horizon, max_window)));
    for (const Parity parity : {Parity::kOdd, Parity::kEven}) {
      splits->list_windows(parity, *windows);
      for (const Window& window : *windows) ASSERT_LE(window.num_steps(), max_window) << horizon;
    }
  }
}

TEST(TrustRadius, BeginsWithFifteenStepsOrThreeMetres) {
  EXPECT_NEAR(first_trust_m(0.1), 1.5, 1e-12);
  EXPECT_NEAR(first_trust_m(1.0), 3.0, 1e-12);
}

TEST(TrustRadius, FollowsTheLargestMove) {
  SweepSummary summary;
  summary.displacement_m = 0.4;
  EXPECT_NEAR(next_trust_m(summary, 1.5, 0.1), 0.8, 1e-12);
  summary.displacement_m = 0.0;
  EXPECT_NEAR(next_trust_m(summary, 1.5, 0.1), 0.1, 1e-12) << "a step at least";
  summary.displacement_m = 100.0;
  EXPECT_NEAR(next_trust_m(summary, 0.2, 0.1), 1.5, 1e-12) << "never more than at first";
  summary.was_shortened = true;
  EXPECT_EQ(next_trust_m(summary, 0.7, 0.1), 0.7);
}

// --- the optimiser

class PaperOptimizer : public testing::Test {
 protected:
  void use(const Scene& scene) { ASSERT_EQ(fill(scene, test_.world), WorldStatus::kOk); }
  OptimizerResult<Point2> optimize(const std::vector<Vec2>& states) {
    trajectory_->states.clear();
    for (const Vec2& z : states) (void)trajectory_->states.try_push_back(z);
    return optimizer_->optimize({&robot_, &test_.world, plain_profile(0.05), ds_m_, &options_},
                                *trajectory_, Deadline());
  }
  void expect_whole(const std::vector<Vec2>& states, const OptimizerResult<Point2>& result) {
    ASSERT_GE(static_cast<int>(result.status), 0);
    EXPECT_EQ(trajectory_->states[0], states.front());
    EXPECT_EQ(trajectory_->states.back(), states.back());
    ASSERT_FALSE(result.splits.empty());
    EXPECT_EQ(result.splits.front(), 0);
    EXPECT_EQ(result.splits.back(), trajectory_->horizon());
    for (std::size_t i = 1; i < result.splits.size(); ++i) {
      EXPECT_LT(result.splits[i - 1], result.splits[i]);
    }
    ASSERT_EQ(result.history.size(), static_cast<std::size_t>(result.iterations) + 1);
    EXPECT_LE(result.iterations, options_.max_iterations);
    EXPECT_NEAR(result.history.back().cost, cost_of(trajectory_->states.span(), ds_m_), 1e-9);
    EXPECT_NEAR(result.history.back().path_length, length_of(trajectory_->states.span()), 1e-9);
    EXPECT_EQ(result.cost, result.history.back().cost);
    for (const Vec2& z : trajectory_->states) EXPECT_TRUE(z.allFinite());
  }

  static constexpr int kMaxHorizon = 200;
  Point2 robot_{kBodyRadius_m};
  SerialExecutor serial_;
  TestWorld test_{{256, 4096}};
  InArena<SegmentedOptimizer<Point2>> optimizer_{[] {
                                                   PlannerSettings settings = dense_settings();
                                                   settings.max_horizon = kMaxHorizon;
                                                   return settings;
                                                 }(),
                                                 serial_, monotonic_clock()};
  InArena<Trajectory<Point2>> trajectory_{kMaxHorizon};
  PlanOptions options_ = PlanOptions::paper();
  double ds_m_ = 0.2;
};

TEST_F(PaperOptimizer, ShortensTheHorizonWithThePath) {
  use({{Vec2::Zero(), Vec2::Constant(10.0)}, {}});
  const std::vector<Vec2> states =
      cut_into_steps(std::vector<Vec2>{{1.0, 1.0}, {5.0, 9.0}, {9.0, 1.0}}, ds_m_);
  ASSERT_GT(states.size(), 80U);
  const OptimizerResult<Point2> result = optimize(states);
  expect_whole(states, result);
  // A straight line of 8 m, but for what the stopping rule leaves.
  EXPECT_LT(length_of(trajectory_->states.span()), 8.5);
  EXPECT_LE(trajectory_->horizon(), 43);
  EXPECT_GE(trajectory_->horizon(), 40);
}

TEST_F(PaperOptimizer, KeepsTheHorizonInEverythingElse) {
  use({{Vec2::Zero(), Vec2::Constant(10.0)}, {}});
  const std::vector<Vec2> states =
      cut_into_steps(std::vector<Vec2>{{1.0, 1.0}, {5.0, 9.0}, {9.0, 1.0}}, ds_m_);
  options_.resampling = Resampling::kOff;
  expect_whole(states, optimize(states));
  EXPECT_EQ(trajectory_->horizon(), static_cast<int>(states.size()) - 1);
}

TEST_F(PaperOptimizer, MergesAsPrintedWhenLittleIsGained) {
  use({{Vec2::Zero(), Vec2::Constant(10.0)}, {}});
  // Straight already: every pair of windows gains nothing and loses its shared end.
  const std::vector<Vec2> states = cut_into_steps(std::vector<Vec2>{{1.0, 5.0}, {9.0, 5.0}}, ds_m_);
  ASSERT_EQ(states.size(), 41U);
  options_.num_segments = 4;  // 0 5 10 .. 40
  options_.max_iterations = 2;
  options_.tol_step = 1e-3;
  const OptimizerResult<Point2> result = optimize(states);
  expect_whole(states, result);
  EXPECT_EQ(std::vector<int>(result.splits.begin(), result.splits.end()),
            (std::vector<int>{0, 5, 15, 20, 25, 35, 40}))
      << "10 and 30 go in the first sweep; the second one is the last";
}

TEST_F(PaperOptimizer, StaysWholeInRandomWorlds) {
  Random random(7);
  const Aabb2 bounds = {Vec2::Zero(), Vec2::Constant(10.0)};
  for (int round = 0; round < 150; ++round) {
    SCOPED_TRACE(round);
    const std::vector<Vec2> way =
        random_polyline(random, {Vec2::Constant(0.5), Vec2::Constant(9.5)}, 2 + random.index(4));
    use(random_scene_around(random, bounds, way, 60, 0.8, 0.1));
    ds_m_ = random.uniform(0.2, 1.0);
    const std::vector<Vec2> states = cut_into_steps(way, ds_m_);
    if (states.size() > kMaxHorizon) continue;
    options_.rows = static_cast<RowMode>(random.index(3));
    options_.solver = static_cast<WindowSolver>(random.index(2));
    options_.merge = static_cast<MergeRule>(random.index(3));
    options_.accept = random.chance(0.5);
    options_.zero_input_start = random.chance(0.5);
    options_.num_segments = random.chance(0.5) ? 0 : 1 + random.index(40);
    options_.max_window = random.chance(0.5) ? 0 : 4 + random.index(57);
    options_.tol_step = random.chance(0.3) ? 0.0 : 1e-3;
    expect_whole(states, optimize(states));
  }
}

TEST_F(PaperOptimizer, GrowsToTheCapacityAtMost) {
  use({{Vec2::Zero(), Vec2::Constant(10.0)}, {}});
  ds_m_ = 1e-3;  // much shorter than the steps there are
  const std::vector<Vec2> states =
      cut_into_steps(std::vector<Vec2>{{1.0, 1.0}, {5.0, 9.0}, {9.0, 1.0}}, 0.5);
  expect_whole(states, optimize(states));
  EXPECT_EQ(trajectory_->horizon(), kMaxHorizon);
}

// --- the planner

class PaperPlanner : public PlannerTest {
 protected:
  void SetUp() override {
    PlannerTest::SetUp();
    request_.options = PlanOptions::paper();
  }
  PlanResult<Point2> plan() { return test_planner_.planner.plan(request_); }
  // Steps of the reference that the result's path makes.
  std::vector<Vec2> plan_0(const PlanResult<Point2>& result) {
    InArena<Trajectory<Point2>> reference(small_settings().max_horizon);
    const Point2& robot = test_planner_.robot;
    EXPECT_TRUE(make_reference(robot, *result.path,
                               choose_step_length(robot, *request_.world, request_.options),
                               request_.options.dt_s, *reference));
    return copy_of(reference->states.span());
  }

  TestPlanner test_planner_{dense_settings()};
};

TEST_F(PaperPlanner, AnswersWithVerifiedPlans) {
  int num_optimised = 0;
  for (request_.seed = 1; request_.seed <= 10; ++request_.seed) {
    const PlanResult<Point2> result = plan();
    expect_valid(scene_, request_, result);
    EXPECT_EQ(result.plan->trajectory().dt_s, request_.options.dt_s) << "time is not scaled";
    num_optimised += result.fell_back ? 0 : 1;
  }
  EXPECT_GT(num_optimised, 0);
}

TEST_F(PaperPlanner, MakesEachChoiceAlone) {
  const PlanOptions paper = PlanOptions::paper();
  std::vector<PlanOptions> each(9);
  each[0].sampler = paper.sampler;
  each[1].shortcut = paper.shortcut;
  each[2].merge = paper.merge;
  each[3].resampling = paper.resampling;
  each[4].rows = paper.rows;
  each[5].solver = paper.solver;
  each[6].accept = paper.accept;
  each[7].zero_input_start = paper.zero_input_start;
  each[8].lattice = paper.lattice;
  for (std::size_t i = 0; i < each.size(); ++i) {
    for (request_.seed = 1; request_.seed <= 5; ++request_.seed) {
      SCOPED_TRACE(std::to_string(i) + " " + std::to_string(request_.seed));
      request_.options = each[i];
      expect_valid(scene_, request_, plan());
    }
  }
}

TEST_F(PaperPlanner, PlansTheSameWithEitherSolver) {
  request_.options = PlanOptions();
  for (request_.seed = 1; request_.seed <= 5; ++request_.seed) {
    request_.options.solver = WindowSolver::kClosedForm;
    const double length_m = plan().path_length;
    request_.options.solver = WindowSolver::kDense;
    const PlanResult<Point2> dense = plan();
    expect_valid(scene_, request_, dense);
    EXPECT_NEAR(dense.path_length, length_m, 1e-6);
  }
}

// A wall so thin that long steps leave no waypoint above it: rows on waypoints alone let the edge
// between two of them through.
class ThinWall : public PaperPlanner {
 protected:
  void SetUp() override {
    PaperPlanner::SetUp();
    set_scene({{{0.0, 0.0}, {10.0, 10.0}}, {{box_between({4.98, 0.5}, {5.02, 7.0})}}});
    request_.start = {1.0, 2.0};
    request_.goal = {9.0, 2.0};
    request_.options.speed_mps = 10.0;  // 1 m in a step
  }
};

TEST_F(ThinWall, LeavesPlanZeroWhenTheOptimisedOneCollides) {
  int num_fell_back = 0;
  for (request_.seed = 1; request_.seed <= 10; ++request_.seed) {
    SCOPED_TRACE(request_.seed);
    const PlanResult<Point2> result = plan();
    expect_valid(scene_, request_, result);
    EXPECT_EQ(result.status, PlanStatus::kOk);
    if (!result.fell_back) continue;
    ++num_fell_back;
    EXPECT_EQ(copy_of(result.plan->trajectory().states.span()), plan_0(result));
    EXPECT_EQ(result.plan->trajectory().dt_s, request_.options.dt_s);
    ASSERT_FALSE(result.history.empty());
    EXPECT_EQ(result.cost, result.history.front().cost);
    EXPECT_EQ(result.path_length, result.history.front().path_length);
  }
  EXPECT_GT(num_fell_back, 5);
}

TEST_F(ThinWall, IsKeptClearOfByRowsOnEdges) {
  request_.options.rows = RowMode::kEdge;
  request_.options.resampling = Resampling::kOff;
  request_.options.zero_input_start = false;
  for (request_.seed = 1; request_.seed <= 10; ++request_.seed) {
    const PlanResult<Point2> result = plan();
    expect_valid(scene_, request_, result);
    EXPECT_FALSE(result.fell_back) << request_.seed;
  }
}

TEST_F(PaperPlanner, NeedsRoomForTheDenseSolver) {
  TestPlanner without;
  const PlanResult<Point2> result = without.planner.plan(request_);
  EXPECT_EQ(result.status, PlanStatus::kBadInput);
  EXPECT_EQ(result.failure.stage, PlanStage::kRequest);
  EXPECT_NE(std::string(result.failure.reason).find("dense_solver"), std::string::npos)
      << result.failure.reason;
  EXPECT_FALSE(static_cast<bool>(result.plan));
  request_.options.solver = WindowSolver::kClosedForm;
  expect_valid(scene_, request_, without.planner.plan(request_));
}

TEST_F(PaperPlanner, StaysWhenStartIsGoal) {
  request_.goal = request_.start;
  const PlanResult<Point2> result = plan();
  expect_valid(scene_, request_, result);
  EXPECT_EQ(result.plan->trajectory().horizon(), 2);
}

TEST_F(PaperPlanner, PlansToANearGoal) {
  for (const double distance_m : {1e-12, 1e-6, 1e-3, 0.05, 0.3}) {
    request_.goal = request_.start + Vec2(distance_m, 0.0);
    expect_valid(scene_, request_, plan());
  }
}

TEST_F(PaperPlanner, StaysAtAnySpeed) {
  request_.goal = request_.start;
  for (const double speed_mps : {1e-9, 1e-200, 1e-308}) {
    request_.options.speed_mps = speed_mps;
    request_.options.dt_s = speed_mps;
    const PlanResult<Point2> result = plan();
    if (static_cast<int>(result.status) >= 0) expect_valid(scene_, request_, result);
  }
}

TEST_F(PaperPlanner, PlansInAnEmptyWorld) {
  set_scene({{{0.0, 0.0}, {10.0, 10.0}}, {}});
  for (request_.seed = 1; request_.seed <= 5; ++request_.seed) {
    const PlanResult<Point2> result = plan();
    expect_valid(scene_, request_, result);
    EXPECT_NEAR(result.path_length, 8.0, 0.1);
  }
}

}  // namespace
}  // namespace sopt::oracle
