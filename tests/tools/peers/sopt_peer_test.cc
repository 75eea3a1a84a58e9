#include "tools/peers/sopt_peer.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tools/peers/peers_run.h"

namespace sopt {
namespace {

class SoptPeerTest : public ::testing::Test {
 protected:
  PeerResult run(SoptStage stage, SamplerMode mode, std::uint64_t seed) {
    const auto peer = make_sopt_peer("sopt", stage, mode);
    peer->prepare(problem_);
    return peer->run(seed);
  }

  Scene scene_ =
      load_scene(std::filesystem::path(SOPT_SOURCE_DIR) / "tests/data/three_obstacles.json");
  PeerProblem problem_ = make_peer_problem(scene_);
};

TEST_F(SoptPeerTest, AVerifiedPlanLeadsToTheGoalWithItsMarginAndWithoutTheHeap) {
  const PeerResult result = run(SoptStage::kVerifiedPlan, SamplerMode::kRrtStarConnect, 1);
  ASSERT_TRUE(result.is_solved);
  EXPECT_EQ(result.path.front(), scene_.start);
  EXPECT_EQ(result.path.back(), scene_.goal);
  EXPECT_EQ(check_path(problem_, result.path), PathVerdict::kKeepsMargin);
  EXPECT_GE(result.length_m, 8.0);
  EXPECT_GT(result.time_ns, 0);
  EXPECT_EQ(result.num_allocations, 0);
}

TEST_F(SoptPeerTest, TheFirstPathIsWhatTheSamplerFoundBeforeAnythingShortenedIt) {
  for (const SamplerMode mode : {SamplerMode::kRrtStar, SamplerMode::kRrtStarConnect}) {
    const PeerResult first = run(SoptStage::kFirstPath, mode, 1);
    const PeerResult plan = run(SoptStage::kVerifiedPlan, mode, 1);
    ASSERT_TRUE(first.is_solved);
    EXPECT_TRUE(first.path.empty());
    EXPECT_GT(first.length_m, plan.length_m);
    EXPECT_GT(first.time_ns, 0);
  }
}

TEST_F(SoptPeerTest, WithoutAPlanItSaysWhy) {
  problem_.request.goal = {3, 3};  // inside the disc
  for (const SoptStage stage : {SoptStage::kFirstPath, SoptStage::kVerifiedPlan}) {
    const PeerResult result = run(stage, SamplerMode::kRrtStar, 1);
    EXPECT_FALSE(result.is_solved);
    EXPECT_EQ(result.failure, "goal is closer than min_clearance");
    EXPECT_TRUE(result.path.empty());
  }
}

TEST_F(SoptPeerTest, TheSeedDecides) {
  const auto length_m = [this](std::uint64_t seed) {
    return run(SoptStage::kFirstPath, SamplerMode::kRrtStar, seed).length_m;
  };
  EXPECT_EQ(length_m(1), length_m(1));
  EXPECT_NE(length_m(1), length_m(2));
}

}  // namespace
}  // namespace sopt
