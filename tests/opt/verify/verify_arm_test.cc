#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "alloc/memory_block.h"
#include "opt/verify/verify.h"
#include "tests/support/arm_motion_oracle.h"
#include "tests/support/rt_guard.h"

namespace sopt {
namespace {

using oracle::ArmTrajectory;
using Config = Arm<4>::Config;

constexpr double kDt_s = 0.1;

// Joint 0 turns about world z at the origin, joint 1 slides along link 1's x, joint 2 turns about z
// at its end, joint 3 about x and moves nothing. Link 2: a capsule from the origin to x = 1, radius
// 0.1; link 3: from x = 1 to 1.5, radius 0.05; link 0: a sphere at (-0.5, 0, 0) of radius 0.1.
class VerifyArm : public testing::Test {
 protected:
  static constexpr World3Capacity kCapacity{8, 8};

  void SetUp() override {
    description_.joints[0] = {{}, Vec3::UnitZ(), JointKind::kContinuous, -kInfinity, kInfinity, 2,
                              9};
    description_.joints[1] = {{}, Vec3::UnitX(), JointKind::kPrismatic, -0.5, 0.5, 2, 9};
    description_.joints[2] = {{}, Vec3::UnitZ(), JointKind::kRevolute, -3.5, 3.5, 2, 9};
    description_.joints[2].origin.position = {1.0, 0.0, 0.0};
    description_.joints[3] = {{}, Vec3::UnitX(), JointKind::kRevolute, -1.0, 1.0, 2, 9};
    description_.capsules = capsules_;
    description_.pairs = pairs_;
    ASSERT_EQ(arm_.reset(description_), ArmStatus::kOk);
    world_.reset();
  }

  // Every joint as far as `travel`: speeds up, then slows down as much.
  ArmTrajectory<4> bang_bang(const Config& start, const Config& travel, int half = 10) const {
    const double duration_s = half * kDt_s;
    std::vector<Config> inputs;
    for (int t = 0; t < 2 * half; ++t) {
      inputs.push_back((t < half ? 1.0 : -1.0) / (duration_s * duration_s) * travel);
    }
    return {start, inputs, kDt_s};
  }
  ArmTrajectory<4> stay(const Config& where = Config::Zero()) const {
    return bang_bang(where, Config::Zero(), 2);
  }

  VerifyResult<Arm<4>> run(const ArmTrajectory<4>& test) {
    world_.build();
    return verify(arm_, test.trajectory, {test.start(), test.goal(), &world_});
  }
  Violation violation(const ArmTrajectory<4>& test) {
    const VerifyResult<Arm<4>> result = run(test);
    EXPECT_EQ(result.plan.has_value(), result.violation.kind == ViolationKind::kNone);
    return result.violation;
  }

  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  LinkCapsule capsules_[3] = {{0, {-0.5, 0, 0}, {-0.5, 0, 0}, 0.1},
                              {2, {0, 0, 0}, {1, 0, 0}, 0.1},
                              {3, {0, 0, 0}, {0.5, 0, 0}, 0.05}};
  BodyPair pairs_[1] = {{0, 3}};
  ArmDescription<4> description_;
  Arm<4> arm_;
  MemoryBlock block_{World3::required_bytes(kCapacity)};
  Arena arena_{block_};
  World3 world_{arena_, kCapacity};
};

// --- accepts

TEST_F(VerifyArm, CertifiesAnArmThatStays) {
  ASSERT_EQ(world_.try_add(Sphere3{{0.5, 0.0, 0.5}, 0.2}), WorldStatus::kOk);
  const ArmTrajectory<4> test = stay();
  const auto result = run(test);
  ASSERT_TRUE(result.plan.has_value());
  const Certificate& certificate = result.plan->certificate();
  EXPECT_NEAR(certificate.min_clearance_m, 0.2, 1e-6);
  EXPECT_EQ(certificate.i_link, 2);
  EXPECT_EQ(certificate.i_obstacle, 0);
  EXPECT_NEAR(certificate.min_self_clearance_m, 1.35, 1e-6);
  EXPECT_EQ(certificate.i_self_link, 3);
  EXPECT_EQ(certificate.i_other_link, 0);
  EXPECT_EQ(certificate.goal_error, 0.0);
}

// The tip passes (0, 1.5, 0) half-way.
TEST_F(VerifyArm, CertifiesTheClearanceOnTheWay) {
  ASSERT_EQ(world_.try_add(Sphere3{{0.0, 2.0, 0.0}, 0.1}), WorldStatus::kOk);
  ASSERT_EQ(world_.try_add(Sphere3{{0.0, 5.0, 0.0}, 0.1}), WorldStatus::kOk);
  const auto test = bang_bang({0.3, 0, 0, 0}, {std::numbers::pi - 0.6, 0, 0, 0}, 20);
  const auto result = run(test);
  ASSERT_TRUE(result.plan.has_value()) << static_cast<int>(result.violation.kind);
  const Certificate& certificate = result.plan->certificate();
  EXPECT_LE(certificate.min_clearance_m, 0.35 + 1e-9);
  EXPECT_GE(certificate.min_clearance_m, 0.35 - 3.5e-3);
  EXPECT_NEAR(certificate.where_t_s, 2.0, 0.1);
  EXPECT_EQ(certificate.i_link, 3);
  EXPECT_EQ(certificate.i_obstacle, 0);
}

TEST_F(VerifyArm, TakesWholeTurnsOfAContinuousJointForTheGoal) {
  const auto test = bang_bang(Config::Zero(), {2.0 * std::numbers::pi, 0, 0, 0}, 40);
  world_.build();
  VerifyProblem<Arm<4>> problem{test.start(), Config::Zero(), &world_};
  EXPECT_EQ(verify(arm_, test.trajectory, problem).violation.kind, ViolationKind::kNone);
  problem.goal[0] = 1e-9;
  EXPECT_EQ(verify(arm_, test.trajectory, problem).violation.kind, ViolationKind::kGoal);
}

// --- collisions

// The straight link sweeps over a ball between two waypoints that are both clear of it.
TEST_F(VerifyArm, FindsACollisionBetweenWaypoints) {
  ASSERT_EQ(world_.try_add(Sphere3{{0.0, 1.4, 0.0}, 0.05}), WorldStatus::kOk);
  const double quarter = std::numbers::pi / 2.0;
  const ArmTrajectory<4> test = [&] {
    std::vector<Config> inputs = {{8, 0, 0, 0}, {8, 0, 0, 0}, {-8, 0, 0, 0}, {-8, 0, 0, 0}};
    return ArmTrajectory<4>({quarter - 0.16, 0, 0, 0}, inputs, kDt_s);
  }();
  const Violation found = violation(test);
  EXPECT_EQ(found.kind, ViolationKind::kCollision);
  EXPECT_EQ(found.i_link, 3);
  EXPECT_EQ(found.i_obstacle, 0);
  EXPECT_EQ(found.step, 1);
  EXPECT_LT(found.amount, 1e-4);
  EXPECT_LE(found.t_s, 0.2 + 1e-12);
}

TEST_F(VerifyArm, SaysHowDeepAnArmIsThatStays) {
  ASSERT_EQ(world_.try_add(Box3{{Mat3::Identity(), {0.5, 0.0, 0.18}}, {0.2, 0.2, 0.2}}),
            WorldStatus::kOk);
  const Violation found = violation(stay());
  EXPECT_EQ(found.kind, ViolationKind::kCollision);
  EXPECT_EQ(found.i_link, 2);
  EXPECT_EQ(found.t_s, 0.0);
  EXPECT_NEAR(found.amount, -0.02, 1e-6);
}

TEST_F(VerifyArm, NamesTheFirstOfTwoCollisions) {
  ASSERT_EQ(world_.try_add(Sphere3{{-1.0, 1.0, 0.0}, 0.1}), WorldStatus::kOk);
  ASSERT_EQ(world_.try_add(Sphere3{{1.0, 1.0, 0.0}, 0.1}), WorldStatus::kOk);
  const auto test = bang_bang(Config::Zero(), {std::numbers::pi - 0.3, 0, 0, 0}, 20);
  const Violation found = violation(test);
  EXPECT_EQ(found.kind, ViolationKind::kCollision);
  EXPECT_EQ(found.i_obstacle, 1);
  EXPECT_LT(found.t_s, 2.0);
}

TEST_F(VerifyArm, FindsTwoLinksThatCollide) {
  capsules_[0].p0 = capsules_[0].p1 = {0.1, 0.0, 0.0};
  ASSERT_EQ(arm_.reset(description_), ArmStatus::kOk);
  const Violation found = violation(bang_bang({0, -0.5, 0, 0}, {0, 0, 3.1, 0}, 20));
  EXPECT_EQ(found.kind, ViolationKind::kSelfCollision);
  EXPECT_EQ(found.i_link, 3);
  EXPECT_EQ(found.i_other_link, 0);
  EXPECT_EQ(found.i_obstacle, kSelfObstacle);
  EXPECT_LT(found.amount, 0.0);
}

TEST_F(VerifyArm, KeepsTheHardMinimum) {
  ASSERT_EQ(world_.try_add(Sphere3{{0.5, 0.0, 0.5}, 0.2}), WorldStatus::kOk);
  const ArmTrajectory<4> test = stay();
  world_.build();
  VerifyProblem<Arm<4>> problem{test.start(), test.goal(), &world_, 0.199};
  EXPECT_EQ(verify(arm_, test.trajectory, problem).violation.kind, ViolationKind::kNone);
  problem.min_clearance_m = 0.201;
  EXPECT_EQ(verify(arm_, test.trajectory, problem).violation.kind, ViolationKind::kCollision);
  problem.min_clearance_m = 1e-4;
  problem.min_self_clearance_m = 1.36;
  EXPECT_EQ(verify(arm_, test.trajectory, problem).violation.kind, ViolationKind::kSelfCollision);
}

// Closer to the hard minimum than libccd can tell.
TEST_F(VerifyArm, AsksForASecondOpinion) {
  ASSERT_EQ(world_.try_add(Sphere3{{0.5, 0.0, 0.5}, 0.4 - 1e-4 - 5e-7}), WorldStatus::kOk);
  const Violation found = violation(stay());
  EXPECT_EQ(found.kind, ViolationKind::kSecondOpinion);
  EXPECT_EQ(found.i_link, 2);
  EXPECT_EQ(found.i_obstacle, 0);
  EXPECT_NEAR(found.amount, 1e-4, 1e-6);
}

// The tip stops there; nowhere else is it as near.
TEST_F(VerifyArm, AsksForASecondOpinionAtTheLastWaypoint) {
  ASSERT_EQ(world_.try_add(Sphere3{{2.05 + 1e-4 + 5e-7, 0.0, 0.0}, 0.2}), WorldStatus::kOk);
  const Violation found = violation(bang_bang(Config::Zero(), {0, 0.3, 0, 0}));
  EXPECT_EQ(found.kind, ViolationKind::kSecondOpinion);
  EXPECT_EQ(found.i_link, 3);
  EXPECT_EQ(found.i_obstacle, 0);
  EXPECT_EQ(found.step, 19);
  EXPECT_NEAR(found.t_s, 2.0, 1e-12);
  EXPECT_NEAR(found.amount, 1e-4, 1e-6);
}

TEST_F(VerifyArm, AsksForASecondOpinionAboutTwoLinks) {
  const ArmTrajectory<4> test = stay();
  world_.build();
  const VerifyProblem<Arm<4>> problem{test.start(), test.goal(), &world_, 1e-4, 1.35 - 5e-7};
  const Violation found = verify(arm_, test.trajectory, problem).violation;
  EXPECT_EQ(found.kind, ViolationKind::kSecondOpinion);
  EXPECT_EQ(found.i_link, 3);
  EXPECT_EQ(found.i_other_link, 0);
  EXPECT_EQ(found.i_obstacle, kSelfObstacle);
  EXPECT_NEAR(found.amount, 1.35, 1e-6);
}

// --- everything else

TEST_F(VerifyArm, RejectsAnotherStartAndAnotherGoal) {
  const auto test = bang_bang(Config::Zero(), {0, 0.3, 0, 0});
  world_.build();
  VerifyProblem<Arm<4>> problem{test.start(), test.goal(), &world_};
  problem.start[1] = 1e-7;
  EXPECT_EQ(verify(arm_, test.trajectory, problem).violation.kind, ViolationKind::kStart);
  problem.start = test.start();
  problem.goal[1] += 1e-7;
  const Violation found = verify(arm_, test.trajectory, problem).violation;
  EXPECT_EQ(found.kind, ViolationKind::kGoal);
  EXPECT_NEAR(found.amount, 1e-7, 1e-12);
}

TEST_F(VerifyArm, RejectsMotionAtTheEnds) {
  auto test = bang_bang(Config::Zero(), {0, 0.3, 0, 0});
  test.trajectory.states.back()[4 + 2] = 1e-10;
  const Violation found = violation(test);
  EXPECT_EQ(found.kind, ViolationKind::kNotAtRest);
  EXPECT_EQ(found.i_joint, 2);
  EXPECT_EQ(found.amount, 1e-10);
}

TEST_F(VerifyArm, RejectsInputsThatDoNotLeadToTheStates) {
  auto test = bang_bang(Config::Zero(), {0, 0.3, 0, 0});
  test.trajectory.inputs[3][1] += 1e-6;
  const Violation found = violation(test);
  EXPECT_EQ(found.kind, ViolationKind::kDynamics);
  EXPECT_EQ(found.step, 4);  // at the end of step 3
  EXPECT_NEAR(found.amount, 1e-7, 1e-8);
}

// Turns back between waypoints, beyond a limit that no waypoint passes.
TEST_F(VerifyArm, FindsThePositionLimitPassedWithinAStep) {
  std::vector<Config> inputs = {{0, 0, 0, 5}, {0, 0, 0, -8}, {0, 0, 0, 1}, {0, 0, 0, 2}};
  const ArmTrajectory<4> test({0, 0, 0, 0.9655}, inputs, kDt_s);
  for (const auto& state : test.trajectory.states) EXPECT_LT(state[3], 1.0 + 0.006);
  const Violation found = violation(test);
  EXPECT_EQ(found.kind, ViolationKind::kPosition);
  EXPECT_EQ(found.i_joint, 3);
  EXPECT_NEAR(found.t_s, 0.1 + 0.5 / 8.0, 1e-9);
  EXPECT_NEAR(found.amount, 0.9655 + 0.025 + 0.25 / 16.0 - 1.0, 1e-9);
}

TEST_F(VerifyArm, FindsLimitsOfVelocityAndAcceleration) {
  const Violation fast = violation(bang_bang(Config::Zero(), {2.1, 0, 0, 0}));
  EXPECT_EQ(fast.kind, ViolationKind::kVelocity);
  EXPECT_EQ(fast.i_joint, 0);
  EXPECT_NEAR(fast.amount, 0.1, 1e-9);
  EXPECT_NEAR(fast.t_s, 1.0, 1e-9);
  const Violation sharp = violation(bang_bang(Config::Zero(), {0, 0.1, 0, 0}, 1));
  EXPECT_EQ(sharp.kind, ViolationKind::kAcceleration);
  EXPECT_EQ(sharp.i_joint, 1);
  EXPECT_NEAR(sharp.amount, 1.0, 1e-9);
}

TEST_F(VerifyArm, SaysWhichLimitIsNearest) {
  const auto test = bang_bang(Config::Zero(), {1.8, 0, 0, 0});
  const auto result = run(test);
  ASSERT_TRUE(result.plan.has_value());
  EXPECT_NEAR(result.plan->certificate().worst_limit_margin, 0.1, 1e-9);
  EXPECT_EQ(result.plan->certificate().i_joint, 0);
}

TEST_F(VerifyArm, RejectsWhatIsNoTrajectory) {
  auto test = stay();
  (void)test.trajectory.inputs.try_resize(2);
  EXPECT_EQ(violation(test).kind, ViolationKind::kShape);
  auto other = stay();
  other.trajectory.inputs[1][0] = std::numeric_limits<double>::quiet_NaN();
  const Violation found = violation(other);
  EXPECT_EQ(found.kind, ViolationKind::kNotFinite);
  EXPECT_EQ(found.step, 1);
}

TEST_F(VerifyArm, UsesNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "nothing is counted in this build";
  ASSERT_EQ(world_.try_add(Sphere3{{0.0, 1.7, 0.0}, 0.1}), WorldStatus::kOk);
  const auto test = bang_bang(Config::Zero(), {1.6, 0, 0, 0});
  (void)run(test);
  RtGuard guard;
  const auto result = run(test);
  guard.stop();
  EXPECT_TRUE(result.plan.has_value());
  EXPECT_EQ(guard.num_allocations(), 0);
}

}  // namespace
}  // namespace sopt
