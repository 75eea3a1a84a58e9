#include "opt/verify/separation3.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "models/space/clearance3.h"
#include "tests/support/oracle3.h"
#include "tests/support/rt_guard.h"

namespace sopt {
namespace {

using oracle::Random;
using oracle::Solid;
using oracle::SolidKind;

constexpr double kFar_m = 1e9;

Separation3 exact(const Convex3& obstacle, std::span<const Vec3> points,
                  const Vec3& first = Vec3::Zero()) {
  return separate(obstacle, points, first, {kFar_m});
}

Convex3 make(const Box3& box) {
  Convex3 shape;
  EXPECT_EQ(try_make_convex(box, shape), WorldStatus::kOk);
  return shape;
}

Convex3 unit_cube() { return make(Box3{{}, Vec3::Ones()}); }

TEST(Separation3, FindsTheFaceOfABox) {
  const Vec3 points[] = {{0.3, 0.2, 2.0}, {-0.2, 0.1, 3.0}};
  const Separation3 found = exact(unit_cube(), points, {1.0, 0.0, 0.0});
  EXPECT_NEAR(found.lower_m, 1.5, 1e-12);
  EXPECT_NEAR(found.upper_m, 1.5, 1e-12);
  EXPECT_NEAR((found.direction - Vec3::UnitZ()).norm(), 0.0, 1e-9);
}

TEST(Separation3, FindsEdgesAndCornersOfABox) {
  const Vec3 edge[] = {{1.5, 1.5, 0.2}};
  EXPECT_NEAR(exact(unit_cube(), edge).lower_m, std::sqrt(2.0), 1e-9);
  const Vec3 corner[] = {{1.5, 1.5, 1.5}};
  EXPECT_NEAR(exact(unit_cube(), corner).lower_m, std::sqrt(3.0), 1e-9);
}

TEST(Separation3, MeasuresOverlapAsNothingApart) {
  const Vec3 points[] = {{-2.0, 0.1, 0.2}, {2.0, 0.1, 0.2}};
  const Separation3 found = exact(unit_cube(), points);
  EXPECT_LE(found.lower_m, 1e-9);
  EXPECT_NEAR(found.upper_m, 0.0, 1e-9);
}

TEST(Separation3, StopsAtABoundThatIsEnough) {
  const Vec3 points[] = {{4.0, 3.0, 0.0}};
  const Separation3 found = separate(unit_cube(), points, {1.0, 0.0, 0.0}, {2.0});
  EXPECT_EQ(found.lower_m, 3.5);  // along the direction it was given
  EXPECT_EQ(found.direction, Vec3::UnitX());
}

TEST(Separation3, GivesUpOnABoundThatCannotBe) {
  const Vec3 points[] = {{4.0, 3.0, 0.0}};
  const Separation3 found = separate(unit_cube(), points, {1.0, 0.0, 0.0}, {100.0, true});
  EXPECT_LT(found.upper_m, 100.0);
  EXPECT_LE(found.lower_m, std::hypot(3.5, 2.5));
  EXPECT_GE(found.upper_m, std::hypot(3.5, 2.5));
}

TEST(Separation3, BoxesHoldTheirObstacles) {
  Random random(5);
  for (int i = 0; i < 500; ++i) {
    const auto kind = static_cast<SolidKind>(i % oracle::kNumSolidKinds);
    const Solid solid = oracle::random_solid(random, kind, 2.0, random.chance(0.5));
    HullData hull;
    Convex3 shape;
    if (!oracle::try_make(solid, hull, shape)) continue;
    const Aabb3 box = box_around(shape);
    const Aabb3 expected = bounding_box(shape);
    EXPECT_NEAR((box.lower - expected.lower).norm(), 0.0, 1e-12);
    EXPECT_NEAR((box.upper - expected.upper).norm(), 0.0, 1e-12);
  }
}

// Segments against all shapes, half of them on a grid; directions kept from other pairs.
TEST(Separation3, NeverExceedsTheDistanceAndReachesItWhenApart) {
  Random random(6);
  Vec3 first = Vec3::Zero();
  int num_apart = 0;
  for (int i = 0; i < 20000; ++i) {
    const bool on_grid = random.chance(0.5);
    const auto kind = static_cast<SolidKind>(i % oracle::kNumSolidKinds);
    const Solid solid = oracle::random_solid(random, kind, 1.0, on_grid);
    HullData hull;
    Convex3 shape;
    if (!oracle::try_make(solid, hull, shape)) continue;
    Vec3 ends[] = {oracle::random_vector(random, 3.0), oracle::random_vector(random, 3.0)};
    if (on_grid) {
      for (Vec3& end : ends) end = end.array().round();
    }
    const Separation3 found = exact(shape, ends, first);
    const double core_m =
        compute_clearance(shape, Capsule3{ends[0], ends[1], 0.0}).distance_m + shape.radius_m;
    ASSERT_NEAR(found.direction.norm(), 1.0, 1e-12);
    ASSERT_LE(found.lower_m, core_m + 1e-12) << i << ' ' << oracle::to_text(solid);
    first = found.direction;
    if (core_m < 1e-6) continue;
    ++num_apart;
    ASSERT_GE(found.lower_m, core_m - 1e-6) << i << ' ' << oracle::to_text(solid);
    ASSERT_GE(found.upper_m, core_m - 1e-12) << i << ' ' << oracle::to_text(solid);
    ASSERT_LE(found.upper_m, core_m + 1e-6) << i << ' ' << oracle::to_text(solid);
  }
  EXPECT_GT(num_apart, 5000);
}

TEST(Separation3, TakesTheHullOfUpToEightPoints) {
  Random random(7);
  int num_apart = 0;
  for (int i = 0; i < 5000; ++i) {
    Convex3 box;
    Convex3 cloud;
    const Pose3 pose{oracle::random_rotation(random), Vec3::Zero()};
    ASSERT_EQ(try_make_convex(Box3{pose, {1.0, 0.5, 0.3}}, box), WorldStatus::kOk);
    const Vec3 middle = oracle::random_vector(random, 2.0);
    std::vector<Vec3> points;
    for (int k = 4 + i % 5; k > 0; --k) {
      points.push_back(middle + oracle::random_vector(random, 0.5));
    }
    HullData storage;
    if (try_make_convex(Hull3{points}, storage, cloud) != WorldStatus::kOk) continue;
    const double core_m = compute_clearance(box, cloud).distance_m;
    const Separation3 found = exact(box, points);
    ASSERT_LE(found.lower_m, core_m + 1e-12) << i;
    if (core_m < 1e-6) continue;
    ++num_apart;
    ASSERT_GE(found.lower_m, core_m - 1e-6) << i;
  }
  EXPECT_GT(num_apart, 1000);
}

TEST(Separation3, UsesNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "nothing is counted in this build";
  const Convex3 cube = unit_cube();
  const Vec3 points[] = {{0.3, 0.2, 2.0}, {-0.2, 1.1, 3.0}};
  (void)exact(cube, points);
  RtGuard guard;
  (void)exact(cube, points);
  guard.stop();
  EXPECT_EQ(guard.num_allocations(), 0);
}

}  // namespace
}  // namespace sopt
