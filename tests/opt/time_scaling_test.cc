#include "opt/time_scaling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "opt/step_measure.h"
#include "tests/support/test_problem.h"
#include "tests/support/test_trajectory.h"

namespace sopt {
namespace {

using oracle::InArena;
using oracle::Random;
using oracle::TestTrajectory;

double longest_step_m(const Trajectory<Point2>& trajectory) {
  double longest = 0.0;
  for (int t = 0; t < trajectory.horizon(); ++t) {
    longest = std::max(longest, (trajectory.states[t + 1] - trajectory.states[t]).norm());
  }
  return longest;
}

// States follow from states and inputs.
void expect_exact_inputs(const Trajectory<Point2>& trajectory) {
  ASSERT_EQ(trajectory.inputs.size(), trajectory.horizon());
  for (int t = 0; t < trajectory.horizon(); ++t) {
    const Vec2 next = trajectory.states[t] + trajectory.dt_s * trajectory.inputs[t];
    EXPECT_LE((next - trajectory.states[t + 1]).norm(), 1e-12);
  }
}

void scale_and_fill(const Point2& robot, double reference_length_m,
                    Trajectory<Point2>& trajectory) {
  scale_time(robot, reference_length_m, trajectory);
  ASSERT_TRUE(fill_inputs(trajectory));
}

TEST(ScaleTime, ShortensTheStepTimeWithTheLength) {
  TestTrajectory test({{0, 0}, {1, 0}, {2, 0}, {3, 0}}, 0.5);
  scale_and_fill(Point2{}, 6.0, test.trajectory);
  EXPECT_DOUBLE_EQ(test.trajectory.dt_s, 0.25);
  EXPECT_DOUBLE_EQ(test.trajectory.inputs[1].x(), 4.0);
  expect_exact_inputs(test.trajectory);
}

TEST(ScaleTime, LengthensItWhenTheSpeedLimitAsksForIt) {
  TestTrajectory test({{0, 0}, {1, 0}, {4, 0}, {5, 0}}, 0.5);
  scale_and_fill(Point2{0.0, 2.0}, 5.0, test.trajectory);
  EXPECT_NEAR(test.trajectory.dt_s, 1.5, 1e-11);  // 3 m at 2 m/s
  expect_exact_inputs(test.trajectory);
}

TEST(ScaleTime, FollowsItsFormulaAndKeepsTheSpeedLimit) {
  Random random(1);
  for (int round = 0; round < 500; ++round) {
    const auto states = oracle::random_polyline(random, {Vec2::Constant(-5.0), Vec2::Constant(5.0)},
                                                2 + random.index(50));
    const double dt_s = random.uniform(0.01, 1.0);
    TestTrajectory test(states, dt_s);
    const double length_m = oracle::length_of(states);
    const double reference_m = length_m * random.uniform(0.5, 2.0);
    const double v_max_mps = random.uniform(0.1, 100.0);
    const Point2 robot = {0.0, v_max_mps};
    scale_and_fill(robot, reference_m, test.trajectory);
    const double expected_s =
        std::max(dt_s * length_m / reference_m, longest_step_m(test.trajectory) / v_max_mps);
    EXPECT_NEAR(test.trajectory.dt_s, expected_s, 1e-11 * expected_s);
    EXPECT_TRUE(oracle::same_bytes(test.trajectory.states.span(), states));
    expect_exact_inputs(test.trajectory);
    for (const Vec2& u : test.trajectory.inputs) EXPECT_LE(u.norm(), v_max_mps);
  }
}

TEST(ScaleTime, KeepsTheStepTimeOfATrajectoryThatStays) {
  TestTrajectory test({{1, 1}, {1, 1}, {1, 1}}, 0.5);
  scale_and_fill(Point2{0.0, 1.0}, 0.0, test.trajectory);
  EXPECT_EQ(test.trajectory.dt_s, 0.5);
  for (const Vec2& u : test.trajectory.inputs) EXPECT_EQ(u, Vec2::Zero());
}

TEST(FillInputs, GivesTheInputsOfTheStates) {
  TestTrajectory test({{0, 0}, {1, 0}, {1, 2}}, 0.5);
  test.trajectory.inputs.clear();
  ASSERT_TRUE(fill_inputs(test.trajectory));
  ASSERT_EQ(test.trajectory.inputs.size(), 2);
  EXPECT_EQ(test.trajectory.inputs[0], Vec2(2, 0));
  EXPECT_EQ(test.trajectory.inputs[1], Vec2(0, 4));
}

TEST(FillInputs, ReproducesRandomStates) {
  Random random(2);
  for (int round = 0; round < 200; ++round) {
    TestTrajectory test(
        oracle::random_polyline(random, {Vec2::Constant(-5.0), Vec2::Constant(5.0)}, 60),
        random.uniform(0.01, 1.0));
    test.trajectory.inputs.clear();
    ASSERT_TRUE(fill_inputs(test.trajectory));
    expect_exact_inputs(test.trajectory);
  }
}

TEST(FillInputs, RefusesWhatDoesNotFit) {
  TestTrajectory test({{0, 0}, {1, 0}, {1, 2}, {2, 2}});
  InArena<FixedVector<Vec2>> small(2);
  test.trajectory.inputs = std::move(*small);
  EXPECT_FALSE(fill_inputs(test.trajectory));
}

TEST(PathLength, AddsUpTheSteps) {
  TestTrajectory test({{0, 0}, {3, 4}, {3, 5}, {3, 5}});
  EXPECT_DOUBLE_EQ(path_length(Point2{}, test.trajectory), 6.0);
}

}  // namespace
}  // namespace sopt
