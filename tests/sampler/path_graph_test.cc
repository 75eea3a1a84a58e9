#include "sampler/path_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/rt_guard.h"
#include "tests/support/test_problem.h"
#include "tests/support/test_world.h"

namespace sopt {
namespace {

using oracle::InArena;
using oracle::Random;
using oracle::Scene;
using oracle::SceneOracle;
using oracle::TestPath;
using oracle::TestWorld;

constexpr Point2 kRobot{};

using Points = std::vector<Vec2>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
const Aabb2 kBounds = {Vec2::Zero(), Vec2::Constant(10.0)};
const Aabb2 kInner = {Vec2::Constant(0.5), Vec2::Constant(9.5)};

// Shortest way from points[0] to points[1] over all pairs that are clear, by Bellman and Ford.
double brute_force_length(const Points& points, const SceneOracle& dense, double radius_m,
                          const MarginProfile& profile) {
  const std::size_t n = points.size();
  std::vector<double> length(n, kInfinity);
  std::vector<std::vector<double>> edge(n, std::vector<double>(n, kInfinity));
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = 0; b < n; ++b) {
      if (a == b || b == 0 || a == 1) continue;  // ways leave the start and end at the goal
      MarginProfile motion_profile = profile;
      if (a != 0) motion_profile.num_start_steps = 0;
      if (b != 1) motion_profile.num_goal_steps = 0;
      const Vec2 motion[] = {points[a], points[b]};
      if (dense.path_slack(motion, radius_m, motion_profile) >= -1e-12) {
        edge[a][b] = (points[b] - points[a]).norm();
      }
    }
  }
  length[0] = 0.0;
  for (std::size_t round = 0; round < n; ++round) {
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t b = 0; b < n; ++b) length[b] = std::min(length[b], length[a] + edge[a][b]);
    }
  }
  return length[1];
}

class PathGraphTest : public ::testing::Test {
 protected:
  void use(const Scene& scene) { ASSERT_EQ(oracle::fill(scene, test_.world), WorldStatus::kOk); }
  bool find(double limit, Path<Point2>& out, const Deadline& deadline = Deadline()) {
    MotionChecker<Point2> checker(robot_, test_.world, profile_);
    return graph_->find_shorter(checker, deadline, limit, out);
  }

  Point2 robot_{0.1};
  TestWorld test_;
  MarginProfile profile_ = oracle::plain_profile(0.05);
  InArena<PathGraph<Point2>> graph_;
};

TEST_F(PathGraphTest, ChangesFromOnePathToAnother) {
  // Two walls; the first path is short at the first wall, the second at the second wall.
  use({kBounds,
       {{oracle::box_between({3.0, 1.5}, {3.2, 8.5}), kDefaultMargin},
        {oracle::box_between({7.0, 1.5}, {7.2, 8.5}), kDefaultMargin}}});
  const Points a = {{1, 2}, {3.1, 1.2}, {5, 5}, {7.1, 8.8}, {9, 2}};
  const Points b = {{1, 2}, {3.1, 8.8}, {5, 5.1}, {7.1, 1.2}, {9, 2}};
  graph_->reset(kRobot);
  graph_->add(TestPath(a).path);
  graph_->add(TestPath(b).path);
  TestPath out({});
  ASSERT_TRUE(find(kInfinity, out.path));
  const Points expected = {{1, 2}, {3.1, 1.2}, {7.1, 1.2}, {9, 2}};
  EXPECT_EQ(oracle::copy_of(out.path.vertices.span()), expected);
}

TEST_F(PathGraphTest, FindsTheShortestWayOverAllClearMotions) {
  Random random(1);
  int num_mixed = 0;
  for (int round = 0; round < 300; ++round) {
    profile_.num_start_steps = random.index(2);
    profile_.num_goal_steps = random.index(2);
    profile_.start_cap_m = 0.01;
    profile_.goal_cap_m = 0.02;
    profile_.step_length = 0.6;
    const Vec2 start = random.point(kInner);
    const Vec2 goal = random.point(kInner);
    Points all = {start, goal};
    std::vector<Points> paths;
    Points joined;  // back and forth: keeps obstacles away from all paths
    for (int k = 1 + random.index(4); k > 0; --k) {
      Points path = oracle::random_polyline(random, kInner, random.index(5));
      all.insert(all.end(), path.begin(), path.end());
      path.insert(path.begin(), start);
      path.push_back(goal);
      if (paths.size() % 2 == 0) {
        joined.insert(joined.end(), path.begin(), path.end());
      } else {
        joined.insert(joined.end(), path.rbegin(), path.rend());
      }
      paths.push_back(path);
    }
    const Scene scene = oracle::random_scene_around(random, kBounds, joined, 40, 0.7, 0.16);
    use(scene);
    graph_->reset(kRobot);
    double shortest_input = kInfinity;
    for (const Points& path : paths) {
      graph_->add(TestPath(path).path);
      shortest_input = std::min(shortest_input, oracle::length_of(path));
    }
    TestPath out({});
    ASSERT_TRUE(find(kInfinity, out.path));
    const SceneOracle dense(scene);
    const auto result = out.path.vertices.span();
    EXPECT_EQ(result.front(), start);
    EXPECT_EQ(result.back(), goal);
    EXPECT_LE(out.path.length(Point2{}), shortest_input * (1.0 + 1e-12));
    EXPECT_GE(dense.path_slack(result, robot_.radius_m, profile_), -1e-9);
    const double expected = brute_force_length(all, dense, robot_.radius_m, profile_);
    EXPECT_NEAR(out.path.length(Point2{}), expected, 1e-9) << oracle::to_text(scene);

    // A limit is strict, and a refusal leaves the output alone.
    if (expected < shortest_input - 1e-9) {
      ++num_mixed;
      EXPECT_TRUE(find(shortest_input, out.path));
      EXPECT_NEAR(out.path.length(Point2{}), expected, 1e-9);
    }
    const Points kept = oracle::copy_of(out.path.vertices.span());
    EXPECT_FALSE(find(expected - 1e-9, out.path));
    EXPECT_TRUE(oracle::same_bytes(kept, out.path.vertices.span()));
  }
  EXPECT_GT(num_mixed, 100);
}

TEST_F(PathGraphTest, LeavesOutPathsThatDoNotFit) {
  use({kBounds, {}});
  graph_->reset(kRobot);
  Random random(2);
  for (int k = 0; k < 10; ++k) {
    Points path = oracle::random_polyline(random, kInner, 40);
    path.front() = {1, 1};
    path.back() = {9, 9};
    graph_->add(TestPath(path).path);
  }
  TestPath out({});
  ASSERT_TRUE(find(kInfinity, out.path));
  EXPECT_NEAR(out.path.length(Point2{}), std::hypot(8.0, 8.0), 1e-9);
}

TEST_F(PathGraphTest, RefusesWhenTheResultDoesNotFit) {
  const Points path = {{1, 2}, {3.1, 1.2}, {7.1, 1.2}, {9, 2}};
  use({kBounds, {{oracle::box_between({3.0, 1.5}, {7.2, 8.5}), kDefaultMargin}}});
  graph_->reset(kRobot);
  graph_->add(TestPath(path).path);
  TestPath small({{5, 5}, {6, 6}}, 3);
  EXPECT_FALSE(find(kInfinity, small.path));
  EXPECT_EQ(oracle::copy_of(small.path.vertices.span()), (Points{{5, 5}, {6, 6}}));
  TestPath exact({}, 4);
  EXPECT_TRUE(find(kInfinity, exact.path));
}

TEST_F(PathGraphTest, GivesUpAtTheDeadline) {
  use({kBounds, {}});
  graph_->reset(kRobot);
  graph_->add(TestPath({{1, 1}, {5, 8}, {9, 9}}).path);
  ManualClock clock;
  TestPath out({});
  EXPECT_FALSE(find(kInfinity, out.path, Deadline(clock.clock(), 0, 0.0)));
  EXPECT_TRUE(out.path.vertices.empty());
}

TEST_F(PathGraphTest, HasNoPathAfterReset) {
  use({kBounds, {}});
  graph_->reset(kRobot);
  graph_->add(TestPath({{1, 1}, {9, 9}}).path);
  graph_->reset(kRobot);
  TestPath out({});
  EXPECT_FALSE(find(kInfinity, out.path));
}

TEST_F(PathGraphTest, TouchesNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "this build cannot count allocations";
  use({kBounds, {}});
  TestPath input({{1, 1}, {5, 8}, {9, 9}});
  TestPath out({});
  RtGuard guard;
  graph_->reset(kRobot);
  graph_->add(input.path);
  const bool found = find(kInfinity, out.path);
  guard.stop();
  EXPECT_TRUE(found);
  EXPECT_EQ(guard.num_allocations() + guard.num_releases() + guard.num_locks(), 0);
}

}  // namespace
}  // namespace sopt
