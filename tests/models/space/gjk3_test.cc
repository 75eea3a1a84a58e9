#include "models/space/gjk3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "models/space/overlap3.h"
#include "tests/support/oracle3.h"

namespace sopt {
namespace {

constexpr double kTol = 1e-12;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Convex3 box_between(const Vec3& lower, const Vec3& upper) {
  Convex3 shape;
  EXPECT_EQ(try_make_convex(Box3{{Mat3::Identity(), 0.5 * (lower + upper)}, upper - lower}, shape),
            WorldStatus::kOk);
  return shape;
}

TEST(Gjk, OfBoxesFaceToFaceEndsOnTheFaces) {
  const Convex3 a = box_between({0, 0, 0}, {1, 1, 1});
  const Convex3 b = box_between({3, -5, -5}, {4, 5, 5});
  const GjkResult r = compute_core_distance(a, b, kInfinity, Vec3::Zero());
  ASSERT_EQ(r.status, GjkStatus::kApart);
  EXPECT_NEAR(r.distance_m, 2.0, kTol);
  EXPECT_TRUE(r.normal.isApprox(Vec3::UnitX(), kTol));
  EXPECT_NEAR(r.on_a.x(), 1.0, kTol);
  EXPECT_NEAR(r.on_b.x(), 3.0, kTol);
}

TEST(Gjk, OfBoxesCornerToCornerIsTheDiagonal) {
  const Convex3 a = box_between({0, 0, 0}, {1, 1, 1});
  const Convex3 b = box_between({2, 3, 3}, {4, 5, 5});
  const GjkResult r = compute_core_distance(a, b, kInfinity, Vec3::Zero());
  ASSERT_EQ(r.status, GjkStatus::kApart);
  EXPECT_NEAR(r.distance_m, 3.0, kTol);
  EXPECT_TRUE(r.normal.isApprox(Vec3(1, 2, 2) / 3, kTol));
  EXPECT_TRUE(r.on_a.isApprox(Vec3(1, 1, 1), kTol));
  EXPECT_TRUE(r.on_b.isApprox(Vec3(2, 3, 3), kTol));
}

TEST(Gjk, DoesNotDependOnTheFirstGuess) {
  const Convex3 a = box_between({0, 0, 0}, {1, 1, 1});
  const Convex3 b = box_between({2, 3, 3}, {4, 5, 5});
  for (const Vec3& first : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0.1, -3, 2), Vec3(1, 2, 2)}) {
    const GjkResult r = compute_core_distance(a, b, kInfinity, first);
    ASSERT_EQ(r.status, GjkStatus::kApart);
    EXPECT_NEAR(r.distance_m, 3.0, kTol);
  }
}

TEST(Gjk, SaysTouchingWhenCoresOverlapOrMeet) {
  const Convex3 a = box_between({0, 0, 0}, {1, 1, 1});
  for (const double at : {0.2, 1.0}) {  // inside, and face on face
    const Convex3 b = box_between({at, 0, 0}, {at + 1, 1, 1});
    EXPECT_EQ(compute_core_distance(a, b, kInfinity, Vec3::Zero()).status, GjkStatus::kTouching);
  }
  EXPECT_EQ(compute_core_distance(a, a, kInfinity, Vec3::Zero()).status, GjkStatus::kTouching);
}

TEST(Gjk, EndsEarlyBeyondALimitWithAProvenBound) {
  const Convex3 a = box_between({0, 0, 0}, {1, 1, 1});
  const Convex3 b = box_between({3, 0, 0}, {4, 1, 1});
  const GjkResult r = compute_core_distance(a, b, 1.5, Vec3::Zero());
  ASSERT_EQ(r.status, GjkStatus::kBeyondLimit);
  EXPECT_GT(r.distance_m, 1.5);
  EXPECT_LE(r.distance_m, 2.0 + kTol);
  EXPECT_EQ(compute_core_distance(a, b, 2.0 + kTol, Vec3::Zero()).status, GjkStatus::kApart);
}

TEST(Gjk, OfSkewCylindersIsTheGapOfTheirMantles) {
  Mat3 lying;
  lying << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  Convex3 a;
  Convex3 b;
  ASSERT_EQ(try_make_convex(Cylinder3{{}, 1, 10}, a), WorldStatus::kOk);
  ASSERT_EQ(try_make_convex(Cylinder3{{lying, {0, 4, 0.3}}, 2, 10}, b), WorldStatus::kOk);
  const GjkResult r = compute_core_distance(a, b, kInfinity, Vec3::Zero());
  ASSERT_EQ(r.status, GjkStatus::kApart);
  EXPECT_NEAR(r.distance_m, 1.0, 1e-9);
  EXPECT_TRUE(r.normal.isApprox(Vec3::UnitY(), 1e-8));
}

TEST(Gjk, NeverExceedsItsCapAndItsBoundHolds) {
  oracle::Random random(11);
  for (int i = 0; i < 2000; ++i) {
    const oracle::Solid a = oracle::random_solid(random, oracle::SolidKind::kCylinder, 1, i % 2);
    const oracle::Solid b = oracle::random_solid(random, oracle::SolidKind::kCylinder, 3, i % 2);
    HullData unused;
    Convex3 shape_a;
    Convex3 shape_b;
    ASSERT_TRUE(oracle::try_make(a, unused, shape_a) && oracle::try_make(b, unused, shape_b));
    const GjkResult r = compute_core_distance(shape_a, shape_b, kInfinity, Vec3::Zero());
    ASSERT_LE(r.num_iterations, kMaxGjkIterations);
    if (r.status < GjkStatus::kApart) continue;
    ASSERT_LE(r.distance_m, oracle::gap_along(a, b, r.normal) + 1e-9) << to_text(a) << to_text(b);
  }
}

TEST(Gjk, OfWhatIsNotANumberEnds) {
  Convex3 a = box_between({0, 0, 0}, {1, 1, 1});
  const Convex3 b = a;
  a.center.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_LE(compute_core_distance(a, b, kInfinity, Vec3::Zero()).num_iterations, kMaxGjkIterations);
}

}  // namespace
}  // namespace sopt
