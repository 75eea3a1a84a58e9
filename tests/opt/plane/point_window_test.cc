#include "opt/plane/point_window.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "rt/clock.h"
#include "tests/support/rt_guard.h"
#include "tests/support/test_problem.h"
#include "tests/support/test_world.h"

namespace sopt {
namespace {

using oracle::InArena;
using oracle::Random;
using oracle::Scene;
using oracle::SceneOracle;
using oracle::TestWorld;

using Points = std::vector<Vec2>;

constexpr double kTol_m = 1e-8;
const Aabb2 kBounds = {Vec2::Zero(), Vec2::Constant(10.0)};
const Aabb2 kInner = {Vec2::Constant(0.6), Vec2::Constant(9.4)};

class WindowOptimizerTest : public ::testing::Test {
 protected:
  void use(const Scene& scene) {
    scene_ = scene;
    ASSERT_EQ(oracle::fill(scene, test_.world), WorldStatus::kOk);
  }
  WindowResult optimize(Points& states, const Window& window,
                        const Deadline& deadline = Deadline()) {
    const SweepProblem<Point2> problem = {&robot_, &test_.world, profile_, trust_m_, ds_m_, states};
    return optimizer_->optimize(problem, window, deadline);
  }
  // Cost over the window alone.
  double cost(const Points& states, const Window& window) const {
    return oracle::cost_of(
        {states.data() + window.first, static_cast<std::size_t>(window.num_steps()) + 1}, ds_m_);
  }
  // A zigzag over a box that the straight line would cross.
  void use_box_below_zigzag() {
    use({kBounds, {{oracle::box_between({4.0, 4.0}, {6.0, 6.0}), kDefaultMargin}}});
    zigzag_ = oracle::cut_into_steps(Points{{2.0, 5.0}, {4.0, 8.0}, {6.0, 7.0}, {8.0, 5.0}}, 0.25);
    whole_ = {0, static_cast<int>(zigzag_.size()) - 1, 0, true};
  }

  PlannerSettings settings_;
  InArena<WindowOptimizer<Point2>> optimizer_{settings_};
  Point2 robot_{0.1};
  TestWorld test_{{512, 8192}};
  Scene scene_;
  MarginProfile profile_ = oracle::plain_profile(0.1);
  double trust_m_ = 3.0;
  double ds_m_ = 0.25;
  Points zigzag_;
  Window whole_;
};

TEST_F(WindowOptimizerTest, StraightensAZigzagInFreeSpace) {
  use({kBounds, {}});
  Points states = {{1, 5}, {2, 6}, {3, 4}, {4, 5}, {5, 5}};
  const WindowResult result = optimize(states, {0, 4, 0, true});
  EXPECT_EQ(result.status, WindowStatus::kMoved);
  EXPECT_EQ(result.qp_status, QpStatus::kOptimal);
  for (int t = 0; t <= 4; ++t) {
    EXPECT_LE((states[static_cast<std::size_t>(t)] - Vec2(1.0 + t, 5.0)).norm(), 1e-12);
  }
  EXPECT_NEAR(result.cost_before, (2.0 + 5.0 + 2.0 + 1.0) / ds_m_, 1e-12);
  EXPECT_NEAR(result.cost_after, 4.0 / ds_m_, 1e-12);
  EXPECT_NEAR(result.displacement_m, 1.0, 1e-12);
  EXPECT_FALSE(result.has_active_rows);
  EXPECT_FALSE(result.was_shortened);
  EXPECT_EQ(result.qp_solves, 1);
}

TEST_F(WindowOptimizerTest, SaysThatThereIsNothingLeftToDo) {
  use_box_below_zigzag();
  Points states = zigzag_;
  WindowResult result;
  for (int k = 0; k < 100 && result.status != WindowStatus::kConverged; ++k) {
    result = optimize(states, whole_);
    ASSERT_GE(static_cast<int>(result.status), 0);
  }
  EXPECT_EQ(result.status, WindowStatus::kConverged);
  EXPECT_TRUE(result.has_active_rows);
  // Over the upper corners of the box at a distance of 0.2 m.
  EXPECT_GT(oracle::length_of(states), 2.0 * std::hypot(2.0, 1.0) + 2.0);
  EXPECT_LT(oracle::length_of(states), 1.05 * (2.0 * std::hypot(2.0, 1.2) + 2.0));
  EXPECT_NEAR(SceneOracle(scene_).trajectory_slack(states, robot_.radius_m, profile_), 0.0, 1e-6);
}

TEST_F(WindowOptimizerTest, WritesOnlyTheInteriorOfItsWindow) {
  use_box_below_zigzag();
  const int horizon = static_cast<int>(zigzag_.size()) - 1;
  for (int first = 0; first + 2 <= horizon; first += 3) {
    Points states = zigzag_;
    const Window window = {first, std::min(horizon, first + 11), 0, true};
    (void)optimize(states, window);
    for (int t = 0; t <= horizon; ++t) {
      const auto i = static_cast<std::size_t>(t);
      if (t <= window.first || t >= window.last) {
        EXPECT_EQ(states[i], zigzag_[i]) << t;
      }
    }
  }
}

TEST_F(WindowOptimizerTest, NeverRaisesTheCostAndKeepsTheClearance) {
  Random random(1);
  double gained = 0.0;
  for (int round = 0; round < 200; ++round) {
    const Points way = oracle::random_polyline(random, kInner, 4);
    profile_.num_start_steps = random.index(2);
    profile_.start_cap_m = random.uniform(0.0, 0.1);
    use(oracle::random_scene_around(random, kBounds, way, 60, 0.6,
                                    robot_.radius_m + profile_.rule.margin_m));
    trust_m_ = random.uniform(0.05, 3.0);
    Points states = oracle::cut_into_steps(way, ds_m_);
    const int horizon = static_cast<int>(states.size()) - 1;
    for (int k = 0; k < 5; ++k) {
      const Points before = states;
      const int first = random.index(horizon);
      const Window window = {first, std::min(horizon, first + 1 + random.index(60)), 0, true};
      const WindowResult result = optimize(states, window);
      if (result.status == WindowStatus::kTooShort) continue;
      ASSERT_GE(static_cast<int>(result.status), 0) << static_cast<int>(result.status);
      EXPECT_NEAR(result.cost_before, cost(before, window), 1e-9);
      EXPECT_NEAR(result.cost_after, cost(states, window), 1e-9);
      EXPECT_LE(result.cost_after, result.cost_before);
      double displacement_m = 0.0;
      for (std::size_t t = 0; t < states.size(); ++t) {
        displacement_m = std::max(displacement_m, (states[t] - before[t]).norm());
      }
      EXPECT_NEAR(result.displacement_m, displacement_m, 1e-9);
      EXPECT_LE(displacement_m, trust_m_ * (1.0 + 1e-9));
      const double slack_m =
          SceneOracle(scene_).trajectory_slack(states, robot_.radius_m, profile_);
      ASSERT_GE(slack_m, -kTol_m) << oracle::to_text(scene_) << oracle::to_text(before)
                                  << window.first << ".." << window.last << " trust " << trust_m_;
      gained += result.cost_before - result.cost_after;
    }
  }
  EXPECT_GT(gained, 100.0);
}

TEST_F(WindowOptimizerTest, StopsAtTheTrustRadius) {
  use({kBounds, {}});
  trust_m_ = 0.1;
  Points states = {{1, 5}, {2, 8}, {3, 5}};
  const WindowResult result = optimize(states, {0, 2, 0, true});
  EXPECT_EQ(result.status, WindowStatus::kMoved);
  EXPECT_TRUE(result.was_shortened);
  EXPECT_NEAR(states[1].y(), 7.9, 1e-9);
}

TEST_F(WindowOptimizerTest, SkipsWindowsWithoutInterior) {
  use({kBounds, {}});
  Points states = {{1, 5}, {2, 8}, {3, 5}};
  EXPECT_EQ(optimize(states, {1, 2, 0, false}).status, WindowStatus::kTooShort);
  EXPECT_EQ(states, (Points{{1, 5}, {2, 8}, {3, 5}}));
}

TEST_F(WindowOptimizerTest, DoesNotRunAfterItsDeadline) {
  use_box_below_zigzag();
  ManualClock clock;
  Points states = zigzag_;
  const WindowResult result = optimize(states, whole_, Deadline(clock.clock(), 0, 0.0));
  EXPECT_TRUE(result.status == WindowStatus::kNotRun || result.status == WindowStatus::kQpFailed);
  EXPECT_EQ(states, zigzag_);
}

TEST_F(WindowOptimizerTest, LeavesTheWindowAloneWhenTheDeadlineCutsTheQp) {
  use_box_below_zigzag();
  for (int polls = 0; polls < 60; ++polls) {
    ManualClock clock(1000);
    Points states = zigzag_;
    const WindowResult result =
        optimize(states, whole_, Deadline(clock.clock(), 0, 1e-6 * polls + 0.5e-6));
    if (result.status == WindowStatus::kMoved) break;
    EXPECT_EQ(states, zigzag_);
    EXPECT_TRUE(
        result.status == WindowStatus::kNotRun ||
        (result.status == WindowStatus::kQpFailed && result.qp_status == QpStatus::kDeadline));
  }
}

TEST_F(WindowOptimizerTest, SaysWhenItsRowsDoNotFit) {
  // Both walls are within the smallest trust radius of every edge.
  const Scene corridor = oracle::narrow_corridor(2.0 * (0.2 + 0.01));
  use(corridor);
  PlannerSettings settings;
  settings.rows_per_window = 16;
  InArena<WindowOptimizer<Point2>> small(settings);
  Points states = oracle::zigzag_in_corridor(ds_m_, 0.005);
  const Points before = states;
  const SweepProblem<Point2> problem = {&robot_, &test_.world, profile_, trust_m_, ds_m_, states};
  const WindowResult result = small->optimize(problem, {0, 30, 0, true}, Deadline());
  EXPECT_EQ(result.status, WindowStatus::kNoRows);
  EXPECT_EQ(result.cost_after, result.cost_before);
  EXPECT_EQ(states, before);
  EXPECT_EQ(small->optimize(problem, {0, 3, 0, true}, Deadline()).status, WindowStatus::kMoved);
}

TEST_F(WindowOptimizerTest, MakesRowsFitWithASmallerTrustRadius) {
  Random random(3);
  const Points way = {{1.0, 5.0}, {4.0, 6.5}, {9.0, 5.0}};
  use(oracle::random_scene_around(random, kBounds, way, 500, 0.15, 0.3));
  PlannerSettings settings;
  settings.rows_per_window = 256;
  InArena<WindowOptimizer<Point2>> small(settings);
  Points states = oracle::cut_into_steps(way, ds_m_);
  const Window window = {0, static_cast<int>(states.size()) - 1, 0, true};
  const SweepProblem<Point2> problem = {&robot_, &test_.world, profile_, trust_m_, ds_m_, states};
  std::int64_t num_queries = 0;
  InArena<PointRows> rows(60, 256);
  ASSERT_FALSE(make_obstacle_rows(robot_, test_.world, profile_, states, window, trust_m_, *rows,
                                  num_queries));
  const WindowResult result = small->optimize(problem, window, Deadline());
  EXPECT_EQ(result.status, WindowStatus::kMoved);
  EXPECT_LT(result.cost_after, result.cost_before);
  EXPECT_GE(SceneOracle(scene_).trajectory_slack(states, robot_.radius_m, profile_), -kTol_m);
}

TEST_F(WindowOptimizerTest, GivesTheSameBytesTwice) {
  use_box_below_zigzag();
  Points first = zigzag_;
  Points second = zigzag_;
  (void)optimize(first, whole_);
  (void)optimize(second, whole_);
  EXPECT_TRUE(oracle::same_bytes(first, second));
}

TEST_F(WindowOptimizerTest, TouchesNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "this build cannot count allocations";
  use_box_below_zigzag();
  RtGuard guard;
  const WindowResult result = optimize(zigzag_, whole_);
  guard.stop();
  EXPECT_EQ(result.status, WindowStatus::kMoved);
  EXPECT_EQ(guard.num_allocations() + guard.num_releases() + guard.num_locks(), 0);
}

// --- the paper's choices

class WindowOptimizerChoices : public WindowOptimizerTest {
 protected:
  SweepProblem<Point2> problem_for(Points& states) {
    return {&robot_, &test_.world, profile_, trust_m_, ds_m_, states};
  }
  // A floor with its top at y = 4, for a robot of 0.1 m with a margin of 0.1 m.
  void use_floor() {
    use({kBounds, {{oracle::box_between({0.5, 3.0}, {9.5, 4.0}), kDefaultMargin}}});
  }
  WindowResult run(const SweepProblem<Point2>& problem, int last) {
    return with_dense_->optimize(problem, {0, last, 0, true}, Deadline());
  }

  InArena<WindowOptimizer<Point2>> with_dense_{[] {
    PlannerSettings settings;
    settings.dense_solver = true;
    return settings;
  }()};
};

TEST_F(WindowOptimizerChoices, SolvesTheSameWindowWithEitherSolver) {
  Random random(21);
  int num_active = 0;
  for (int round = 0; round < 200; ++round) {
    const Points way = oracle::random_polyline(random, kInner, 4);
    use(oracle::random_scene_around(random, kBounds, way, 60, 0.6, 0.2));
    Points closed_form = oracle::cut_into_steps(way, ds_m_);
    Points dense = closed_form;
    const int horizon = static_cast<int>(dense.size()) - 1;
    const int first = random.index(horizon - 1);
    const Window window = {first, std::min(horizon, first + 2 + random.index(59)), 0, true};
    SweepProblem<Point2> problem = problem_for(closed_form);
    problem.rows = static_cast<RowMode>(random.index(3));
    problem.accept = random.chance(0.5);
    problem.linearize_about_rest = random.chance(0.2);
    const WindowResult expected = with_dense_->optimize(problem, window, Deadline());
    problem.states = dense;
    problem.solver = WindowSolver::kDense;
    const WindowResult result = with_dense_->optimize(problem, window, Deadline());
    ASSERT_EQ(result.qp_status, expected.qp_status);
    ASSERT_EQ(result.status, expected.status);
    EXPECT_EQ(result.has_active_rows, expected.has_active_rows);
    for (std::size_t t = 0; t < dense.size(); ++t) {
      ASSERT_LE((dense[t] - closed_form[t]).norm(), 1e-8) << t << oracle::to_text(scene_);
    }
    num_active += result.has_active_rows ? 1 : 0;
  }
  EXPECT_GT(num_active, 50);
}

TEST_F(WindowOptimizerChoices, TakesTheSolutionAsItIsWithoutACheck) {
  use_floor();
  // Below what the row asks for: the solution is longer than the reference.
  Points states = {{4.0, 4.1}, {4.2, 4.1}, {4.4, 4.1}};
  const Points before = states;
  SweepProblem<Point2> problem = problem_for(states);
  problem.rows = RowMode::kLabelMap;
  EXPECT_EQ(run(problem, 2).cost_after, oracle::cost_of(before, ds_m_));
  EXPECT_EQ(states, before);
  problem.accept = false;
  const WindowResult result = run(problem, 2);
  EXPECT_EQ(result.status, WindowStatus::kMoved);
  EXPECT_NEAR(states[1].x(), 4.2, kTol_m);
  EXPECT_NEAR(states[1].y(), 4.2, kTol_m);
  EXPECT_NEAR(result.displacement_m, 0.1, kTol_m);
  EXPECT_GT(result.cost_after, result.cost_before);
  EXPECT_NEAR(result.cost_after, oracle::cost_of(states, ds_m_), 1e-12);
}

TEST_F(WindowOptimizerChoices, PassesTheTrustRadiusWithoutACheck) {
  use({kBounds, {}});
  trust_m_ = 0.1;
  Points states = {{1, 5}, {2, 8}, {3, 5}};
  SweepProblem<Point2> problem = problem_for(states);
  problem.accept = false;
  EXPECT_EQ(run(problem, 2).status, WindowStatus::kMoved);
  EXPECT_NEAR(states[1].y(), 5.0, 1e-12);
  EXPECT_EQ(run(problem, 2).status, WindowStatus::kConverged);
}

TEST_F(WindowOptimizerChoices, LinearizesAboutTheFirstPointOfTheWindow) {
  use_floor();
  // At the reference y >= 4.2; about rest, which is 3.5 m higher, y >= 7.7.
  const Points before = {{4.0, 8.0}, {4.2, 4.5}, {4.4, 4.5}};
  Points states = before;
  SweepProblem<Point2> problem = problem_for(states);
  problem.rows = RowMode::kLabelMap;
  problem.accept = false;
  EXPECT_EQ(run(problem, 2).status, WindowStatus::kMoved);
  EXPECT_NEAR(states[1].y(), 6.25, kTol_m);
  states = before;
  problem.linearize_about_rest = true;
  EXPECT_EQ(run(problem, 2).status, WindowStatus::kMoved);
  EXPECT_NEAR(states[1].y(), 7.7, kTol_m);
  // Windows behind the first begin at their own first point.
  states = {{0.6, 9.0}, {4.0, 8.0}, {4.2, 4.5}, {4.4, 4.5}, {5.0, 9.0}};
  problem.states = states;
  const WindowResult result = with_dense_->optimize(problem, {1, 3, 0, true}, Deadline());
  EXPECT_EQ(result.status, WindowStatus::kMoved);
  EXPECT_NEAR(states[2].y(), 7.7, kTol_m);
}

TEST_F(WindowOptimizerChoices, KeepOneRowOrAllOfAWaypoint) {
  // A corridor along x about y = 5: the floor is a little nearer than the ceiling.
  use({kBounds,
       {{oracle::box_between({0.5, 3.0}, {9.5, 4.5}), kDefaultMargin},
        {oracle::box_between({0.5, 5.3}, {9.5, 7.0}), kDefaultMargin}}});
  const Points before = {{4.0, 6.0}, {4.2, 4.85}, {4.4, 6.0}};
  Points states = before;
  SweepProblem<Point2> problem = problem_for(states);
  problem.accept = false;
  problem.rows = RowMode::kLabelMap;
  EXPECT_EQ(run(problem, 2).status, WindowStatus::kMoved);
  EXPECT_NEAR(states[1].y(), 6.0, kTol_m) << "only the floor counts";
  states = before;
  problem.rows = RowMode::kWaypoint;
  EXPECT_EQ(run(problem, 2).status, WindowStatus::kMoved);
  EXPECT_NEAR(states[1].y(), 5.1, kTol_m) << "the ceiling counts too";
}

TEST_F(WindowOptimizerChoices, LeavesAWindowThatIsTooLongAlone) {
  use({kBounds, {}});
  Points states;
  for (int t = 0; t <= 200; ++t) states.emplace_back(0.5 + 0.04 * t, 5.0 + 0.1 * (t % 2));
  const Points before = states;
  for (const RowMode rows : {RowMode::kEdge, RowMode::kWaypoint, RowMode::kLabelMap}) {
    for (const WindowSolver solver : {WindowSolver::kClosedForm, WindowSolver::kDense}) {
      SweepProblem<Point2> problem = problem_for(states);
      problem.rows = rows;
      problem.solver = solver;
      problem.accept = false;
      EXPECT_EQ(run(problem, settings_.max_window + 1).status, WindowStatus::kNoRows);
      EXPECT_EQ(run(problem, 200).status, WindowStatus::kNoRows);
      EXPECT_EQ(states, before);
    }
  }
  SweepProblem<Point2> problem = problem_for(states);
  problem.solver = WindowSolver::kDense;
  EXPECT_EQ(run(problem, settings_.max_window).status, WindowStatus::kMoved);
}

TEST_F(WindowOptimizerChoices, FitsEveryRowThatTheClosedFormHolds) {
  // Rows of a crowded window, more than rows_per_window but for its groups of four.
  PlannerSettings settings;
  settings.rows_per_window = 0;
  settings.dense_solver = true;
  InArena<WindowOptimizer<Point2>> small(settings);
  use({kBounds,
       {{oracle::box_between({0.5, 3.0}, {9.5, 4.5}), kDefaultMargin},
        {oracle::box_between({0.5, 6.0}, {9.5, 7.0}), kDefaultMargin}}});
  for (const WindowSolver solver : {WindowSolver::kClosedForm, WindowSolver::kDense}) {
    Points states;
    for (int t = 0; t <= 40; ++t) states.emplace_back(1.0 + 0.2 * t, 5.0 + 0.1 * (t % 2));
    SweepProblem<Point2> problem = problem_for(states);
    problem.rows = RowMode::kWaypoint;
    problem.solver = solver;
    const WindowResult result = small->optimize(problem, {0, 40, 0, true}, Deadline());
    EXPECT_EQ(result.status, WindowStatus::kMoved);
    EXPECT_EQ(result.qp_status, QpStatus::kOptimal);
  }
}

TEST_F(WindowOptimizerChoices, SaysThatItHasNoDenseSolver) {
  use({kBounds, {}});
  Points states = {{1, 5}, {2, 8}, {3, 5}};
  const Points before = states;
  SweepProblem<Point2> problem = problem_for(states);
  problem.solver = WindowSolver::kDense;
  EXPECT_EQ(optimizer_->optimize(problem, {0, 2, 0, true}, Deadline()).status,
            WindowStatus::kQpFailed);
  EXPECT_EQ(states, before);
}

TEST_F(WindowOptimizerChoices, LeaveAWindowWithoutASolutionAlone) {
  // A slot narrower than body and margin.
  use({kBounds,
       {{oracle::box_between({0.5, 4.0}, {9.5, 4.9}), kDefaultMargin},
        {oracle::box_between({0.5, 5.1}, {9.5, 6.0}), kDefaultMargin}}});
  Points states = {{4.0, 5.0}, {4.2, 5.0}, {4.4, 5.0}};
  const Points before = states;
  SweepProblem<Point2> problem = problem_for(states);
  problem.rows = RowMode::kWaypoint;
  problem.accept = false;
  for (const WindowSolver solver : {WindowSolver::kClosedForm, WindowSolver::kDense}) {
    problem.solver = solver;
    const WindowResult result = run(problem, 2);
    EXPECT_EQ(result.status, WindowStatus::kQpFailed);
    EXPECT_EQ(result.qp_status, QpStatus::kInfeasible);
    EXPECT_EQ(result.cost_after, result.cost_before);
    EXPECT_EQ(states, before);
  }
}

TEST_F(WindowOptimizerChoices, TouchNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "this build cannot count allocations";
  use_box_below_zigzag();
  SweepProblem<Point2> problem = problem_for(zigzag_);
  problem.rows = RowMode::kLabelMap;
  problem.solver = WindowSolver::kDense;
  problem.accept = false;
  problem.linearize_about_rest = true;
  RtGuard guard;
  const WindowResult result = run(problem, whole_.last);
  guard.stop();
  EXPECT_NE(result.qp_status, QpStatus::kNotSolved);
  EXPECT_EQ(guard.num_allocations() + guard.num_releases() + guard.num_locks(), 0);
}

}  // namespace
}  // namespace sopt
