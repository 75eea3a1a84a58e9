#include "sampler/lattice_search.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "rt/clock.h"
#include "tests/support/rt_guard.h"
#include "tests/support/test_problem.h"
#include "tests/support/test_world.h"

namespace sopt {
namespace {

using oracle::InArena;
using oracle::Random;
using oracle::Scene;
using oracle::SceneOracle;

constexpr double kTol_m = 1e-9;
constexpr int kMaxPoints = 1 << 17;
const Aabb2 kBounds = {Vec2::Zero(), Vec2::Constant(10.0)};

// Walls across the room that leave gaps in turns at the bottom and at the top.
Scene rooms_in_a_row(int num_walls, double gap_m) {
  Scene scene{kBounds, {}};
  for (int i = 1; i <= num_walls; ++i) {
    const double x = 10.0 * i / (num_walls + 1);
    const double lower = i % 2 == 0 ? 0.0 : gap_m;
    const double upper = i % 2 == 0 ? 10.0 - gap_m : 10.0;
    scene.obstacles.push_back({oracle::box_between({x - 0.1, lower}, {x + 0.1, upper})});
  }
  return scene;
}

class LatticeSearchTest : public ::testing::Test {
 protected:
  void use(const Scene& scene) {
    scene_ = scene;
    ASSERT_EQ(oracle::fill(scene, test_.world), WorldStatus::kOk);
  }
  bool find(const Vec2& start, const Vec2& goal, const Deadline& deadline = Deadline()) {
    MotionChecker<Point2> checker(robot_, test_.world, profile_);
    start_ = start;
    goal_ = goal;
    return lattice_->find_path(checker, start, goal, first_level_, deadline, *path_);
  }
  [[nodiscard]] std::vector<Vec2> found() { return oracle::copy_of(path_->vertices.span()); }
  void check_path() {
    const std::vector<Vec2> vertices = found();
    ASSERT_GE(vertices.size(), 2U);
    EXPECT_EQ(vertices.front(), start_);
    EXPECT_EQ(vertices.back(), goal_);
    const SceneOracle dense(scene_);
    EXPECT_GE(dense.path_slack(vertices, robot_.radius_m, profile_), -kTol_m);
  }

  Point2 robot_{0.1};
  oracle::TestWorld test_;
  Scene scene_;
  MarginProfile profile_ = oracle::plain_profile(0.05);
  InArena<LatticeSearch<Point2>> lattice_{kMaxPoints};
  InArena<Path<Point2>> path_{256};
  int first_level_ = 0;
  Vec2 start_ = Vec2::Zero();
  Vec2 goal_ = Vec2::Zero();
};

TEST_F(LatticeSearchTest, FindsTheWayThroughRoomsInARow) {
  for (const int num_walls : {1, 3, 7}) {
    use(rooms_in_a_row(num_walls, 0.6));
    ASSERT_TRUE(find({0.5, 5.0}, {9.5, 5.0})) << num_walls;
    check_path();
    EXPECT_GT(path_->length(Point2{}), 8.0 * num_walls) << "up and down through every gap";
  }
}

TEST_F(LatticeSearchTest, TakesAFinerLatticeForAGapThatTheCoarseOneMisses) {
  // The robot needs 0.3 m; 4096 points over the room are 0.16 m apart.
  for (const double gap_m : {0.6, 0.34, 0.32}) {
    use(rooms_in_a_row(1, gap_m));
    ASSERT_TRUE(find({0.5, 5.0}, {9.5, 5.0})) << gap_m;
    check_path();
  }
  use(rooms_in_a_row(1, 0.29));
  EXPECT_FALSE(find({0.5, 5.0}, {9.5, 5.0})) << "the robot does not fit";
  EXPECT_TRUE(path_->vertices.empty());
}

TEST_F(LatticeSearchTest, IsNearlyAsShortAsTheShortestWay) {
  // Around the end of one wall; eight directions lengthen a way by at most 8.3 %.
  use({kBounds, {{oracle::box_between({4.9, 0.0}, {5.1, 8.0})}}});
  ASSERT_TRUE(find({1.0, 2.0}, {9.0, 2.0}));
  check_path();
  const double shortest_m = 2.0 * Vec2(3.9, 6.15).norm();
  EXPECT_LT(path_->length(Point2{}), 1.1 * shortest_m);
}

TEST_F(LatticeSearchTest, PassesByPointsOnTheWay) {
  use({kBounds, {{oracle::box_between({4.0, 0.0}, {4.2, 6.0})}}});
  ASSERT_TRUE(find({1.0, 1.0}, {9.0, 1.0}));
  EXPECT_LT(path_->vertices.size(), 8) << "the way has more than 60 lattice motions";
  const double shortest_m = Vec2(2.85, 5.15).norm() + 0.5 + Vec2(4.65, 5.15).norm();
  EXPECT_LT(path_->length(Point2{}), 1.03 * shortest_m);
}

// The short way leads through a gap between the points of the coarse lattice.
TEST_F(LatticeSearchTest, FindsMoreWaysOnAFinerLevel) {
  use({kBounds,
       {{oracle::box_between({4.9, 0.0}, {5.1, 4.89})},
        {oracle::box_between({4.9, 5.25}, {5.1, 9.0})}}});
  ASSERT_TRUE(find({1.0, 5.0}, {9.0, 5.0}));
  const double coarse_m = path_->length(Point2{});
  first_level_ = 1;
  ASSERT_TRUE(find({1.0, 5.0}, {9.0, 5.0}));
  check_path();
  EXPECT_LT(path_->length(Point2{}), 8.1);
  EXPECT_GT(coarse_m, 11.0);
  first_level_ = kLatticeLevels;
  EXPECT_FALSE(find({1.0, 5.0}, {9.0, 5.0}));
}

TEST_F(LatticeSearchTest, LeavesAndEntersEndsThatAreCloserThanTheMargin) {
  use({kBounds,
       {{oracle::box_between({4.9, 0.0}, {5.1, 8.0})},
        {oracle::box_between({1.12, 1.0}, {1.5, 3.0})},
        {oracle::box_between({8.5, 1.0}, {8.88, 3.0})}}});
  EXPECT_FALSE(find({1.0, 2.0}, {9.0, 2.0})) << "both ends have 0.02 m";
  for (double* const cap_m : {&profile_.start_cap_m, &profile_.goal_cap_m}) *cap_m = 0.015;
  profile_.num_start_steps = 2;
  profile_.num_goal_steps = 2;
  profile_.step_length = 0.5;
  ASSERT_TRUE(find({1.0, 2.0}, {9.0, 2.0}));
  check_path();
}

TEST_F(LatticeSearchTest, MindsMarginsOfSingleObstacles) {
  Scene scene = rooms_in_a_row(1, 0.6);
  scene.obstacles[0].margin_m = 0.6;  // leaves no room in the gap
  use(scene);
  EXPECT_FALSE(find({0.5, 5.0}, {9.5, 5.0}));
  scene.obstacles[0].margin_m = 0.2;
  use(scene);
  ASSERT_TRUE(find({0.5, 5.0}, {9.5, 5.0}));
  check_path();
}

TEST_F(LatticeSearchTest, FindsAWayWhereverAFloodOfCellsDoes) {
  Random random(7);
  int num_found = 0;
  for (int k = 0; k < 60; ++k) {
    const std::vector<Vec2> line = oracle::random_polyline(
        random, {Vec2::Constant(0.5), Vec2::Constant(9.5)}, 3 + random.index(4));
    // Nothing within 0.4 m of the polyline: the robot and its margin need 0.15 m.
    use(oracle::random_scene_around(random, kBounds, line, 60, 1.5, 0.4));
    ASSERT_TRUE(find(line.front(), line.back())) << k;
    check_path();
    ++num_found;
    EXPECT_LT(path_->length(Point2{}), 1.1 * oracle::length_of(line) + 0.5) << k;
  }
  EXPECT_EQ(num_found, 60);
}

TEST_F(LatticeSearchTest, RefusesWhatDoesNotFit) {
  use(rooms_in_a_row(7, 0.6));
  InArena<LatticeSearch<Point2>> small(4000);  // less than the coarsest lattice
  InArena<LatticeSearch<Point2>> none(0);
  MotionChecker<Point2> checker(robot_, test_.world, profile_);
  EXPECT_FALSE(small->find_path(checker, {0.5, 5.0}, {9.5, 5.0}, 0, Deadline(), *path_));
  EXPECT_FALSE(none->find_path(checker, {0.5, 5.0}, {9.5, 5.0}, 0, Deadline(), *path_));
  InArena<Path<Point2>> short_path(6);
  EXPECT_FALSE(lattice_->find_path(checker, {0.5, 5.0}, {9.5, 5.0}, 0, Deadline(), *short_path));
  EXPECT_TRUE(short_path->vertices.empty());
}

TEST_F(LatticeSearchTest, StopsAtTheDeadline) {
  use(rooms_in_a_row(7, 0.6));
  const Clock clock = monotonic_clock();
  EXPECT_FALSE(find({0.5, 5.0}, {9.5, 5.0}, Deadline(clock, clock.now_ns() - 1'000'000'000, 1e-3)));
  EXPECT_TRUE(path_->vertices.empty());
  EXPECT_TRUE(find({0.5, 5.0}, {9.5, 5.0})) << "nothing is left of the search before";
}

TEST_F(LatticeSearchTest, TouchesNeitherHeapNorLock) {
  if (!RtGuard::available()) GTEST_SKIP() << "this build cannot count allocations";
  use(rooms_in_a_row(7, 0.6));
  ASSERT_TRUE(find({0.5, 5.0}, {9.5, 5.0}));
  RtGuard guard;
  const bool is_found = find({0.5, 5.0}, {9.5, 5.0});
  guard.stop();
  EXPECT_TRUE(is_found);
  EXPECT_EQ(guard.num_allocations(), 0);
  EXPECT_EQ(guard.num_locks(), 0);
}

}  // namespace
}  // namespace sopt
