#include "sampler/motion_checker.h"

#include <gtest/gtest.h>

#include <cmath>

#include "models/plane/point2.h"
#include "tests/support/test_problem.h"
#include "tests/support/test_world.h"

namespace sopt {
namespace {

using oracle::Random;
using oracle::Scene;
using oracle::SceneOracle;
using oracle::TestWorld;

const Aabb2 kBounds = {Vec2::Zero(), Vec2::Constant(10.0)};

class MotionCheckerTest : public ::testing::Test {
 protected:
  // A floor below y = 1: the motion along y = 1 + h has clearance h.
  void SetUp() override {
    ASSERT_EQ(test_.world.reset(kBounds), WorldStatus::kOk);
    ASSERT_EQ(test_.world.try_add(oracle::box_between({1.0, 0.5}, {9.0, 1.0})), WorldStatus::kOk);
    test_.world.build();
    profile_.rule.margin_m = 0.5;
    profile_.start_cap_m = 0.125;
    profile_.goal_cap_m = 0.25;
    profile_.num_start_steps = 1;
    profile_.num_goal_steps = 1;
    profile_.step_length = 0.5;  // so the relaxed rules reach 0.25 m
  }

  bool is_clear(const Vec2& a, RequestEnd a_end, const Vec2& b, RequestEnd b_end) {
    MotionChecker<Point2> checker(robot_, test_.world, profile_);
    return checker.is_clear(a, a_end, b, b_end);
  }

  TestWorld test_;
  Point2 robot_{0.0};
  MarginProfile profile_;
};

TEST_F(MotionCheckerTest, AsksForTheMarginAwayFromTheEnds) {
  EXPECT_TRUE(is_clear({3.0, 1.51}, RequestEnd::kNone, {7.0, 1.51}, RequestEnd::kNone));
  EXPECT_FALSE(is_clear({3.0, 1.49}, RequestEnd::kNone, {7.0, 1.49}, RequestEnd::kNone));
}

TEST_F(MotionCheckerTest, AddsTheRobotsRadius) {
  robot_.radius_m = 0.25;
  EXPECT_TRUE(is_clear({3.0, 1.76}, RequestEnd::kNone, {7.0, 1.76}, RequestEnd::kNone));
  EXPECT_FALSE(is_clear({3.0, 1.74}, RequestEnd::kNone, {7.0, 1.74}, RequestEnd::kNone));
}

TEST_F(MotionCheckerTest, RelaxesOnlyTheReachOfTheStart) {
  // Straight up: 0.14 at the start, the margin 0.36 further on.
  EXPECT_FALSE(is_clear({3.0, 1.14}, RequestEnd::kStart, {3.0, 3.0}, RequestEnd::kNone));
  // 0.3 at the start: the margin is reached within 0.2 m.
  EXPECT_TRUE(is_clear({3.0, 1.3}, RequestEnd::kStart, {3.0, 3.0}, RequestEnd::kNone));
  EXPECT_FALSE(is_clear({3.0, 1.3}, RequestEnd::kNone, {3.0, 3.0}, RequestEnd::kNone));
  EXPECT_TRUE(is_clear({3.0, 1.14}, RequestEnd::kStart, {3.2, 1.14}, RequestEnd::kNone));
  EXPECT_FALSE(is_clear({3.0, 1.12}, RequestEnd::kStart, {3.2, 1.14}, RequestEnd::kNone));
}

TEST_F(MotionCheckerTest, RelaxesOnlyTheReachOfTheGoal) {
  EXPECT_TRUE(is_clear({3.0, 3.0}, RequestEnd::kNone, {3.0, 1.3}, RequestEnd::kGoal));
  EXPECT_FALSE(is_clear({3.0, 3.0}, RequestEnd::kNone, {3.0, 1.2}, RequestEnd::kGoal));
  EXPECT_FALSE(is_clear({3.0, 3.0}, RequestEnd::kNone, {3.0, 1.3}, RequestEnd::kNone));
}

TEST_F(MotionCheckerTest, CanBeWalkedFromGoalToStart) {
  EXPECT_TRUE(is_clear({3.0, 1.3}, RequestEnd::kGoal, {3.0, 3.0}, RequestEnd::kNone));
  EXPECT_TRUE(is_clear({3.0, 3.0}, RequestEnd::kNone, {3.0, 1.3}, RequestEnd::kStart));
}

TEST_F(MotionCheckerTest, ChecksAMotionOfNoLengthByTheLoosestRule) {
  EXPECT_TRUE(is_clear({3.0, 1.2}, RequestEnd::kStart, {3.0, 1.2}, RequestEnd::kGoal));
  EXPECT_FALSE(is_clear({3.0, 1.1}, RequestEnd::kStart, {3.0, 1.1}, RequestEnd::kGoal));
  EXPECT_FALSE(is_clear({3.0, 1.2}, RequestEnd::kNone, {3.0, 1.2}, RequestEnd::kNone));
}

TEST_F(MotionCheckerTest, CountsItsChecks) {
  MotionChecker<Point2> checker(robot_, test_.world, profile_);
  for (int i = 0; i < 5; ++i) {
    (void)checker.is_clear({3.0, 3.0}, RequestEnd::kNone, {4.0, 3.0}, RequestEnd::kNone);
  }
  EXPECT_EQ(checker.num_checks(), 5);
}

TEST_F(MotionCheckerTest, AgreesWithDenseSamplingOnRandomMotions) {
  constexpr double kTol_m = 1e-9;
  Random random(1);
  int num_clear = 0;
  for (int round = 0; round < 40; ++round) {
    const Scene scene = oracle::random_scene(random, kBounds, 25, 0.8);
    ASSERT_EQ(oracle::fill(scene, test_.world), WorldStatus::kOk);
    const SceneOracle dense(scene);
    robot_.radius_m = random.uniform(0.0, 0.2);
    profile_.rule.margin_m = random.uniform(0.0, 0.3);
    profile_.step_length = random.uniform(0.1, 2.0);
    for (int k = 0; k < 50; ++k) {
      const Vec2 a = random.point(kBounds);
      const Vec2 b = a + random.uniform(0.1, 4.0) * (random.point(kBounds) - a).normalized();
      const RequestEnd a_end = random.chance(0.5) ? RequestEnd::kNone : RequestEnd::kStart;
      const RequestEnd b_end = random.chance(0.5) ? RequestEnd::kNone : RequestEnd::kGoal;
      MarginProfile profile = profile_;
      if (a_end == RequestEnd::kNone) profile.num_start_steps = 0;
      if (b_end == RequestEnd::kNone) profile.num_goal_steps = 0;
      const Vec2 motion[] = {a, b};
      const double slack_m = dense.path_slack(motion, robot_.radius_m, profile);
      if (std::abs(slack_m) < kTol_m) continue;
      EXPECT_EQ(is_clear(a, a_end, b, b_end), slack_m > 0.0) << slack_m;
      num_clear += slack_m > 0.0 ? 1 : 0;
    }
  }
  EXPECT_GT(num_clear, 200);
}

}  // namespace
}  // namespace sopt
