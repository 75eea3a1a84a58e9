// Every status of Planner<Arm<N>> other than a plan, with its evidence, and the leases of its
// slots.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "opt/request_rules.h"
#include "tests/support/arm_planner_fixture.h"

namespace sopt::oracle {
namespace {

using Robot = Arm<5>;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <int N>
void expect_failed(const PlanResult<Arm<N>>& result, PlanStatus status, PlanStage stage) {
  EXPECT_EQ(result.status, status) << static_cast<int>(result.status) << result.failure.reason;
  EXPECT_EQ(result.failure.stage, stage);
  EXPECT_FALSE(static_cast<bool>(result.plan));
  EXPECT_FALSE(std::string(result.failure.reason).empty());
}

class ArmPlannerRefuses : public ArmPlannerTest {
 protected:
  PlanResult<Robot> plan() { return test_planner_.planner.plan(request_); }
  // With `bad` for start and for goal; the evidence is the same.
  template <class Check>
  void expect_bad_ends(const Robot::Config& bad, Check&& check) {
    for (const bool is_start : {true, false}) {
      SCOPED_TRACE(is_start ? "start" : "goal");
      PlanRequest<Robot> request = request_;
      (is_start ? request.start : request.goal) = bad;
      const PlanResult<Robot> result = test_planner_.planner.plan(request);
      expect_failed(result, is_start ? PlanStatus::kBadStart : PlanStatus::kBadGoal,
                    PlanStage::kRequest);
      const std::string reason = result.failure.reason;
      EXPECT_NE(reason.find(is_start ? "start" : "goal"), std::string::npos) << reason;
      check(result.failure);
    }
  }

  TestArmPlanner<5> test_planner_{robot_};
};

TEST_F(ArmPlannerRefuses, EndsOutsideTheLimitsWithJointValueAndLimits) {
  for (int j = 0; j < 5; ++j) {
    for (const double value : {robot_.lower()[j] - 1e-9, robot_.upper()[j] + 0.5}) {
      Robot::Config bad = request_.start;
      bad[j] = value;
      expect_bad_ends(bad, [&](const PlanFailure& failure) {
        EXPECT_EQ(failure.i_joint, j);
        EXPECT_EQ(failure.amount, value);
        EXPECT_EQ(failure.lower, robot_.lower()[j]);
        EXPECT_EQ(failure.upper, robot_.upper()[j]);
        EXPECT_EQ(failure.i_obstacle, kNoObstacle);
      });
    }
  }
}

TEST_F(ArmPlannerRefuses, EndsInAnObstacleWithLinkObstacleAndDepth) {
  add(Sphere3{{0.05, 0.0, 0.3}, 0.05});  // on the axis of link 2, whose radius is 68 mm
  expect_bad_ends(Robot::Config::Zero(), [](const PlanFailure& failure) {
    EXPECT_EQ(failure.i_link, 2);
    EXPECT_EQ(failure.i_obstacle, 2);
    EXPECT_NEAR(failure.amount, -0.118, 1e-12);
    EXPECT_EQ(failure.i_other_link, kNoLink);
    EXPECT_EQ(failure.i_joint, kNoJoint);
  });
}

TEST_F(ArmPlannerRefuses, EndsCloserThanMinClearance) {
  const double gap_m = 0.5e-4;
  const Robot::Config upright = {-1.2, 0.0, -0.2, 0.0, 0.0};
  const Vec3 ahead(std::cos(upright[0]), std::sin(upright[0]), 0.0);
  add(Sphere3{(0.05 - 0.068 - 0.05 - gap_m) * ahead + 0.3 * Vec3::UnitZ(), 0.05});
  expect_bad_ends(upright, [&](const PlanFailure& failure) {
    EXPECT_EQ(failure.i_link, 2);
    EXPECT_EQ(failure.i_obstacle, 2);
    EXPECT_NEAR(failure.amount, gap_m, 1e-9);
  });
  request_.options.min_clearance_m = 0.4 * gap_m;
  request_.start = upright;
  expect_valid(robot_, request_, plan());
}

// A ball next to link 2 of the upright arm.
TEST_F(ArmPlannerRefuses, EndsTooNearMinClearanceForAnyMotionAtOnce) {
  const Robot::Config upright = {-1.2, 0.0, -0.2, 0.0, 0.0};
  const Vec3 ahead(std::cos(upright[0]), std::sin(upright[0]), 0.0);
  const double needed_m = request_.options.min_clearance_m + kEndRoom_m;
  const auto add_ball = [&](double gap_m) {
    test_.world.reset();
    add(Sphere3{(0.05 - 0.068 - 0.05 - gap_m) * ahead + 0.3 * Vec3::UnitZ(), 0.05});
  };
  for (const double gap_m : {1.001e-4, 1.05e-4, 1.1e-4, 1.2e-4, needed_m - 1e-9}) {
    SCOPED_TRACE(gap_m);
    add_ball(gap_m);
    expect_bad_ends(upright, [&](const PlanFailure& failure) {
      EXPECT_EQ(failure.i_link, 2);
      EXPECT_EQ(failure.i_obstacle, 0);
      EXPECT_NEAR(failure.amount, gap_m, 1e-9);
      EXPECT_EQ(failure.lower, needed_m);
      EXPECT_NE(std::string(failure.reason).find("too near min_clearance"), std::string::npos);
    });
  }
  for (const double gap_m : {needed_m + 1e-9, 1.3e-4}) {
    SCOPED_TRACE(gap_m);
    add_ball(gap_m);
    for (const bool is_start : {true, false}) {
      PlanRequest<Robot> request = request_;
      (is_start ? request.start : request.goal) = upright;
      expect_valid(robot_, request, test_planner_.planner.plan(request));
    }
  }
}

TEST_F(ArmPlannerRefuses, ContinuousJointsWoundUpBeyondAThousandTurns) {
  RandomArm<4> chain;
  for (ArmJoint& joint : chain.description.joints) {
    constexpr double kEndless = std::numeric_limits<double>::infinity();
    joint = {{Mat3::Identity(), {0.0, 0.0, 0.3}},
             Vec3::UnitY(),
             JointKind::kContinuous,
             -kEndless,
             kEndless,
             2.0,
             9.0};
  }
  chain.description.joints[0].axis = Vec3::UnitZ();
  const LinkCapsule tool = {4, Vec3::Zero(), {0.0, 0.0, 0.2}, 0.03};
  chain.description.capsules = {&tool, 1};
  ASSERT_EQ(chain.arm.reset(chain.description), ArmStatus::kOk);
  PlanRequest<Arm<4>> request;
  request.world = &test_.world;
  request.options = PlanOptions::arm();
  request.start = {-1.2, 0.3, 0.3, 0.4};
  request.goal = {1.1, 0.4, 0.4, 0.6};
  TestArmPlanner<4> test_planner(chain.arm);
  for (const bool is_start : {true, false}) {
    for (const double bound : {-kMaxWound_rad, kMaxWound_rad}) {
      SCOPED_TRACE((is_start ? "start " : "goal ") + std::to_string(bound));
      PlanRequest<Arm<4>> wound = request;
      Arm<4>::Config& end = is_start ? wound.start : wound.goal;
      end = Arm<4>::Config::Constant(bound);
      expect_valid(chain.arm, wound, test_planner.planner.plan(wound));
      for (const double value : {1.0001 * bound, std::copysign(1e9, bound)}) {
        end[2] = value;
        const PlanResult<Arm<4>> result = test_planner.planner.plan(wound);
        expect_failed(result, is_start ? PlanStatus::kBadStart : PlanStatus::kBadGoal,
                      PlanStage::kRequest);
        EXPECT_EQ(result.failure.i_joint, 2);
        EXPECT_EQ(result.failure.amount, value);
        EXPECT_EQ(result.failure.lower, -kMaxWound_rad);
        EXPECT_EQ(result.failure.upper, kMaxWound_rad);
      }
    }
  }
}

TEST_F(ArmPlannerRefuses, EndsInSelfCollisionWithBothLinksAndTheDepth) {
  const Robot::Config folded = {0.0, 2.5, -1.2, 0.0, 0.0};
  const double depth_m = PlainArm<5>(robot_).self_clearance_m(folded);
  ASSERT_LT(depth_m, -0.01);
  expect_bad_ends(folded, [&](const PlanFailure& failure) {
    EXPECT_EQ(failure.i_link, 4);
    EXPECT_EQ(failure.i_other_link, 1);
    EXPECT_EQ(failure.i_obstacle, kSelfObstacle);
    EXPECT_NEAR(failure.amount, depth_m, 1e-9);
  });
}

// A stick that can only turn about z, not all the way round, behind a post.
TEST_F(ArmPlannerRefuses, AGoalBehindAPostThatNothingPasses) {
  ArmDescription<4> description;
  for (ArmJoint& joint : description.joints) {
    joint = {{}, Vec3::UnitZ(), JointKind::kRevolute, -0.01, 0.01, 2.0, 9.0};
  }
  description.joints[0].lower = 0.0;
  description.joints[0].upper = 3.0;
  const LinkCapsule stick = {4, {0.1, 0.0, 0.0}, {1.0, 0.0, 0.0}, 0.03};
  description.capsules = {&stick, 1};
  Arm<4> arm;
  ASSERT_EQ(arm.reset(description), ArmStatus::kOk);
  test_.world.reset();
  add(Capsule3{{0.0, 0.5, -1.0}, {0.0, 0.5, 1.0}, 0.05});
  PlanRequest<Arm<4>> request;
  request.world = &test_.world;
  request.options = PlanOptions::arm();
  request.options.num_samples = 500;
  request.options.num_batches = 2;
  request.start = {0.5, 0.0, 0.0, 0.0};
  request.goal = {2.5, 0.0, 0.0, 0.0};
  TestArmPlanner<4> test_planner(arm);
  for (const SamplerMode mode : {SamplerMode::kRrtStarConnect, SamplerMode::kRrtStar}) {
    request.options.sampler = mode;
    expect_failed(test_planner.planner.plan(request), PlanStatus::kNoPath, PlanStage::kSample);
  }
  test_.world.reset();
  test_.world.build();
  expect_valid(arm, request, test_planner.planner.plan(request));
}

TEST_F(ArmPlannerRefuses, APathBeyondTheSmallestBudget) {
  request_.options.num_samples = 1;
  request_.options.num_batches = 1;
  expect_failed(plan(), PlanStatus::kNoPath, PlanStage::kSample);
}

TEST_F(ArmPlannerRefuses, APathThatNeedsMoreStepsThanThereAre) {
  PlannerSettings settings = small_arm_settings();
  settings.max_horizon = 20;
  TestArmPlanner<5> little(robot_, settings);
  const PlanResult<Robot> result = little.planner.plan(request_);
  expect_failed(result, PlanStatus::kCapacity, PlanStage::kReference);
  EXPECT_GT(result.failure.amount, 20.0);
}

TEST_F(ArmPlannerRefuses, APathThatNeedsMoreVerticesThanThereAre) {
  PlannerSettings settings = small_arm_settings();
  settings.max_path_vertices = 4;
  TestArmPlanner<5> little(robot_, settings);
  Random random(5);
  int num_refused = 0;
  for (int i = 0; i < 20; ++i) {
    scatter_obstacles(random, robot_, 9, test_.world);
    const ClearanceRule rule{request_.options.margin_m, 1.0, 1e-4};
    if (!draw_request(random, robot_, test_.world, rule, request_.start, request_.goal)) continue;
    if (plan().status != PlanStatus::kOk) continue;
    const PlanResult<Robot> result = little.planner.plan(request_);
    if (result.status == PlanStatus::kOk) continue;
    expect_failed(result, PlanStatus::kCapacity, PlanStage::kSample);
    EXPECT_EQ(result.failure.amount, 4.0);
    ++num_refused;
  }
  EXPECT_GT(num_refused, 0);
}

// --- slots

TEST_F(ArmPlannerRefuses, AFourthPlanUntilOneIsReleased) {
  PlanResult<Robot> first = plan();
  PlanResult<Robot> second = plan();
  const PlanResult<Robot> third = plan();
  ASSERT_TRUE(first.plan && second.plan && third.plan);
  const std::vector<double> before = numbers_of(third);
  expect_failed(plan(), PlanStatus::kNoSlot, PlanStage::kRequest);
  second.plan.reset();
  EXPECT_FALSE(static_cast<bool>(second.plan));
  { EXPECT_EQ(plan().status, PlanStatus::kOk); }
  PlanLease<Robot> moved = std::move(first.plan);
  const PlanResult<Robot> fourth = plan();
  EXPECT_EQ(fourth.status, PlanStatus::kOk);
  EXPECT_EQ(plan().status, PlanStatus::kNoSlot);
  moved.reset();
  std::swap(request_.start, request_.goal);
  EXPECT_EQ(plan().status, PlanStatus::kOk);
  EXPECT_EQ(numbers_of(third), before);
}

TEST_F(ArmPlannerRefuses, WithoutUsingUpASlot) {
  const Robot::Config good = request_.start;
  for (int i = 0; i < 5; ++i) {
    request_.start[0] = 7.0;
    EXPECT_EQ(plan().status, PlanStatus::kBadStart);
    request_.start[0] = kNan;
    EXPECT_EQ(plan().status, PlanStatus::kBadInput);
  }
  request_.start = good;
  EXPECT_EQ(plan().status, PlanStatus::kOk);
}

// --- bad input

TEST_F(ArmPlannerRefuses, EveryMalformedRequest) {
  const PlanRequest<Robot> good = request_;
  using Request = PlanRequest<Robot>;
  const auto expect_bad = [&](const char* name, auto&& spoil) {
    SCOPED_TRACE(name);
    request_ = good;
    spoil(request_);
    expect_failed(plan(), PlanStatus::kBadInput, PlanStage::kRequest);
  };
  expect_bad("no world", [](Request& r) { r.world = nullptr; });
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    for (int j = 0; j < 5; ++j) {
      expect_bad("start", [&](Request& r) { r.start[j] = bad; });
      expect_bad("goal", [&](Request& r) { r.goal[j] = bad; });
    }
    expect_bad("speed", [&](Request& r) { r.options.speed_mps = bad; });
    expect_bad("dt", [&](Request& r) { r.options.dt_s = bad; });
    expect_bad("margin", [&](Request& r) { r.options.margin_m = bad; });
    expect_bad("min_clearance", [&](Request& r) { r.options.min_clearance_m = bad; });
    expect_bad("improve", [&](Request& r) { r.options.improve_s = bad; });
  }
  for (const double bad : {0.0, -1.0, kNan}) {
    expect_bad("deadline", [&](Request& r) { r.deadline_s = bad; });
  }
  expect_bad("margin", [](Request& r) { r.options.margin_m = 0.5 * r.options.min_clearance_m; });
  expect_bad("dense", [](Request& r) { r.options.solver = WindowSolver::kDense; });
  expect_bad("streams", [](Request& r) { r.options.num_streams = 3; });
  expect_bad("window", [](Request& r) { r.options.max_window = 161; });
  request_ = good;
  EXPECT_EQ(plan().status, PlanStatus::kOk);
}

TEST_F(ArmPlannerRefuses, EverythingWhenItGotTooLittleMemory) {
  SerialExecutor executor;
  const MemoryBlock block(4096);
  Arena arena(block);
  Planner<Robot> planner(arena, robot_, small_arm_settings(), executor);
  EXPECT_FALSE(planner.is_ready());
  expect_failed(planner.plan(request_), PlanStatus::kBadInput, PlanStage::kRequest);
}

}  // namespace
}  // namespace sopt::oracle
