#include "models/arm/arm_motion.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "models/arm/arm_clearance.h"
#include "models/arm/arm_lanes.h"
#include "sampler/motion_checker.h"
#include "tests/support/rt_guard.h"
#include "tests/support/test_arm.h"

namespace sopt {
namespace {

using oracle::Random;
using oracle::RandomArm;
using oracle::TestWorld3;
using Config5 = Arm<5>::Config;

const ClearanceRule kRule{0.02, 1.0, 1e-4};

// Five joints about z, 0.2 m apart along x; the last link ends in a ball of 5 cm.
struct FlatArm {
  explicit FlatArm(JointKind kind = JointKind::kRevolute) {
    for (ArmJoint& joint : description.joints) {
      joint.origin.position = {0.2, 0.0, 0.0};
      joint.kind = kind;
      const bool is_free = kind == JointKind::kContinuous;
      joint.upper = is_free ? std::numeric_limits<double>::infinity() : 3.0;
      joint.lower = -joint.upper;
      joint.v_max = joint.a_max = 1.0;
    }
    capsules[0] = {5, {0.2, 0.0, 0.0}, {0.2, 0.0, 0.0}, 0.05};
    capsules[1] = {1, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 0.05};
    description.capsules = capsules;
    description.pairs = pairs;
    EXPECT_EQ(arm.reset(description), ArmStatus::kOk);
  }
  LinkCapsule capsules[2];
  BodyPair pairs[1] = {{1, 5}};
  ArmDescription<5> description;
  Arm<5> arm;
};

TEST(ArmLanes, AgreeWithForwardKinematicsWithinTheirPad) {
  Random random(1);
  double worst = 0.0;
  for (int i = 0; i < 300; ++i) {
    RandomArm<8> drawn;
    oracle::draw_arm(random, drawn);
    ASSERT_EQ(drawn.arm.reset(drawn.description), ArmStatus::kOk);
    LaneConfig<8> q;
    Arm<8>::Config lane[kLanesFloat];
    double slides_m = 0.0;
    for (int k = 0; k < kLanesFloat; ++k) {
      lane[k] = oracle::random_configuration(random, drawn.arm);
      slides_m =
          std::max(slides_m, lane[k].cwiseProduct(drawn.arm.kinematics().slides).lpNorm<1>());
      for (int j = 0; j < 8; ++j) {
        LaneJoint& joint = q.joint[static_cast<std::size_t>(j)];
        (k < 4 ? joint.low[k] : joint.high[k - 4]) = lane[k][j];
      }
    }
    LanePose<8> lanes;
    forward_lanes(drawn.arm, q, lanes);
    const Vec3 point = oracle::random_vector(random, 0.5);
    const double pad_m = lane_pad_m(drawn.arm, point.lpNorm<1>(), slides_m);
    for (int k = 0; k < kLanesFloat; ++k) {
      ArmPose<8> pose;
      drawn.arm.forward(lane[k], pose);
      for (std::size_t l = 0; l <= 8; ++l) {
        const LaneFrame& X = lanes.X_WJ[l];
        const LaneVec3 at =
            X.position + turn(X, static_cast<float>(point.x()), static_cast<float>(point.y()),
                              static_cast<float>(point.z()));
        const Vec3 exact = pose.X_WJ[l].rotation * point + pose.X_WJ[l].position;
        const Vec3 found = Eigen::Vector3f(at.x[k], at.y[k], at.z[k]).cast<double>();
        worst = std::max(worst, (found - exact).norm() / pad_m);
      }
    }
  }
  EXPECT_LT(worst, 0.5);
  EXPECT_GT(worst, 0.001) << "the pad is far too wide";
}

TEST(ArmMotion, IsClearInAnEmptyWorld) {
  const FlatArm flat;
  TestWorld3 test;
  test.world.build();
  EXPECT_TRUE(flat.arm.motion_is_clear(test.world, kRule, Config5::Zero(), Config5::Ones()));
}

// The tool passes a ball of 1 cm at 1 m from the first axis while it sweeps 2 rad.
TEST(ArmMotion, SeesASmallObstacleAnywhereOnALongMotion) {
  const FlatArm flat;
  const Config5 a = -1.0 * Config5::Unit(0);
  const Config5 b = Config5::Unit(0);
  for (int i = 0; i <= 200; ++i) {
    const double angle = -1.0 + 0.01 * i;
    TestWorld3 test;
    // 1 m from the axis of the first joint, which is at x = 0.2.
    const Vec3 center(0.2 + std::cos(angle), std::sin(angle), 0.0);
    ASSERT_EQ(test.world.try_add(Sphere3{center, 0.01}), WorldStatus::kOk);
    test.world.build();
    EXPECT_FALSE(flat.arm.motion_is_clear(test.world, {}, a, b)) << angle;
    EXPECT_TRUE(flat.arm.motion_is_clear(test.world, kRule, a, a) || i <= 10) << angle;
  }
}

TEST(ArmMotion, GoesTheShortWayRound) {
  const FlatArm flat(JointKind::kContinuous);
  constexpr double kPi = std::numbers::pi;
  TestWorld3 test;
  ASSERT_EQ(test.world.try_add(Sphere3{{-0.8, 0.0, 0.0}, 0.05}), WorldStatus::kOk);
  test.world.build();
  const auto turned = [](double angle) { return Config5(angle * Config5::Unit(0)); };
  EXPECT_FALSE(flat.arm.motion_is_clear(test.world, kRule, turned(3.0), turned(-3.0)));
  EXPECT_FALSE(flat.arm.motion_is_clear(test.world, kRule, turned(2.5), turned(-2.5 + 4.0 * kPi)));
  EXPECT_TRUE(flat.arm.motion_is_clear(test.world, kRule, turned(1.0), turned(-1.0)));
  EXPECT_TRUE(flat.arm.motion_is_clear(test.world, kRule, turned(1.0), turned(-1.0 + 2.0 * kPi)));
}

TEST(ArmMotion, IsBlockedByLinksThatWouldMeet) {
  const FlatArm flat;
  TestWorld3 test;
  test.world.build();
  // The five links close a regular pentagon at 72 degrees each.
  const Config5 closed = Config5(0.0, 1.0, 1.0, 1.0, 1.0) * (2.0 * std::numbers::pi / 5.0);
  const Config5 open = Config5::Zero();
  const Config5 beyond = 1.4 * closed;
  EXPECT_LT(oracle::least_self_distance(flat.arm, closed), 0.0);
  EXPECT_GT(oracle::least_self_distance(flat.arm, beyond), 0.02);
  EXPECT_FALSE(flat.arm.motion_is_clear(test.world, kRule, open, closed));
  EXPECT_FALSE(flat.arm.motion_is_clear(test.world, kRule, open, beyond)) << "passes in between";
  EXPECT_TRUE(flat.arm.motion_is_clear(test.world, kRule, open, 0.5 * closed));
}

TEST(ArmMotion, IsBlockedWithAConfigurationThatIsNotFinite) {
  const FlatArm flat;
  TestWorld3 test;
  test.world.build();
  Config5 bad = Config5::Zero();
  bad[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(flat.arm.motion_is_clear(test.world, kRule, Config5::Zero(), bad));
  bad[3] = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(flat.arm.motion_is_clear(test.world, kRule, bad, Config5::Zero()));
}

// As many links and obstacles as presets and scenes have; the same motion either way.
TEST(ArmMotion, AgreesWithTenTimesFinerChecks) {
  constexpr double kPad_m = 2e-3;  // of the finer checks, which are no more than samples either
  Random random(2);
  int num_clear = 0;
  int num_all = 0;
  for (const Arm<5>& arm : {lr_mate_200id_7l(), so_101(), widowx_250(), xarm5()}) {
    for (int i_scene = 0; i_scene < 5; ++i_scene) {
      TestWorld3 test;
      oracle::scatter_obstacles(random, arm, i_scene == 4 ? 24 : 7 + i_scene, test.world);
      for (int i = 0; i < 20; ++i) {
        const Config5 a = oracle::random_configuration(random, arm);
        if (oracle::least_excess(arm, test.world, a, kRule) < 0.0) continue;
        const Config5 d = arm.difference(a, oracle::random_configuration(random, arm));
        const Config5 b = a + d * std::min(1.0, random.uniform(0.1, 2.0) / d.norm());
        double excess_m = 1e300;  // beyond what the rule asks for
        double floor_m = 1e300;   // beyond the floor
        double self_m = 1e300;
        for (int k = 0; k <= 1000; ++k) {
          const Config5 q = arm.interpolate(a, b, 1e-3 * k);
          excess_m = std::min(excess_m, oracle::least_excess(arm, test.world, q, kRule));
          floor_m = std::min(floor_m, oracle::least_excess(arm, test.world, q, {0, 1, 1e-4}));
          self_m = std::min(self_m, oracle::least_self_distance(arm, q));
          if (floor_m < 0.0 || self_m < 0.0) break;
        }
        const bool is_clear = arm.motion_is_clear(test.world, kRule, a, b);
        EXPECT_FALSE(is_clear && (floor_m < 0.0 || self_m < 0.0));
        EXPECT_FALSE(!is_clear && excess_m > kPad_m && self_m > kPad_m);
        EXPECT_EQ(is_clear, arm.motion_is_clear(test.world, kRule, b, a)) << "the other way";
        num_clear += is_clear ? 1 : 0;
        ++num_all;
      }
    }
  }
  EXPECT_GT(num_clear, num_all / 10);
  EXPECT_GT(num_all - num_clear, num_all / 10);
}

// Where the rule asks for the floor alone, motions along an obstacle still end in a verdict.
TEST(ArmMotion, KeepsAFloorWithoutAMargin) {
  const FlatArm flat;
  const Config5 a = -0.5 * Config5::Unit(0);
  const Config5 b = 0.5 * Config5::Unit(0);
  for (const double gap_m : {-1e-3, 1.5e-4, 1e-3}) {
    TestWorld3 test;  // the tool's ball passes at gap_m
    ASSERT_EQ(test.world.try_add(Sphere3{{1.2 + 0.15 + gap_m, 0.0, 0.0}, 0.1}), WorldStatus::kOk);
    test.world.build();
    EXPECT_EQ(flat.arm.motion_is_clear(test.world, {0.0, 1.0, 1e-4}, a, b), gap_m > 0.0) << gap_m;
  }
}

TEST(ArmMotion, LeavesAnEndUnderItsRelaxedRuleAndNothingElse) {
  const FlatArm flat;
  TestWorld3 test;  // 5 mm from the tool at zero, less than the margin
  ASSERT_EQ(test.world.try_add(Box3{{Mat3::Identity(), {1.355, 0.0, 0.0}}, {0.2, 0.2, 0.2}}),
            WorldStatus::kOk);
  test.world.build();
  MarginProfile profile;
  profile.rule = kRule;
  profile.step_length = 0.8;
  profile.num_start_steps = 1;
  profile.start_cap_m = 0.004;
  MotionChecker<Arm<5>> checker(flat.arm, test.world, profile);
  const Config5 start = Config5::Zero();
  const Config5 goal = Config5(1.0, 0.5, 0.0, 0.0, 0.0);
  EXPECT_FALSE(checker.is_clear(start, RequestEnd::kNone, goal, RequestEnd::kNone));
  EXPECT_TRUE(checker.is_clear(start, RequestEnd::kStart, goal, RequestEnd::kNone));
  EXPECT_FALSE(checker.is_clear(goal, RequestEnd::kNone, start, RequestEnd::kGoal));
  EXPECT_EQ(checker.num_checks(), 3);
}

TEST(ArmMotion, GivesThePlannerItsLimits) {
  const FlatArm flat;
  const FlatArm free(JointKind::kContinuous);
  TestWorld3 test;
  EXPECT_EQ(flat.arm.default_step_length(test.world),
            PlanOptions::arm().speed_mps * PlanOptions::arm().dt_s);
  EXPECT_EQ(flat.arm.sampling_box(test.world, kRule).upper, Config5(Config5::Constant(3.0)));
  EXPECT_EQ(free.arm.sampling_box(test.world, kRule).lower,
            Config5(Config5::Constant(-std::numbers::pi)));
  const Config5 a = Config5::Constant(3.0);
  const Config5 b = Config5::Constant(-3.0);
  EXPECT_EQ(flat.arm.unwrapped(a, b), b);
  EXPECT_LT((free.arm.unwrapped(a, b) - a - free.arm.difference(a, b)).norm(), 1e-14);
  EXPECT_EQ(free.arm.unwrapped(a, Config5(Config5::Constant(2.5))),
            Config5(Config5::Constant(2.5)));
}

TEST(ArmMotion, TouchesNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "this build cannot count allocations";
  const Arm<5> arm = widowx_250();
  Random random(3);
  TestWorld3 test;
  oracle::scatter_obstacles(random, arm, 24, test.world);
  const Config5 a = oracle::random_configuration(random, arm);
  const Config5 b = oracle::random_configuration(random, arm);
  RtGuard guard;
  (void)arm.motion_is_clear(test.world, kRule, a, b);
  guard.stop();
  EXPECT_EQ(guard.num_allocations() + guard.num_releases() + guard.num_locks(), 0);
}

}  // namespace
}  // namespace sopt
