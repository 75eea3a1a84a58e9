#include "opt/reference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/test_problem.h"

namespace sopt {
namespace {

using oracle::InArena;
using oracle::Random;
using oracle::TestPath;

const Aabb2 kBox = {Vec2::Zero(), Vec2::Constant(10.0)};

TEST(MakeReference, CutsOneMotionIntoEqualSteps) {
  TestPath path({{0.0, 0.0}, {1.0, 0.0}});
  InArena<Trajectory<Point2>> out(100);
  ASSERT_TRUE(make_reference(Point2{}, path.path, 0.3, 0.25, *out));
  ASSERT_EQ(out->horizon(), 4);
  EXPECT_EQ(out->dt_s, 0.25);
  for (int t = 0; t <= 4; ++t) EXPECT_NEAR(out->states[t].x(), 0.25 * t, 1e-15);
}

TEST(MakeReference, DoesNotCutWhatFitsExactly) {
  TestPath path({{0.0, 0.0}, {1.0, 0.0}, {1.0, 0.5}});
  InArena<Trajectory<Point2>> out(100);
  ASSERT_TRUE(make_reference(Point2{}, path.path, 0.5, 0.1, *out));
  EXPECT_EQ(out->horizon(), 3);
}

TEST(MakeReference, FollowsTheVerticesOfRandomPaths) {
  Random random(1);
  InArena<Trajectory<Point2>> out(2000);
  for (int round = 0; round < 500; ++round) {
    std::vector<Vec2> vertices = oracle::random_polyline(random, kBox, 2 + random.index(8));
    // Some motions are shorter than half a step.
    for (std::size_t i = 1; i < vertices.size(); ++i) {
      if (random.chance(0.2)) {
        vertices[i] = vertices[i - 1] + random.uniform(0.0, 0.1) * Vec2(0.6, 0.8);
      }
    }
    const double step = random.uniform(0.05, 1.0);
    TestPath path(vertices);
    ASSERT_TRUE(make_reference(Point2{}, path.path, step, 0.1, *out));
    const auto states = out->states.span();
    ASSERT_GE(out->horizon(), 2);
    EXPECT_EQ(states.front(), vertices.front());
    EXPECT_EQ(states.back(), vertices.back());

    // Walk along: every vertex is a waypoint, waypoints lie on the path at equal distances.
    std::size_t t = 0;
    for (std::size_t i = 1; i < vertices.size(); ++i) {
      const double length = (vertices[i] - vertices[i - 1]).norm();
      std::size_t next = t;
      while (next + 1 < states.size() && states[next] != vertices[i]) ++next;
      ASSERT_EQ(states[next], vertices[i]) << "vertex " << i << " is no waypoint";
      const double num_steps = static_cast<double>(next - t);
      for (std::size_t k = t; k < next; ++k) {
        const double edge = (states[k + 1] - states[k]).norm();
        EXPECT_LE(edge, step * (1.0 + 1e-12));
        if (length >= 0.5 * step && out->horizon() > 2) {
          EXPECT_GE(edge, 0.5 * step * (1.0 - 1e-12));
        }
        EXPECT_NEAR(edge, length / num_steps, 1e-12);
      }
      t = next;
    }
    EXPECT_EQ(t + 1, states.size());
    EXPECT_NEAR(oracle::length_of(states), path.path.length(Point2{}), 1e-9);
  }
}

TEST(MakeReference, TakesAtLeastTwoSteps) {
  InArena<Trajectory<Point2>> out(100);
  for (const double length : {0.0, 1e-12, 0.05, 0.9, 1.0}) {
    TestPath path({{3.0, 4.0}, {3.0 + length, 4.0}});
    ASSERT_TRUE(make_reference(Point2{}, path.path, 1.0, 0.1, *out));
    EXPECT_EQ(out->horizon(), 2);
    EXPECT_EQ(out->states[0], Vec2(3.0, 4.0));
    EXPECT_EQ(out->states[2], Vec2(3.0 + length, 4.0));
  }
}

TEST(MakeReference, RefusesAHorizonBeyondTheCapacity) {
  TestPath path({{0.0, 0.0}, {10.0, 0.0}});
  InArena<Trajectory<Point2>> out(10);
  EXPECT_TRUE(make_reference(Point2{}, path.path, 1.0, 0.1, *out));
  EXPECT_EQ(out->horizon(), 10);
  EXPECT_FALSE(make_reference(Point2{}, path.path, 0.9, 0.1, *out));
  EXPECT_FALSE(make_reference(Point2{}, path.path, 1e-12, 0.1, *out));
  EXPECT_FALSE(make_reference(Point2{}, path.path, 1e-300, 0.1, *out));
}

TEST(MakeReference, ReplacesWhatWasThere) {
  InArena<Trajectory<Point2>> out(100);
  TestPath longer({{0.0, 0.0}, {10.0, 0.0}});
  TestPath shorter({{5.0, 5.0}, {7.0, 5.0}});
  ASSERT_TRUE(make_reference(Point2{}, longer.path, 0.2, 0.1, *out));
  ASSERT_TRUE(make_reference(Point2{}, shorter.path, 1.0, 0.2, *out));
  EXPECT_EQ(out->horizon(), 2);
  EXPECT_EQ(out->states[0], Vec2(5.0, 5.0));
  EXPECT_EQ(out->dt_s, 0.2);
}

}  // namespace
}  // namespace sopt
