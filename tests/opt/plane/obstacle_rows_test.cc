#include "opt/plane/obstacle_rows.h"

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
using oracle::Random;
using oracle::Scene;
using oracle::SceneOracle;
using oracle::TestWorld;

using Points = std::vector<Vec2>;

constexpr double kTol_m = 1e-9;
const Aabb2 kBounds = {Vec2::Zero(), Vec2::Constant(10.0)};
const Aabb2 kInner = {Vec2::Constant(0.6), Vec2::Constant(9.4)};

class ObstacleRowsTest : public ::testing::Test {
 protected:
  void use(const Scene& scene) {
    scene_ = scene;
    ASSERT_EQ(oracle::fill(scene, test_.world), WorldStatus::kOk);
  }
  bool make(const Points& states, const Window& window, double trust_m) {
    return make_obstacle_rows(robot_, test_.world, profile_, states, window, trust_m, *rows_,
                              num_queries_);
  }
  // Largest violation of a row when the window's waypoints are `points`.
  double violation_at(const Points& points) {
    rows_->shorten_step(points.data(), 0.0);
    double worst = -oracle::kFar_m;
    for (int id = 0; id < rows_->num_ids(); ++id) {
      if (rows_->is_free(id)) worst = std::max(worst, rows_->violation(id));
    }
    return worst;
  }
  static Points part(const Points& states, const Window& window) {
    return {states.begin() + window.first, states.begin() + window.last + 1};
  }
  // Smallest slack of the window's steps against the rules of their place in the trajectory.
  double slack(const Points& points, const Window& window, int horizon) const {
    const SceneOracle dense(scene_);
    double best_m = oracle::kFar_m;
    for (std::size_t i = 1; i < points.size(); ++i) {
      const int t = window.first + static_cast<int>(i) - 1;
      best_m = std::min(best_m, dense.slack(points[i - 1], points[i], robot_.radius_m,
                                            profile_.at_step(t, horizon)));
    }
    return best_m;
  }
  // Moves interior waypoints at random by at most trust_m, then back towards the reference until
  // all rows hold: often right up to a row.
  Points perturb(Random& random, const Points& reference, double trust_m) {
    Points target = reference;
    for (std::size_t i = 1; i + 1 < target.size(); ++i) {
      const double angle = random.uniform(-3.2, 3.2);
      target[i] += trust_m * (1.0 - 1e-12) * Vec2(std::cos(angle), std::sin(angle));
    }
    if (violation_at(target) <= 0.0) return target;
    double low = 0.0;
    double high = 1.0;
    Points best = reference;
    for (int k = 0; k < 40; ++k) {
      const double s = 0.5 * (low + high);
      Points trial = reference;
      for (std::size_t i = 0; i < trial.size(); ++i) trial[i] += s * (target[i] - reference[i]);
      if (violation_at(trial) <= 0.0) {
        low = s;
        best = trial;
      } else {
        high = s;
      }
    }
    return best;
  }

  Point2 robot_{0.1};
  TestWorld test_{{256, 4096}};
  Scene scene_;
  MarginProfile profile_ = oracle::plain_profile(0.1);
  InArena<PointRows> rows_{60, 4096};
  std::int64_t num_queries_ = 0;
};

TEST_F(ObstacleRowsTest, PutsPlanesBetweenTheReferenceAndADisc) {
  use({kBounds, {{Disc{{5.0, 4.0}, 0.5}, kDefaultMargin}}});
  const Points states = {{4.0, 5.0}, {5.0, 5.0}, {6.0, 5.0}};
  const Window window = {0, 2, 0, true};
  ASSERT_TRUE(make(states, window, 1.0));
  EXPECT_GT(num_queries_, 0);
  EXPECT_EQ(rows_->num_steps(), 2);
  // Both edges are nearest to the disc at (5, 5): y >= 4.5 + 0.1 + 0.1.
  EXPECT_LE(violation_at({{4.0, 5.0}, {5.0, 4.7 + 1e-9}, {6.0, 5.0}}), 0.0);
  EXPECT_NEAR(violation_at({{4.0, 5.0}, {5.0, 4.6}, {6.0, 5.0}}), 0.1, 1e-12);
}

TEST_F(ObstacleRowsTest, MakesNoRowsFarFromEverything) {
  use({kBounds, {{Disc{{5.0, 1.0}, 0.5}, kDefaultMargin}}});
  const Points states = {{4.0, 5.0}, {5.0, 5.0}, {6.0, 5.0}};
  ASSERT_TRUE(make(states, {0, 2, 0, true}, 1.0));
  EXPECT_EQ(rows_->num_ids(), 0);
}

TEST_F(ObstacleRowsTest, KeepsTheBoundsAsWell) {
  use({kBounds, {}});
  const Points states = {{4.0, 0.5}, {5.0, 0.5}, {6.0, 0.5}};
  ASSERT_TRUE(make(states, {0, 2, 0, true}, 1.0));
  EXPECT_LE(violation_at({{4.0, 0.5}, {5.0, 0.2 + 1e-9}, {6.0, 0.5}}), 0.0);
  EXPECT_NEAR(violation_at({{4.0, 0.5}, {5.0, 0.15}, {6.0, 0.5}}), 0.05, 1e-12);
}

TEST_F(ObstacleRowsTest, HoldAtAReferenceThatHasTheClearance) {
  Random random(1);
  for (int round = 0; round < 300; ++round) {
    const Points way = oracle::random_polyline(random, kInner, 4);
    use(oracle::random_scene_around(random, kBounds, way, 80, 0.6,
                                    robot_.radius_m + profile_.rule.margin_m));
    const Points states = oracle::cut_into_steps(way, random.uniform(0.2, 0.8));
    const int horizon = static_cast<int>(states.size()) - 1;
    const int first = random.index(horizon);
    const Window window = {first, std::min(horizon, first + 1 + random.index(40)), 0, true};
    ASSERT_TRUE(make(states, window, random.uniform(0.01, 2.0)));
    EXPECT_LE(violation_at(part(states, window)), 1e-12) << oracle::to_text(scene_);
  }
}

TEST_F(ObstacleRowsTest, KeepWholeEdgesClearWithinTheTrustRadius) {
  Random random(2);
  double smallest_m = oracle::kFar_m;
  for (int round = 0; round < 300; ++round) {
    robot_.radius_m = random.chance(0.3) ? 0.0 : random.uniform(0.0, 0.3);
    profile_.rule.margin_m = random.uniform(0.0, 0.2);
    const Points way = oracle::random_polyline(random, kInner, 3);
    Scene scene = oracle::random_scene_around(random, kBounds, way, 80, 0.6, robot_.radius_m + 0.2);
    for (auto& obstacle : scene.obstacles) {
      if (random.chance(0.2)) obstacle.margin_m = random.uniform(0.0, 0.2);
    }
    use(scene);
    const Points states = oracle::cut_into_steps(way, random.uniform(0.2, 0.8));
    const int horizon = static_cast<int>(states.size()) - 1;
    const int first = random.index(std::max(1, horizon - 4));
    const Window window = {first, std::min(horizon, first + 2 + random.index(10)), 0, true};
    const double trust_m = random.uniform(0.02, 1.5);
    ASSERT_TRUE(make(states, window, trust_m));
    for (int k = 0; k < 5; ++k) {
      const Points moved = perturb(random, part(states, window), trust_m);
      const double slack_m = slack(moved, window, horizon);
      smallest_m = std::min(smallest_m, slack_m);
      ASSERT_GE(slack_m, -kTol_m) << oracle::to_text(scene_) << oracle::to_text(states) << "\n["
                                  << window.first << "," << window.last << "] trust " << trust_m
                                  << " moved " << oracle::to_text(moved);
    }
  }
  EXPECT_LT(smallest_m, 1e-3) << "the test does not reach the rows";
}

TEST_F(ObstacleRowsTest, RelaxStepsNextToTheEndsOnly) {
  // A wall below y = 1; start and goal 0.05 above it, the rest at the margin.
  use({kBounds, {{oracle::box_between({1.0, 0.2}, {9.0, 1.0}), kDefaultMargin}}});
  robot_.radius_m = 0.0;
  profile_.num_start_steps = 1;
  profile_.num_goal_steps = 1;
  profile_.start_cap_m = 0.045;
  profile_.goal_cap_m = 0.045;
  const Points states = {{3.0, 1.05}, {3.5, 1.1}, {4.0, 1.1}, {4.5, 1.1}, {5.0, 1.05}};
  const Window window = {0, 4, 0, true};
  ASSERT_TRUE(make(states, window, 0.5));
  EXPECT_LE(violation_at(states), 1e-12);
  // Waypoints 1 and 3 also belong to steps that ask for the whole margin.
  for (const std::size_t t : {1u, 2u, 3u}) {
    Points lowered = states;
    lowered[t].y() = 1.08;
    EXPECT_NEAR(violation_at(lowered), 0.02, 1e-12) << t;
  }
}

TEST_F(ObstacleRowsTest, UseTheEndRulesOnlyInWindowsAtTheEnds) {
  use({kBounds, {{oracle::box_between({1.0, 0.2}, {9.0, 1.0}), kDefaultMargin}}});
  robot_.radius_m = 0.0;
  profile_.num_start_steps = 3;
  profile_.start_cap_m = 0.02;
  Points states;
  for (int t = 0; t <= 12; ++t) states.emplace_back(2.0 + 0.5 * t, 1.2);
  ASSERT_TRUE(make(states, {0, 4, 0, true}, 0.5));
  Points lowered = part(states, {0, 4, 0, true});
  lowered[2].y() = 1.05;
  EXPECT_LE(violation_at(lowered), 0.0);
  ASSERT_TRUE(make(states, {4, 8, 0, true}, 0.5));
  lowered = part(states, {4, 8, 0, true});
  lowered[2].y() = 1.05;
  EXPECT_NEAR(violation_at(lowered), 0.05, 1e-12);
}

TEST_F(ObstacleRowsTest, SayWhenTheyDoNotFit) {
  Random random(3);
  const Points states = oracle::cut_into_steps(Points{{1.0, 5.0}, {9.0, 5.0}}, 0.4);
  use(oracle::random_scene_around(random, kBounds, states, 200, 0.3, 0.2));
  InArena<PointRows> small(60, 8);
  EXPECT_FALSE(make_obstacle_rows(robot_, test_.world, profile_, states, {0, 20, 0, true}, 1.0,
                                  *small, num_queries_));
  ASSERT_TRUE(make(states, {0, 20, 0, true}, 1.0));
}

TEST_F(ObstacleRowsTest, TouchNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "this build cannot count allocations";
  Random random(4);
  const Points states = oracle::cut_into_steps(Points{{1.0, 5.0}, {9.0, 5.0}}, 0.4);
  use(oracle::random_scene_around(random, kBounds, states, 200, 0.3, 0.2));
  RtGuard guard;
  const bool made = make(states, {0, 20, 0, true}, 1.0);
  guard.stop();
  EXPECT_TRUE(made);
  EXPECT_EQ(guard.num_allocations() + guard.num_releases() + guard.num_locks(), 0);
}

}  // namespace
}  // namespace sopt
