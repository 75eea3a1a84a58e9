#include "models/space/ccd_check.h"

#include <gtest/gtest.h>

#include "tests/support/rt_guard.h"

namespace sopt {
namespace {

template <class Shape>
Convex3 made(const Shape& shape) {
  Convex3 result;
  EXPECT_EQ(try_make_convex(shape, result), WorldStatus::kOk);
  return result;
}

Convex3 cube_at(const Vec3& center) {
  return made(Box3{{Mat3::Identity(), center}, Vec3::Constant(1.0)});
}

TEST(CcdCheck, SeesOverlapAndGap) {
  const Convex3 cube = cube_at(Vec3::Zero());
  EXPECT_TRUE(may_overlap(cube, cube_at({0.5, 0.5, 0.5}), 0.0));
  EXPECT_FALSE(may_overlap(cube, cube_at({1.01, 0, 0}), 0.0));
  EXPECT_TRUE(may_overlap(cube, Capsule3{{0, -3, 0}, {0, 3, 0}, 0.1}, 0.0));
  EXPECT_FALSE(may_overlap(cube, Capsule3{{0.7, -3, 0}, {0.7, 3, 0}, 0.1}, 0.0));
  EXPECT_TRUE(may_overlap(made(Cylinder3{{}, 1.0, 2.0}), made(Sphere3{{1.5, 0, 0}, 0.6}), 0.0));
  EXPECT_FALSE(may_overlap(made(Cylinder3{{}, 1.0, 2.0}), made(Sphere3{{1.7, 0, 0}, 0.6}), 0.0));
}

TEST(CcdCheck, CountsTouchingAsOverlap) {
  EXPECT_TRUE(may_overlap(cube_at(Vec3::Zero()), cube_at({1, 0, 0}), 0.0));
  EXPECT_TRUE(may_overlap(cube_at(Vec3::Zero()), cube_at({1, 1, 1}), 0.0));
  EXPECT_TRUE(may_overlap(made(Sphere3{{0, 0, 0}, 1.0}), made(Sphere3{{0, 2, 0}, 1.0}), 0.0));
}

// Their centers give no direction to begin with.
TEST(CcdCheck, SeesThatConcentricShapesOverlap) {
  const Convex3 cube = cube_at({3, 2, 1});
  EXPECT_TRUE(may_overlap(cube, cube, 0.0));
  EXPECT_TRUE(may_overlap(cube, Capsule3{{3, 2, 0}, {3, 2, 2}, 0.1}, 0.0));
  const Convex3 ball = made(Sphere3{{3, 2, 1}, 1.0});
  EXPECT_TRUE(may_overlap(ball, ball, 0.0));
  EXPECT_TRUE(may_overlap(ball, cube, 0.0));
}

TEST(CcdCheck, CountsADegenerateSearchAsOverlap) {
  // They touch; grown by the pad, libccd's simplex gets the same point twice and it answers 0.
  EXPECT_TRUE(
      may_overlap(made(Capsule3{{0, 0, 0}, {1, -1, 1}, 0.5}), made(Sphere3{{0, 0, -1}, 0.5}), 0.0));
}

TEST(CcdCheck, GrowsShapesByWhatIsAskedFor) {
  const Convex3 cube = cube_at(Vec3::Zero());
  EXPECT_FALSE(may_overlap(cube, cube_at({1.5, 0, 0}), 0.49));
  EXPECT_TRUE(may_overlap(cube, cube_at({1.5, 0, 0}), 0.51));
}

TEST(CcdCheck, SeesAGapJustBeyondItsPad) {
  const double gap_m = 100.0 * kCcdPad_m;
  EXPECT_FALSE(may_overlap(cube_at(Vec3::Zero()), cube_at({1.0 + gap_m, 0, 0}), 0.0));
  EXPECT_FALSE(
      may_overlap(made(Sphere3{{0, 0, 0}, 1.0}), made(Sphere3{{0, 2.0 + gap_m, 0}, 1.0}), 0.0));
}

TEST(CcdCheck, UsesNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "the guard cannot count under sanitizers";
  const Convex3 cube = cube_at(Vec3::Zero());
  const Convex3 other = cube_at({0.5, 0.5, 0.5});
  RtGuard guard;
  const bool overlap = may_overlap(cube, other, 0.0);
  guard.stop();
  EXPECT_TRUE(overlap);
  EXPECT_EQ(guard.num_allocations(), 0);
  EXPECT_EQ(guard.num_locks(), 0);
}

}  // namespace
}  // namespace sopt
