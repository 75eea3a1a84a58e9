#include "opt/verify/verify.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/rt_guard.h"
#include "tests/support/test_trajectory.h"
#include "tests/support/test_world.h"

namespace sopt {
namespace {

using oracle::box_between;
using oracle::TestTrajectory;
using oracle::TestWorld;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kTol = 1e-12;

// Along y = 0 from x = 0 to 10 in steps of 1, dt 0.1 s.
std::vector<Vec2> straight_states() {
  std::vector<Vec2> states;
  for (int i = 0; i <= 10; ++i) states.emplace_back(i, 0.0);
  return states;
}

class Verify : public testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(world_.reset({{-20, -20}, {20, 20}}), WorldStatus::kOk); }

  template <class Shape>
  void add(const Shape& shape, double margin_m = kDefaultMargin) {
    ASSERT_EQ(world_.try_add(shape, margin_m), WorldStatus::kOk);
  }

  // Checks `trajectory` as an answer to its own ends.
  VerifyResult<Point2> run(const Trajectory<Point2>& trajectory, double min_clearance_m = 1e-4) {
    world_.build();
    return verify(robot_, trajectory,
                  {straight_states().front(), straight_states().back(), &world_, min_clearance_m});
  }

  Violation violation(const Trajectory<Point2>& trajectory, double min_clearance_m = 1e-4) {
    const VerifyResult<Point2> result = run(trajectory, min_clearance_m);
    EXPECT_EQ(result.plan.has_value(), result.violation.kind == ViolationKind::kNone);
    return result.violation;
  }

  TestWorld test_world_;
  World2& world_ = test_world_.world;
  Point2 robot_{0.5, kInfinity};
  TestTrajectory straight_{straight_states(), 0.1};
  Trajectory<Point2>& trajectory_ = straight_.trajectory;
};

// --- accepts

TEST_F(Verify, CertifiesTheClearanceBetweenWaypoints) {
  add(Disc{{5.25, 3.0}, 1.0});
  const VerifyResult<Point2> result = run(trajectory_);
  ASSERT_TRUE(result.plan.has_value());
  EXPECT_EQ(result.violation.kind, ViolationKind::kNone);
  EXPECT_EQ(&result.plan->trajectory(), &trajectory_);
  const Certificate& certificate = result.plan->certificate();
  EXPECT_NEAR(certificate.min_clearance_m, 1.5, kTol);
  EXPECT_NEAR(certificate.where_t_s, 0.525, 1e-9);
  EXPECT_EQ(certificate.i_obstacle, 0);
  EXPECT_EQ(certificate.goal_error, 0.0);
  EXPECT_LE(certificate.dynamics_defect, 1e-14);
  EXPECT_EQ(certificate.worst_limit_margin, 1.0);
}

TEST_F(Verify, CertifiesTheNearestOfSeveralObstacles) {
  add(Disc{{2.0, 3.0}, 1.0});
  add(box_between({6.0, -2.0}, {8.0, -1.25}));
  add(Disc{{9.0, 4.0}, 1.0});
  const VerifyResult<Point2> result = run(trajectory_);
  ASSERT_TRUE(result.plan.has_value());
  EXPECT_NEAR(result.plan->certificate().min_clearance_m, 0.75, kTol);
  EXPECT_EQ(result.plan->certificate().i_obstacle, 1);
  EXPECT_GE(result.plan->certificate().where_t_s, 0.6 - 1e-9);
  EXPECT_LE(result.plan->certificate().where_t_s, 0.8 + 1e-9);
}

TEST_F(Verify, CertifiesTheDistanceToTheBounds) {
  ASSERT_EQ(world_.reset({{-20.0, -20.0}, {10.75, 20.0}}), WorldStatus::kOk);
  const VerifyResult<Point2> result = run(trajectory_);
  ASSERT_TRUE(result.plan.has_value());
  EXPECT_NEAR(result.plan->certificate().min_clearance_m, 0.25, kTol);
  EXPECT_NEAR(result.plan->certificate().where_t_s, 1.0, 1e-9);
  EXPECT_EQ(result.plan->certificate().i_obstacle, kBoundsObstacle);
}

TEST_F(Verify, CertifiesClearancesBeyondAnyMargin) {
  add(Disc{{5.0, 15.0}, 0.5});
  const VerifyResult<Point2> result = run(trajectory_);
  ASSERT_TRUE(result.plan.has_value());
  EXPECT_NEAR(result.plan->certificate().min_clearance_m, 9.5, kTol);  // the wall at x = 20
  EXPECT_EQ(result.plan->certificate().i_obstacle, kBoundsObstacle);
}

TEST_F(Verify, AcceptsExactlyTheMinClearance) {
  add(box_between({4.0, 0.75}, {6.0, 2.0}));
  EXPECT_EQ(violation(trajectory_, 0.25).kind, ViolationKind::kNone);
  EXPECT_EQ(violation(trajectory_, 0.25 + 1e-9).kind, ViolationKind::kCollision);
}

TEST_F(Verify, IgnoresMarginsThatAreOnlyWanted) {
  add(box_between({4.0, 0.75}, {6.0, 2.0}), 5.0);
  EXPECT_EQ(violation(trajectory_, 0.1).kind, ViolationKind::kNone);
}

TEST_F(Verify, AcceptsAPlanThatStays) {
  const TestTrajectory stay({{1, 1}, {1, 1}, {1, 1}});
  world_.build();
  const auto result = verify(robot_, stay.trajectory, {{1, 1}, {1, 1}, &world_, 1e-4});
  ASSERT_TRUE(result.plan.has_value());
  EXPECT_NEAR(result.plan->certificate().min_clearance_m, 18.5, kTol);
}

TEST_F(Verify, AcceptsASingleStep) {
  const TestTrajectory one({{1, 1}, {2, 1}});
  world_.build();
  EXPECT_TRUE(verify(robot_, one.trajectory, {{1, 1}, {2, 1}, &world_, 1e-4}).plan.has_value());
}

TEST_F(Verify, ReportsTheWorstLimitMargin) {
  robot_.v_max_mps = 40.0;
  const VerifyResult<Point2> result = run(trajectory_);  // 10 m/s
  ASSERT_TRUE(result.plan.has_value());
  EXPECT_NEAR(result.plan->certificate().worst_limit_margin, 0.75, kTol);
}

TEST_F(Verify, ReportsTheDynamicsDefect) {
  trajectory_.inputs[3].x() += 5e-9;  // moves 5e-10 m in a step
  const VerifyResult<Point2> result = run(trajectory_);
  ASSERT_TRUE(result.plan.has_value());
  EXPECT_NEAR(result.plan->certificate().dynamics_defect, 5e-10, 1e-14);
}

// --- rejects: shape and numbers

TEST_F(Verify, RejectsATrajectoryWithoutSteps) {
  const TestTrajectory empty(std::vector<Vec2>{});
  EXPECT_EQ(violation(empty.trajectory).kind, ViolationKind::kShape);
  const TestTrajectory point({{0.0, 0.0}});
  EXPECT_EQ(violation(point.trajectory).kind, ViolationKind::kShape);
}

TEST_F(Verify, RejectsMissingOrSurplusInputs) {
  ASSERT_TRUE(trajectory_.inputs.try_resize(9));
  EXPECT_EQ(violation(trajectory_).kind, ViolationKind::kShape);
  ASSERT_TRUE(trajectory_.inputs.try_resize(11));
  EXPECT_EQ(violation(trajectory_).kind, ViolationKind::kShape);
}

TEST_F(Verify, RejectsATimeStepThatIsNotPositive) {
  for (const double dt_s : {0.0, -0.1, kNan}) {
    trajectory_.dt_s = dt_s;
    EXPECT_EQ(violation(trajectory_).kind, ViolationKind::kShape) << dt_s;
  }
}

TEST_F(Verify, RejectsNumbersThatAreNotFinite) {
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    for (const int t : {0, 4, 10}) {
      TestTrajectory broken(straight_states());
      broken.trajectory.states[t].y() = bad;
      EXPECT_EQ(violation(broken.trajectory).kind, ViolationKind::kNotFinite) << t << " " << bad;
    }
    for (const int t : {0, 4, 9}) {
      TestTrajectory broken(straight_states());
      broken.trajectory.inputs[t].x() = bad;
      EXPECT_EQ(violation(broken.trajectory).kind, ViolationKind::kNotFinite) << t << " " << bad;
    }
  }
}

// --- rejects: ends, dynamics, limits

TEST_F(Verify, RejectsAnotherStart) {
  auto states = straight_states();
  states[0].y() = 0.25;
  const TestTrajectory other(states);
  const Violation found = violation(other.trajectory);
  EXPECT_EQ(found.kind, ViolationKind::kStart);
  EXPECT_NEAR(found.amount, 0.25, kTol);
  EXPECT_EQ(found.t_s, 0.0);
}

TEST_F(Verify, RejectsAnotherGoal) {
  auto states = straight_states();
  states[10].x() = 9.5;
  const TestTrajectory other(states);
  const Violation found = violation(other.trajectory);
  EXPECT_EQ(found.kind, ViolationKind::kGoal);
  EXPECT_NEAR(found.amount, 0.5, kTol);
  EXPECT_NEAR(found.t_s, 1.0, 1e-9);
}

TEST_F(Verify, RejectsEndsThatAreOffByARounding) {
  auto states = straight_states();
  states[0].y() = 1e-15;
  EXPECT_EQ(violation(TestTrajectory(states).trajectory).kind, ViolationKind::kStart);
  states = straight_states();
  states[10].x() = std::nextafter(10.0, 0.0);
  EXPECT_EQ(violation(TestTrajectory(states).trajectory).kind, ViolationKind::kGoal);
}

TEST_F(Verify, RejectsStatesThatDoNotFollowFromTheInputs) {
  trajectory_.inputs[6].y() += 1e-5;
  const Violation found = violation(trajectory_);
  EXPECT_EQ(found.kind, ViolationKind::kDynamics);
  EXPECT_EQ(found.step, 6);
  EXPECT_NEAR(found.amount, 1e-6, 1e-12);
}

TEST_F(Verify, RejectsTheWrongTimeStep) {
  trajectory_.dt_s = 0.1001;
  EXPECT_EQ(violation(trajectory_).kind, ViolationKind::kDynamics);
}

TEST_F(Verify, RejectsSpeedsAboveTheLimit) {
  robot_.v_max_mps = 12.0;
  auto states = straight_states();
  for (std::size_t i = 7; i <= 9; ++i) states[i].x() += 0.5;  // step 6 is 1.5 m long: 15 m/s
  const TestTrajectory fast(states);
  const Violation found = violation(fast.trajectory);
  EXPECT_EQ(found.kind, ViolationKind::kSpeed);
  EXPECT_EQ(found.step, 6);
  EXPECT_NEAR(found.amount, 3.0, 1e-9);
}

TEST_F(Verify, LimitsTheNormOfTheVelocity) {
  const TestTrajectory diagonal({{0.0, 0.0}, {1.0, 1.0}});  // 14.1 m/s
  robot_.v_max_mps = 12.0;
  world_.build();
  const auto result = verify(robot_, diagonal.trajectory, {{0, 0}, {1, 1}, &world_, 1e-4});
  EXPECT_EQ(result.violation.kind, ViolationKind::kSpeed);
  EXPECT_NEAR(result.violation.amount, 10.0 * std::sqrt(2.0) - 12.0, 1e-9);
}

// --- rejects: collisions

TEST_F(Verify, RejectsWhatOnlyCollidesBetweenWaypoints) {
  robot_.radius_m = 0.0;
  add(box_between({3.25, -1.0}, {3.75, 1.0}));
  const Violation found = violation(trajectory_);
  EXPECT_EQ(found.kind, ViolationKind::kCollision);
  EXPECT_EQ(found.step, 3);
  EXPECT_EQ(found.i_obstacle, 0);
  EXPECT_LT(found.amount, 1e-4);
  EXPECT_GE(found.t_s, 0.3 - 1e-9);
  EXPECT_LE(found.t_s, 0.4 + 1e-9);
}

TEST_F(Verify, RejectsADiscSmallerThanAStep) {
  robot_.radius_m = 0.0;
  add(Disc{{7.5, 0.0}, 1e-3});
  const Violation found = violation(trajectory_, 0.0);
  EXPECT_EQ(found.kind, ViolationKind::kCollision);
  EXPECT_EQ(found.step, 7);
}

TEST_F(Verify, RejectsAPointRobotInsideAnObstacleWithoutMinClearance) {
  robot_.radius_m = 0.0;
  add(box_between({-5.0, -5.0}, {15.0, 5.0}));
  EXPECT_EQ(violation(trajectory_, 0.0).kind, ViolationKind::kCollision);
}

// Zero is then the clearance of the wall and the distance of every box that overlaps the motion's.
TEST_F(Verify, RejectsAPointRobotThatTouchesAWallAndThenCrossesAnObstacle) {
  robot_.radius_m = 0.0;
  ASSERT_EQ(world_.reset({{0.0, -20.0}, {20.0, 20.0}}), WorldStatus::kOk);
  add(box_between({4.0, -2.0}, {6.0, 2.0}));
  EXPECT_EQ(violation(trajectory_, 0.0).kind, ViolationKind::kCollision);
}

TEST_F(Verify, ReportsTheFirstCollisionOfAPointRobot) {
  robot_.radius_m = 0.0;
  add(box_between({7.25, -2.0}, {7.75, 2.0}));
  add(box_between({4.25, -2.0}, {4.75, 2.0}));
  const Violation found = violation(trajectory_, 0.0);
  EXPECT_EQ(found.kind, ViolationKind::kCollision);
  EXPECT_EQ(found.step, 4);
  EXPECT_EQ(found.i_obstacle, 1);
}

TEST_F(Verify, RejectsTheBodyNotOnlyTheCentre) {
  add(Disc{{5.5, 1.0}, 0.5});  // 0.5 from the path: touches the robot
  const Violation found = violation(trajectory_);
  EXPECT_EQ(found.kind, ViolationKind::kCollision);
  EXPECT_EQ(found.step, 5);
  EXPECT_NEAR(found.amount, 0.0, kTol);
}

TEST_F(Verify, RejectsLeavingTheBounds) {
  ASSERT_EQ(world_.reset({{-20.0, -20.0}, {8.25, 20.0}}), WorldStatus::kOk);
  const Violation found = violation(trajectory_);
  EXPECT_EQ(found.kind, ViolationKind::kCollision);
  EXPECT_EQ(found.step, 7);  // its end, x = 8, is 0.25 from the wall with a body of 0.5
  EXPECT_EQ(found.i_obstacle, kBoundsObstacle);
  EXPECT_NEAR(found.amount, -0.25, kTol);
}

TEST_F(Verify, ReportsTheFirstCollisionInTime) {
  add(box_between({7.75, -1.0}, {8.25, 1.0}));
  add(box_between({3.75, 0.5}, {4.25, 1.0}));
  add(box_between({5.75, -1.0}, {6.25, 1.0}));
  const Violation found = violation(trajectory_);
  EXPECT_EQ(found.kind, ViolationKind::kCollision);
  EXPECT_EQ(found.i_obstacle, 1);
  EXPECT_EQ(found.step, 3);
}

TEST_F(Verify, ReportsTheFirstOfSeveralKindsInTime) {
  add(box_between({7.75, -1.0}, {8.25, 1.0}));
  trajectory_.inputs[2].y() += 1.0;
  EXPECT_EQ(violation(trajectory_).kind, ViolationKind::kDynamics);
  EXPECT_EQ(violation(trajectory_).step, 2);
}

TEST_F(Verify, SeesEveryObstacleAndEveryStep) {
  robot_.radius_m = 0.1;
  for (int i = 0; i < 10; ++i) {
    ASSERT_EQ(world_.reset({{-20, -20}, {20, 20}}), WorldStatus::kOk);
    for (int k = 0; k < 10; ++k) add(Disc{{k + 0.5, k == i ? 0.25 : 2.0}, 0.25});
    const Violation found = violation(trajectory_);
    EXPECT_EQ(found.kind, ViolationKind::kCollision);
    EXPECT_EQ(found.step, i);
    EXPECT_EQ(found.i_obstacle, i);
  }
}

TEST(VerifyResult, IsARejectionByDefault) {
  const VerifyResult<Point2> result;
  EXPECT_FALSE(result.plan.has_value());
  EXPECT_NE(result.violation.kind, ViolationKind::kNone);
}

TEST_F(Verify, UsesNeitherHeapNorLock) {
  if (!RtGuard::available()) GTEST_SKIP() << "the guard cannot count under sanitizers";
  add(Disc{{5.25, 3.0}, 1.0});
  world_.build();
  const VerifyProblem<Point2> problem = {{0.0, 0.0}, {10.0, 0.0}, &world_, 1e-4};
  RtGuard guard;
  const bool accepted = verify(robot_, trajectory_, problem).plan.has_value();
  guard.stop();
  EXPECT_TRUE(accepted);
  EXPECT_EQ(guard.num_allocations(), 0);
  EXPECT_EQ(guard.num_locks(), 0);
}

}  // namespace
}  // namespace sopt
