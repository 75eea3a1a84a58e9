#include "opt/verify/verify_arm_ccd.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "models/space/ccd_check.h"
#include "tests/support/arm_motion_oracle.h"
#include "tests/support/arm_oracle.h"
#include "tests/support/oracle3.h"
#include "tests/support/rt_guard.h"

namespace sopt {
namespace {

constexpr double kDt_s = 0.15;
constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr int kNone = -1;

// Random arms and worlds, with every capsule asked about at every waypoint to compare with.
class VerifyArmCcd : public testing::Test {
 protected:
  static constexpr int kDof = 5;
  static constexpr int kHorizon = 24;
  static constexpr World3Capacity kCapacity{300, 300};

  void draw_arm() {
    oracle::draw_arm(random_, drawn_);
    drawn_.capsules.resize(kDof + 2);
    for (LinkCapsule& capsule : drawn_.capsules) capsule.radius_m *= 0.3;
    pairs_.clear();
    for (int i = random_.index(8); i > 0; --i) {
      const int a = random_.index(kDof - 1);
      pairs_.push_back({a, a + 2 + random_.index(kDof - a - 1)});
    }
    drawn_.description.capsules = drawn_.capsules;
    drawn_.description.pairs = pairs_;
    ASSERT_EQ(arm().reset(drawn_.description), ArmStatus::kOk);
  }
  void draw_world(int num) {
    world_.reset();
    for (int i = 0; i < num; ++i) {
      const auto kind = static_cast<oracle::SolidKind>(random_.index(oracle::kNumSolidKinds));
      (void)oracle::add_to(world_, oracle::random_solid(random_, kind, 3.0, random_.chance(0.3)));
    }
    world_.build();
  }
  // The first waypoint where contact cannot be ruled out, or kNone.
  int first_contact(const Trajectory<Arm<kDof>>& motion) {
    for (int t = 0; t <= motion.horizon(); ++t) {
      arm().forward(motion.states[t].head<kDof>(), pose_);
      if (has_contact()) return t;
    }
    return kNone;
  }
  bool has_contact() {
    for (int l = 0; l <= kDof; ++l) {
      for (int i = arm().first_capsule(l); i < arm().first_capsule(l + 1); ++i) {
        for (int k = 0; k < world_.num_obstacles(); ++k) {
          const Capsule3 capsule = arm().capsule_W(pose_, i);
          if (may_overlap(world_.obstacle(k), capsule, min_clearance_m_)) return true;
        }
      }
    }
    for (const auto& bodies : arm().self_collision_pairs()) {
      const ArmBody& a = arm().body(bodies.i_body_a);
      const ArmBody& b = arm().body(bodies.i_body_b);
      for (int i = a.first; i < a.last; ++i) {
        const Convex3 one = to_convex(arm().capsule_W(pose_, i));
        for (int k = b.first; k < b.last; ++k) {
          if (may_overlap(one, arm().capsule_W(pose_, k), min_self_clearance_m_)) return true;
        }
      }
    }
    return false;
  }

  Violation run(const oracle::ArmTrajectory<kDof>& test, double x_stop = kNever) {
    const VerifyProblem<Arm<kDof>> problem{test.start(), test.goal(), &world_, min_clearance_m_,
                                           min_self_clearance_m_};
    const ArmMotion<kDof> motion(arm(), test.trajectory, 0.0);
    ArmCcd<kDof> ccd(arm(), problem, motion);
    return ccd.run(kDt_s, x_stop);
  }

  Arm<kDof>& arm() { return drawn_.arm; }

  oracle::Random random_{7};
  oracle::RandomArm<kDof> drawn_;
  std::vector<BodyPair> pairs_;
  Arm<kDof>::Pose pose_;
  double min_clearance_m_ = 0.01;
  double min_self_clearance_m_ = 0.005;
  MemoryBlock block_{World3::required_bytes(kCapacity)};
  Arena arena_{block_};
  World3 world_{arena_, kCapacity};
};

TEST_F(VerifyArmCcd, FindsTheFirstContactOfAllCapsulesAtAllWaypoints) {
  int num_free = 0;
  int num_on_the_way = 0;
  int num_self = 0;
  for (int i = 0; i < 2000; ++i) {
    draw_arm();
    draw_world(random_.index(4));
    const auto test = oracle::random_motion(random_, arm(), kHorizon, kDt_s);
    const int expected = first_contact(test.trajectory);
    const Violation found = run(test);
    num_free += expected == kNone ? 1 : 0;
    num_on_the_way += expected > 0 ? 1 : 0;
    num_self += found.i_obstacle == kSelfObstacle ? 1 : 0;
    if (expected == kNone) {
      EXPECT_EQ(found.kind, ViolationKind::kNone) << "case " << i;
      continue;
    }
    EXPECT_EQ(found.kind, ViolationKind::kSecondOpinion) << "case " << i;
    EXPECT_NEAR(found.t_s, expected * kDt_s, 1e-12) << "case " << i;
    EXPECT_EQ(found.step, std::min(expected, kHorizon - 1)) << "case " << i;
  }
  EXPECT_GE(num_free, 200);
  EXPECT_GE(num_on_the_way, 40);
  EXPECT_GE(num_self, 40);
}

// More than are looked at together.
TEST_F(VerifyArmCcd, LooksAtAllOfManyObstacles) {
  int num_late = 0;
  for (int i = 0; i < 60; ++i) {
    draw_arm();
    world_.reset();
    for (int k = 0; k < 300; ++k) {
      const Vec3 center = oracle::random_vector(random_, 3.0);
      ASSERT_EQ(world_.try_add(Sphere3{center, 0.03}), WorldStatus::kOk);
    }
    world_.build();
    const auto test = oracle::random_motion(random_, arm(), kHorizon, kDt_s);
    const int expected = first_contact(test.trajectory);
    const Violation found = run(test);
    ASSERT_EQ(found.kind, expected == kNone ? ViolationKind::kNone : ViolationKind::kSecondOpinion);
    EXPECT_NEAR(found.t_s, std::max(expected, 0) * kDt_s, 1e-12) << "case " << i;
    num_late += found.i_obstacle >= 128 ? 1 : 0;
  }
  EXPECT_GE(num_late, 3);
}

TEST_F(VerifyArmCcd, LooksNoFurtherThanItIsAskedTo) {
  int num_looked_at = 0;
  for (int i = 0; i < 200 && num_looked_at < 10; ++i) {
    draw_arm();
    draw_world(4);
    const auto test = oracle::random_motion(random_, arm(), kHorizon, kDt_s);
    const int expected = first_contact(test.trajectory);
    if (expected <= 0) continue;
    ++num_looked_at;
    EXPECT_EQ(run(test, expected).kind, ViolationKind::kNone);
    EXPECT_EQ(run(test, expected + 0.5).kind, ViolationKind::kSecondOpinion);
  }
  EXPECT_EQ(num_looked_at, 10);
}

TEST_F(VerifyArmCcd, UsesNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "nothing is counted in this build";
  draw_arm();
  draw_world(8);
  const auto test = oracle::random_motion(random_, arm(), kHorizon, kDt_s);
  (void)run(test);
  RtGuard guard;
  (void)run(test);
  guard.stop();
  EXPECT_EQ(guard.num_allocations(), 0);
}

}  // namespace
}  // namespace sopt
