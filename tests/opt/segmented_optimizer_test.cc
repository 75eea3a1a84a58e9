#include "opt/segmented_optimizer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "opt/verify/verify.h"
#include "tests/support/rt_guard.h"
#include "tests/support/test_problem.h"
#include "tests/support/test_trajectory.h"
#include "tests/support/test_world.h"

namespace sopt {
namespace {

using oracle::InArena;
using oracle::Random;
using oracle::Scene;
using oracle::SceneOracle;
using oracle::TestTrajectory;
using oracle::TestWorld;

using Points = std::vector<Vec2>;

constexpr double kTol_m = 1e-8;
constexpr double kStep_m = 0.1;
const Aabb2 kBounds = {Vec2::Zero(), Vec2::Constant(10.0)};
const Aabb2 kInner = {Vec2::Constant(0.6), Vec2::Constant(9.4)};

class SegmentedOptimizerTest : public ::testing::Test {
 protected:
  void use(const Scene& scene) {
    scene_ = scene;
    ASSERT_EQ(oracle::fill(scene, test_.world), WorldStatus::kOk);
  }
  // A random way among obstacles that leave it the margin.
  void use_random(std::uint64_t seed, int num_obstacles = 40) {
    Random random(seed);
    const Points way = oracle::random_polyline(random, kInner, 4);
    use(oracle::random_scene_around(random, kBounds, way, num_obstacles, 0.6,
                                    robot_.radius_m + profile_.rule.margin_m));
    reference_ = oracle::cut_into_steps(way, kStep_m);
  }
  struct Run {
    OptimizerResult<Point2> result;
    Points states;
    std::vector<IterationRecord> history;
    std::vector<int> splits;
  };
  Run optimize(SegmentedOptimizer<Point2>& optimizer, const Deadline& deadline = Deadline()) {
    TestTrajectory test(reference_);
    Run run;
    run.result = optimizer.optimize({&robot_, &test_.world, profile_, kStep_m, &options_},
                                    test.trajectory, deadline);
    run.states = oracle::copy_of(test.trajectory.states.span());
    run.history = {run.result.history.begin(), run.result.history.end()};
    run.splits = {run.result.splits.begin(), run.result.splits.end()};
    return run;
  }
  Run optimize(const Deadline& deadline = Deadline()) { return optimize(*optimizer_, deadline); }

  void expect_feasible(const Points& states) const {
    ASSERT_EQ(states.size(), reference_.size());
    EXPECT_EQ(states.front(), reference_.front());
    EXPECT_EQ(states.back(), reference_.back());
    EXPECT_GE(SceneOracle(scene_).trajectory_slack(states, robot_.radius_m, profile_), -kTol_m)
        << oracle::to_text(scene_) << oracle::to_text(reference_);
  }
  void expect_consistent(const Run& run) const {
    ASSERT_EQ(run.history.size(), static_cast<std::size_t>(run.result.iterations) + 1);
    EXPECT_EQ(run.history.front().iteration, 0);
    EXPECT_NEAR(run.history.front().cost, oracle::cost_of(reference_, kStep_m), 1e-9);
    EXPECT_NEAR(run.history.front().path_length, oracle::length_of(reference_), 1e-9);
    EXPECT_NEAR(run.history.back().cost, oracle::cost_of(run.states, kStep_m), 1e-9);
    EXPECT_NEAR(run.history.back().path_length, oracle::length_of(run.states), 1e-9);
    EXPECT_EQ(run.history.back().cost, run.result.cost);
    for (std::size_t i = 1; i < run.history.size(); ++i) {
      EXPECT_EQ(run.history[i].iteration, static_cast<int>(i));
      EXPECT_LE(run.history[i].cost, run.history[i - 1].cost * (1.0 + 1e-12)) << i;
    }
    ASSERT_GE(run.splits.size(), 2u);
    EXPECT_EQ(run.splits.front(), 0);
    EXPECT_EQ(run.splits.back(), static_cast<int>(run.states.size()) - 1);
    EXPECT_TRUE(std::is_sorted(run.splits.begin(), run.splits.end()));
  }

  PlannerSettings settings_;
  SerialExecutor serial_;
  ManualClock clock_;
  InArena<SegmentedOptimizer<Point2>> optimizer_{settings_, serial_, clock_.clock()};
  Point2 robot_{0.1};
  TestWorld test_{{512, 8192}};
  Scene scene_;
  MarginProfile profile_ = oracle::plain_profile(0.1);
  PlanOptions options_;
  Points reference_;
};

TEST_F(SegmentedOptimizerTest, StraightensADetourInFreeSpace) {
  use({kBounds, {}});
  reference_ = oracle::cut_into_steps(Points{{1, 5}, {4, 7}, {9, 5}}, kStep_m);
  options_.max_iterations = 100;
  options_.tol_step = 1e-7;
  const Run run = optimize();
  EXPECT_EQ(run.result.status, OptimizerStatus::kConverged);
  EXPECT_LT(oracle::length_of(run.states), 8.001);
  expect_consistent(run);
}

TEST_F(SegmentedOptimizerTest, NeverRaisesTheCostIn40ForcedSweeps) {
  options_.tol_step = 0.0;
  options_.max_iterations = 40;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    use_random(seed);
    for (const bool merge : {false, true}) {
      options_.merge = merge ? MergeRule::kPaired : MergeRule::kOff;
      options_.num_segments = 1 + static_cast<int>(seed % 9);
      const Run run = optimize();
      ASSERT_GE(static_cast<int>(run.result.status), 0);
      expect_consistent(run);
      expect_feasible(run.states);
      EXPECT_EQ(run.result.counts.windows_failed, 0);
    }
  }
}

TEST_F(SegmentedOptimizerTest, KeepsEveryIterateFeasible) {
  for (std::uint64_t seed = 0; seed < 15; ++seed) {
    use_random(seed);
    std::vector<double> costs;
    Run run;
    for (int limit = 0; limit <= 20; ++limit) {
      options_.max_iterations = limit;
      run = optimize();
      expect_feasible(run.states);
      expect_consistent(run);
      EXPECT_LE(run.result.iterations, limit);
      costs.push_back(oracle::cost_of(run.states, kStep_m));
    }
    // The history of the longest run is the costs of all shorter ones.
    for (std::size_t i = 0; i < run.history.size(); ++i) {
      EXPECT_NEAR(run.history[i].cost, costs[i], 1e-9);
    }
  }
}

TEST_F(SegmentedOptimizerTest, ReturnsTheReferenceWithoutIterations) {
  use_random(3);
  options_.max_iterations = 0;
  const Run run = optimize();
  EXPECT_TRUE(oracle::same_bytes(run.states, reference_));
  EXPECT_EQ(run.result.iterations, 0);
  EXPECT_EQ(run.result.status, OptimizerStatus::kIterationLimit);
  expect_consistent(run);
}

TEST_F(SegmentedOptimizerTest, StopsWhenBothParitiesGainLittle) {
  options_.max_iterations = 200;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    use_random(seed);
    const Run run = optimize();
    ASSERT_EQ(run.result.status, OptimizerStatus::kConverged);
    const auto n = run.history.size();
    ASSERT_GE(n, 3u);
    const double tolerance = options_.tol_step * (static_cast<double>(reference_.size()) - 1.0);
    const auto gain = [&](std::size_t i) { return run.history[i - 1].cost - run.history[i].cost; };
    EXPECT_LE(gain(n - 1), tolerance * (1.0 + 1e-9));
    // One sweep over a single window is both.
    const bool was_single = run.history.back().segments == 1;
    if (!was_single) {
      EXPECT_LE(gain(n - 2), tolerance * (1.0 + 1e-9));
    }
    // And not before.
    for (std::size_t i = 2; i + 1 < n; ++i) {
      if (run.history[i].segments == 1) {
        EXPECT_GT(gain(i), tolerance * (1.0 - 1e-9)) << i;
      }
      EXPECT_GT(std::max(gain(i), gain(i - 1)), tolerance * (1.0 - 1e-9)) << i;
    }
  }
}

TEST_F(SegmentedOptimizerTest, MergesSegmentsWithoutMuchLoss) {
  int num_merged = 0;
  for (std::uint64_t seed = 0; seed < 25; ++seed) {
    use_random(seed);
    options_.num_segments = 9;
    options_.merge = MergeRule::kOff;
    const Run apart = optimize();
    EXPECT_EQ(apart.result.segments_initial, 9);
    EXPECT_EQ(apart.result.segments_final, 9);
    options_.merge = MergeRule::kPaired;
    const Run merged = optimize();
    EXPECT_EQ(merged.result.segments_initial, 9);
    EXPECT_LE(merged.result.segments_final, 9);
    EXPECT_EQ(merged.history.front().segments, 9);
    EXPECT_LE(oracle::length_of(merged.states), 1.02 * oracle::length_of(apart.states)) << seed;
    EXPECT_LE(merged.result.cost, 1.02 * apart.result.cost) << seed;
    num_merged += merged.result.segments_final < 9 ? 1 : 0;
    for (std::size_t i = 2; i < merged.splits.size(); ++i) {
      EXPECT_LE(merged.splits[i] - merged.splits[i - 2], settings_.max_window);
    }
  }
  EXPECT_GT(num_merged, 10);
}

TEST_F(SegmentedOptimizerTest, KeepsWindowsWithinTheCap) {
  for (const int num_segments : {0, 1, 2, 5, 30}) {
    for (const int max_window : {0, 2, 7, 30, 1000}) {
      use_random(5);
      options_.num_segments = num_segments;
      options_.max_window = max_window;
      const Run run = optimize();
      const int cap =
          max_window == 0 ? settings_.max_window : std::min(max_window, settings_.max_window);
      for (std::size_t i = 2; i < run.splits.size(); ++i) {
        EXPECT_LE(run.splits[i] - run.splits[i - 2], cap) << num_segments << " " << max_window;
      }
      expect_feasible(run.states);
    }
  }
}

TEST_F(SegmentedOptimizerTest, CutsWindowsThatFail) {
  // Walls within any trust radius, so that rows fit only into short windows.
  use(oracle::narrow_corridor(2.0 * (0.2 + 0.01)));
  reference_ = oracle::zigzag_in_corridor(kStep_m, 0.005);
  settings_.rows_per_window = 40;
  InArena<SegmentedOptimizer<Point2>> tight(settings_, serial_, clock_.clock());
  options_.tol_step = 0.0;
  options_.num_segments = 3;
  const Run run = optimize(*tight);
  expect_feasible(run.states);
  expect_consistent(run);
  EXPECT_GT(run.result.counts.windows_failed, 0);
  EXPECT_GT(run.result.segments_final, 3);
  EXPECT_LT(run.result.cost, oracle::cost_of(reference_, kStep_m));
  EXPECT_LT(oracle::length_of(run.states), 8.0 + 1e-3);
  TestTrajectory test(run.states);
  const VerifyProblem<Point2> problem = {reference_.front(), reference_.back(), &test_.world};
  EXPECT_TRUE(verify(robot_, test.trajectory, problem).plan.has_value());
}

TEST_F(SegmentedOptimizerTest, StaysFeasibleWhereWindowsCannotBeCut) {
  use(oracle::narrow_corridor(2.0 * (0.2 + 0.01)));
  reference_ = oracle::zigzag_in_corridor(kStep_m, 0.005);
  settings_.rows_per_window = 1;
  settings_.max_window = 2;
  InArena<SegmentedOptimizer<Point2>> hopeless(settings_, serial_, clock_.clock());
  const Run run = optimize(*hopeless);
  expect_feasible(run.states);
  expect_consistent(run);
  EXPECT_GT(run.result.counts.windows_failed, 0);
}

TEST_F(SegmentedOptimizerTest, GivesTheSameBytesForEveryExecutor) {
  oracle::ReverseExecutor reverse;
  InArena<SegmentedOptimizer<Point2>> other(settings_, reverse, clock_.clock());
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    use_random(seed);
    const Run a = optimize();
    const Run b = optimize(*other);
    const Run c = optimize();
    EXPECT_TRUE(oracle::same_bytes(a.states, b.states));
    EXPECT_TRUE(oracle::same_bytes(a.states, c.states));
    EXPECT_EQ(a.splits, b.splits);
    EXPECT_EQ(a.result.iterations, b.result.iterations);
    EXPECT_EQ(a.result.counts.qp_steps, b.result.counts.qp_steps);
    EXPECT_EQ(a.result.counts.clearance_queries, b.result.counts.clearance_queries);
  }
}

TEST_F(SegmentedOptimizerTest, LeavesAWholeFeasibleTrajectoryAtAnyDeadline) {
  use_random(7);
  ManualClock free_clock(1000);
  const Run free = optimize(Deadline(free_clock.clock(), 0, 1e6));
  const std::int64_t num_polls = free_clock.num_reads();
  ASSERT_GT(num_polls, 20);
  for (std::int64_t polls = 0; polls <= num_polls + 2; polls += 1 + num_polls / 150) {
    ManualClock clock(1000);
    const Run run =
        optimize(Deadline(clock.clock(), 0, 1e-6 * static_cast<double>(polls) + 0.5e-6));
    expect_feasible(run.states);
    expect_consistent(run);
    EXPECT_LE(oracle::cost_of(run.states, kStep_m),
              oracle::cost_of(reference_, kStep_m) * (1.0 + 1e-12));
    if (polls < num_polls / 2) {
      EXPECT_EQ(run.result.status, OptimizerStatus::kDeadline);
    }
  }
}

// Convergence and the iteration limit promise a result that does not depend on the clock.
TEST_F(SegmentedOptimizerTest, SaysWhenTheClockCutAnySweep) {
  for (const int max_iterations : {1, 2, 3, 20}) {
    options_.max_iterations = max_iterations;
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
      use_random(seed);
      ManualClock free_clock(1000);
      const Run free = optimize(Deadline(free_clock.clock(), 0, 1e6));
      for (std::int64_t polls = free_clock.num_reads(); polls >= 0; --polls) {
        ManualClock clock(1000);
        const Run run =
            optimize(Deadline(clock.clock(), 0, 1e-6 * static_cast<double>(polls) + 0.5e-6));
        if (oracle::same_bytes(run.states, free.states)) continue;
        ASSERT_EQ(run.result.status, OptimizerStatus::kDeadline)
            << "seed " << seed << ", limit " << max_iterations << ", cut after " << polls << " of "
            << free_clock.num_reads() << " polls";
      }
    }
  }
}

TEST_F(SegmentedOptimizerTest, OptimisesTheShortestTrajectories) {
  use({kBounds, {}});
  for (const Points& states : {Points{{1, 1}, {1, 1}, {1, 1}}, Points{{1, 1}, {1.2, 1}, {1.1, 1}},
                               Points{{1, 1}, {2, 1}, {2, 2}, {1, 2}}}) {
    reference_ = states;
    const Run run = optimize();
    ASSERT_GE(static_cast<int>(run.result.status), 0);
    expect_consistent(run);
    const double shortest = (states.back() - states.front()).norm();
    EXPECT_NEAR(oracle::length_of(run.states), shortest, 0.05);
  }
}

TEST_F(SegmentedOptimizerTest, TouchesNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "this build cannot count allocations";
  use_random(8);
  TestTrajectory test(reference_);
  RtGuard guard;
  const auto result = optimizer_->optimize({&robot_, &test_.world, profile_, kStep_m, &options_},
                                           test.trajectory, Deadline());
  guard.stop();
  EXPECT_GT(result.iterations, 0);
  EXPECT_EQ(guard.num_allocations() + guard.num_releases() + guard.num_locks(), 0);
}

}  // namespace
}  // namespace sopt
