#include <gtest/gtest.h>

#include <cmath>

#include "models/arm/arm_presets.h"
#include "opt/segmented_optimizer.h"
#include "opt/step_measure.h"
#include "opt/time_scaling.h"
#include "tests/support/arm_segment.h"
#include "tests/support/rt_guard.h"
#include "tests/support/test_problem.h"
#include "tests/support/threaded_executor.h"

namespace sopt {
namespace {

using oracle::InArena;
using oracle::Random;

constexpr int kDof = 5;
constexpr double kStep = 0.05;
using Robot = Arm<kDof>;
using States = oracle::States<kDof>;

class ArmOptimizerTest : public ::testing::Test {
 protected:
  void draw(std::uint64_t seed) {
    Random random(seed);
    const auto way = oracle::random_way(random, robot_, 3);
    oracle::draw_obstacles(random, robot_, way, 8, 0.8, options_.margin_m + 0.002, test_.world);
    oracle::make_arm_reference(robot_, way, kStep, options_.dt_s, reference_.trajectory);
  }
  struct Run {
    OptimizerResult<Robot> result;
    States states;
    std::vector<IterationRecord> history;
  };
  Run optimize(SegmentedOptimizer<Robot>& optimizer) {
    auto& trajectory = trajectory_.trajectory;
    (void)trajectory.states.try_assign(reference_.trajectory.states.span());
    trajectory.dt_s = options_.dt_s;
    Run run;
    run.result = optimizer.optimize({&robot_, &test_.world, profile_, kStep, &options_}, trajectory,
                                    Deadline());
    run.states = {trajectory.states.begin(), trajectory.states.end()};
    run.history = {run.result.history.begin(), run.result.history.end()};
    return run;
  }
  Run optimize() { return optimize(*optimizer_); }

  const Robot robot_ = lr_mate_200id_7l();
  PlannerSettings settings_ = PlannerSettings::arm();
  PlanOptions options_ = PlanOptions::arm();
  MarginProfile profile_{.rule = {options_.margin_m, 1.0, options_.min_clearance_m + 1e-8}};
  SerialExecutor serial_;
  ManualClock clock_;
  InArena<SegmentedOptimizer<Robot>> optimizer_{settings_, serial_, clock_.clock()};
  oracle::ArmTestWorld test_;
  oracle::EmptyArmTrajectory<kDof> reference_, trajectory_;
};

TEST_F(ArmOptimizerTest, DescendsMonotonelyAndKeepsEveryConstraint) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    draw(seed);
    const Run run = optimize();
    EXPECT_EQ(run.result.status, OptimizerStatus::kConverged) << seed;
    ASSERT_EQ(run.history.size(), static_cast<std::size_t>(run.result.iterations) + 1);
    for (std::size_t k = 1; k < run.history.size(); ++k) {
      EXPECT_LE(run.history[k].cost, run.history[k - 1].cost) << seed;
    }
    EXPECT_LT(run.history.back().path_length, run.history.front().path_length);
    const auto facts = oracle::examine(robot_, test_.world, run.states, options_.dt_s, 16);
    EXPECT_GE(facts.clearance_m, options_.min_clearance_m) << seed;
    EXPECT_GE(facts.self_clearance_m, kSelfClearance_m) << seed;
    EXPECT_LE(facts.limit_excess, 0.0) << seed;
    EXPECT_LE(facts.defect, 1e-12) << seed;
    EXPECT_EQ(run.states.front(), reference_.trajectory.states[0]);
    EXPECT_EQ(run.states.back(), reference_.trajectory.states.back());
  }
}

TEST_F(ArmOptimizerTest, CostsOfWindowsAddUpToTheCost) {
  draw(1);
  options_.max_iterations = 1;
  options_.num_segments = 5;
  const States before(reference_.trajectory.states.begin(), reference_.trajectory.states.end());
  InArena<Splits> splits(settings_.max_horizon);
  ASSERT_TRUE(splits->try_reset(static_cast<int>(before.size()) - 1, 5));
  InArena<FixedVector<Window>> windows(settings_.max_horizon);
  const double whole = oracle::arm_cost(robot_, before, options_.dt_s, kStep);
  for (const Parity parity : {Parity::kOdd, Parity::kEven}) {
    splits->list_windows(parity, *windows);
    double sum = 0.0;
    for (const Window& w : *windows) {
      const States part(before.begin() + w.first, before.begin() + w.last + 1);
      sum += oracle::arm_cost(robot_, part, options_.dt_s, kStep);
    }
    EXPECT_NEAR(sum, whole, 1e-12 * whole);
  }
  const Run run = optimize();
  EXPECT_NEAR(run.history[0].cost, whole, 1e-12 * whole);
  EXPECT_NEAR(run.history[1].cost, oracle::arm_cost(robot_, run.states, options_.dt_s, kStep),
              1e-12 * whole);
}

TEST_F(ArmOptimizerTest, HardlyDependsOnTheNumberOfSegments) {
  double lengths[10] = {};
  for (const int num_segments : {3, 5, 7, 9}) {
    options_.num_segments = num_segments;
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
      draw(seed);
      lengths[num_segments] += optimize().history.back().path_length;
    }
  }
  for (const int num_segments : {5, 7, 9}) {
    EXPECT_NEAR(lengths[num_segments] / lengths[3], 1.0, 0.03) << num_segments;
  }
}

TEST_F(ArmOptimizerTest, GoesOnWhileASweepGainsATenthWhateverTheTolerance) {
  int num_longer = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    draw(seed);
    options_.tol_step = 1e3;
    options_.merge = MergeRule::kPaired;
    options_.num_segments = 6;
    const Run run = optimize();
    ASSERT_GE(run.history.size(), 3U);
    const auto gain = [&](std::size_t k) {
      return (run.history[k - 1].cost - run.history[k].cost) / run.history[k - 1].cost;
    };
    const std::size_t last = run.history.size() - 1;
    EXPECT_LE(gain(last), 0.1) << seed;
    num_longer += last > 2 ? 1 : 0;
  }
  EXPECT_GT(num_longer, 0);
}

TEST_F(ArmOptimizerTest, EndsNearWhatManySweepsReach) {
  double cost = 0.0;
  double best = 0.0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    draw(seed);
    options_ = PlanOptions::arm();
    cost += optimize().result.cost;
    options_.max_iterations = 200;
    options_.tol_step = 0.0;
    best += optimize().result.cost;
  }
  EXPECT_LE(cost, 1.05 * best);
}

TEST_F(ArmOptimizerTest, KeepsTheLimitsWhenTimeIsScaled) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    draw(seed);
    (void)optimize();
    auto& trajectory = trajectory_.trajectory;
    scale_time(robot_, path_length(robot_, reference_.trajectory), trajectory);
    EXPECT_LE(trajectory.dt_s, options_.dt_s * (1.0 + 1e-6));
    const States states(trajectory.states.begin(), trajectory.states.end());
    const auto facts = oracle::examine(robot_, test_.world, states, trajectory.dt_s, 16);
    EXPECT_GE(facts.clearance_m, options_.min_clearance_m) << seed;
    EXPECT_LE(facts.limit_excess, 0.0) << seed;
    EXPECT_LE(facts.defect, 1e-12) << seed;
  }
}

TEST_F(ArmOptimizerTest, GivesTheSameBytesForAnyNumberOfWorkers) {
  ThreadedExecutor threads;
  InArena<SegmentedOptimizer<Robot>> parallel(settings_, threads, clock_.clock());
  options_.num_segments = 7;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    draw(seed);
    const States serial = optimize().states;
    EXPECT_EQ(optimize(*parallel).states, serial) << seed;
  }
}

TEST_F(ArmOptimizerTest, TouchesNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "this build cannot count allocations";
  draw(1);
  auto& trajectory = trajectory_.trajectory;
  (void)trajectory.states.try_assign(reference_.trajectory.states.span());
  trajectory.dt_s = options_.dt_s;
  RtGuard guard;
  const auto result = optimizer_->optimize({&robot_, &test_.world, profile_, kStep, &options_},
                                           trajectory, Deadline());
  guard.stop();
  EXPECT_EQ(result.status, OptimizerStatus::kConverged);
  EXPECT_EQ(guard.num_allocations() + guard.num_releases() + guard.num_locks(), 0);
}

}  // namespace
}  // namespace sopt
