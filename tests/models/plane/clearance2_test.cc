// Every expected number here follows by hand from a right triangle or an axis-aligned difference.
#include "models/plane/clearance2.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "models/simd.h"
#include "tests/support/rt_guard.h"
#include "tests/support/test_world.h"

namespace sopt {
namespace {

using oracle::box_between;
using oracle::polygon_of;
using oracle::TestWorld;

constexpr double kTol = 1e-12;
const double kHalfSqrt2 = std::sqrt(0.5);

class Clearance : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(test_world_.world.reset(oracle::far_bounds()), WorldStatus::kOk);
  }

  template <class Shape>
  ConvexView add(const Shape& shape) {
    EXPECT_EQ(test_world_.world.try_add(shape), WorldStatus::kOk);
    test_world_.world.build();
    return test_world_.world.obstacle(test_world_.world.num_obstacles() - 1);
  }
  // [0, 2] x [0, 1].
  ConvexView add_box() { return add(box_between({0.0, 0.0}, {2.0, 1.0})); }

  TestWorld test_world_;
};

void expect_near(const Vec2& value, const Vec2& expected, double tolerance = kTol) {
  EXPECT_NEAR(value.x(), expected.x(), tolerance);
  EXPECT_NEAR(value.y(), expected.y(), tolerance);
}

void expect_clearance(const Clearance2& value, double distance_m, const Vec2& normal,
                      const Vec2& on_obstacle, const Vec2& on_segment) {
  EXPECT_NEAR(value.distance_m, distance_m, kTol);
  expect_near(value.normal, normal);
  expect_near(value.on_obstacle, on_obstacle);
  expect_near(value.on_segment, on_segment);
}

TEST_F(Clearance, OfAPointFromADiscIsAlongTheLineOfCentres) {
  const ConvexView disc = add(Disc{{1.0, 2.0}, 0.5});
  const Vec2 z(4.0, 6.0);
  expect_clearance(compute_clearance(disc, z, z), 4.5, {0.6, 0.8}, {1.3, 2.4}, z);
}

TEST_F(Clearance, OfASegmentFromADiscIsAtTheFootOfThePerpendicular) {
  const ConvexView disc = add(Disc{{0.0, 0.0}, 1.0});
  expect_clearance(compute_clearance(disc, {-5.0, 3.0}, {7.0, 3.0}), 2.0, {0.0, 1.0}, {0.0, 1.0},
                   {0.0, 3.0});
}

TEST_F(Clearance, OfASegmentThatEndsBeforeADiscIsAtItsEnd) {
  const ConvexView disc = add(Disc{{0.0, 0.0}, 1.0});
  expect_clearance(compute_clearance(disc, {9.0, 3.0}, {4.0, 3.0}), 4.0, {0.8, 0.6}, {0.8, 0.6},
                   {4.0, 3.0});
}

TEST_F(Clearance, InsideADiscPointsAwayFromItsCentre) {
  const ConvexView disc = add(Disc{{1.0, 2.0}, 0.5});
  const Vec2 z(1.25, 2.0);
  expect_clearance(compute_clearance(disc, z, z), -0.25, {1.0, 0.0}, {1.5, 2.0}, z);
}

TEST_F(Clearance, AtTheCentreOfADiscIsItsRadiusInSomeDirection) {
  const ConvexView disc = add(Disc{{1.0, 2.0}, 0.5});
  const Vec2 z(1.0, 2.0);
  const Clearance2 clearance = compute_clearance(disc, z, z);
  EXPECT_NEAR(clearance.distance_m, -0.5, kTol);
  EXPECT_NEAR(clearance.normal.norm(), 1.0, kTol);
  expect_near(clearance.on_obstacle, z + 0.5 * clearance.normal);
}

TEST_F(Clearance, OfASegmentThroughTheCentreOfADiscIsAcrossTheSegment) {
  const ConvexView disc = add(Disc{{1.0, 2.0}, 0.5});
  const Clearance2 clearance = compute_clearance(disc, {-3.0, 2.0}, {4.0, 2.0});
  EXPECT_NEAR(clearance.distance_m, -0.5, kTol);
  EXPECT_NEAR(std::abs(clearance.normal.y()), 1.0, kTol);
}

TEST_F(Clearance, FromACornerPointsFromTheCorner) {
  const ConvexView box = add_box();
  const Vec2 z(5.0, 5.0);
  expect_clearance(compute_clearance(box, z, z), 5.0, {0.6, 0.8}, {2.0, 1.0}, z);
}

TEST_F(Clearance, FromAFaceIsPerpendicular) {
  const ConvexView box = add_box();
  const Vec2 z(0.75, 3.0);
  expect_clearance(compute_clearance(box, z, z), 2.0, {0.0, 1.0}, {0.75, 1.0}, z);
}

TEST_F(Clearance, FromATurnedBoxTurnsWithIt) {
  Box2 box = box_between({-1.0, -0.5}, {1.0, 0.5});
  box.angle_rad = std::numbers::pi / 2.0;  // now [-0.5, 0.5] x [-1, 1]
  const ConvexView view = add(box);
  const Vec2 z(2.0, 0.25);
  expect_clearance(compute_clearance(view, z, z), 1.5, {1.0, 0.0}, {0.5, 0.25}, z);
}

TEST_F(Clearance, OfASegmentPassingACornerIsFromTheCornerAcrossTheSegment) {
  const ConvexView box = add_box();
  // x + y = 5; the corner (2, 1) has x + y = 3.
  expect_clearance(compute_clearance(box, {2.0, 3.0}, {5.0, 0.0}), std::sqrt(2.0),
                   {kHalfSqrt2, kHalfSqrt2}, {2.0, 1.0}, {3.0, 2.0});
}

TEST_F(Clearance, OfASegmentParallelToAFaceIsPerpendicular) {
  const ConvexView box = add_box();
  for (const auto& [from, to] : {std::pair{0.5, 1.5}, {-1.0, 3.0}, {1.0, 9.0}}) {
    const Clearance2 clearance = compute_clearance(box, {from, 2.5}, {to, 2.5});
    EXPECT_NEAR(clearance.distance_m, 1.5, kTol);
    expect_near(clearance.normal, {0.0, 1.0});
    expect_near(clearance.on_segment - clearance.on_obstacle, {0.0, 1.5});
    EXPECT_NEAR(clearance.on_obstacle.y(), 1.0, kTol);
    EXPECT_GE(clearance.on_obstacle.x(), -kTol);
    EXPECT_LE(clearance.on_obstacle.x(), 2.0 + kTol);
  }
}

TEST_F(Clearance, InsidePointsToTheShallowestFace) {
  const ConvexView box = add_box();
  const Vec2 below_top(1.0, 0.9);
  expect_clearance(compute_clearance(box, below_top, below_top), -0.1, {0.0, 1.0}, {1.0, 1.0},
                   below_top);
  const Vec2 near_left(0.2, 0.5);
  expect_clearance(compute_clearance(box, near_left, near_left), -0.2, {-1.0, 0.0}, {0.0, 0.5},
                   near_left);
  const Vec2 near_corner(1.75, 0.125);
  expect_clearance(compute_clearance(box, near_corner, near_corner), -0.125, {0.0, -1.0},
                   {1.75, 0.0}, near_corner);
}

TEST_F(Clearance, OnAFaceIsZeroAlongTheFaceNormal) {
  const ConvexView box = add_box();
  const Vec2 z(0.75, 1.0);
  expect_clearance(compute_clearance(box, z, z), 0.0, {0.0, 1.0}, z, z);
  const Clearance2 resting = compute_clearance(box, {0.5, 1.0}, {1.5, 1.0});
  EXPECT_NEAR(resting.distance_m, 0.0, kTol);
  expect_near(resting.normal, {0.0, 1.0});
}

TEST_F(Clearance, NextToAFaceDoesNotAmplifyRounding) {
  const ConvexView box = add_box();
  for (const double gap_m : {1e-16, 1e-13, 1e-11, 9e-10, -1e-16, -1e-13, -1e-11, -9e-10}) {
    const Vec2 z(1.3, 1.0 + gap_m);
    const Clearance2 clearance = compute_clearance(box, z, z);
    EXPECT_NEAR(clearance.distance_m, gap_m, 1e-15) << gap_m;
    expect_near(clearance.normal, {0.0, 1.0}, 1e-9);
  }
}

TEST_F(Clearance, NextToACornerHasANormalThatSeparates) {
  const ConvexView box = add_box();
  for (const double gap_m : {0.0, 1e-15, 1e-12, 1e-10}) {
    const Vec2 z(2.0 + gap_m, 1.0 + 0.5 * gap_m);
    const Clearance2 clearance = compute_clearance(box, z, z);
    EXPECT_NEAR(clearance.distance_m, gap_m * std::sqrt(1.25), 1e-9);
    EXPECT_NEAR(clearance.normal.norm(), 1.0, kTol);
    for (const Vec2& corner : {Vec2(0.0, 0.0), Vec2(2.0, 0.0), Vec2(2.0, 1.0), Vec2(0.0, 1.0)}) {
      EXPECT_LE(clearance.normal.dot(corner), clearance.normal.dot(z) + 1e-9);
    }
  }
}

TEST_F(Clearance, OfASegmentGrazingACornerIsZeroAcrossTheSegment) {
  const ConvexView box = add_box();
  const Clearance2 clearance = compute_clearance(box, {1.0, 2.0}, {3.0, 0.0});
  EXPECT_NEAR(clearance.distance_m, 0.0, kTol);
  expect_near(clearance.normal, {kHalfSqrt2, kHalfSqrt2}, 1e-9);
}

TEST_F(Clearance, OfASegmentCuttingACornerIsTheDepthOfTheCornerAcrossIt) {
  const ConvexView box = add_box();
  // x + y = 2.9 against the corner's 3; any face is 0.5 away.
  const Clearance2 clearance = compute_clearance(box, {1.5, 1.4}, {2.4, 0.5});
  expect_clearance(clearance, -0.1 * kHalfSqrt2, {kHalfSqrt2, kHalfSqrt2}, {2.0, 1.0},
                   {1.95, 0.95});
}

TEST_F(Clearance, OfASegmentCrossingFullyIsTheShortestWayOut) {
  const ConvexView box = add_box();
  const Clearance2 upright = compute_clearance(box, {0.75, -1.0}, {0.75, 2.0});
  EXPECT_NEAR(upright.distance_m, -0.75, kTol);
  expect_near(upright.normal, {-1.0, 0.0});
  const Clearance2 lying = compute_clearance(box, {-1.0, 0.25}, {3.0, 0.25});
  EXPECT_NEAR(lying.distance_m, -0.25, kTol);
  expect_near(lying.normal, {0.0, -1.0});
}

TEST_F(Clearance, OfASegmentEndingInsideIsTheDepthOfItsEnd) {
  const ConvexView box = add_box();
  expect_clearance(compute_clearance(box, {1.0, 3.0}, {1.0, 0.8}), -0.2, {0.0, 1.0}, {1.0, 1.0},
                   {1.0, 0.8});
}

TEST_F(Clearance, OfASegmentWhollyInsideIsTheDepthOfItsDeepEnd) {
  const ConvexView box = add_box();
  const Clearance2 clearance = compute_clearance(box, {0.9, 0.9}, {1.1, 0.7});
  EXPECT_NEAR(clearance.distance_m, -0.3, kTol);
  expect_near(clearance.normal, {0.0, 1.0});
  expect_near(clearance.on_segment, {1.1, 0.7});
}

TEST_F(Clearance, DoesNotDependOnTheDirectionOfTheSegment) {
  const ConvexView box = add_box();
  const ConvexView disc = add(Disc{{4.0, 0.0}, 0.5});
  for (const auto& [p, q] : {std::pair{Vec2(1.0, 3.0), Vec2(5.0, 1.0)},
                             {Vec2(1.0, 3.0), Vec2(1.2, 0.8)},
                             {Vec2(3.0, -1.0), Vec2(2.5, 2.0)}}) {
    for (const ConvexView& view : {box, disc}) {
      const Clearance2 one = compute_clearance(view, p, q);
      const Clearance2 other = compute_clearance(view, q, p);
      EXPECT_NEAR(one.distance_m, other.distance_m, kTol);
      expect_near(one.normal, other.normal);
    }
  }
}

// Regular polygons with every vertex count, so with every amount of padding.
TEST_F(Clearance, IsRightForEveryVertexCount) {
  for (int n = 3; n <= kMaxPolygonVertices; ++n) {
    Polygon2 polygon;
    polygon.num_vertices = n;
    const double slice_rad = 2.0 * std::numbers::pi / n;
    const auto direction = [&](double i) {
      return Vec2(std::cos(slice_rad * i), std::sin(slice_rad * i));
    };
    for (int i = 0; i < n; ++i) polygon.vertices[static_cast<std::size_t>(i)] = 2.0 * direction(i);
    const ConvexView view = add(polygon);
    const double apothem_m = 2.0 * std::cos(0.5 * slice_rad);
    EXPECT_NEAR(compute_clearance(view, Vec2::Zero(), Vec2::Zero()).distance_m, -apothem_m, kTol);
    for (int i = 0; i < n; ++i) {
      const Vec2 off_corner = 5.0 * direction(i);
      expect_clearance(compute_clearance(view, off_corner, off_corner), 3.0, direction(i),
                       2.0 * direction(i), off_corner);
      const Vec2 mid = direction(i + 0.5);
      const Vec2 off_face = 5.0 * mid;
      expect_clearance(compute_clearance(view, off_face, off_face), 5.0 - apothem_m, mid,
                       apothem_m * mid, off_face);
    }
  }
}

TEST_F(Clearance, ViewsArePaddedByTheLastVertex) {
  const ConvexView triangle = add(polygon_of({{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}));
  EXPECT_EQ(triangle.num_vertices, 3);
  ASSERT_EQ(triangle.num_padded % kLanesDouble, 0);
  ASSERT_GE(triangle.num_padded, triangle.num_vertices);
  for (int i = triangle.num_vertices; i < triangle.num_padded; ++i) {
    EXPECT_EQ(triangle.x[i], triangle.x[triangle.num_vertices - 1]);
    EXPECT_EQ(triangle.y[i], triangle.y[triangle.num_vertices - 1]);
  }
}

TEST_F(Clearance, ViewsHoldOutwardUnitNormals) {
  const ConvexView triangle = add(polygon_of({{0.0, 0.0}, {3.0, 0.0}, {3.0, 4.0}}));
  expect_near({triangle.normal_x[0], triangle.normal_y[0]}, {0.0, -1.0});
  expect_near({triangle.normal_x[1], triangle.normal_y[1]}, {1.0, 0.0});
  expect_near({triangle.normal_x[2], triangle.normal_y[2]}, {-0.8, 0.6});
  EXPECT_NEAR(triangle.offset[0], 0.0, kTol);
  EXPECT_NEAR(triangle.offset[1], 3.0, kTol);
  EXPECT_NEAR(triangle.offset[2], 0.0, kTol);
  EXPECT_NEAR(triangle.inv_edge2[2], 1.0 / 25.0, kTol);
}

TEST_F(Clearance, OfARoundedPolygonIsItsCoresLessTheRadius) {
  ConvexView box = add_box();
  box.radius_m = 0.5;
  const Vec2 off_corner(5.0, 5.0);
  expect_clearance(compute_clearance(box, off_corner, off_corner), 4.5, {0.6, 0.8}, {2.3, 1.4},
                   off_corner);
  const Vec2 in_the_rim(1.0, 1.25);
  expect_clearance(compute_clearance(box, in_the_rim, in_the_rim), -0.25, {0.0, 1.0}, {1.0, 1.5},
                   in_the_rim);
  const Vec2 in_the_core(1.0, 0.75);
  expect_clearance(compute_clearance(box, in_the_core, in_the_core), -0.75, {0.0, 1.0}, {1.0, 1.5},
                   in_the_core);
}

TEST_F(Clearance, IsExactFarFromTheOrigin) {
  const ConvexView box = add(box_between({10000.0, -20000.0}, {10002.0, -19999.0}));
  const Vec2 z(10005.0, -19995.0);
  const Clearance2 clearance = compute_clearance(box, z, z);
  EXPECT_NEAR(clearance.distance_m, 5.0, 1e-11);
  expect_near(clearance.normal, {0.6, 0.8}, 1e-11);
}

TEST_F(Clearance, OfAVeryLongSegmentIsExact) {
  const ConvexView box = add_box();
  const Clearance2 clearance = compute_clearance(box, {-1e5, 1.5}, {1e5, 1.5});
  EXPECT_NEAR(clearance.distance_m, 0.5, 1e-10);
  expect_near(clearance.normal, {0.0, 1.0}, 1e-10);
}

TEST_F(Clearance, WithinALimitIsTheSameAsWithout) {
  const ConvexView box = add_box();
  const Vec2 p(4.0, 2.0);
  const Vec2 q(5.0, 5.0);
  const Clearance2 expected = compute_clearance(box, p, q);  // sqrt(5), corner to p
  EXPECT_NEAR(expected.distance_m, std::sqrt(5.0), kTol);
  Clearance2 found;
  ASSERT_TRUE(compute_clearance_within(box, p, q, 2.5, found));
  expect_clearance(found, expected.distance_m, expected.normal, expected.on_obstacle,
                   expected.on_segment);
}

TEST_F(Clearance, BeyondALimitIsRefusedAndNotWritten) {
  const ConvexView box = add_box();
  const Vec2 z(1.0, 3.0);
  Clearance2 found;
  found.distance_m = 123.0;
  EXPECT_FALSE(compute_clearance_within(box, z, z, 1.999, found));
  EXPECT_EQ(found.distance_m, 123.0);
  EXPECT_TRUE(compute_clearance_within(box, z, z, 2.0, found));
  EXPECT_EQ(found.distance_m, 2.0);
}

TEST_F(Clearance, BeyondALimitInTheCornerRegionIsRefused) {
  const ConvexView box = add_box();
  const Vec2 z(3.0, 2.0);  // faces are 1 away, the corner sqrt(2)
  Clearance2 found;
  EXPECT_FALSE(compute_clearance_within(box, z, z, 1.2, found));
  EXPECT_TRUE(compute_clearance_within(box, z, z, 1.5, found));
}

TEST_F(Clearance, IsWithinMeansStrictlyLess) {
  const ConvexView box = add_box();
  const Vec2 off_face(1.0, 3.0);
  EXPECT_FALSE(is_within(box, off_face, off_face, 2.0));
  EXPECT_TRUE(is_within(box, off_face, off_face, 2.0 + 1e-9));
  const Vec2 off_corner(5.0, 5.0);
  EXPECT_FALSE(is_within(box, off_corner, off_corner, 5.0));
  EXPECT_TRUE(is_within(box, off_corner, off_corner, 5.0 + 1e-9));
  const ConvexView disc = add(Disc{{0.0, -8.0}, 1.0});
  EXPECT_FALSE(is_within(disc, {-3.0, -5.0}, {3.0, -5.0}, 2.0));
  EXPECT_TRUE(is_within(disc, {-3.0, -5.0}, {3.0, -5.0}, 2.0 + 1e-9));
}

TEST_F(Clearance, IsWithinNothingWhenItOnlyTouches) {
  const ConvexView box = add_box();
  EXPECT_FALSE(is_within(box, {0.5, 1.0}, {1.5, 1.0}, 0.0));
  EXPECT_TRUE(is_within(box, {0.5, 0.99}, {1.5, 0.99}, 0.0));
  EXPECT_TRUE(is_within(box, {1.0, -1.0}, {1.0, 2.0}, 0.0));
  EXPECT_TRUE(is_within(box, {1.0, 0.5}, {1.0, 0.5}, 0.0));
}

TEST_F(Clearance, UsesNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "the guard cannot count under sanitizers";
  const ConvexView box = add_box();
  RtGuard guard;
  Clearance2 clearance = compute_clearance(box, {1.0, 3.0}, {5.0, 0.5});
  const bool near = compute_clearance_within(box, {1.0, 3.0}, {5.0, 0.5}, 3.0, clearance) &&
                    is_within(box, {1.0, 3.0}, {5.0, 0.5}, 3.0);
  guard.stop();
  EXPECT_TRUE(near);
  EXPECT_EQ(guard.num_allocations(), 0);
  EXPECT_EQ(guard.num_locks(), 0);
}

}  // namespace
}  // namespace sopt
