// What a world takes and what it refuses. Its answers: world2_query_test.cc.
#include "models/plane/world2.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "tests/support/test_world.h"

namespace sopt {
namespace {

using oracle::box_between;
using oracle::polygon_of;
using oracle::TestWorld;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
const Vec2 kUnit(1.0, 1.0);

class World : public testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(world_.reset({{0.0, 0.0}, {10.0, 8.0}}), WorldStatus::kOk); }

  TestWorld test_world_;
  World2& world_ = test_world_.world;
};

TEST(UnsetWorld, RefusesObstaclesBeforeItIsReset) {
  TestWorld test_world;
  EXPECT_EQ(test_world.world.try_add(Disc{kUnit, 1.0}), WorldStatus::kNotReset);
  EXPECT_EQ(test_world.world.try_add(Box2{kUnit, kUnit, 0.0}), WorldStatus::kNotReset);
  EXPECT_EQ(test_world.world.try_add(polygon_of({{0, 0}, {1, 0}, {0, 1}})), WorldStatus::kNotReset);
  EXPECT_EQ(test_world.world.num_obstacles(), 0);
}

TEST_F(World, KeepsWhatItWasGiven) {
  ASSERT_EQ(world_.try_add(Disc{{2.0, 3.0}, 0.5}), WorldStatus::kOk);
  ASSERT_EQ(world_.try_add(box_between({4.0, 4.0}, {6.0, 5.0}), 0.25), WorldStatus::kOk);
  ASSERT_EQ(world_.try_add(polygon_of({{7, 1}, {9, 1}, {8, 3}})), WorldStatus::kOk);
  world_.build();
  EXPECT_EQ(world_.num_obstacles(), 3);
  EXPECT_EQ(world_.bounds().upper, Vec2(10.0, 8.0));
  EXPECT_EQ(world_.obstacle(0).num_vertices, 1);
  EXPECT_EQ(world_.obstacle(0).radius_m, 0.5);
  EXPECT_EQ(world_.obstacle(1).num_vertices, 4);
  EXPECT_EQ(world_.obstacle(2).num_vertices, 3);
  EXPECT_EQ(world_.obstacle_margin_m(0), kDefaultMargin);
  EXPECT_EQ(world_.obstacle_margin_m(1), 0.25);
  EXPECT_EQ(world_.obstacle_box(0).lower, Vec2(1.5, 2.5));
  EXPECT_EQ(world_.obstacle_box(0).upper, Vec2(2.5, 3.5));
  EXPECT_EQ(world_.obstacle_box(1).lower, Vec2(4.0, 4.0));
  EXPECT_EQ(world_.obstacle_box(2).upper, Vec2(9.0, 3.0));
}

TEST_F(World, IsEmptyAfterAReset) {
  ASSERT_EQ(world_.try_add(Disc{kUnit, 0.5}, 3.0), WorldStatus::kOk);
  world_.build();
  ASSERT_EQ(world_.reset({{-1.0, -1.0}, {1.0, 1.0}}), WorldStatus::kOk);
  world_.build();
  EXPECT_EQ(world_.num_obstacles(), 0);
  EXPECT_EQ(world_.bounds().lower, Vec2(-1.0, -1.0));
  const ClearanceRule rule = {.margin_m = 0.1};
  EXPECT_EQ(world_.max_required_m(rule), 0.1);
  EXPECT_TRUE(world_.is_clear({-0.5, 0.5}, {0.5, 0.5}, 0.0, rule));
}

TEST_F(World, RefusesBoundsThatAreNotFinite) {
  EXPECT_EQ(world_.reset({{0.0, kNan}, {1.0, 1.0}}), WorldStatus::kNotFinite);
  EXPECT_EQ(world_.reset({{0.0, 0.0}, {kInfinity, 1.0}}), WorldStatus::kNotFinite);
  EXPECT_EQ(world_.reset({{-kInfinity, 0.0}, {1.0, 1.0}}), WorldStatus::kNotFinite);
}

TEST_F(World, RefusesBoundsThatEncloseNothing) {
  EXPECT_EQ(world_.reset({{0.0, 0.0}, {0.0, 1.0}}), WorldStatus::kBadBounds);
  EXPECT_EQ(world_.reset({{0.0, 2.0}, {1.0, 1.0}}), WorldStatus::kBadBounds);
}

TEST_F(World, RefusesCoordinatesThatAreNotFinite) {
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    EXPECT_EQ(world_.try_add(Disc{{bad, 1.0}, 1.0}), WorldStatus::kNotFinite);
    EXPECT_EQ(world_.try_add(Disc{kUnit, bad}), WorldStatus::kNotFinite);
    EXPECT_EQ(world_.try_add(Box2{{1.0, bad}, kUnit, 0.0}), WorldStatus::kNotFinite);
    EXPECT_EQ(world_.try_add(Box2{kUnit, {bad, 1.0}, 0.0}), WorldStatus::kNotFinite);
    EXPECT_EQ(world_.try_add(Box2{kUnit, kUnit, bad}), WorldStatus::kNotFinite);
    EXPECT_EQ(world_.try_add(polygon_of({{0, 0}, {1, 0}, {bad, 1}})), WorldStatus::kNotFinite);
    EXPECT_EQ(world_.try_add(Disc{kUnit, 1.0}, bad), WorldStatus::kNotFinite);
  }
  EXPECT_EQ(world_.num_obstacles(), 0);
}

TEST_F(World, RefusesSizesThatAreNotPositive) {
  for (const double bad : {0.0, -1.0}) {
    EXPECT_EQ(world_.try_add(Disc{kUnit, bad}), WorldStatus::kBadSize);
    EXPECT_EQ(world_.try_add(Box2{kUnit, {bad, 1.0}, 0.0}), WorldStatus::kBadSize);
    EXPECT_EQ(world_.try_add(Box2{kUnit, {1.0, bad}, 0.0}), WorldStatus::kBadSize);
  }
  EXPECT_EQ(world_.num_obstacles(), 0);
}

TEST_F(World, RefusesNegativeMargins) {
  EXPECT_EQ(world_.try_add(Disc{kUnit, 1.0}, -0.5), WorldStatus::kBadSize);
  EXPECT_EQ(world_.try_add(Disc{kUnit, 1.0}, 0.0), WorldStatus::kOk);
}

TEST_F(World, RefusesBadVertexCounts) {
  Polygon2 polygon = polygon_of({{0, 0}, {1, 0}, {0, 1}});
  for (const int bad : {0, 1, 2, -1, kMaxPolygonVertices + 1, 1 << 30}) {
    polygon.num_vertices = bad;
    EXPECT_EQ(world_.try_add(polygon), WorldStatus::kBadVertexCount) << bad;
  }
}

TEST_F(World, RefusesOutlinesThatTurnRight) {
  EXPECT_EQ(world_.try_add(polygon_of({{0, 0}, {4, 0}, {2, 1}, {2, 4}})), WorldStatus::kNotConvex);
  const auto bow_tie = polygon_of({{0, 0}, {2, 0}, {0, 1}, {1, 1}});
  EXPECT_EQ(world_.try_add(bow_tie), WorldStatus::kNotConvex);
}

TEST_F(World, RefusesOutlinesThatWindTwice) {
  std::vector<Vec2> star;
  for (int i = 0; i < 5; ++i) {
    const double angle = 2.0 * (2.0 * std::numbers::pi / 5.0) * i;  // turns left at every vertex
    star.emplace_back(std::cos(angle), std::sin(angle));
  }
  EXPECT_EQ(world_.try_add(polygon_of(star)), WorldStatus::kNotConvex);
  const std::vector<Vec2> square_twice = {{0, 0}, {1, 0}, {1, 1}, {0, 1},
                                          {0, 0}, {1, 0}, {1, 1}, {0, 1}};
  EXPECT_NE(world_.try_add(polygon_of(square_twice)), WorldStatus::kOk);
  EXPECT_EQ(world_.num_obstacles(), 0);
}

TEST_F(World, RefusesClockwiseOutlines) {
  EXPECT_EQ(world_.try_add(polygon_of({{0, 0}, {0, 1}, {1, 1}, {1, 0}})), WorldStatus::kClockwise);
  EXPECT_EQ(world_.try_add(polygon_of({{0, 0}, {0, 1}, {1, 0}})), WorldStatus::kClockwise);
}

TEST_F(World, RefusesDegenerateOutlines) {
  EXPECT_EQ(world_.try_add(polygon_of({{0, 0}, {1, 0}, {2, 0}})), WorldStatus::kDegenerate);
  EXPECT_EQ(world_.try_add(polygon_of({{0, 0}, {1, 0}, {1, 0}, {0, 1}})), WorldStatus::kDegenerate);
  EXPECT_EQ(world_.try_add(polygon_of({{0, 0}, {1, 0}, {0, 1}, {0, 0}})), WorldStatus::kDegenerate);
  EXPECT_EQ(world_.try_add(polygon_of({{1, 1}, {1, 1}, {1, 1}})), WorldStatus::kDegenerate);
}

TEST_F(World, AcceptsVerticesInTheMiddleOfAFace) {
  EXPECT_EQ(world_.try_add(polygon_of({{1, 1}, {2, 1}, {3, 1}, {3, 2}, {1, 2}})), WorldStatus::kOk);
  world_.build();
  const Vec2 z(2.5, 0.0);
  EXPECT_NEAR(compute_clearance(world_.obstacle(0), z, z).distance_m, 1.0, 1e-12);
}

TEST_F(World, AcceptsThinAndTinyShapes) {
  EXPECT_EQ(world_.try_add(polygon_of({{1, 1}, {2, 1}, {2, 1.001}})), WorldStatus::kOk);
  EXPECT_EQ(world_.try_add(box_between({1.0, 1.0}, {9.0, 1.0001})), WorldStatus::kOk);
  EXPECT_EQ(world_.try_add(polygon_of({{3, 3}, {3.001, 3}, {3, 3.001}})), WorldStatus::kOk);
}

TEST(WorldCapacityOfTwo, RefusesAThirdObstacle) {
  TestWorld test_world({2, 64});
  World2& world = test_world.world;
  ASSERT_EQ(world.reset({{0, 0}, {9, 9}}), WorldStatus::kOk);
  EXPECT_EQ(world.try_add(Disc{kUnit, 1.0}), WorldStatus::kOk);
  EXPECT_EQ(world.try_add(Disc{kUnit, 1.0}), WorldStatus::kOk);
  EXPECT_EQ(world.try_add(Disc{kUnit, 1.0}), WorldStatus::kTooManyObstacles);
  EXPECT_EQ(world.num_obstacles(), 2);
  ASSERT_EQ(world.reset({{0, 0}, {9, 9}}), WorldStatus::kOk);
  EXPECT_EQ(world.try_add(Disc{kUnit, 1.0}), WorldStatus::kOk);
}

TEST(WorldCapacityOfEightVertices, CountsThemInFours) {
  TestWorld test_world({64, 8});
  World2& world = test_world.world;
  ASSERT_EQ(world.reset({{0, 0}, {9, 9}}), WorldStatus::kOk);
  EXPECT_EQ(world.try_add(polygon_of({{0, 0}, {1, 0}, {2, 1}, {1, 2}, {0, 1}})), WorldStatus::kOk);
  EXPECT_EQ(world.try_add(Disc{kUnit, 1.0}), WorldStatus::kTooManyVertices);
  EXPECT_EQ(world.num_obstacles(), 1);
  ASSERT_EQ(world.reset({{0, 0}, {9, 9}}), WorldStatus::kOk);
  EXPECT_EQ(world.try_add(Disc{kUnit, 1.0}), WorldStatus::kOk);
  EXPECT_EQ(world.try_add(Disc{kUnit, 1.0}), WorldStatus::kOk);
  EXPECT_EQ(world.try_add(Disc{kUnit, 1.0}), WorldStatus::kTooManyVertices);
}

TEST(WorldCapacityOfEightVertices, IsNotUsedUpByRefusedObstacles) {
  TestWorld test_world({2, 8});
  World2& world = test_world.world;
  ASSERT_EQ(world.reset({{0, 0}, {9, 9}}), WorldStatus::kOk);
  for (int i = 0; i < 20; ++i) {
    EXPECT_NE(world.try_add(polygon_of({{0, 0}, {0, 1}, {1, 0}})), WorldStatus::kOk);
    EXPECT_NE(world.try_add(Disc{kUnit, -1.0}), WorldStatus::kOk);
    EXPECT_NE(world.try_add(Disc{kUnit, 1.0}, kNan), WorldStatus::kOk);
  }
  EXPECT_EQ(world.try_add(Disc{kUnit, 1.0}), WorldStatus::kOk);
  EXPECT_EQ(world.try_add(Disc{kUnit, 1.0}), WorldStatus::kOk);
  EXPECT_EQ(world.num_obstacles(), 2);
}

TEST(WorldMemory, IsExactlyWhatIsRequired) {
  for (const WorldCapacity& capacity : {WorldCapacity{1, 4}, {7, 100}, {5000, 20000}}) {
    const std::size_t required_B = World2::required_bytes(capacity);
    const MemoryBlock block(required_B);
    Arena arena(block);
    const World2 world(arena, capacity);
    EXPECT_FALSE(arena.exhausted());
    EXPECT_EQ(arena.used_B(), required_B);
  }
}

}  // namespace
}  // namespace sopt
