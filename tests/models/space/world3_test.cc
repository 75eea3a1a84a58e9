// What a world in space takes and refuses, and what it answers.
#include "models/space/world3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "alloc/memory_block.h"
#include "tests/support/oracle3.h"
#include "tests/support/rt_guard.h"

namespace sopt {
namespace {

constexpr double kTol = 1e-12;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr World3Capacity kCapacity{64, 2};

class SolidWorld : public testing::Test {
 protected:
  Box3 cube_at(const Vec3& center, double size = 1.0) {
    return {{Mat3::Identity(), center}, Vec3::Constant(size)};
  }

  MemoryBlock block_{World3::required_bytes(kCapacity)};
  Arena arena_{block_};
  World3 world_{arena_, kCapacity};
  std::vector<Vec3> tetrahedron_ = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
};

TEST_F(SolidWorld, TakesExactlyTheMemoryItAsksFor) {
  EXPECT_FALSE(arena_.exhausted());
  EXPECT_EQ(arena_.used_B(), World3::required_bytes(kCapacity));
}

TEST_F(SolidWorld, KeepsWhatItWasGiven) {
  ASSERT_EQ(world_.try_add(Sphere3{{1, 2, 3}, 0.5}), WorldStatus::kOk);
  ASSERT_EQ(world_.try_add(cube_at({5, 5, 5}), 0.25), WorldStatus::kOk);
  ASSERT_EQ(world_.try_add(Capsule3{{0, 0, 0}, {1, 0, 0}, 0.1}), WorldStatus::kOk);
  ASSERT_EQ(world_.try_add(Cylinder3{{}, 1.0, 2.0}), WorldStatus::kOk);
  ASSERT_EQ(world_.try_add(Hull3{tetrahedron_}), WorldStatus::kOk);
  EXPECT_EQ(world_.num_obstacles(), 5);
  EXPECT_EQ(world_.obstacle(0).kind, CoreKind::kPoint);
  EXPECT_EQ(world_.obstacle(1).kind, CoreKind::kBox);
  EXPECT_EQ(world_.obstacle(2).kind, CoreKind::kSegment);
  EXPECT_EQ(world_.obstacle(3).kind, CoreKind::kCylinder);
  EXPECT_EQ(world_.obstacle(4).kind, CoreKind::kHull);
  EXPECT_EQ(world_.obstacle_margin_m(0), kDefaultMargin);
  EXPECT_EQ(world_.obstacle_margin_m(1), 0.25);
  EXPECT_EQ(world_.obstacle_box(0).lower, Vec3(0.5, 1.5, 2.5));
  EXPECT_EQ(world_.obstacle_box(4).upper, Vec3(1, 1, 1));
}

TEST_F(SolidWorld, RefusesWhatIsNoShapeAndAddsNothing) {
  const Mat3 mirror = Vec3(1, 1, -1).asDiagonal();
  const std::vector<Vec3> flat = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  EXPECT_EQ(world_.try_add(Sphere3{{0, 0, 0}, 0.0}), WorldStatus::kBadSize);
  EXPECT_EQ(world_.try_add(Capsule3{{0, 0, kNan}, {1, 0, 0}, 0.1}), WorldStatus::kNotFinite);
  EXPECT_EQ(world_.try_add(Box3{{mirror, Vec3::Zero()}, {1, 1, 1}}), WorldStatus::kBadRotation);
  EXPECT_EQ(world_.try_add(Cylinder3{{}, 1.0, -1.0}), WorldStatus::kBadSize);
  EXPECT_EQ(world_.try_add(Hull3{flat}), WorldStatus::kDegenerate);
  EXPECT_EQ(world_.try_add(Sphere3{{0, 0, 0}, 1.0}, -0.5), WorldStatus::kBadSize);
  EXPECT_EQ(world_.try_add(Sphere3{{0, 0, 0}, 1.0}, kInfinity), WorldStatus::kNotFinite);
  EXPECT_EQ(world_.num_obstacles(), 0);
}

TEST_F(SolidWorld, RefusesHullsBeyondItsCapacityAndARefusedOneTakesNoRoom) {
  const std::vector<Vec3> flat = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  for (int i = 0; i < kCapacity.max_hulls; ++i) {
    EXPECT_EQ(world_.try_add(Hull3{flat}), WorldStatus::kDegenerate);
    EXPECT_EQ(world_.try_add(Hull3{tetrahedron_}), WorldStatus::kOk);
  }
  EXPECT_EQ(world_.try_add(Hull3{tetrahedron_}), WorldStatus::kTooManyVertices);
  EXPECT_EQ(world_.num_obstacles(), kCapacity.max_hulls);
}

TEST_F(SolidWorld, RefusesObstaclesBeyondItsCapacity) {
  for (int i = 0; i < kCapacity.max_obstacles; ++i) {
    ASSERT_EQ(world_.try_add(cube_at({3.0 * i, 0, 0})), WorldStatus::kOk);
  }
  EXPECT_EQ(world_.try_add(cube_at({0, 9, 0})), WorldStatus::kTooManyObstacles);
  EXPECT_EQ(world_.try_add(Hull3{tetrahedron_}), WorldStatus::kTooManyObstacles);
}

TEST_F(SolidWorld, IsEmptyAfterAReset) {
  ASSERT_EQ(world_.try_add(cube_at({0, 0, 0}), 3.0), WorldStatus::kOk);
  ASSERT_EQ(world_.try_add(Hull3{tetrahedron_}), WorldStatus::kOk);
  world_.build();
  world_.reset();
  EXPECT_EQ(world_.num_obstacles(), 0);
  EXPECT_EQ(world_.max_required_m({0.1}), 0.1);
  EXPECT_TRUE(world_.is_clear({{0, 0, 0}, {0, 0, 1}, 1.0}, {0.1}));
  for (int i = 0; i < kCapacity.max_hulls; ++i) {
    EXPECT_EQ(world_.try_add(Hull3{tetrahedron_}), WorldStatus::kOk);
  }
}

TEST_F(SolidWorld, NearestIsTheNearestWithinTheLimit) {
  ASSERT_EQ(world_.try_add(cube_at({5, 0, 0})), WorldStatus::kOk);
  ASSERT_EQ(world_.try_add(cube_at({-4, 0, 0})), WorldStatus::kOk);
  world_.build();
  const Capsule3 body{{0, -1, 0}, {0, 1, 0}, 0.25};
  EXPECT_EQ(world_.nearest(body, 10.0).i_obstacle, 1);
  EXPECT_NEAR(world_.nearest(body, 10.0).distance_m, 3.25, kTol);
  EXPECT_EQ(world_.nearest(body, kInfinity).i_obstacle, 1);
  EXPECT_EQ(world_.nearest(body, 3.0).i_obstacle, kNoObstacle);
  EXPECT_EQ(world_.nearest(body, 3.0).distance_m, 3.0);
  EXPECT_NEAR(world_.nearest({{5, 0, 0}, {5, 0, 9}, 0.25}, 1.0).distance_m, -0.75, kTol);
}

TEST_F(SolidWorld, IsClearKeepsEveryObstaclesOwnMargin) {
  ASSERT_EQ(world_.try_add(cube_at({5, 0, 0})), WorldStatus::kOk);
  ASSERT_EQ(world_.try_add(cube_at({-5, 0, 0}), 2.0), WorldStatus::kOk);
  world_.build();
  const ClearanceRule rule{0.5};
  EXPECT_EQ(world_.required_m(0, rule), 0.5);
  EXPECT_EQ(world_.required_m(1, rule), 2.0);
  EXPECT_EQ(world_.max_required_m(rule), 2.0);
  EXPECT_TRUE(world_.is_clear({{3.7, 0, 0}, {0, 0, 0}, 0.25}, rule));
  EXPECT_FALSE(world_.is_clear({{3.8, 0, 0}, {0, 0, 0}, 0.25}, rule));
  EXPECT_TRUE(world_.is_clear({{-2.2, 0, 0}, {0, 0, 0}, 0.25}, rule));
  EXPECT_FALSE(world_.is_clear({{-2.3, 0, 0}, {0, 0, 0}, 0.25}, rule));
}

TEST_F(SolidWorld, IsNeverClearOfABodyThatIsNotFinite) {
  const auto expect_blocked = [this](const Capsule3& body) {
    for (const double bad : {kNan, kInfinity, -kInfinity}) {
      for (int axis = 0; axis < 3; ++axis) {
        Capsule3 one = body;
        one.p0[axis] = bad;
        EXPECT_FALSE(world_.is_clear(one, {0.1}));
        std::swap(one.p0, one.p1);
        EXPECT_FALSE(world_.is_clear(one, {0.1}));
      }
      EXPECT_FALSE(world_.is_clear({body.p0, body.p1, bad}, {0.1}));
    }
  };
  world_.build();
  expect_blocked({{0, 0, 0}, {0, 0, 1}, 0.5});
  ASSERT_EQ(world_.try_add(cube_at({5, 0, 0})), WorldStatus::kOk);
  world_.build();
  expect_blocked({{0, 0, 0}, {0, 0, 1}, 0.5});
  expect_blocked({{0, 0, 0}, {0, 0, 0}, 0.0});
}

TEST_F(SolidWorld, AnswersAsAScanOfAllObstaclesDoes) {
  oracle::Random random(5);
  for (int i = 0; i < 60; ++i) {
    const Vec3 center = oracle::random_vector(random, 6.0);
    const Pose3 pose{oracle::random_rotation(random), center};
    const double margin_m = random.chance(0.3) ? 0.3 : kDefaultMargin;
    const WorldStatus status = i % 2 == 0 ? world_.try_add(Box3{pose, {1, 0.5, 2}}, margin_m)
                                          : world_.try_add(Cylinder3{pose, 0.5, 1.0}, margin_m);
    ASSERT_EQ(status, WorldStatus::kOk);
  }
  world_.build();
  const ClearanceRule rule{0.1};
  int num_clear = 0;
  for (int round = 0; round < 500; ++round) {
    const Vec3 p = oracle::random_vector(random, 6.0);
    const Capsule3 body{p, p + oracle::random_vector(random, 1.0), 0.2};
    NearestObstacle expected{2.0, kNoObstacle};
    bool is_clear = true;
    for (int i = 0; i < world_.num_obstacles(); ++i) {
      const double distance_m = compute_clearance(world_.obstacle(i), body).distance_m;
      if (distance_m < expected.distance_m) expected = {distance_m, i};
      is_clear = is_clear && distance_m >= world_.required_m(i, rule);
    }
    const NearestObstacle found = world_.nearest(body, 2.0);
    ASSERT_EQ(found.i_obstacle, expected.i_obstacle);
    ASSERT_NEAR(found.distance_m, expected.distance_m, kTol);
    ASSERT_EQ(world_.is_clear(body, rule), is_clear);
    num_clear += is_clear ? 1 : 0;
  }
  EXPECT_GT(num_clear, 50);
  EXPECT_LT(num_clear, 450);
}

TEST_F(SolidWorld, QueriesWithoutTheHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "the guard cannot count under sanitizers";
  ASSERT_EQ(world_.try_add(cube_at({5, 0, 0})), WorldStatus::kOk);
  ASSERT_EQ(world_.try_add(Hull3{tetrahedron_}), WorldStatus::kOk);
  world_.build();
  const Capsule3 body{{2, 0, 0}, {3, 0, 0}, 0.1};
  RtGuard guard;
  const bool is_clear = world_.is_clear(body, {0.1});
  const NearestObstacle nearest = world_.nearest(body, 5.0);
  guard.stop();
  EXPECT_TRUE(is_clear);
  EXPECT_EQ(nearest.i_obstacle, 1);
  EXPECT_EQ(guard.num_allocations(), 0);
  EXPECT_EQ(guard.num_locks(), 0);
}

}  // namespace
}  // namespace sopt
