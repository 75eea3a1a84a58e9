#include "sampler/shortcut.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "rt/clock.h"
#include "sampler/tuning.h"
#include "tests/support/rt_guard.h"
#include "tests/support/test_problem.h"
#include "tests/support/test_world.h"

namespace sopt {
namespace {

using oracle::Random;
using oracle::Scene;
using oracle::SceneOracle;
using oracle::TestPath;
using oracle::TestWorld;

constexpr double kTol_m = 1e-9;
const Aabb2 kBounds = {Vec2::Zero(), Vec2::Constant(10.0)};
const Aabb2 kInner = {Vec2::Constant(0.5), Vec2::Constant(9.5)};

class ShortcutTest : public ::testing::Test {
 protected:
  void shorten(TestPath& test, std::uint64_t seed = 1, const Deadline& deadline = Deadline()) {
    MotionChecker<Point2> checker(robot_, test_.world, profile_);
    CounterRng rng(seed);
    shortcut_path(checker, rng, deadline, test.path);
    num_checks_ = checker.num_checks();
  }

  Point2 robot_{0.1};
  TestWorld test_;
  MarginProfile profile_ = oracle::plain_profile(0.05);
  std::int64_t num_checks_ = 0;
};

TEST_F(ShortcutTest, MakesOneMotionOfADetourInFreeSpace) {
  ASSERT_EQ(oracle::fill({kBounds, {}}, test_.world), WorldStatus::kOk);
  TestPath test({{1, 1}, {2, 8}, {4, 2}, {6, 8}, {9, 9}});
  shorten(test);
  ASSERT_EQ(test.path.vertices.size(), 2);
  EXPECT_EQ(test.path.vertices[0], Vec2(1, 1));
  EXPECT_EQ(test.path.vertices[1], Vec2(9, 9));
}

TEST_F(ShortcutTest, LeavesAPathOfOneMotionAsItIs) {
  ASSERT_EQ(oracle::fill({kBounds, {}}, test_.world), WorldStatus::kOk);
  TestPath test({{1, 1}, {9, 2}});
  shorten(test);
  EXPECT_EQ(oracle::copy_of(test.path.vertices.span()), (std::vector<Vec2>{{1, 1}, {9, 2}}));
}

TEST_F(ShortcutTest, CutsCornersRoundAnObstacle) {
  const Scene scene = {kBounds, {{oracle::box_between({4, 4}, {6, 6}), kDefaultMargin}}};
  ASSERT_EQ(oracle::fill(scene, test_.world), WorldStatus::kOk);
  TestPath test({{1, 5}, {1, 9}, {9, 9}, {9, 5}});
  shorten(test);
  // Round the box with clearance 0.15: at least over its upper corners.
  const double shortest = 2.0 * std::hypot(3.0, 1.0) + 2.0;
  EXPECT_GT(test.path.length(Point2{}), shortest);
  EXPECT_LT(test.path.length(Point2{}), 1.25 * shortest);
}

TEST_F(ShortcutTest, NeverLengthensAndKeepsEndsAndClearance) {
  Random random(1);
  double shortened = 0.0;
  for (int round = 0; round < 200; ++round) {
    profile_.rule.margin_m = random.uniform(0.0, 0.2);
    profile_.num_start_steps = random.index(2);
    profile_.num_goal_steps = random.index(2);
    profile_.start_cap_m = 0.01;
    profile_.goal_cap_m = 0.02;
    profile_.step_length = 0.4;
    const std::vector<Vec2> vertices = oracle::random_polyline(random, kInner, 2 + random.index(8));
    const Scene scene = oracle::random_scene_around(random, kBounds, vertices, 40, 0.7,
                                                    robot_.radius_m + profile_.rule.margin_m);
    ASSERT_EQ(oracle::fill(scene, test_.world), WorldStatus::kOk);
    TestPath test(vertices);
    shorten(test, static_cast<std::uint64_t>(round));
    const auto result = test.path.vertices.span();
    EXPECT_EQ(result.front(), vertices.front());
    EXPECT_EQ(result.back(), vertices.back());
    EXPECT_LE(oracle::length_of(result), oracle::length_of(vertices) * (1.0 + 1e-12));
    EXPECT_GE(SceneOracle(scene).path_slack(result, robot_.radius_m, profile_), -kTol_m)
        << oracle::to_text(scene) << oracle::to_text(vertices);
    shortened += oracle::length_of(result) / oracle::length_of(vertices) / 200.0;
  }
  EXPECT_LT(shortened, 0.8);
}

TEST_F(ShortcutTest, StaysWithinItsBoundOfChecks) {
  Random random(2);
  for (int round = 0; round < 20; ++round) {
    const int size = 100;
    const std::vector<Vec2> vertices = oracle::random_polyline(random, kInner, size);
    const Scene scene =
        oracle::random_scene_around(random, kBounds, vertices, 400, 0.05, robot_.radius_m + 0.05);
    TestWorld dense({512, 8192});
    ASSERT_EQ(oracle::fill(scene, dense.world), WorldStatus::kOk);
    TestPath test(vertices);
    MotionChecker<Point2> checker(robot_, dense.world, profile_);
    CounterRng rng(static_cast<std::uint64_t>(round));
    shortcut_path(checker, rng, Deadline(), test.path);
    EXPECT_LE(checker.num_checks(), SamplerTuning<Point2>::kShortcutTries + 2 * kMaxSkip * size);
  }
}

TEST_F(ShortcutTest, WorksWhenThePathFillsItsCapacity) {
  Random random(3);
  for (int round = 0; round < 50; ++round) {
    const std::vector<Vec2> vertices = oracle::random_polyline(random, kInner, 6);
    const Scene scene =
        oracle::random_scene_around(random, kBounds, vertices, 40, 0.7, robot_.radius_m + 0.05);
    ASSERT_EQ(oracle::fill(scene, test_.world), WorldStatus::kOk);
    TestPath test(vertices, 6);
    shorten(test, static_cast<std::uint64_t>(round));
    EXPECT_EQ(test.path.vertices[0], vertices.front());
    EXPECT_EQ(test.path.vertices.back(), vertices.back());
    EXPECT_GE(SceneOracle(scene).path_slack(test.path.vertices.span(), 0.1, profile_), -kTol_m);
  }
}

TEST_F(ShortcutTest, LeavesAWholePathAtAnyDeadline) {
  Random random(4);
  const std::vector<Vec2> vertices = oracle::random_polyline(random, kInner, 10);
  const Scene scene =
      oracle::random_scene_around(random, kBounds, vertices, 60, 0.5, robot_.radius_m + 0.05);
  ASSERT_EQ(oracle::fill(scene, test_.world), WorldStatus::kOk);
  double last_length = oracle::length_of(vertices) * (1.0 + 1e-12);
  for (int num_polls = 0; num_polls < 80; ++num_polls) {
    ManualClock clock(1000);
    TestPath test(vertices);
    shorten(test, 1, Deadline(clock.clock(), 0, 1e-6 * num_polls + 0.5e-6));
    const auto result = test.path.vertices.span();
    EXPECT_EQ(result.front(), vertices.front());
    EXPECT_EQ(result.back(), vertices.back());
    EXPECT_LE(oracle::length_of(result), last_length);
    EXPECT_GE(SceneOracle(scene).path_slack(result, 0.1, profile_), -kTol_m);
  }
}

TEST_F(ShortcutTest, TouchesNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "this build cannot count allocations";
  ASSERT_EQ(oracle::fill({kBounds, {}}, test_.world), WorldStatus::kOk);
  TestPath test({{1, 1}, {2, 8}, {4, 2}, {6, 8}, {9, 9}});
  RtGuard guard;
  shorten(test);
  guard.stop();
  EXPECT_EQ(guard.num_allocations() + guard.num_releases() + guard.num_locks(), 0);
}

}  // namespace
}  // namespace sopt
