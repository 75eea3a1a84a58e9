// What a world answers about segments and the robot in it; every number follows by hand.
#include <gtest/gtest.h>

#include <limits>

#include "models/plane/point2.h"
#include "models/plane/world2.h"
#include "tests/support/rt_guard.h"
#include "tests/support/test_world.h"

namespace sopt {
namespace {

using oracle::box_between;
using oracle::TestWorld;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

ClearanceRule rule_of(double margin_m, double rung = 1.0) {
  return {.margin_m = margin_m, .rung = rung};
}

class WorldQuery : public testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(world_.reset({{0.0, 0.0}, {10.0, 8.0}}), WorldStatus::kOk); }

  TestWorld test_world_;
  World2& world_ = test_world_.world;
};

TEST_F(WorldQuery, TakesItsBoundsForWalls) {
  world_.build();
  EXPECT_DOUBLE_EQ(world_.bounds_distance({2.0, 3.0}, {2.0, 3.0}), 2.0);
  EXPECT_DOUBLE_EQ(world_.bounds_distance({2.0, 3.0}, {9.5, 3.0}), 0.5);
  EXPECT_DOUBLE_EQ(world_.bounds_distance({5.0, 7.75}, {5.0, 4.0}), 0.25);
  EXPECT_DOUBLE_EQ(world_.bounds_distance({0.0, 4.0}, {5.0, 4.0}), 0.0);
  EXPECT_DOUBLE_EQ(world_.bounds_distance({5.0, 4.0}, {10.5, 4.0}), -0.5);
}

TEST_F(WorldQuery, FindsTheWallAsTheNearest) {
  ASSERT_EQ(world_.try_add(Disc{{5.0, 4.0}, 1.0}), WorldStatus::kOk);
  world_.build();
  const NearestObstacle wall = world_.nearest({5.0, 7.5}, {6.0, 7.5}, 5.0);
  EXPECT_EQ(wall.i_obstacle, kBoundsObstacle);
  EXPECT_DOUBLE_EQ(wall.distance_m, 0.5);
  const NearestObstacle outside = world_.nearest({5.0, 7.5}, {5.0, 9.0}, 5.0);
  EXPECT_EQ(outside.i_obstacle, kBoundsObstacle);
  EXPECT_DOUBLE_EQ(outside.distance_m, -1.0);
}

TEST_F(WorldQuery, FindsTheNearestObstacle) {
  ASSERT_EQ(world_.try_add(Disc{{2.0, 4.0}, 0.5}), WorldStatus::kOk);
  ASSERT_EQ(world_.try_add(box_between({6.0, 3.0}, {8.0, 5.0})), WorldStatus::kOk);
  ASSERT_EQ(world_.try_add(Disc{{5.0, 2.0}, 0.25}), WorldStatus::kOk);
  world_.build();
  const NearestObstacle box = world_.nearest({5.5, 4.0}, {5.5, 4.0}, 3.0);
  EXPECT_EQ(box.i_obstacle, 1);
  EXPECT_DOUBLE_EQ(box.distance_m, 0.5);
  const NearestObstacle disc = world_.nearest({3.0, 4.0}, {4.0, 4.0}, 3.0);
  EXPECT_EQ(disc.i_obstacle, 0);
  EXPECT_DOUBLE_EQ(disc.distance_m, 0.5);
  const NearestObstacle inside = world_.nearest({5.0, 4.0}, {6.25, 4.0}, 3.0);
  EXPECT_EQ(inside.i_obstacle, 1);
  EXPECT_DOUBLE_EQ(inside.distance_m, -0.25);
}

TEST_F(WorldQuery, FindsNothingBeyondTheLimit) {
  ASSERT_EQ(world_.try_add(Disc{{5.0, 4.0}, 0.5}), WorldStatus::kOk);
  world_.build();
  const NearestObstacle none = world_.nearest({3.0, 4.0}, {3.0, 4.0}, 1.25);
  EXPECT_EQ(none.i_obstacle, kNoObstacle);
  EXPECT_EQ(none.distance_m, 1.25);
  const NearestObstacle some = world_.nearest({3.0, 4.0}, {3.0, 4.0}, 1.75);
  EXPECT_EQ(some.i_obstacle, 0);
  EXPECT_DOUBLE_EQ(some.distance_m, 1.5);
}

TEST_F(WorldQuery, FindsTheNearestWithoutALimit) {
  ASSERT_EQ(world_.try_add(Disc{{5.0, 4.0}, 0.5}), WorldStatus::kOk);
  world_.build();
  const NearestObstacle nearest = world_.nearest({3.0, 4.0}, {4.0, 4.0}, kInfinity);
  EXPECT_EQ(nearest.i_obstacle, 0);
  EXPECT_DOUBLE_EQ(nearest.distance_m, 0.5);
}

TEST_F(WorldQuery, IsClearExactlyAtTheMargin) {
  ASSERT_EQ(world_.try_add(box_between({4.0, 3.0}, {6.0, 5.0})), WorldStatus::kOk);
  world_.build();
  const Vec2 p(3.0, 5.75);
  const Vec2 q(7.0, 5.75);  // 0.75 above the box
  EXPECT_TRUE(world_.is_clear(p, q, 0.5, rule_of(0.25)));
  EXPECT_FALSE(world_.is_clear(p, q, 0.5, rule_of(0.25 + 1e-9)));
  EXPECT_FALSE(world_.is_clear(p, q, 0.5 + 1e-9, rule_of(0.25)));
  EXPECT_TRUE(world_.is_clear(p, q, 0.5, rule_of(0.5, 0.5)));
  EXPECT_FALSE(world_.is_clear(p, q, 0.5, rule_of(0.5, 1.0)));
}

TEST_F(WorldQuery, IsClearExactlyAtTheMarginOfTheBounds) {
  world_.build();
  const Vec2 p(0.75, 2.0);
  const Vec2 q(5.0, 4.0);
  EXPECT_TRUE(world_.is_clear(p, q, 0.5, rule_of(0.25)));
  EXPECT_FALSE(world_.is_clear(p, q, 0.5, rule_of(0.25 + 1e-9)));
}

TEST_F(WorldQuery, IsNotClearOutsideItsBounds) {
  world_.build();
  EXPECT_FALSE(world_.is_clear({11.0, 4.0}, {12.0, 4.0}, 0.0, rule_of(0.0)));
  EXPECT_FALSE(world_.is_clear({5.0, 4.0}, {5.0, 8.5}, 0.0, rule_of(0.0)));
}

TEST_F(WorldQuery, IsNotClearThroughAnObstacleWithoutRadiusAndMargin) {
  ASSERT_EQ(world_.try_add(box_between({4.0, 3.0}, {6.0, 5.0})), WorldStatus::kOk);
  ASSERT_EQ(world_.try_add(Disc{{2.0, 6.0}, 0.5}), WorldStatus::kOk);
  world_.build();
  EXPECT_FALSE(world_.is_clear({1.0, 4.0}, {9.0, 4.0}, 0.0, rule_of(0.0)));
  EXPECT_FALSE(world_.is_clear({5.0, 4.0}, {5.0, 4.0}, 0.0, rule_of(0.0)));
  EXPECT_FALSE(world_.is_clear({1.0, 6.0}, {3.0, 6.0}, 0.0, rule_of(0.0)));
  EXPECT_TRUE(world_.is_clear({1.0, 5.0}, {9.0, 5.0}, 0.0, rule_of(0.0)));  // slides along the face
}

TEST_F(WorldQuery, IsNeverClearOfWhatIsNotFinite) {
  world_.build();
  const Vec2 p(2.0, 4.0);
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    for (const Vec2& q : {Vec2(bad, 4.0), Vec2(4.0, bad), Vec2(bad, bad)}) {
      EXPECT_FALSE(world_.is_clear(p, q, 0.5, rule_of(0.0)));
      EXPECT_FALSE(world_.is_clear(q, p, 0.5, rule_of(0.0)));
    }
    EXPECT_FALSE(world_.is_clear(p, p, bad, rule_of(0.0)));
  }
}

TEST_F(WorldQuery, KeepsAnObstaclesOwnMargin) {
  ASSERT_EQ(world_.try_add(box_between({4.0, 3.0}, {6.0, 5.0}), 0.5), WorldStatus::kOk);
  ASSERT_EQ(world_.try_add(box_between({4.0, 0.0}, {6.0, 1.0}), 0.0), WorldStatus::kOk);
  world_.build();
  const ClearanceRule rule = rule_of(0.125);
  EXPECT_EQ(world_.required_m(0, rule), 0.5);
  EXPECT_EQ(world_.required_m(1, rule), 0.0);
  EXPECT_EQ(world_.required_m(kBoundsObstacle, rule), 0.125);
  EXPECT_EQ(world_.max_required_m(rule), 0.5);
  EXPECT_EQ(world_.max_required_m(rule_of(0.75)), 0.75);
  EXPECT_TRUE(world_.is_clear({3.0, 5.5}, {7.0, 5.5}, 0.0, rule));
  EXPECT_FALSE(world_.is_clear({3.0, 5.4375}, {7.0, 5.4375}, 0.0, rule));
  EXPECT_TRUE(world_.is_clear({3.0, 5.25}, {7.0, 5.25}, 0.0, rule_of(0.125, 0.5)));
  EXPECT_TRUE(world_.is_clear({3.0, 1.0}, {7.0, 1.0}, 0.0, rule));
}

TEST_F(WorldQuery, CapsEveryMarginNextToAnEnd) {
  ASSERT_EQ(world_.try_add(box_between({4.0, 3.0}, {6.0, 5.0}), 0.5), WorldStatus::kOk);
  world_.build();
  const ClearanceRule rule = {.margin_m = 0.25, .cap_m = 0.0625};
  EXPECT_EQ(world_.required_m(0, rule), 0.0625);
  EXPECT_EQ(world_.required_m(kBoundsObstacle, rule), 0.0625);
  EXPECT_TRUE(world_.is_clear({3.0, 5.0625}, {7.0, 5.0625}, 0.0, rule));
}

TEST_F(WorldQuery, KeepsTheFloorOfEveryMargin) {
  ASSERT_EQ(world_.try_add(box_between({4.0, 3.0}, {6.0, 5.0}), 0.0), WorldStatus::kOk);
  world_.build();
  const ClearanceRule rule = {.margin_m = 0.25, .floor_m = 0.125};
  EXPECT_EQ(world_.required_m(0, rule), 0.125);
  EXPECT_EQ(world_.max_required_m(rule), 0.25);
  EXPECT_TRUE(world_.is_clear({3.0, 5.125}, {7.0, 5.125}, 0.0, rule));
  EXPECT_FALSE(world_.is_clear({3.0, 5.0625}, {7.0, 5.0625}, 0.0, rule));
}

TEST_F(WorldQuery, SeesEveryObstacleOfAFullWorld) {
  constexpr int kSide = 8;
  const auto center_of = [](int i) {
    const int row = i / kSide;
    return Vec2(0.6 + 1.2 * (i % kSide), 0.5 + 0.95 * row);
  };
  for (int i = 0; i < kSide * kSide; ++i) {
    const Vec2 center = center_of(i);
    ASSERT_EQ(world_.try_add(Disc{center, 0.25}), WorldStatus::kOk);
  }
  world_.build();
  for (int i = 0; i < kSide * kSide; ++i) {
    const Vec2 center = center_of(i);
    const NearestObstacle nearest = world_.nearest(center, center, 1.0);
    EXPECT_EQ(nearest.i_obstacle, i);
    EXPECT_NEAR(nearest.distance_m, -0.25, 1e-12);
    bool is_visited = false;
    EXPECT_TRUE(world_.for_each_near(center, center, 0.0, [&](int i_obstacle) {
      is_visited = is_visited || i_obstacle == i;
      return true;
    }));
    EXPECT_TRUE(is_visited);
  }
}

TEST_F(WorldQuery, AnswersWithoutHeapOrLock) {
  if (!RtGuard::available()) GTEST_SKIP() << "the guard cannot count under sanitizers";
  RtGuard guard;
  bool done = world_.reset({{0.0, 0.0}, {10.0, 8.0}}) == WorldStatus::kOk;
  for (int i = 0; i < 40; ++i) {
    done = world_.try_add(Disc{{0.2 * i + 1.0, 4.0}, 0.1}) == WorldStatus::kOk && done;
  }
  world_.build();
  const NearestObstacle nearest = world_.nearest({1.0, 5.0}, {9.0, 5.0}, 2.0);
  done = world_.is_clear({1.0, 5.0}, {9.0, 5.0}, 0.1, rule_of(0.05)) && done;
  guard.stop();
  EXPECT_TRUE(done);
  EXPECT_NEAR(nearest.distance_m, 0.9, 1e-12);
  EXPECT_EQ(guard.num_allocations(), 0);
  EXPECT_EQ(guard.num_locks(), 0);
}

// --- the robot in it

TEST_F(WorldQuery, IsSmallerForABiggerRobot) {
  ASSERT_EQ(world_.try_add(box_between({4.0, 3.0}, {6.0, 5.0})), WorldStatus::kOk);
  world_.build();
  const Point2 robot{0.5, kInfinity};
  const NearestObstacle nearest = robot.clearance(world_, {3.0, 4.0}, 2.0);
  EXPECT_EQ(nearest.i_obstacle, 0);
  EXPECT_DOUBLE_EQ(nearest.distance_m, 0.5);
  EXPECT_TRUE(robot.motion_is_clear(world_, rule_of(0.25), {3.0, 5.75}, {7.0, 5.75}));
  EXPECT_FALSE(robot.motion_is_clear(world_, rule_of(0.25), {3.0, 5.7}, {7.0, 5.7}));
  const Aabb2 box = robot.sampling_box(world_, rule_of(0.25));
  EXPECT_EQ(box.lower, Vec2(0.75, 0.75));
  EXPECT_EQ(box.upper, Vec2(9.25, 7.25));
}

TEST_F(WorldQuery, ShowsNothingNearARobotBeyondTheLimit) {
  world_.build();
  const Point2 robot{0.5, kInfinity};
  const NearestObstacle none = robot.clearance(world_, {5.0, 4.0}, 1.0);
  EXPECT_EQ(none.i_obstacle, kNoObstacle);
  EXPECT_DOUBLE_EQ(none.distance_m, 1.0);
}

TEST(Point, MovesInAStraightLine) {
  EXPECT_DOUBLE_EQ(Point2::path_distance({1.0, 1.0}, {4.0, 5.0}), 5.0);
  EXPECT_EQ(Point2::interpolate({1.0, 1.0}, {5.0, 3.0}, 0.25), Vec2(2.0, 1.5));
  EXPECT_EQ(Point2::interpolate({1.0, 1.0}, {5.0, 3.0}, 0.0), Vec2(1.0, 1.0));
}

}  // namespace
}  // namespace sopt
