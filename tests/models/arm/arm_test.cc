#include "models/arm/arm.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>
#include <vector>

#include "models/arm/sin_cos.h"
#include "tests/support/arm_oracle.h"
#include "tests/support/rt_guard.h"

namespace sopt {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kPi = std::numbers::pi;
using Vec4 = Arm<4>::Config;

// A yaw joint, then three pitch joints with links of 1 m along x, all capsules along their links.
class ArmTest : public ::testing::Test {
 protected:
  void SetUp() override {
    for (std::size_t j = 0; j < 4; ++j) {
      ArmJoint& joint = description_.joints[j];
      joint.axis = j == 0 ? Vec3::UnitZ() : Vec3::UnitY();
      joint.origin.position = j == 0 ? Vec3(0, 0, 1) : Vec3(j == 1 ? 0.0 : 1.0, 0, 0);
      joint.lower = -2.0;
      joint.upper = 2.0;
      joint.v_max = 1.0;
      joint.a_max = 5.0;
    }
    capsules_ = {{0, {0, 0, 0}, {0, 0, 1}, 0.2},
                 {2, {0, 0, 0}, {1, 0, 0}, 0.1},
                 {3, {0, 0, 0}, {1, 0, 0}, 0.1},
                 {4, {0, 0, 0}, {1, 0, 0}, 0.05}};
    pairs_ = {{0, 3}, {4, 0}};
  }
  [[nodiscard]] ArmStatus reset() {
    description_.capsules = capsules_;
    description_.pairs = pairs_;
    return arm_.reset(description_);
  }

  ArmDescription<4> description_;
  std::vector<LinkCapsule> capsules_;
  std::vector<BodyPair> pairs_;
  Arm<4> arm_;
};

TEST_F(ArmTest, StretchedAtZero) {
  ASSERT_EQ(reset(), ArmStatus::kOk);
  ArmPose<4> pose;
  arm_.forward(Arm<4>::Config::Zero(), pose);
  EXPECT_NEAR((arm_.capsule_W(pose, 3).p1 - Vec3(3, 0, 1)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((arm_.link_pose(pose, 4).rotation - Mat3::Identity()).norm(), 0.0, 1e-15);
}

TEST_F(ArmTest, BentByQuarterTurns) {
  ASSERT_EQ(reset(), ArmStatus::kOk);
  ArmPose<4> pose;
  arm_.forward({kPi / 2, -kPi / 2, kPi / 2, 0.0}, pose);
  EXPECT_NEAR((arm_.capsule_W(pose, 1).p1 - Vec3(0, 0, 2)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((arm_.capsule_W(pose, 3).p1 - Vec3(0, 2, 2)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((arm_.link_pose(pose, 1).rotation.col(0) - Vec3::UnitY()).norm(), 0.0, 1e-15);
}

TEST_F(ArmTest, StandsWhereItsBaseStands) {
  description_.X_WB.position = {10, 20, 30};
  description_.X_WB.rotation = oracle::rotation_about(Vec3::UnitX(), kPi);  // hangs
  ASSERT_EQ(reset(), ArmStatus::kOk);
  ArmPose<4> pose;
  arm_.forward(Arm<4>::Config::Zero(), pose);
  EXPECT_NEAR((arm_.capsule_W(pose, 0).p1 - Vec3(10, 20, 29)).norm(), 0.0, 1e-14);
  EXPECT_NEAR((arm_.capsule_W(pose, 3).p1 - Vec3(13, 20, 29)).norm(), 0.0, 1e-14);
}

TEST_F(ArmTest, PrismaticJointsSlideAlongTheirAxis) {
  description_.joints[1].kind = JointKind::kPrismatic;
  description_.joints[1].axis = Vec3::UnitX();
  ASSERT_EQ(reset(), ArmStatus::kOk);
  ArmPose<4> pose;
  arm_.forward({kPi / 2, 0.5, 0.0, 0.0}, pose);
  EXPECT_NEAR((arm_.capsule_W(pose, 3).p1 - Vec3(0, 3.5, 1)).norm(), 0.0, 1e-15);
  const Arm<4>::Config along =
      arm_.distance_gradient(pose, 4, arm_.capsule_W(pose, 3).p1, Vec3::UnitY());
  EXPECT_NEAR(along[1], 1.0, 1e-15);
  EXPECT_NEAR(along[0], 0.0, 1e-15);
}

TEST_F(ArmTest, GradientOfKnownMotions) {
  ASSERT_EQ(reset(), ArmStatus::kOk);
  ArmPose<4> pose;
  arm_.forward(Arm<4>::Config::Zero(), pose);
  const Vec3 tip(3, 0, 1);
  EXPECT_NEAR((arm_.distance_gradient(pose, 4, tip, Vec3::UnitY()) - Vec4(3, 0, 0, 0)).norm(), 0.0,
              1e-14);
  EXPECT_NEAR((arm_.distance_gradient(pose, 4, tip, Vec3::UnitZ()) - Vec4(0, -3, -2, -1)).norm(),
              0.0, 1e-14);
  EXPECT_NEAR(
      (arm_.distance_gradient(pose, 2, {1, 0, 1}, Vec3::UnitZ()) - Vec4(0, -1, 0, 0)).norm(), 0.0,
      1e-14);
  EXPECT_EQ(arm_.distance_gradient(pose, 0, tip, Vec3::UnitZ()), Vec4(0, 0, 0, 0));
}

TEST_F(ArmTest, ReachOfAStretchedChainIsItsLength) {
  ASSERT_EQ(reset(), ArmStatus::kOk);
  EXPECT_NEAR(arm_.max_reach(3, 4), 1.0, 1e-9);
  EXPECT_NEAR(arm_.max_reach(2, 4), 2.0, 1e-9);
  EXPECT_NEAR(arm_.max_reach(1, 4), 3.0, 1e-9);
  EXPECT_NEAR(arm_.max_reach(1, 2), 1.0, 1e-9);
  EXPECT_EQ(arm_.max_reach(2, 2), 0.0);
  EXPECT_NEAR(arm_.displacement_bound(4, {0.1, 0.2, 0.0, 0.3}), 0.3 + 0.6 + 0.3, 1e-9);
  EXPECT_NEAR(arm_.displacement_bound(4, {0.1, 0.2, 0.0, 0.3}, 2), 0.3, 1e-9);
}

TEST_F(ArmTest, CapsulesNearTheirJointsMoveLessThanTheirLink) {
  capsules_.push_back({4, {0, 0, 0}, {0.1, 0, 0}, 0.2});  // next to the last joint
  ASSERT_EQ(reset(), ArmStatus::kOk);
  const Vec4 turn(0.1, 0.2, 0.0, 0.3);
  EXPECT_NEAR(arm_.capsule_displacement_bound(3, turn), arm_.displacement_bound(4, turn), 1e-12);
  EXPECT_NEAR(arm_.capsule_displacement_bound(4, turn), 0.21 + 0.42 + 0.03, 1e-9);
  EXPECT_NEAR(arm_.capsule_displacement_bound(4, turn, 3), 0.03, 1e-9);
  oracle::Random random(5);
  for (int i = 0; i < 2000; ++i) {
    Vec4 a, b;
    for (int j = 0; j < 4; ++j) {
      a[j] = random.uniform(-2.0, 2.0);
      b[j] = random.uniform(-2.0, 2.0);
    }
    ArmPose<4> from, to;
    arm_.forward(a, from);
    arm_.forward(b, to);
    for (int k = 0; k < 5; ++k) {
      const double bound_m = arm_.capsule_displacement_bound(k, (b - a).cwiseAbs());
      ASSERT_LE((arm_.capsule_W(to, k).p0 - arm_.capsule_W(from, k).p0).norm(), bound_m + 1e-12);
      ASSERT_LE((arm_.capsule_W(to, k).p1 - arm_.capsule_W(from, k).p1).norm(), bound_m + 1e-12);
    }
  }
}

TEST_F(ArmTest, SpheresContainAndAreSmall) {
  capsules_.push_back({4, {1, 0.3, 0}, {1, -0.3, 0}, 0.05});
  ASSERT_EQ(reset(), ArmStatus::kOk);
  const Sphere3& straight = arm_.link_sphere_J(3);
  EXPECT_GE(straight.radius_m, 0.6);
  EXPECT_LE(straight.radius_m, 0.6 * 1.01);
  const Sphere3& tee = arm_.link_sphere_J(4);
  // Through the three ends (0, 0), (1, 0.3), (1, -0.3): radius 0.545, plus 0.05.
  EXPECT_GE(tee.radius_m, 0.595);
  EXPECT_LE(tee.radius_m, 0.595 * 1.01);
}

TEST_F(ArmTest, CapsulesAreGroupedByLinkAndPairsByBody) {
  capsules_ = {{4, {0, 0, 0}, {1, 0, 0}, 0.01, 1},
               {0, {0, 0, 0}, {0, 0, 1}, 0.2},
               {4, {0, 0, 0}, {0, 1, 0}, 0.02, 0},
               {4, {0, 0, 0}, {0, 0, 1}, 0.03, 1}};
  pairs_ = {{4, 0, 1, 0}, {2, 0}};  // link 2 has no capsules
  ASSERT_EQ(reset(), ArmStatus::kOk);
  EXPECT_EQ(arm_.num_bodies(), 3);
  EXPECT_EQ(arm_.first_capsule(0), 0);
  EXPECT_EQ(arm_.first_capsule(1), 1);
  EXPECT_EQ(arm_.first_capsule(4), 1);
  EXPECT_EQ(arm_.first_capsule(5), 4);
  EXPECT_EQ(arm_.capsule_J(1).radius_m, 0.02);
  EXPECT_EQ(arm_.capsule_J(2).radius_m, 0.01);
  EXPECT_EQ(arm_.capsule_J(3).radius_m, 0.03);
  ASSERT_EQ(arm_.self_collision_pairs().size(), 1U);
  const auto pair = arm_.self_collision_pairs()[0];
  EXPECT_EQ(arm_.body(pair.i_body_a).i_link, 0);
  EXPECT_EQ(arm_.body(pair.i_body_b).first, 2);
  EXPECT_EQ(arm_.body(pair.i_body_b).last, 4);
}

TEST_F(ArmTest, AttachedObjectsComeAndGo) {
  ASSERT_EQ(reset(), ArmStatus::kOk);
  const Sphere3 bare = arm_.link_sphere_J(2);
  const LinkCapsule rod{2, {0, 0, 0}, {0, 0, 2}, 0.3};
  ASSERT_EQ(arm_.try_attach({&rod, 1}), ArmStatus::kOk);
  EXPECT_EQ(arm_.num_capsules(), 5);
  EXPECT_EQ(arm_.first_capsule(3) - arm_.first_capsule(2), 2);
  EXPECT_GT(arm_.link_sphere_J(2).radius_m, 1.2);
  EXPECT_NEAR(arm_.max_reach(1, 2), 2.0, 1e-9);
  arm_.detach();
  EXPECT_EQ(arm_.num_capsules(), 4);
  EXPECT_EQ(arm_.link_sphere_J(2).radius_m, bare.radius_m);
  EXPECT_NEAR(arm_.max_reach(1, 2), 1.0, 1e-9);
}

TEST_F(ArmTest, AttachRefusesWhatDoesNotFit) {
  ASSERT_EQ(reset(), ArmStatus::kOk);
  const std::vector<LinkCapsule> many(kMaxLinkCapsules - 3, {4, {0, 0, 0}, {1, 0, 0}, 0.1});
  EXPECT_EQ(arm_.try_attach(many), ArmStatus::kTooManyCapsules);
  const LinkCapsule nowhere{5, {0, 0, 0}, {1, 0, 0}, 0.1};
  EXPECT_EQ(arm_.try_attach({&nowhere, 1}), ArmStatus::kBadLink);
  EXPECT_EQ(arm_.num_capsules(), 4);
}

TEST_F(ArmTest, ContinuousJointsTakeTheShortWay) {
  description_.joints[0].kind = JointKind::kContinuous;
  description_.joints[0].lower = -kInfinity;
  description_.joints[0].upper = kInfinity;
  ASSERT_EQ(reset(), ArmStatus::kOk);
  const Arm<4>::Config a(3.0, 1.0, 0.0, 0.0);
  const Arm<4>::Config b(-3.0, -1.0, 0.0, 0.0);
  EXPECT_NEAR(arm_.difference(a, b)[0], 2.0 * kPi - 6.0, 1e-15);
  EXPECT_EQ(arm_.difference(a, b)[1], -2.0);
  EXPECT_NEAR(arm_.path_distance(a, b), std::hypot(2.0 * kPi - 6.0, 2.0), 1e-15);
  EXPECT_NEAR(arm_.interpolate(a, b, 0.5)[0], kPi, 1e-15);
  EXPECT_EQ(arm_.interpolate(a, b, 0.0), a);
  // Half a turn is +pi, whichever way round; whole turns are nothing.
  const Arm<4>::Config half(kPi, 0.0, 0.0, 0.0);
  const Arm<4>::Config zero = Arm<4>::Config::Zero();
  EXPECT_EQ(arm_.difference(zero, half)[0], kPi);
  EXPECT_EQ(arm_.difference(half, zero)[0], kPi);
  EXPECT_EQ(arm_.difference(zero, 2.0 * half)[0], 0.0);
  EXPECT_TRUE(arm_.within_limits({1e6, 0, 0, 0}));
}

TEST_F(ArmTest, JointsCountByTheirWeightsInThePathMetric) {
  description_.joints[1].kind = JointKind::kContinuous;
  description_.joints[1].lower = -kInfinity;
  description_.joints[1].upper = kInfinity;
  const Arm<4>::Config a(0.0, 3.0, 0.0, 0.5);
  const Arm<4>::Config b(1.0, -3.0, -1.0, 0.5);
  const double turn = 2.0 * kPi - 6.0;
  ASSERT_EQ(reset(), ArmStatus::kOk);
  EXPECT_EQ(arm_.weights(), Arm<4>::Config::Ones());
  EXPECT_NEAR(arm_.path_distance(a, b), std::hypot(1.0, turn, 1.0), 1e-15);
  const double weights[] = {1e-3, 2.0, 3.0, 1e3};
  for (std::size_t j = 0; j < 4; ++j) description_.joints[j].weight = weights[j];
  ASSERT_EQ(reset(), ArmStatus::kOk);
  EXPECT_EQ(arm_.weights(), Arm<4>::Config(1e-3, 2.0, 3.0, 1e3));
  EXPECT_NEAR(arm_.path_distance(a, b), std::hypot(1e-3, 2.0 * turn, 3.0), 1e-15);
  EXPECT_NEAR(arm_.path_distance(b, a), std::hypot(1e-3, 2.0 * turn, 3.0), 1e-15);
  EXPECT_NEAR(arm_.motion_length({0, 0, 0, 0.25}), 250.0, 1e-12);
  // The way itself does not change.
  EXPECT_EQ(arm_.interpolate(a, b, 0.5)[2], -0.5);
}

TEST_F(ArmTest, NamesTheJointOutsideItsLimits) {
  ASSERT_EQ(reset(), ArmStatus::kOk);
  EXPECT_EQ(arm_.joint_outside_limits({-2, 2, 0, 0}), kNoJoint);
  EXPECT_EQ(arm_.joint_outside_limits({0, 0, 2.0 + 1e-12, 0}), 2);
  EXPECT_EQ(arm_.joint_outside_limits({0, 0, 0, -2.1}), 3);
  EXPECT_EQ(arm_.joint_outside_limits({0, kNan, 0, 0}), 1);
  EXPECT_EQ(arm_.joint_outside_limits({kInfinity, 0, 0, 0}), 0);
}

TEST_F(ArmTest, StepsAreExactForConstantAcceleration) {
  Arm<4>::State z;
  z << 1, 2, 3, 4, 0.1, 0.2, 0.3, 0.4;
  const Arm<4>::Input alpha(1, -1, 2, 0);
  const Arm<4>::State once = Arm<4>::step(z, alpha, 0.5);
  EXPECT_NEAR(once[0], 1 + 0.05 + 0.125, 1e-15);
  EXPECT_NEAR(once[4], 0.6, 1e-15);
  const Arm<4>::State twice = Arm<4>::step(Arm<4>::step(z, alpha, 0.25), alpha, 0.25);
  EXPECT_LT((once - twice).norm(), 1e-14);
}

TEST_F(ArmTest, RefusesEachBrokenRule) {
  ASSERT_EQ(reset(), ArmStatus::kOk);
  const auto refuses = [this](ArmStatus expected, auto&& spoil) {
    const auto kept = std::tuple(description_, capsules_, pairs_);
    spoil();
    EXPECT_EQ(reset(), expected);
    std::tie(description_, capsules_, pairs_) = kept;
  };
  ArmJoint& joint = description_.joints[2];
  refuses(ArmStatus::kNotFinite, [&] { joint.origin.position.x() = kNan; });
  refuses(ArmStatus::kNotFinite, [&] { joint.upper = kInfinity; });
  refuses(ArmStatus::kNotFinite, [&] { joint.v_max = kInfinity; });
  refuses(ArmStatus::kNotFinite, [&] { capsules_[1].p1.z() = kNan; });
  refuses(ArmStatus::kNotFinite, [&] { capsules_[1].radius_m = kNan; });
  refuses(ArmStatus::kNotFinite, [&] { description_.X_WB.position.x() = kInfinity; });
  refuses(ArmStatus::kBadRotation, [&] { joint.origin.rotation *= 1.001; });
  refuses(ArmStatus::kBadRotation, [&] { joint.origin.rotation.col(0) *= -1.0; });
  refuses(ArmStatus::kBadRotation, [&] { description_.X_WB.rotation.setZero(); });
  refuses(ArmStatus::kBadAxis, [&] { joint.axis.setZero(); });
  refuses(ArmStatus::kBadAxis, [&] { joint.axis = {1, 1, 0}; });
  refuses(ArmStatus::kBadLimits, [&] { joint.lower = 2.1; });
  refuses(ArmStatus::kBadLimits, [&] { joint.kind = JointKind::kContinuous; });
  refuses(ArmStatus::kBadRate, [&] { joint.v_max = 0.0; });
  refuses(ArmStatus::kBadRate, [&] { joint.a_max = -1.0; });
  for (const double weight : {0.0, -1.0, 0.9e-3, 1.1e3, kInfinity, kNan}) {
    refuses(ArmStatus::kBadWeight, [&] { joint.weight = weight; });
  }
  refuses(ArmStatus::kBadRadius, [&] { capsules_[0].radius_m = -1e-9; });
  refuses(ArmStatus::kBadLink, [&] { capsules_[0].i_link = 5; });
  refuses(ArmStatus::kBadLink, [&] { capsules_[0].i_link = -1; });
  refuses(ArmStatus::kBadLink, [&] { capsules_[0].i_body = kMaxBodies; });
  refuses(ArmStatus::kBadLink, [&] { pairs_[0] = {2, 2}; });
  refuses(ArmStatus::kBadLink, [&] { pairs_[0] = {0, 5}; });
  refuses(ArmStatus::kBadLink, [&] { pairs_[0] = {0, 2, -1, 0}; });
  refuses(ArmStatus::kTooManyCapsules, [&] { capsules_.resize(kMaxLinkCapsules + 1); });
  refuses(ArmStatus::kTooManyPairs, [&] { pairs_.resize(kMaxBodyPairs + 1, {0, 2}); });
  refuses(ArmStatus::kTooManyBodies, [&] {
    for (int i = 0; i < kMaxBodies; ++i) {
      capsules_.push_back({i % 2, {0, 0, 0}, {1, 0, 0}, 0.1, i});
    }
  });
  EXPECT_EQ(arm_.num_capsules(), 4);  // as before
  EXPECT_EQ(reset(), ArmStatus::kOk);
}

TEST_F(ArmTest, TakesAsMuchAsFits) {
  capsules_.resize(kMaxLinkCapsules);
  pairs_.assign(kMaxBodyPairs, {0, 2});
  EXPECT_EQ(reset(), ArmStatus::kOk);
}

TEST_F(ArmTest, KinematicsDoNotTouchTheHeap) {
  ASSERT_EQ(reset(), ArmStatus::kOk);
  ArmPose<4> pose;
  if (!RtGuard::available()) GTEST_SKIP() << "the guard cannot count under sanitizers";
  RtGuard guard;
  arm_.forward({0.1, 0.2, 0.3, 0.4}, pose);
  const Arm<4>::Config slope = arm_.distance_gradient(pose, 4, {1, 2, 3}, Vec3::UnitZ());
  const double sum = slope.sum() + arm_.displacement_bound(3, slope.cwiseAbs()) +
                     arm_.path_distance(slope, 2.0 * slope) + arm_.link_sphere_W(pose, 2).radius_m +
                     arm_.capsule_W(pose, 1).p0.x();
  guard.stop();
  EXPECT_EQ(guard.num_allocations(), 0);
  EXPECT_EQ(guard.num_locks(), 0);
  EXPECT_TRUE(std::isfinite(sum));
}

TEST(SinCosTest, AgreesWithTheStandardLibrary) {
  oracle::Random random(3);
  for (int i = 0; i < 20000; ++i) {
    const double reach = std::pow(10.0, random.uniform(-9.0, 5.0));
    V4d angle;
    for (int k = 0; k < 4; ++k) angle[k] = random.uniform(-reach, reach);
    if (i % 4 == 0) angle = splat4(kPi / 4.0) * static_cast<double>(i);
    V4d sine;
    V4d cosine;
    sin_cos4(angle, sine, cosine);
    for (int k = 0; k < 4; ++k) {
      ASSERT_NEAR(sine[k], std::sin(angle[k]), 3e-16) << angle[k];
      ASSERT_NEAR(cosine[k], std::cos(angle[k]), 3e-16) << angle[k];
    }
  }
}

TEST(SinCosTest, OfEightFloatsIsWithinTwoRoundings) {
  oracle::Random random(4);
  for (int i = 0; i < 20000; ++i) {
    const double reach = std::pow(10.0, random.uniform(-9.0, 5.0));
    V4d low, high;
    for (int k = 0; k < 4; ++k) {
      low[k] = random.uniform(-reach, reach);
      high[k] = i % 4 == 0 ? kPi / 4.0 * (4 * i + k) : random.uniform(-reach, reach);
    }
    V8f sine, cosine;
    sin_cos8(low, high, sine, cosine);
    for (int k = 0; k < 8; ++k) {
      const double angle = k < 4 ? low[k] : high[k - 4];
      ASSERT_NEAR(static_cast<double>(sine[k]), std::sin(angle), 0x1p-23) << angle;
      ASSERT_NEAR(static_cast<double>(cosine[k]), std::cos(angle), 0x1p-23) << angle;
    }
  }
}

TEST(SinCosTest, HasNoAnswerForNumbersThatAreNotFinite) {
  V4d sine;
  V4d cosine;
  sin_cos4(V4d{kNan, kInfinity, -kInfinity, 0.0}, sine, cosine);
  for (int k = 0; k < 3; ++k) {
    EXPECT_TRUE(std::isnan(sine[k]));
    EXPECT_TRUE(std::isnan(cosine[k]));
  }
  EXPECT_EQ(sine[3], 0.0);
  EXPECT_EQ(cosine[3], 1.0);
}

}  // namespace
}  // namespace sopt
