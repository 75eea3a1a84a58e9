#include "tools/peers/sopt_peer.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tools/peers/peers_run.h"

namespace sopt {
namespace {

const std::filesystem::path kFolder(SOPT_SOURCE_DIR);

class SoptPeerTest : public ::testing::Test {
 protected:
  PeerResult run(const SoptVariant& variant, std::uint64_t seed) {
    return make_sopt_peer("sopt", variant)->prepare(scene_)->run(seed);
  }
  [[nodiscard]] Scene& plane() { return std::get<Scene>(scene_); }

  AnyScene scene_ = load_any_scene(kFolder / "tests/data/three_obstacles.json");
};

constexpr SoptVariant kWholePlan{SoptStage::kVerifiedPlan};
constexpr SoptVariant kFirst{SoptStage::kFirstPath};
constexpr SoptVariant kFirstOfOneTree{SoptStage::kFirstPath, SamplerMode::kRrtStar};

TEST_F(SoptPeerTest, AVerifiedPlanLeadsToTheGoalWithItsMarginAndWithoutTheHeap) {
  const PeerResult result = run(kWholePlan, 1);
  ASSERT_TRUE(result.is_solved);
  EXPECT_EQ(result.path.front(), plane().start);
  EXPECT_EQ(result.path.back(), plane().goal);
  EXPECT_EQ(check_path(scene_, result.path), PathVerdict::kKeepsMargin);
  EXPECT_GE(result.length, 8.0);
  EXPECT_GT(result.time_ns, 0);
  EXPECT_EQ(result.num_allocations, 0);
}

TEST_F(SoptPeerTest, TheFirstPathIsWhatTheSamplerFoundBeforeAnythingShortenedIt) {
  for (const SoptVariant& variant : {kFirst, kFirstOfOneTree}) {
    const PeerResult first = run(variant, 1);
    const PeerResult plan = run({SoptStage::kVerifiedPlan, variant.sampler}, 1);
    ASSERT_TRUE(first.is_solved);
    EXPECT_TRUE(first.path.empty());
    EXPECT_GT(first.length, plan.length);
    EXPECT_GT(first.time_ns, 0);
  }
}

TEST_F(SoptPeerTest, WithoutAPlanItSaysWhy) {
  plane().goal = {3, 3};  // inside the disc
  for (const SoptVariant& variant : {kFirstOfOneTree, kWholePlan}) {
    const PeerResult result = run(variant, 1);
    EXPECT_FALSE(result.is_solved);
    EXPECT_EQ(result.failure, "goal is closer than min_clearance");
    EXPECT_TRUE(result.path.empty());
  }
}

TEST_F(SoptPeerTest, TheSeedDecides) {
  const auto length = [this](std::uint64_t seed) { return run(kFirstOfOneTree, seed).length; };
  EXPECT_EQ(length(1), length(1));
  EXPECT_NE(length(1), length(2));
}

// A gap that samples do not find in their first round, a lattice does.
TEST_F(SoptPeerTest, WithoutTheLatticeOnlySamplesLookForAPath) {
  scene_ = load_any_scene(kFolder / "tools/scenes/plane_long.json");
  SoptVariant variant{SoptStage::kFirstPath, SamplerMode::kRrtStar, 1};
  const PeerResult with = run(variant, 1);
  variant.lattice = false;
  const PeerResult without = run(variant, 1);
  ASSERT_TRUE(with.is_solved);
  ASSERT_TRUE(without.is_solved);
  EXPECT_NE(with.length, without.length);
}

TEST_F(SoptPeerTest, PlansArmsFromStartToGoal) {
  scene_ = load_any_scene(kFolder / "tools/scenes/arm/arm_8_01.json");
  const auto& arm = std::get<ArmScene<5>>(scene_);
  const PeerResult plan = run(kWholePlan, 1);
  ASSERT_TRUE(plan.is_solved);
  EXPECT_LT((plan.path.front() - arm.start).norm(), 1e-9);
  EXPECT_LT((plan.path.back() - arm.goal).norm(), 1e-9);
  double length = 0.0;
  for (std::size_t i = 1; i < plan.path.size(); ++i) {
    length += (plan.path[i] - plan.path[i - 1]).norm();
  }
  EXPECT_NEAR(length, plan.length, 0.01 * plan.length);
  EXPECT_EQ(plan.num_allocations, 0);
  EXPECT_GT(run(kFirst, 1).length, plan.length);
}

}  // namespace
}  // namespace sopt
