#include <gtest/gtest.h>

#include <cmath>

#include "opt/reference.h"
#include "opt/step_measure.h"
#include "opt/time_scaling.h"
#include "tests/support/arm_segment.h"
#include "tests/support/rt_guard.h"

namespace sopt {
namespace {

using oracle::Configs;
using oracle::EmptyArmTrajectory;
using oracle::make_arm_reference;
using oracle::Random;
using oracle::States;

constexpr double kDt_s = 0.05;
constexpr double kStep = 0.05;  // 1 rad/s

template <int N>
States<N> states_of(const Trajectory<Arm<N>>& trajectory) {
  return {trajectory.states.begin(), trajectory.states.end()};
}

template <class Dof>
class ArmReferenceTest : public ::testing::Test {
 protected:
  static constexpr int kNumJoints = Dof::value;

  void SetUp() override { draw(1); }
  void draw(std::uint64_t seed) {
    Random random(seed);
    oracle::draw_arm(random, drawn_);
    ASSERT_EQ(drawn_.arm.reset(drawn_.description), ArmStatus::kOk);
    way_.clear();
    const int num_vertices = 2 + random.index(4);
    for (int i = 0; i < num_vertices; ++i) {
      way_.push_back(oracle::random_configuration(random, drawn_.arm));
    }
    if (random.chance(0.2)) way_.push_back(way_.back());  // a motion of no length
  }

  oracle::RandomArm<kNumJoints> drawn_;
  Configs<kNumJoints> way_;
  EmptyArmTrajectory<kNumJoints> out_{4096};
};

template <int N>
using Int = std::integral_constant<int, N>;
using Dofs = ::testing::Types<Int<4>, Int<5>, Int<6>, Int<7>, Int<8>>;
TYPED_TEST_SUITE(ArmReferenceTest, Dofs);

TYPED_TEST(ArmReferenceTest, IsExactAndWithinAllLimits) {
  constexpr int kDof = TypeParam::value;
  const oracle::ArmTestWorld empty;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    this->draw(seed);
    const auto& arm = this->drawn_.arm;
    make_arm_reference(arm, this->way_, kStep, kDt_s, this->out_.trajectory);
    const States<kDof> z = states_of(this->out_.trajectory);
    ASSERT_GE(z.size(), 3u) << seed;
    EXPECT_EQ(this->out_.trajectory.dt_s, kDt_s);
    const auto facts = oracle::examine(arm, empty.world, z, kDt_s, 4);
    EXPECT_LE(facts.defect, 1e-12) << seed;
    // Continuous joints may wind up; their limits are infinite.
    EXPECT_LE(facts.limit_excess, 0.0) << seed;
    for (const auto& state : z) {
      EXPECT_LE(oracle::weighted_length<kDof>(arm, state.template tail<kDof>()),
                kStep / kDt_s * (1.0 + 1e-12))
          << seed;
    }
    EXPECT_TRUE((z.front().template head<kDof>() == this->way_.front()));
    EXPECT_TRUE(z.front().template tail<kDof>().isZero(0.0));
    EXPECT_TRUE(z.back().template tail<kDof>().isZero(0.0));
    EXPECT_LE(arm.difference(z.back().template head<kDof>(), this->way_.back()).norm(), 1e-13);
    for (int j = 0; j < kDof; ++j) {
      if (arm.is_continuous(j)) continue;
      EXPECT_EQ(z.back()[j], this->way_.back()[j]) << seed;
    }
  }
}

// Every waypoint lies on its motion, farther along than the one before.
TYPED_TEST(ArmReferenceTest, FollowsThePathFromVertexToVertexAndRestsThere) {
  constexpr int kDof = TypeParam::value;
  using Config = typename Arm<kDof>::Config;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    this->draw(seed);
    const auto& arm = this->drawn_.arm;
    make_arm_reference(arm, this->way_, kStep, kDt_s, this->out_.trajectory);
    const States<kDof> z = states_of(this->out_.trajectory);
    std::size_t t = 0;
    for (std::size_t i = 1; i < this->way_.size(); ++i) {
      const Config from = z[t].template head<kDof>();
      const Config way = arm.difference(this->way_[i - 1], this->way_[i]);
      if (way.norm() == 0.0) continue;
      double share = 0.0;
      while (share < 1.0 - 1e-9) {
        ASSERT_LT(++t, z.size()) << "vertex " << i << " is not reached";
        const Config offset = z[t].template head<kDof>() - from;
        const double next = offset.dot(way) / way.squaredNorm();
        EXPECT_GT(next, share);
        EXPECT_LE((offset - next * way).norm(), 1e-12);
        share = next;
      }
      EXPECT_NEAR(share, 1.0, 1e-12);
      EXPECT_TRUE(z[t].template tail<kDof>().isZero(1e-12)) << "at rest at vertex " << i;
    }
    EXPECT_EQ(t + 1, z.size());
  }
}

// One step less cannot be enough: the largest rates from rest to rest on n - 1 steps sum to less
// than the motion.
TYPED_TEST(ArmReferenceTest, TakesNoMoreStepsThanItNeeds) {
  constexpr int kDof = TypeParam::value;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    this->draw(seed);
    const auto& arm = this->drawn_.arm;
    const Configs<kDof> motion = {this->way_[0], this->way_[1]};
    make_arm_reference(arm, motion, kStep, kDt_s, this->out_.trajectory);
    const int n = this->out_.trajectory.horizon();
    if (n <= 2) continue;
    const auto way = arm.difference(motion[0], motion[1]);
    double reach = 0.0;
    for (int k = 1; k < n - 1; ++k) {
      double rate = kStep / oracle::weighted_length<kDof>(arm, way);
      for (int j = 0; j < kDof; ++j) {
        const double d = std::abs(way[j]);
        rate = std::min({rate, arm.v_max()[j] * kDt_s / d,
                         arm.a_max()[j] * kDt_s * kDt_s / d * std::min(k, n - 1 - k)});
      }
      reach += rate;
    }
    EXPECT_LT(reach, 1.0 + 1e-6) << seed;
  }
}

TYPED_TEST(ArmReferenceTest, StaysWhenThereIsNowhereToGo) {
  constexpr int kDof = TypeParam::value;
  const Configs<kDof> way = {this->way_[0], this->way_[0]};
  make_arm_reference(this->drawn_.arm, way, kStep, kDt_s, this->out_.trajectory);
  ASSERT_EQ(this->out_.trajectory.horizon(), 2);
  for (const auto& z : this->out_.trajectory.states) {
    EXPECT_TRUE((z.template head<kDof>() == way[0]));
    EXPECT_TRUE(z.template tail<kDof>().isZero(0.0));
  }
}

TYPED_TEST(ArmReferenceTest, TakesMotionsOfAnyLength) {
  constexpr int kDof = TypeParam::value;
  for (const double length : {1e-300, 1e-12, 1e-3}) {
    Configs<kDof> way = {this->way_[0], this->way_[0]};
    way[0][0] = 0.0;
    way[1][0] = way[0][0] + length;
    make_arm_reference(this->drawn_.arm, way, kStep, kDt_s, this->out_.trajectory);
    ASSERT_GE(this->out_.trajectory.horizon(), 2) << length;
    EXPECT_EQ(this->out_.trajectory.states.back()[0], way[1][0]);
    for (const auto& z : this->out_.trajectory.states) EXPECT_TRUE(z.allFinite());
  }
}

TYPED_TEST(ArmReferenceTest, RefusesAHorizonBeyondTheCapacity) {
  make_arm_reference(this->drawn_.arm, this->way_, kStep, kDt_s, this->out_.trajectory);
  const int horizon = this->out_.trajectory.horizon();
  EmptyArmTrajectory<TypeParam::value> fits(horizon);
  make_arm_reference(this->drawn_.arm, this->way_, kStep, kDt_s, fits.trajectory);
  EXPECT_EQ(fits.trajectory.horizon(), horizon);
  EmptyArmTrajectory<TypeParam::value> too_small(horizon - 1);
  make_arm_reference(this->drawn_.arm, this->way_, kStep, kDt_s, too_small.trajectory);
  EXPECT_TRUE(too_small.trajectory.states.empty());
}

// --- time scaling

TYPED_TEST(ArmReferenceTest, ScaledTimeKeepsWaypointsDynamicsAndLimits) {
  constexpr int kDof = TypeParam::value;
  const oracle::ArmTestWorld empty;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    this->draw(seed);
    const auto& arm = this->drawn_.arm;
    auto& trajectory = this->out_.trajectory;
    make_arm_reference(arm, this->way_, kStep, kDt_s, trajectory);
    const States<kDof> before = states_of(trajectory);
    const double length = path_length(arm, trajectory);
    if (length == 0.0) continue;
    // Shorter by half: asked to go at twice the speed.
    scale_time(arm, 2.0 * length, trajectory);
    const States<kDof> after = states_of(trajectory);
    EXPECT_LT(trajectory.dt_s, kDt_s * (1.0 + 1e-6)) << seed;
    EXPECT_GE(trajectory.dt_s, 0.5 * kDt_s) << seed;
    const auto facts = oracle::examine(arm, empty.world, after, trajectory.dt_s, 1);
    EXPECT_LE(facts.defect, 1e-12) << seed;
    EXPECT_LE(facts.limit_excess, 0.0) << seed;
    for (std::size_t t = 0; t < before.size(); ++t) {
      EXPECT_TRUE((before[t].template head<kDof>() == after[t].template head<kDof>()));
    }
    ASSERT_TRUE(fill_inputs(trajectory));
    for (int t = 0; t < trajectory.horizon(); ++t) {
      const auto next =
          Arm<kDof>::step(trajectory.states[t], trajectory.inputs[t], trajectory.dt_s);
      EXPECT_LE((next - trajectory.states[t + 1]).cwiseAbs().maxCoeff(), 1e-12);
    }
  }
}

TYPED_TEST(ArmReferenceTest, ScaledTimeIsTheLengthsRatioWhereLimitsAllowIt) {
  constexpr int kDof = TypeParam::value;
  auto& trajectory = this->out_.trajectory;
  make_arm_reference(this->drawn_.arm, this->way_, kStep, kDt_s, trajectory);
  trajectory.dt_s *= 2.0;  // the same at half the speed
  for (auto& z : trajectory.states) z.template tail<kDof>() *= 0.5;
  const States<kDof> before = states_of(trajectory);
  scale_time(this->drawn_.arm, 1.25 * path_length(this->drawn_.arm, trajectory), trajectory);
  EXPECT_NEAR(trajectory.dt_s, 0.8 * 2.0 * kDt_s, 1e-12);
  for (std::size_t t = 0; t < before.size(); ++t) {
    const auto& z = trajectory.states[static_cast<int>(t)];
    EXPECT_LE((0.8 * z.template tail<kDof>() - before[t].template tail<kDof>()).norm(), 1e-12);
  }
}

TYPED_TEST(ArmReferenceTest, TouchesNoHeap) {
  constexpr int kDof = TypeParam::value;
  MemoryBlock block(4096);
  Arena arena(block);
  Path<Arm<kDof>> path(arena, 8);
  for (const auto& q : this->way_) (void)path.vertices.try_push_back(q);
  auto& trajectory = this->out_.trajectory;
  const auto run = [&] {
    bool fits = make_reference(this->drawn_.arm, path, kStep, kDt_s, trajectory);
    scale_time(this->drawn_.arm, path_length(this->drawn_.arm, trajectory), trajectory);
    return fits && fill_inputs(trajectory);
  };
  if (!RtGuard::available()) GTEST_SKIP() << "this build cannot count allocations";
  ASSERT_TRUE(run());
  RtGuard guard;
  const bool fits = run();
  guard.stop();
  EXPECT_EQ(guard.num_allocations() + guard.num_releases() + guard.num_locks(), 0);
  EXPECT_TRUE(fits);
}

}  // namespace
}  // namespace sopt
