// Every expected number here follows by hand from a right triangle or an axis-aligned difference.
#include "models/space/clearance3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "models/space/gjk3.h"
#include "models/space/overlap3.h"
#include "tests/support/rt_guard.h"

namespace sopt {
namespace {

constexpr double kTol = 1e-12;
const double kHalfSqrt2 = std::sqrt(0.5);

template <class Shape>
Convex3 made(const Shape& shape) {
  Convex3 result;
  EXPECT_EQ(try_make_convex(shape, result), WorldStatus::kOk);
  return result;
}

Convex3 box_between(const Vec3& lower, const Vec3& upper) {
  return made(Box3{{Mat3::Identity(), 0.5 * (lower + upper)}, upper - lower});
}
// [0, 4] x [0, 2] x [0, 6].
Convex3 block() { return box_between({0, 0, 0}, {4, 2, 6}); }
// About the z axis, radius 2, z in [-3, 3].
Convex3 pillar() { return made(Cylinder3{{}, 2.0, 6.0}); }

Capsule3 point(const Vec3& z, double radius_m = 0.0) { return {z, z, radius_m}; }
Capsule3 segment(const Vec3& p, const Vec3& q, double radius_m = 0.0) { return {p, q, radius_m}; }

void expect_near(const Vec3& value, const Vec3& expected, double tolerance = kTol) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(value[i], expected[i], tolerance) << "component " << i;
}

void expect_clearance(const Clearance3& value, double distance_m, const Vec3& normal,
                      const Vec3& on_obstacle, const Vec3& on_body) {
  EXPECT_NEAR(value.distance_m, distance_m, kTol);
  expect_near(value.normal, normal);
  expect_near(value.on_obstacle, on_obstacle);
  expect_near(value.on_body, on_body);
}

void expect_distance(const Clearance3& value, double distance_m, const Vec3& normal,
                     double tolerance = kTol) {
  EXPECT_NEAR(value.distance_m, distance_m, tolerance);
  expect_near(value.normal, normal, tolerance);
}

// The 8 corners of the block as a hull.
class HullClearance : public testing::Test {
 protected:
  void SetUp() override {
    for (int i = 0; i < 8; ++i)
      vertices_.push_back({4.0 * (i & 1), 2.0 * ((i >> 1) & 1), 6.0 * (i >> 2)});
    ASSERT_EQ(try_make_convex(Hull3{vertices_}, data_, hull_), WorldStatus::kOk);
  }

  std::vector<Vec3> vertices_;
  HullData data_;
  Convex3 hull_;
};

// --- spheres and capsules

TEST(Clearance3d, OfTwoSpheresIsAlongTheLineOfCentres) {
  const Convex3 ball = made(Sphere3{{1, 2, 3}, 0.5});
  expect_clearance(compute_clearance(ball, point({3, 4, 4}, 0.25)), 2.25, Vec3(2, 2, 1) / 3,
                   Vec3(1, 2, 3) + 0.5 * Vec3(2, 2, 1) / 3,
                   Vec3(3, 4, 4) - 0.25 * Vec3(2, 2, 1) / 3);
}

TEST(Clearance3d, OfTwoSpheresThatOverlapIsNegative) {
  const Convex3 ball = made(Sphere3{{0, 0, 0}, 1.0});
  expect_clearance(compute_clearance(ball, point({0.5, 0, 0}, 1.0)), -1.5, Vec3::UnitX(), {1, 0, 0},
                   {-0.5, 0, 0});
  const Clearance3 same = compute_clearance(ball, point({0, 0, 0}, 1.0));
  EXPECT_NEAR(same.distance_m, -2.0, kTol);
  EXPECT_NEAR(same.normal.norm(), 1.0, kTol);
}

TEST(Clearance3d, OfACapsuleFromASphereIsAtTheFootOrTheEnd) {
  const Convex3 ball = made(Sphere3{{0, 0, 0}, 1.0});
  expect_clearance(compute_clearance(ball, segment({-5, 3, 0}, {7, 3, 0}, 0.5)), 1.5, Vec3::UnitY(),
                   {0, 1, 0}, {0, 2.5, 0});
  expect_clearance(compute_clearance(ball, segment({9, 3, 0}, {4, 3, 0})), 4.0, {0.8, 0.6, 0},
                   {0.8, 0.6, 0}, {4, 3, 0});
}

TEST(Clearance3d, OfSkewCapsulesIsAlongTheCommonPerpendicular) {
  const Convex3 capsule = made(Capsule3{{-2, 0, 0}, {2, 0, 0}, 0.5});
  expect_clearance(compute_clearance(capsule, segment({1, -3, 2}, {1, 3, 2}, 0.25)), 1.25,
                   Vec3::UnitZ(), {1, 0, 0.5}, {1, 0, 1.75});
}

TEST(Clearance3d, OfParallelCapsulesIsTheGapBetweenTheirLines) {
  const Convex3 capsule = made(Capsule3{{0, 0, 0}, {4, 0, 0}, 0.5});
  const Clearance3 c = compute_clearance(capsule, segment({1, 0, 3}, {2, 0, 3}, 0.5));
  expect_distance(c, 2.0, Vec3::UnitZ());
  EXPECT_GE(c.on_body.x(), 1.0);
  EXPECT_LE(c.on_body.x(), 2.0);
  expect_distance(compute_clearance(capsule, segment({7, 4, 0}, {9, 4, 0}, 0.5)), 4.0,
                  {0.6, 0.8, 0.0});
}

TEST(Clearance3d, OfCapsulesWhoseLinesCrossIsTheCommonPerpendicular) {
  const Convex3 capsule = made(Capsule3{{-1, 0, 0}, {1, 0, 0}, 0.5});
  const Clearance3 c = compute_clearance(capsule, segment({0, -1, 0}, {0, 1, 0}, 0.25));
  EXPECT_NEAR(c.distance_m, -0.75, kTol);
  EXPECT_NEAR(std::abs(c.normal.z()), 1.0, kTol);
  const Clearance3 along = compute_clearance(capsule, segment({0, 0, 0}, {3, 0, 0}, 0.25));
  EXPECT_NEAR(along.distance_m, -0.75, kTol);
  EXPECT_NEAR(along.normal.x(), 0.0, kTol);
}

// --- box

TEST(Clearance3d, OfAPointBesideABoxIsItsFaceEdgeOrCorner) {
  expect_clearance(compute_clearance(block(), point({1, 5, 1})), 3.0, Vec3::UnitY(), {1, 2, 1},
                   {1, 5, 1});
  expect_clearance(compute_clearance(block(), point({-3, 1, -4})), 5.0, {-0.6, 0, -0.8}, {0, 1, 0},
                   {-3, 1, -4});
  expect_clearance(compute_clearance(block(), point({5, 4, 8}, 0.5)), 2.5, Vec3(1, 2, 2) / 3,
                   {4, 2, 6}, Vec3(5, 4, 8) - 0.5 * Vec3(1, 2, 2) / 3);
}

TEST(Clearance3d, OfAPointInABoxIsItsShallowestFace) {
  expect_clearance(compute_clearance(block(), point({1.5, 0.5, 3}, 0.25)), -0.75, -Vec3::UnitY(),
                   {1.5, 0, 3}, {1.5, 0.75, 3});
}

TEST(Clearance3d, OfASegmentPastABoxEdgeIsTheCommonPerpendicular) {
  // Crosses above the edge x = 4, z = 6 in direction (1, 0, -1) + something along y.
  const Vec3 above(4.0 + 3.0 * kHalfSqrt2, 1.0, 6.0 + 3.0 * kHalfSqrt2);
  const Vec3 along(1.0, 0.2, -1.0);
  expect_clearance(compute_clearance(block(), segment(above - along, above + along)), 3.0,
                   {kHalfSqrt2, 0, kHalfSqrt2}, {4, 1, 6}, above);
}

TEST(Clearance3d, OfASegmentParallelToAFaceIsTheGap) {
  const Clearance3 c = compute_clearance(block(), segment({1, 1, 8}, {3, 1, 8}, 0.5));
  expect_distance(c, 1.5, Vec3::UnitZ());
  EXPECT_GE(c.on_body.x(), 1.0);
  EXPECT_LE(c.on_body.x(), 3.0);
  expect_distance(compute_clearance(block(), segment({-9, 1, 8}, {9, 1, 8})), 2.0, Vec3::UnitZ());
}

TEST(Clearance3d, OfASegmentThroughABoxIsTheShallowestWayOut) {
  const Clearance3 c = compute_clearance(block(), segment({2, 0.5, -9}, {2, 0.5, 9}, 0.25));
  expect_distance(c, -0.75, -Vec3::UnitY());
  EXPECT_NEAR(c.on_obstacle.y(), 0.0, kTol);
  EXPECT_GE(c.on_obstacle.z(), 0.0);
  EXPECT_LE(c.on_obstacle.z(), 6.0);
}

TEST(Clearance3d, OfASegmentThatCutsAnEdgeIsPushedOutAcrossTheEdge) {
  // Through (3.9, 1, 6) and (4, 1, 5.9): 0.05 sqrt(2) under the edge.
  expect_distance(compute_clearance(block(), segment({2.9, 1.1, 7}, {5.0, 0.9, 4.9})),
                  -0.1 * kHalfSqrt2, {kHalfSqrt2, 0, kHalfSqrt2});
}

TEST(Clearance3d, OfWhatOnlyTouchesABoxHasAFaceNormal) {
  expect_distance(compute_clearance(block(), point({1, 2, 3})), 0.0, Vec3::UnitY());
  expect_distance(compute_clearance(block(), segment({1, 2, 3}, {3, 2, 3}, 0.5)), -0.5,
                  Vec3::UnitY());
  const Clearance3 corner =
      compute_clearance(block(), point(Vec3(4, 2, 6) + Vec3::Constant(1e-11)));
  EXPECT_NEAR(corner.distance_m, 0.0, 1e-9);
  EXPECT_NEAR(corner.normal.cwiseAbs().maxCoeff(), 1.0, kTol);
}

// --- cylinder

TEST(Clearance3d, OfAPointBesideACylinderIsItsMantleCapOrRim) {
  expect_clearance(compute_clearance(pillar(), point({3, 4, 1})), 3.0, {0.6, 0.8, 0}, {1.2, 1.6, 1},
                   {3, 4, 1});
  expect_clearance(compute_clearance(pillar(), point({1, 0, -7}, 0.5)), 3.5, -Vec3::UnitZ(),
                   {1, 0, -3}, {1, 0, -6.5});
  expect_clearance(compute_clearance(pillar(), point({0, 5, 7})), 5.0, {0, 0.6, 0.8}, {0, 2, 3},
                   {0, 5, 7});
}

TEST(Clearance3d, OfAPointInACylinderIsItsMantleOrCap) {
  expect_clearance(compute_clearance(pillar(), point({0, 1.5, 0})), -0.5, Vec3::UnitY(), {0, 2, 0},
                   {0, 1.5, 0});
  expect_clearance(compute_clearance(pillar(), point({0, 0, 2.5})), -0.5, Vec3::UnitZ(), {0, 0, 3},
                   {0, 0, 2.5});
}

TEST(Clearance3d, OfASegmentPastACylinderIsFromItsMantle) {
  expect_clearance(compute_clearance(pillar(), segment({5, -9, 0}, {5, 9, 0}, 1.0)), 2.0,
                   Vec3::UnitX(), {2, 0, 0}, {4, 0, 0});
  expect_distance(compute_clearance(pillar(), segment({5, 0, -2}, {5, 0, 2})), 3.0, Vec3::UnitX());
}

TEST(Clearance3d, OfASegmentPastARimIsTheCommonPerpendicular) {
  // Nearest to (2, 0, 3), where the rim runs along y, in the direction (3, 0, 4) / 5.
  const Vec3 nearest(5, 0, 7);
  expect_clearance(
      compute_clearance(pillar(), segment(nearest - Vec3(0, 2, 0), nearest + Vec3(0, 2, 0))), 5.0,
      {0.6, 0, 0.8}, {2, 0, 3}, nearest);
  const Vec3 tilted(4, 0.5, -3);  // across the normal
  expect_distance(compute_clearance(pillar(), segment(nearest - tilted, nearest + tilted)), 5.0,
                  {0.6, 0, 0.8});
}

TEST(Clearance3d, OfASegmentThroughACylinderIsTheShallowestWayOut) {
  expect_distance(compute_clearance(pillar(), segment({1.5, -9, 0}, {1.5, 9, 0}, 0.5)), -1.0,
                  Vec3::UnitX());
  expect_distance(compute_clearance(pillar(), segment({-9, 0, 2.5}, {9, 0, 2.5})), -0.5,
                  Vec3::UnitZ());
  // Level and under the cap by 0.4, the rim seen from the side is a straight line.
  expect_distance(compute_clearance(pillar(), segment({1.9, -9, 2.6}, {1.9, 9, 2.6})), -0.1,
                  Vec3::UnitX());
}

TEST(Clearance3d, OfASegmentThatCutsARimIsPushedOutAcrossIt) {
  // In the plane y = 0 the rim is the corner (2, 3); the segment in direction (1, 0, -1) passes
  // 0.1 under it. Seen along the segment the rim is an ellipse whose end is that corner.
  const Vec3 under = Vec3(2, 0, 3) - 0.1 * Vec3(kHalfSqrt2, 0, kHalfSqrt2);
  const Vec3 along(1, 0, -1);
  expect_distance(compute_clearance(pillar(), segment(under - along, under + along)), -0.1,
                  {kHalfSqrt2, 0, kHalfSqrt2}, 1e-8);
}

// --- two boxes

TEST(Clearance3d, OfBoxesIsFaceToFaceEdgeToEdgeOrCornerToCorner) {
  expect_distance(compute_clearance(block(), box_between({7, -9, -9}, {9, 9, 9})), 3.0,
                  Vec3::UnitX());
  expect_distance(compute_clearance(block(), box_between({7, 6, 1}, {9, 9, 2})), 5.0,
                  {0.6, 0.8, 0});
  expect_clearance(compute_clearance(block(), box_between({5, 4, 8}, {9, 9, 9})), 3.0,
                   Vec3(1, 2, 2) / 3, {4, 2, 6}, {5, 4, 8});
}

TEST(Clearance3d, OfBoxesThatOverlapIsTheShallowestAxis) {
  const Clearance3 c = compute_clearance(block(), box_between({3.5, -9, 1}, {9, 9, 2}));
  expect_distance(c, -0.5, Vec3::UnitX());
  EXPECT_NEAR(c.on_obstacle.x(), 4.0, kTol);
  EXPECT_NEAR(c.on_body.x(), 3.5, kTol);
}

TEST(Clearance3d, OfBoxesFaceOnFaceIsNoughtAlongTheFace) {
  expect_distance(compute_clearance(block(), box_between({4, 0, 0}, {6, 2, 6})), 0.0,
                  Vec3::UnitX());
}

TEST(Clearance3d, OfCrossedBoxEdgesIsAlongTheirCross) {
  // Both cubes turned by 45 degrees, a about z and b about x: edges x = sqrt2 / 2, along z, of a
  // and along x of b do not meet; the edge along z of a faces the edge along y of b.
  Mat3 about_z;
  about_z << kHalfSqrt2, -kHalfSqrt2, 0, kHalfSqrt2, kHalfSqrt2, 0, 0, 0, 1;
  Mat3 about_y;
  about_y << kHalfSqrt2, 0, kHalfSqrt2, 0, 1, 0, -kHalfSqrt2, 0, kHalfSqrt2;
  const Convex3 a = made(Box3{{about_z, Vec3::Zero()}, {1, 1, 1}});
  for (const double gap : {0.25, -0.125}) {
    const Convex3 b = made(Box3{{about_y, {2.0 * kHalfSqrt2 + gap, 0, 0}}, {1, 1, 1}});
    expect_clearance(compute_clearance(a, b), gap, Vec3::UnitX(), {kHalfSqrt2, 0, 0},
                     {kHalfSqrt2 + gap, 0, 0});
  }
}

// --- hull

TEST_F(HullClearance, IsThatOfTheBoxItDescribes) {
  const std::vector<Capsule3> bodies = {
      point({5, 4, 8}, 0.5),          point({1, 5, 1}),
      point({1.5, 0.5, 3}),           segment({2, 0.5, -9}, {2, 0.5, 9}, 0.25),
      segment({1, 1, 8}, {3, 1, 8}),  segment({2.9, 1.1, 7}, {5.0, 0.9, 4.9}),
      segment({7, 6, -3}, {7, 6, 9}), segment({1, 2, 3}, {3, 2, 3}, 0.5)};
  for (const Capsule3& body : bodies) {
    const Clearance3 expected = compute_clearance(block(), body);
    const Clearance3 found = compute_clearance(hull_, body);
    expect_distance(found, expected.distance_m, expected.normal, 1e-11);
    expect_near(found.on_body - found.on_obstacle, found.distance_m * found.normal);
  }
}

TEST_F(HullClearance, OfABoxWorksFromEitherSide) {
  const Convex3 other = box_between({3.5, -9, 1}, {9, 9, 2});
  expect_distance(compute_clearance(hull_, other), -0.5, Vec3::UnitX());
  expect_distance(compute_clearance(other, hull_), -0.5, -Vec3::UnitX());
  expect_distance(compute_clearance(hull_, box_between({5, 4, 8}, {9, 9, 9})), 3.0,
                  Vec3(1, 2, 2) / 3);
}

TEST(Clearance3d, OfACapsuleFromTheOtherSideIsTurnedRound) {
  const Convex3 capsule = made(Capsule3{{2, 0.5, -9}, {2, 0.5, 9}, 0.25});
  const Clearance3 c = compute_clearance(capsule, block());
  expect_distance(c, -0.75, Vec3::UnitY());
  EXPECT_NEAR(c.on_body.y(), 0.0, kTol);
}

// --- cylinder against the others

TEST(Clearance3d, OfACylinderFromABoxIsExactWhenApart) {
  expect_distance(compute_clearance(pillar(), box_between({5, -1, -1}, {6, 1, 1})), 3.0,
                  Vec3::UnitX(), 1e-9);
  expect_distance(compute_clearance(pillar(), box_between({-9, -9, 4}, {9, 9, 5})), 1.0,
                  Vec3::UnitZ(), 1e-9);
}

TEST(Clearance3d, OfACylinderThatOverlapsABoxIsNeverTooLarge) {
  const Clearance3 c = compute_clearance(pillar(), box_between({1.5, -9, -9}, {6, 9, 9}));
  EXPECT_NEAR(c.distance_m, -0.5, 1e-9);
  expect_near(c.normal, Vec3::UnitX(), 1e-6);
}

TEST(WidestAxis, OfBoxesEndsEarlyOnlyWhenThatIsEnough) {
  const Convex3 other = box_between({5, 5, 0}, {6, 6, 1});  // gaps: x 1, y 3
  EXPECT_NEAR(widest_axis(block(), other, Vec3::Zero()).separation_m, 3.0, kTol);
  EXPECT_GT(widest_axis_of_boxes(block(), other, 0.5).separation_m, 0.5);
}

// --- accuracy, limits

TEST(Clearance3d, IsExactFarFromTheOrigin) {
  const Vec3 far(10000, -20000, 30000);
  const Convex3 box = box_between(far, far + Vec3(4, 2, 6));
  expect_distance(compute_clearance(box, point(far + Vec3(5, 4, 8))), 3.0, Vec3(1, 2, 2) / 3,
                  1e-11);
  expect_distance(compute_clearance(box, box_between(far + Vec3(5, 4, 8), far + Vec3(9, 9, 9))),
                  3.0, Vec3(1, 2, 2) / 3, 1e-11);
}

TEST(Clearance3d, OfAVeryLongSegmentIsExact) {
  expect_distance(compute_clearance(block(), segment({-1e5, 1, 8}, {1e5, 1, 8})), 2.0,
                  Vec3::UnitZ(), 1e-10);
  expect_distance(compute_clearance(pillar(), segment({5, -1e5, 0}, {5, 1e5, 0})), 3.0,
                  Vec3::UnitX(), 1e-9);
}

TEST(Clearance3d, BeyondALimitIsRefusedAndNotWritten) {
  const std::vector<Convex3> bodies = {made(Capsule3{{5, 4, 8}, {9, 9, 9}, 1.0}),
                                       box_between({4.5, 3, 7}, {9, 9, 9})};
  for (const Convex3& body : bodies) {
    const double distance_m = compute_clearance(block(), body).distance_m;
    EXPECT_NEAR(distance_m, body.is_round() ? 2.0 : 1.5, kTol);
    Clearance3 found;
    found.distance_m = 123.0;
    EXPECT_FALSE(compute_clearance_within(block(), body, distance_m - 1e-9, found));
    EXPECT_EQ(found.distance_m, 123.0);
    ASSERT_TRUE(compute_clearance_within(block(), body, distance_m + 1e-9, found));
    EXPECT_NEAR(found.distance_m, distance_m, kTol);
  }
}

TEST(Clearance3d, IsWithinMeansStrictlyLess) {
  const Capsule3 off_face = point({1, 5, 1}, 0.5);
  EXPECT_FALSE(is_within(block(), off_face, 2.5));
  EXPECT_TRUE(is_within(block(), off_face, 2.5 + 1e-9));
  EXPECT_FALSE(is_within(block(), point({1, 2, 3}), 0.0));
  EXPECT_TRUE(is_within(block(), point({1, 1.99, 3}), 0.0));
  EXPECT_FALSE(is_within(block(), box_between({4, 0, 0}, {6, 2, 6}), 0.0));
  EXPECT_TRUE(is_within(block(), box_between({3.99, 0, 0}, {6, 2, 6}), 0.0));
}

TEST_F(HullClearance, IsWithinMeansStrictlyLess) {
  EXPECT_FALSE(is_within(hull_, point({1, 5, 1}, 0.5), 2.5));
  EXPECT_TRUE(is_within(hull_, point({1, 5, 1}, 0.5), 2.5 + 1e-9));
  EXPECT_FALSE(is_within(hull_, point({1, 2, 3}), 0.0));
  EXPECT_TRUE(is_within(hull_, point({1, 1.99, 3}), 0.0));
  EXPECT_TRUE(is_within(hull_, point({1, 2.2, 3}, 0.5), 0.0));
}

TEST_F(HullClearance, WhatIsNotANumberIsWithin) {
  const Capsule3 nowhere = point({std::numeric_limits<double>::quiet_NaN(), 0, 0});
  for (const Convex3& shape : {block(), pillar(), hull_, made(Sphere3{{0, 0, 0}, 1.0})}) {
    EXPECT_TRUE(is_within(shape, nowhere, 0.0));
  }
}

TEST_F(HullClearance, UsesNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "the guard cannot count under sanitizers";
  const std::vector<Convex3> shapes = {block(), pillar(), hull_, made(Sphere3{{0, 0, 0}, 1.0}),
                                       box_between({2, 1, 1}, {9, 9, 9})};
  double sum = 0.0;
  RtGuard guard;
  for (const Convex3& a : shapes) {
    for (const Convex3& b : shapes) {
      Convex3 apart = b;
      apart.center.x() += 30.0;
      sum += compute_clearance(a, b).distance_m + compute_clearance(a, apart).distance_m;
    }
    sum += is_within(a, segment({1, 1, 1}, {2, 5, 1}, 0.5), 0.1) ? 1.0 : 0.0;
  }
  guard.stop();
  EXPECT_TRUE(std::isfinite(sum));
  EXPECT_EQ(guard.num_allocations(), 0);
  EXPECT_EQ(guard.num_locks(), 0);
}

}  // namespace
}  // namespace sopt
