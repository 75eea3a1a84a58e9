// How shapes are checked and stored. Expected numbers by hand.
#include "models/space/shape3.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace sopt {
namespace {

constexpr double kTol = 1e-12;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<Vec3> cube_corners(const Vec3& lower, double size) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) corners.push_back(lower + size * Vec3(i & 1, (i >> 1) & 1, i >> 2));
  return corners;
}

Mat3 about_z(double angle_rad) {
  Mat3 r = Mat3::Identity();
  r.topLeftCorner<2, 2>() << std::cos(angle_rad), -std::sin(angle_rad), std::sin(angle_rad),
      std::cos(angle_rad);
  return r;
}

class Shapes : public testing::Test {
 protected:
  WorldStatus make_hull(const std::vector<Vec3>& vertices) {
    return try_make_convex(Hull3{vertices}, hull_, shape_);
  }

  HullData hull_;
  Convex3 shape_;
};

TEST_F(Shapes, ACapsuleIsASegmentWithARadius) {
  ASSERT_EQ(try_make_convex(Capsule3{{1, 0, 0}, {1, 0, 4}, 0.5}, shape_), WorldStatus::kOk);
  EXPECT_EQ(shape_.kind, CoreKind::kSegment);
  EXPECT_EQ(shape_.center, Vec3(1, 0, 2));
  EXPECT_EQ(shape_.half_m.z(), 2.0);
  EXPECT_EQ(to_capsule(shape_).p0, Vec3(1, 0, 0));
  EXPECT_EQ(to_capsule(shape_).p1, Vec3(1, 0, 4));
  EXPECT_EQ(to_capsule(shape_).radius_m, 0.5);
}

TEST_F(Shapes, ASphereAndACapsuleWithoutLengthArePoints) {
  ASSERT_EQ(try_make_convex(Sphere3{{1, 2, 3}, 0.5}, shape_), WorldStatus::kOk);
  EXPECT_EQ(shape_.kind, CoreKind::kPoint);
  EXPECT_EQ(shape_.center, Vec3(1, 2, 3));
  ASSERT_EQ(try_make_convex(Capsule3{{1, 2, 3}, {1, 2, 3}, 0.5}, shape_), WorldStatus::kOk);
  EXPECT_EQ(shape_.kind, CoreKind::kPoint);
}

TEST_F(Shapes, BoundingBoxesIncludeTurnsAndRadii) {
  ASSERT_EQ(try_make_convex(Box3{{about_z(M_PI / 4), {1, 0, 0}}, {2, 2, 6}}, shape_),
            WorldStatus::kOk);
  const double reach = std::sqrt(2.0);
  EXPECT_TRUE(bounding_box(shape_).lower.isApprox(Vec3(1 - reach, -reach, -3), kTol));
  EXPECT_TRUE(bounding_box(shape_).upper.isApprox(Vec3(1 + reach, reach, 3), kTol));
  ASSERT_EQ(try_make_convex(Cylinder3{{about_z(1.0), {0, 0, 1}}, 0.5, 4}, shape_),
            WorldStatus::kOk);
  EXPECT_TRUE(bounding_box(shape_).lower.isApprox(Vec3(-0.5, -0.5, -1), kTol));
  EXPECT_TRUE(bounding_box(shape_).upper.isApprox(Vec3(0.5, 0.5, 3), kTol));
  ASSERT_EQ(try_make_convex(Capsule3{{0, 0, 0}, {1, 2, 3}, 0.5}, shape_), WorldStatus::kOk);
  EXPECT_TRUE(bounding_box(shape_).upper.isApprox(Vec3(1.5, 2.5, 3.5), kTol));
  ASSERT_EQ(make_hull(cube_corners({1, 1, 1}, 2)), WorldStatus::kOk);
  EXPECT_TRUE(bounding_box(shape_).lower.isApprox(Vec3(1, 1, 1), kTol));
  EXPECT_TRUE(bounding_box(shape_).upper.isApprox(Vec3(3, 3, 3), kTol));
}

TEST_F(Shapes, ACubeAsAHullHasSixPlanesAndThreeEdgeDirections) {
  std::vector<Vec3> vertices = cube_corners({-1, -1, -1}, 2);
  vertices.push_back({0, 0, 0});   // inside
  vertices.push_back({1, 0, 0});   // on a face
  vertices.push_back({1, 1, 0});   // on an edge
  vertices.push_back({1, 1, 1});   // listed twice
  vertices.push_back({-1, 1, 1});  // likewise
  ASSERT_EQ(make_hull(vertices), WorldStatus::kOk);
  EXPECT_EQ(hull_.num_planes, 6);
  EXPECT_EQ(hull_.num_edges, 3);
  for (int i = 0; i < hull_.num_planes; ++i) {
    EXPECT_NEAR(hull_.offset[i], 1.0, kTol);
    EXPECT_NEAR(hull_.normal[i].cwiseAbs().maxCoeff(), 1.0, kTol);
  }
}

TEST_F(Shapes, ATetrahedronHasFourPlanesAndSixEdges) {
  ASSERT_EQ(make_hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}), WorldStatus::kOk);
  EXPECT_EQ(hull_.num_planes, 4);
  EXPECT_EQ(hull_.num_edges, 6);
}

TEST_F(Shapes, ADoubledVertexHidesNoEdges) {
  // Opposite faces of an octahedron share nothing but an end, here listed twice.
  ASSERT_EQ(
      make_hull({{0, 0, 1}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}}),
      WorldStatus::kOk);
  EXPECT_EQ(hull_.num_planes, 8);
  EXPECT_EQ(hull_.num_edges, 6);  // 12, parallel in pairs
  for (int i = 0; i < hull_.num_edges; ++i) EXPECT_NEAR(hull_.edge[i].norm(), 1.0, kTol);
}

TEST_F(Shapes, AHullHasRoomForThirtyTwoVertices) {
  std::vector<Vec3> ball;
  for (int i = 0; i < kMaxHullVertices; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / kMaxHullVertices;
    const double across = std::sqrt(1.0 - z * z);
    ball.push_back({across * std::cos(2.4 * i), across * std::sin(2.4 * i), z});
  }
  ASSERT_EQ(make_hull(ball), WorldStatus::kOk);
  EXPECT_EQ(hull_.num_planes, kMaxHullPlanes);  // all triangles
  ball.push_back({0, 0, 2});
  EXPECT_EQ(make_hull(ball), WorldStatus::kBadVertexCount);
  ball.resize(3);
  EXPECT_EQ(make_hull(ball), WorldStatus::kBadVertexCount);
}

TEST_F(Shapes, AHullWithoutVolumeIsRefused) {
  EXPECT_EQ(make_hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}), WorldStatus::kDegenerate);
  EXPECT_EQ(make_hull({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}), WorldStatus::kDegenerate);
  EXPECT_EQ(make_hull({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}}), WorldStatus::kDegenerate);
  EXPECT_EQ(make_hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, kNan}}), WorldStatus::kNotFinite);
}

TEST_F(Shapes, NumbersThatAreNotFiniteAreRefused) {
  EXPECT_EQ(try_make_convex(Sphere3{{kNan, 0, 0}, 1}, shape_), WorldStatus::kNotFinite);
  EXPECT_EQ(try_make_convex(Sphere3{{0, 0, 0}, kInfinity}, shape_), WorldStatus::kNotFinite);
  EXPECT_EQ(try_make_convex(Capsule3{{0, 0, 0}, {0, kInfinity, 0}, 1}, shape_),
            WorldStatus::kNotFinite);
  EXPECT_EQ(try_make_convex(Box3{{}, {1, kNan, 1}}, shape_), WorldStatus::kNotFinite);
  EXPECT_EQ(try_make_convex(Cylinder3{{}, 1, kNan}, shape_), WorldStatus::kNotFinite);
  EXPECT_EQ(try_make_convex(Box3{{Mat3::Identity(), {0, kNan, 0}}, {1, 1, 1}}, shape_),
            WorldStatus::kNotFinite);
}

TEST_F(Shapes, SizesThatAreNotPositiveAreRefused) {
  EXPECT_EQ(try_make_convex(Sphere3{{0, 0, 0}, 0}, shape_), WorldStatus::kBadSize);
  EXPECT_EQ(try_make_convex(Capsule3{{0, 0, 0}, {1, 0, 0}, -1}, shape_), WorldStatus::kBadSize);
  EXPECT_EQ(try_make_convex(Box3{{}, {1, 0, 1}}, shape_), WorldStatus::kBadSize);
  EXPECT_EQ(try_make_convex(Cylinder3{{}, 0, 1}, shape_), WorldStatus::kBadSize);
  EXPECT_EQ(try_make_convex(Cylinder3{{}, 1, 0}, shape_), WorldStatus::kBadSize);
}

TEST_F(Shapes, MatricesThatDoNotTurnAreRefused) {
  const Mat3 mirror = Vec3(1, 1, -1).asDiagonal();
  EXPECT_EQ(try_make_convex(Box3{{mirror, Vec3::Zero()}, {1, 1, 1}}, shape_),
            WorldStatus::kBadRotation);
  EXPECT_EQ(try_make_convex(Cylinder3{{1.001 * Mat3::Identity(), Vec3::Zero()}, 1, 1}, shape_),
            WorldStatus::kBadRotation);
  EXPECT_EQ(try_make_convex(Box3{{about_z(0.3), Vec3::Zero()}, {1, 1, 1}}, shape_),
            WorldStatus::kOk);
}

TEST_F(Shapes, ARefusedShapeIsNotWritten) {
  shape_.radius_m = 123.0;
  EXPECT_NE(try_make_convex(Sphere3{{0, 0, 0}, -1}, shape_), WorldStatus::kOk);
  EXPECT_NE(make_hull({}), WorldStatus::kOk);
  EXPECT_EQ(shape_.radius_m, 123.0);
}

TEST_F(Shapes, SupportPointsAreTheFarthestOnes) {
  ASSERT_EQ(make_hull(cube_corners({0, 0, 0}, 2)), WorldStatus::kOk);
  EXPECT_EQ(core_support(shape_, {1, -2, 3}), Vec3(1, -1, 1));
  EXPECT_NEAR(core_interval(shape_, {1, -2, 3}).upper, 6.0, kTol);
  EXPECT_NEAR(core_interval(shape_, {1, -2, 3}).lower, -6.0, kTol);
  ASSERT_EQ(try_make_convex(Cylinder3{{}, 5, 2}, shape_), WorldStatus::kOk);
  EXPECT_TRUE(core_support(shape_, {0.3, 0.4, -1}).isApprox(Vec3(3, 4, -1), kTol));
  EXPECT_NEAR(core_interval(shape_, {0.3, 0.4, -1}).upper, 3.5, kTol);
}

}  // namespace
}  // namespace sopt
