#include "tools/peers/peers_run.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tests/tools/temporary_folder.h"
#include "tools/peers/sopt_peer.h"

namespace sopt {
namespace {

// A wall 2 cm thick across the middle, open below y = 5 m; the radius is 0.1 m, the margin 0.05 m.
constexpr const char* kWall = R"({
  "robot": "point2d", "radius": 0.1, "bounds": [0, 0, 10, 10], "start": [1, 7], "goal": [9, 7],
  "obstacles": [{"type": "box", "center": [5, 7.5], "size": [0.02, 5]}]
})";

class CheckPathTest : public TemporaryFolderTest {
 protected:
  void SetUp() override {
    TemporaryFolderTest::SetUp();
    scene_ = load_any_scene(write("wall.json", kWall));
  }
  [[nodiscard]] PathVerdict check(const std::vector<Vec2>& path) const {
    return check_path(scene_, {path.begin(), path.end()});
  }

  AnyScene scene_;
};

TEST_F(CheckPathTest, AroundTheWallKeepsTheMargin) {
  EXPECT_EQ(check({{1, 7}, {5, 4.8}, {9, 7}}), PathVerdict::kKeepsMargin);
}

TEST_F(CheckPathTest, ThroughTheWallCollidesThoughItsPointsAreFarFromIt) {
  EXPECT_EQ(check({{1, 7}, {9, 7}}), PathVerdict::kCollides);
}

TEST_F(CheckPathTest, PastTheWallsEndWithinTheMarginIsBelowIt) {
  EXPECT_EQ(check({{4, 4.88}, {6, 4.88}}), PathVerdict::kBelowMargin);
  EXPECT_EQ(check({{4, 4.92}, {6, 4.92}}), PathVerdict::kCollides);
}

TEST_F(CheckPathTest, AMicrometreIsForgivenAndTwoAreNot) {
  EXPECT_EQ(check({{4, 4.85 + 0.9e-6}, {6, 4.85 + 0.9e-6}}), PathVerdict::kKeepsMargin);
  EXPECT_EQ(check({{4, 4.85 + 2e-6}, {6, 4.85 + 2e-6}}), PathVerdict::kBelowMargin);
}

TEST_F(CheckPathTest, TheBoundsAreWalls) {
  EXPECT_EQ(check({{1, 0.12}, {9, 0.12}}), PathVerdict::kBelowMargin);
  EXPECT_EQ(check({{1, 0.05}, {9, 0.05}}), PathVerdict::kCollides);
}

TEST_F(CheckPathTest, NoPathIsNotChecked) { EXPECT_EQ(check({}), PathVerdict::kNotChecked); }

// A shipped scene whose straight motion is blocked.
class CheckArmPathTest : public ::testing::Test {
 protected:
  using Arm5 = ArmScene<5>;
  CheckArmPathTest()
      : scene_(load_any_scene(std::filesystem::path(SOPT_SOURCE_DIR) /
                              "tools/scenes/arm/arm_2_01.json")) {}

  [[nodiscard]] const Arm5& arm() const { return std::get<Arm5>(scene_); }
  [[nodiscard]] std::vector<Eigen::VectorXd> plan() const {
    const auto peer = make_sopt_peer("sopt", {SoptStage::kVerifiedPlan});
    return peer->prepare(scene_)->run(1).path;
  }

  AnyScene scene_;
};

TEST_F(CheckArmPathTest, AVerifiedPlanTouchesNothing) {
  const std::vector<Eigen::VectorXd> path = plan();
  ASSERT_FALSE(path.empty());
  EXPECT_NE(check_path(scene_, path), PathVerdict::kCollides);
  EXPECT_NE(check_path(scene_, path), PathVerdict::kNotChecked);
}

TEST_F(CheckArmPathTest, StraightThroughAnObstacleCollidesThoughItsEndsAreFree) {
  const std::vector<Eigen::VectorXd> ends = {arm().start, arm().goal};
  EXPECT_EQ(check_path(scene_, {ends[0], ends[0]}), PathVerdict::kKeepsMargin);
  EXPECT_EQ(check_path(scene_, {ends[1], ends[1]}), PathVerdict::kKeepsMargin);
  EXPECT_EQ(check_path(scene_, ends), PathVerdict::kCollides);
}

TEST_F(CheckArmPathTest, BetweenTheMarginAndContactIsBelowIt) {
  // The last share of the straight motion before it touches.
  double free = 0.0;
  double touching = 1.0;
  const auto at = [this](double share) {
    return Eigen::VectorXd(arm().arm.interpolate(arm().start, arm().goal, share));
  };
  const auto verdict = [&](double share) { return check_path(scene_, {arm().start, at(share)}); };
  while (touching - free > 1e-3) {
    const double middle = 0.5 * (free + touching);
    (verdict(middle) == PathVerdict::kCollides ? touching : free) = middle;
  }
  EXPECT_EQ(verdict(free), PathVerdict::kBelowMargin);
}

using Call = std::pair<std::string, std::uint64_t>;  // peer and seed; seed 0: prepare

// Notes its calls; what it answers is known.
class NotingSolver final : public PeerSolver {
 public:
  NotingSolver(std::string name, std::vector<Call>& calls)
      : name_(std::move(name)), calls_(&calls) {}

  PeerResult run(std::uint64_t seed) override {
    calls_->emplace_back(name_, seed);
    PeerResult result;
    result.is_solved = seed != 2;
    result.failure = result.is_solved ? "" : "gave up";
    result.time_ns = static_cast<std::int64_t>(10 * seed);
    result.num_allocations = 3;
    result.length = static_cast<double>(seed);
    result.path = {Eigen::Vector2d(1, 7), Eigen::Vector2d(9, 7)};
    return result;
  }

 private:
  std::string name_;
  std::vector<Call>* calls_;
};

class NotingPeer final : public Peer {
 public:
  NotingPeer(std::string name, bool is_slow, std::vector<Call>& calls)
      : Peer(std::move(name), is_slow), calls_(&calls) {}

  [[nodiscard]] std::unique_ptr<PeerSolver> prepare(const AnyScene& /*scene*/) const override {
    calls_->emplace_back(name(), 0);
    return std::make_unique<NotingSolver>(name(), *calls_);
  }

 private:
  std::vector<Call>* calls_;
};

class RunPeersTest : public TemporaryFolderTest {
 protected:
  void SetUp() override {
    TemporaryFolderTest::SetUp();
    peers_.push_back(std::make_unique<NotingPeer>("a", false, calls_));
    peers_.push_back(std::make_unique<NotingPeer>("b", false, calls_));
    peers_.push_back(std::make_unique<NotingPeer>("slow", true, calls_));
    std::vector<AnyScene> scenes;
    scenes.push_back(load_any_scene(write("wall.json", kWall)));
    runs_ = run_peers(scenes, {.num_seeds = 3, .num_slow_seeds = 1}, peers_);
  }

  std::vector<Call> calls_;
  std::vector<std::unique_ptr<Peer>> peers_;
  std::vector<PeerRun> runs_;
};

TEST_F(RunPeersTest, ForEachSeedThePeersFollowEachOther) {
  const std::vector<Call> expected = {{"a", 0}, {"a", 1},    {"b", 0}, {"b", 1}, {"slow", 0},
                                      {"b", 1}, {"slow", 1}, {"a", 1},  // warmed up, first seed
                                      {"a", 2}, {"b", 2},               //
                                      {"a", 3}, {"b", 3}};
  EXPECT_EQ(calls_, expected);
}

TEST_F(RunPeersTest, CountsEveryRunButTheWarmUp) {
  ASSERT_EQ(runs_.size(), 3U);
  EXPECT_EQ(runs_[0].peer, "a");
  EXPECT_EQ(runs_[0].cases.size(), 3U);
  EXPECT_EQ(runs_[1].cases.size(), 3U);
  EXPECT_EQ(runs_[2].cases.size(), 1U);
}

TEST_F(RunPeersTest, ACaseSaysWhatThePeerDidAndWhatItsPathIsWorth) {
  const PeerCase& c = runs_[1].cases[1];
  EXPECT_EQ(c.scene, "wall");
  EXPECT_EQ(c.seed, 2U);
  EXPECT_FALSE(c.is_solved);
  EXPECT_EQ(c.failure, "gave up");
  EXPECT_EQ(c.time_ns, 20);
  EXPECT_EQ(c.num_allocations, 3);
  EXPECT_EQ(c.length, 2.0);
  EXPECT_EQ(c.verdict, PathVerdict::kCollides);
}

}  // namespace
}  // namespace sopt
