// The sampler in joint space under its options: one tree or two, joints that turn without end,
// goals that cannot be reached, deadlines, and ever shorter paths.
#include <gtest/gtest.h>

#include <numbers>

#include "sampler/sampler.h"
#include "tests/support/test_arm.h"
#include "tests/support/test_problem.h"

namespace sopt {
namespace {

using oracle::InArena;
using oracle::TestWorld3;

constexpr double kPi = std::numbers::pi;

// A stick of 1 m that turns without end about z; three more joints tilt and lengthen it a little.
class StickSampling : public testing::Test {
 protected:
  using Robot = Arm<4>;

  void SetUp() override {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    ArmDescription<4> description;
    description.joints[0] = {{}, Vec3::UnitZ(), JointKind::kContinuous, -kInfinity, kInfinity, 2,
                             9};
    description.joints[1] = {{}, Vec3::UnitY(), JointKind::kRevolute, -0.7, 0.7, 2, 9};
    description.joints[2] = {{}, Vec3::UnitX(), JointKind::kPrismatic, 0.0, 0.1, 2, 9};
    description.joints[3] = {{}, Vec3::UnitX(), JointKind::kRevolute, -1.0, 1.0, 2, 9};
    const LinkCapsule stick = {3, {0.1, 0.0, 0.0}, {1.0, 0.0, 0.0}, 0.03};
    description.capsules = {&stick, 1};
    ASSERT_EQ(arm_.reset(description), ArmStatus::kOk);
    for (std::size_t i = 0; i < ladder_.size(); ++i) {
      ladder_[i].rule = {0.02, kMarginRungs[i], 1e-4};
    }
    options_.num_samples = 3000;
    options_.num_batches = 1;
    problem_.robot = &arm_;
    problem_.world = &test_.world;
    problem_.ladder = &ladder_;
    problem_.options = &options_;
    test_.world.build();
  }
  // A post of `height_m` either way, at the stick's middle.
  void put_post(double angle, double height_m) {
    const Vec3 foot(0.5 * std::cos(angle), 0.5 * std::sin(angle), 0.0);
    const Vec3 up = height_m * Vec3::UnitZ();
    ASSERT_EQ(test_.world.try_add(Capsule3{foot - up, foot + up, 0.05}), WorldStatus::kOk);
    test_.world.build();
  }
  SamplerResult<Robot> find(const Deadline& deadline = Deadline()) {
    return sampler_->find_path(problem_, deadline);
  }
  void expect_clear(const Path<Robot>& path) const {
    for (int i = 0; i + 1 < path.vertices.size(); ++i) {
      for (int k = 0; k <= 200; ++k) {
        const auto q = arm_.interpolate(path.vertices[i], path.vertices[i + 1], k / 200.0);
        ASSERT_GE(oracle::least_excess(arm_, test_.world, q, {0.0, 0.0, 1e-4}), 0.0);
        ASSERT_TRUE(arm_.within_limits(q));
      }
    }
  }
  static PlannerSettings settings() {
    PlannerSettings settings;
    settings.nodes_per_stream = 4000;
    settings.max_lattice_points = 0;
    return settings;
  }

  Robot arm_;
  TestWorld3 test_;
  PlanOptions options_;
  MarginLadder ladder_;
  SamplerProblem<Robot> problem_;
  SerialExecutor serial_;
  ManualClock clock_{1000};
  InArena<Sampler<Robot>> sampler_{settings(), serial_, clock_.clock()};
};

TEST_F(StickSampling, GoesTheShortWayRoundAcrossHalfATurn) {
  problem_.start = {3.0, 0.0, 0.0, 0.0};
  problem_.goal = {-3.0, 0.0, 0.0, 0.0};
  put_post(0.0, 2.0);
  for (const SamplerMode mode : {SamplerMode::kRrtStarConnect, SamplerMode::kRrtStar}) {
    options_.sampler = mode;
    const auto result = find();
    ASSERT_EQ(result.status, SamplerStatus::kOk);
    EXPECT_NEAR(result.path->length(arm_), 2.0 * kPi - 6.0, 1e-12);
    EXPECT_NEAR(result.path->vertices.back()[0], 2.0 * kPi - 3.0, 1e-12);
  }
}

TEST_F(StickSampling, GoesTheLongWayRoundWhenTheShortOneIsShut) {
  problem_.start = {2.6, 0.0, 0.0, 0.0};
  problem_.goal = {-2.6, 0.0, 0.0, 0.0};
  put_post(kPi, 2.0);
  for (const SamplerMode mode : {SamplerMode::kRrtStarConnect, SamplerMode::kRrtStar}) {
    options_.sampler = mode;
    for (problem_.seed = 1; problem_.seed <= 5; ++problem_.seed) {
      const auto result = find();
      ASSERT_EQ(result.status, SamplerStatus::kOk);
      expect_clear(*result.path);
      EXPECT_LT(result.path->vertices.back()[0], 0.0);
      EXPECT_GE(result.path->length(arm_), 5.2 - 1e-12);
    }
  }
}

TEST_F(StickSampling, FindsNoWayBetweenTwoPosts) {
  problem_.start = {0.0, 0.0, 0.0, 0.0};
  problem_.goal = {kPi, 0.0, 0.0, 0.0};
  put_post(0.5 * kPi, 2.0);
  put_post(-0.5 * kPi, 2.0);
  for (const SamplerMode mode : {SamplerMode::kRrtStarConnect, SamplerMode::kRrtStar}) {
    options_.sampler = mode;
    EXPECT_EQ(find().status, SamplerStatus::kNoPath);
  }
}

TEST_F(StickSampling, StopsAtItsDeadline) {
  problem_.start = {0.0, 0.0, 0.0, 0.0};
  problem_.goal = {kPi, 0.0, 0.0, 0.0};
  put_post(0.5 * kPi, 2.0);
  put_post(-0.5 * kPi, 2.0);
  const std::int64_t before = clock_.num_reads();
  const Clock clock = clock_.clock();
  EXPECT_EQ(find(Deadline(clock, clock.now_ns(), 20e-6)).status, SamplerStatus::kDeadline);
  EXPECT_LE(clock_.num_reads() - before, 20 + 2 + 4 * settings().num_streams);
}

// Over a low post or round the other side of it: every round may only shorten what is known.
TEST_F(StickSampling, ImprovesAPathWithoutEverLengtheningIt) {
  problem_.start = {-0.6, 0.0, 0.0, 0.3};
  problem_.goal = {0.7, 0.0, 0.1, -0.3};
  put_post(0.0, 0.2);
  options_.shortcut = false;
  const auto first = find();
  ASSERT_EQ(first.status, SamplerStatus::kOk);
  InArena<Path<Robot>> known(256);
  ASSERT_TRUE((*known).vertices.try_assign(first.path->vertices.span()));
  const double first_length = (*known).length(arm_);
  options_.shortcut = true;
  for (int round = 0; round < 20; ++round) {
    const auto better = sampler_->improve_path(problem_, first.i_rung, round, *known, Deadline());
    if (better.path == nullptr) continue;
    EXPECT_LE(better.path->length(arm_), (*known).length(arm_) * (1.0 + 1e-12));
    expect_clear(*better.path);
    ASSERT_TRUE((*known).vertices.try_assign(better.path->vertices.span()));
  }
  EXPECT_LT((*known).length(arm_), first_length);
  EXPECT_GE((*known).length(arm_), arm_.path_distance(problem_.start, problem_.goal));
}

}  // namespace
}  // namespace sopt
