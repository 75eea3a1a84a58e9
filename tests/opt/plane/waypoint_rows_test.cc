#include "opt/plane/waypoint_rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/rt_guard.h"
#include "tests/support/test_problem.h"
#include "tests/support/test_world.h"

namespace sopt {
namespace {

using oracle::InArena;
using oracle::Outline;
using oracle::Random;
using oracle::Scene;
using oracle::TestWorld;

using Points = std::vector<Vec2>;

constexpr double kTol_m = 1e-9;
const Aabb2 kBounds = {Vec2::Zero(), Vec2::Constant(10.0)};

class WaypointRowsTest : public ::testing::Test {
 protected:
  void use(const Scene& scene) {
    scene_ = scene;
    ASSERT_EQ(oracle::fill(scene, test_.world), WorldStatus::kOk);
    outlines_.clear();
    for (const auto& obstacle : scene.obstacles) {
      outlines_.push_back(oracle::outline_of(obstacle.shape));
    }
  }
  bool make(RowMode mode, const Points& states, const Window& window, double trust_m) {
    return make_waypoint_rows(mode, robot_, test_.world, profile_, states, window, trust_m, *rows_,
                              num_queries_);
  }
  std::vector<PointRows::Row> rows_at(int t) {
    std::vector<PointRows::Row> found;
    for (int id = 0; id < rows_->num_ids(); ++id) {
      if (rows_->is_free(id) && rows_->row(id).t == t) found.push_back(rows_->row(id));
    }
    return found;
  }
  double inset_m(std::size_t i, const ClearanceRule& rule) const {
    return robot_.radius_m + rule.required_m(scene_.obstacles[i].margin_m);
  }
  // True when the row is n . z >= n . o + b of obstacle i: a plane that keeps all of the obstacle
  // behind it, b away, and is as far from z as the obstacle.
  bool is_row_of(std::size_t i, const PointRows::Row& row, const Vec2& z,
                 const ClearanceRule& rule) const {
    const Outline& outline = outlines_[i];
    double support = -oracle::kFar_m;
    for (const Vec2& v : outline.vertices) support = std::max(support, row.normal.dot(v));
    const double b = inset_m(i, rule);
    const double distance_m = oracle::point_distance(outline, z);
    return std::abs(row.normal.norm() - 1.0) <= kTol_m &&
           std::abs(support + outline.radius_m + b - row.bound) <= kTol_m &&
           std::abs(row.normal.dot(z) - row.bound - (distance_m - b)) <= kTol_m;
  }
  double nearest_m(const Vec2& z) const {
    double nearest = oracle::kFar_m;
    for (const Outline& outline : outlines_) {
      nearest = std::min(nearest, oracle::point_distance(outline, z));
    }
    return nearest;
  }
  // Of some obstacle at the smallest distance: there may be several.
  bool is_row_of_nearest(const PointRows::Row& row, const Vec2& z, const ClearanceRule& rule) {
    const double nearest = nearest_m(z);
    for (std::size_t i = 0; i < outlines_.size(); ++i) {
      const bool is_nearest = oracle::point_distance(outlines_[i], z) <= nearest + kTol_m;
      if (is_nearest && is_row_of(i, row, z, rule)) return true;
    }
    return false;
  }
  Scene random_world(Random& random, int max_obstacles) {
    Scene scene =
        oracle::random_scene(random, kBounds, random.index(max_obstacles), random.uniform(0.1, 2));
    for (auto& obstacle : scene.obstacles) {
      if (random.chance(0.3)) obstacle.margin_m = random.uniform(0.0, 0.4);
    }
    return scene;
  }

  Point2 robot_{0.1};
  TestWorld test_{{256, 4096}};
  Scene scene_;
  std::vector<Outline> outlines_;
  MarginProfile profile_ = oracle::plain_profile(0.1);
  InArena<PointRows> rows_{60, 4096};
  std::int64_t num_queries_ = 0;
};

TEST_F(WaypointRowsTest, LabelMapPutsOnePlaneBetweenAWaypointAndADisc) {
  use({kBounds, {{oracle::Shape(Disc{{5.0, 4.0}, 0.5}), kDefaultMargin}}});
  ASSERT_TRUE(make(RowMode::kLabelMap, {{4.0, 5.0}, {5.0, 5.0}, {6.0, 5.0}}, {0, 2, 0, true}, 1.0));
  ASSERT_EQ(rows_at(1).size(), 1U);
  EXPECT_NEAR(rows_at(1)[0].normal.x(), 0.0, kTol_m);
  EXPECT_NEAR(rows_at(1)[0].normal.y(), 1.0, kTol_m);
  EXPECT_NEAR(rows_at(1)[0].bound, 4.5 + 0.1 + 0.1, kTol_m);
  EXPECT_EQ(rows_->num_steps(), 2);
  EXPECT_EQ(rows_->position(0), Vec2(4.0, 5.0));
  EXPECT_EQ(rows_->position(2), Vec2(6.0, 5.0));
  EXPECT_GT(num_queries_, 0);
}

TEST_F(WaypointRowsTest, LabelMapTakesExactlyTheNearestObstacle) {
  Random random(1);
  int num_inside = 0;
  int num_far = 0;
  for (int round = 0; round < 400; ++round) {
    robot_.radius_m = random.chance(0.3) ? 0.0 : random.uniform(0.0, 0.3);
    profile_.rule.margin_m = random.uniform(0.0, 0.2);
    use(random_world(random, random.chance(0.3) ? 4 : 60));
    const Points states = oracle::random_polyline(random, kBounds, 12);
    const double trust_m = std::pow(10.0, random.uniform(-4.0, 0.5));
    ASSERT_TRUE(make(RowMode::kLabelMap, states, {0, 11, 0, true}, trust_m));
    for (int t = 1; t < 11; ++t) {
      const Vec2& z = states[static_cast<std::size_t>(t)];
      const auto rows = rows_at(t);
      ASSERT_EQ(rows.size(), scene_.obstacles.empty() ? 0U : 1U);
      if (rows.empty()) continue;
      EXPECT_TRUE(is_row_of_nearest(rows[0], z, profile_.rule))
          << oracle::to_text(scene_) << oracle::to_text(z) << " trust " << trust_m;
      num_inside += nearest_m(z) < 0.0 ? 1 : 0;
      num_far += nearest_m(z) > 4.0 * trust_m ? 1 : 0;
    }
    EXPECT_TRUE(rows_at(0).empty());
    EXPECT_TRUE(rows_at(11).empty());
  }
  EXPECT_GT(num_inside, 100);
  EXPECT_GT(num_far, 100);
}

TEST_F(WaypointRowsTest, LabelMapLooksPastObstaclesBeyondTheBounds) {
  // Nothing but an obstacle outside, further away than the trust radius by far.
  use({kBounds, {{oracle::Shape(Disc{{-8.0, 5.0}, 1.0}), kDefaultMargin}}});
  ASSERT_TRUE(
      make(RowMode::kLabelMap, {{1.0, 5.0}, {2.0, 5.0}, {3.0, 5.0}}, {0, 2, 0, true}, 0.01));
  ASSERT_EQ(rows_at(1).size(), 1U);
  EXPECT_NEAR(rows_at(1)[0].bound, -7.0 + 0.2, kTol_m);
}

TEST_F(WaypointRowsTest, LabelMapNeedsNoTrustRadius) {
  use({kBounds, {{oracle::Shape(Disc{{8.0, 5.0}, 1.0}), kDefaultMargin}}});
  ASSERT_TRUE(make(RowMode::kLabelMap, {{1.0, 5.0}, {2.0, 5.0}, {3.0, 5.0}}, {0, 2, 0, true}, 0.0));
  ASSERT_EQ(rows_at(1).size(), 1U);
  EXPECT_NEAR(rows_at(1)[0].bound, -7.0 + 0.2, kTol_m);
}

TEST_F(WaypointRowsTest, LabelMapOfAnEmptyWorldHasNoRows) {
  use({kBounds, {}});
  ASSERT_TRUE(
      make(RowMode::kLabelMap, {{0.05, 5.0}, {0.05, 5.1}, {0.05, 5.2}}, {0, 2, 0, true}, 1.0));
  EXPECT_EQ(rows_->num_ids(), 0);
  EXPECT_EQ(num_queries_, 0);
}

TEST_F(WaypointRowsTest, WaypointModeTakesEverythingWithinTheTrustRadius) {
  Random random(2);
  int num_rows = 0;
  for (int round = 0; round < 400; ++round) {
    robot_.radius_m = random.chance(0.3) ? 0.0 : random.uniform(0.0, 0.3);
    profile_.rule.margin_m = random.uniform(0.0, 0.2);
    use(random_world(random, 60));
    const Points states = oracle::random_polyline(random, kBounds, 8);
    const double trust_m = random.uniform(0.01, 3.0);
    ASSERT_TRUE(make(RowMode::kWaypoint, states, {0, 7, 0, true}, trust_m));
    for (int t = 1; t < 7; ++t) {
      const Vec2& z = states[static_cast<std::size_t>(t)];
      const std::vector<PointRows::Row> rows = rows_at(t);
      std::size_t num_expected = 0;
      const auto expect_row = [&](double slack_m, auto&& matches, const char* what) {
        if (slack_m > trust_m) return;
        ++num_expected;
        EXPECT_TRUE(std::any_of(rows.begin(), rows.end(), matches))
            << what << oracle::to_text(scene_) << oracle::to_text(z) << " trust " << trust_m;
      };
      for (std::size_t i = 0; i < outlines_.size(); ++i) {
        const double slack_m = oracle::point_distance(outlines_[i], z) - inset_m(i, profile_.rule);
        expect_row(
            slack_m, [&](const PointRows::Row& row) { return is_row_of(i, row, z, profile_.rule); },
            "an obstacle ");
      }
      const double wall_inset_m = robot_.radius_m + profile_.rule.required_m(kDefaultMargin);
      for (const int axis : {0, 1}) {
        for (const double side : {1.0, -1.0}) {
          const double wall = side > 0.0 ? kBounds.lower[axis] : kBounds.upper[axis];
          const double bound = side * wall + wall_inset_m;
          Vec2 inwards = Vec2::Zero();
          inwards[axis] = side;
          expect_row(
              side * z[axis] - bound,
              [&](const PointRows::Row& row) {
                return (row.normal - inwards).norm() <= kTol_m &&
                       std::abs(row.bound - bound) <= kTol_m;
              },
              "a wall ");
        }
      }
      EXPECT_EQ(rows.size(), num_expected);
      num_rows += static_cast<int>(rows.size());
    }
  }
  EXPECT_GT(num_rows, 5000);
}

TEST_F(WaypointRowsTest, RelaxWaypointsNextToTheEndsOnly) {
  use({kBounds, {{oracle::Shape(oracle::box_between({1.0, 0.2}, {9.0, 1.0})), kDefaultMargin}}});
  robot_.radius_m = 0.0;
  profile_.num_start_steps = 3;
  profile_.num_goal_steps = 3;
  profile_.start_cap_m = 0.02;
  profile_.goal_cap_m = 0.03;
  Points states;
  for (int t = 0; t <= 20; ++t) states.emplace_back(2.0 + 0.2 * t, 1.5);
  for (const RowMode mode : {RowMode::kLabelMap, RowMode::kWaypoint}) {
    ASSERT_TRUE(make(mode, states, {0, 20, 0, true}, 0.6));
    for (const int t : {1, 2, 3, 10, 16, 18, 19}) {
      ASSERT_EQ(rows_at(t).size(), 1U) << t;
      const double wanted_m = t < 3 ? 0.02 : t > 17 ? 0.03 : 0.1;
      EXPECT_NEAR(rows_at(t)[0].bound, 1.0 + wanted_m, kTol_m) << t;
    }
    // Windows away from the ends know the place of their waypoints in the trajectory.
    ASSERT_TRUE(make(mode, states, {2, 6, 0, true}, 0.6));
    for (int t = 1; t < 4; ++t) EXPECT_NEAR(rows_at(t)[0].bound, 1.1, kTol_m) << t;
  }
}

TEST_F(WaypointRowsTest, SayWhenTheyDoNotFit) {
  Random random(3);
  const Points states = oracle::cut_into_steps(Points{{1.0, 5.0}, {9.0, 5.0}}, 0.4);
  use(oracle::random_scene_around(random, kBounds, states, 200, 0.3, 0.2));
  InArena<PointRows> small(20, 0);  // one group for each waypoint
  std::int64_t num_queries = 0;
  const Window window = {0, 20, 0, true};
  EXPECT_FALSE(make_waypoint_rows(RowMode::kWaypoint, robot_, test_.world, profile_, states, window,
                                  3.0, *small, num_queries));
  // One row for each waypoint always fits.
  EXPECT_TRUE(make_waypoint_rows(RowMode::kLabelMap, robot_, test_.world, profile_, states, window,
                                 3.0, *small, num_queries));
}

TEST_F(WaypointRowsTest, TouchNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "this build cannot count allocations";
  Random random(4);
  const Points states = oracle::cut_into_steps(Points{{1.0, 5.0}, {9.0, 5.0}}, 0.4);
  use(oracle::random_scene_around(random, kBounds, states, 200, 0.3, 0.2));
  RtGuard guard;
  const bool made_one = make(RowMode::kLabelMap, states, {0, 20, 0, true}, 1.0);
  const bool made_all = make(RowMode::kWaypoint, states, {0, 20, 0, true}, 1.0);
  guard.stop();
  EXPECT_TRUE(made_one && made_all);
  EXPECT_EQ(guard.num_allocations() + guard.num_releases() + guard.num_locks(), 0);
}

}  // namespace
}  // namespace sopt
