// The plans that the planner answers with, checked by the brute-force oracle. Its other answers:
// planner_status_test.cc; its real-time contract: planner_rt_test.cc.
#include "opt/planner.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/planner_fixture.h"

namespace sopt::oracle {
namespace {

class PlannerAnswers : public PlannerTest {
 protected:
  PlanResult<Point2> plan() { return test_planner_.planner.plan(request_); }

  TestPlanner test_planner_;
};

TEST_F(PlannerAnswers, WithAVerifiedPlanAroundAWall) {
  const PlanResult<Point2> result = plan();
  EXPECT_EQ(result.status, PlanStatus::kOk);
  expect_valid(scene_, request_, result);
  EXPECT_EQ(result.margin_m, request_.options.margin_m);
  EXPECT_GE(result.plan->certificate().min_clearance_m, result.margin_m - 1e-6);
  EXPECT_GT(result.path_length, 8.0);
  EXPECT_LT(result.path_length, 14.0);
  EXPECT_GE(result.sampler_path_length, result.path_length);
}

TEST_F(PlannerAnswers, WithItsHistoryAndItsTimes) {
  const PlanResult<Point2> result = plan();
  ASSERT_EQ(result.status, PlanStatus::kOk);
  EXPECT_EQ(result.history.size(), static_cast<std::size_t>(result.iterations) + 1);
  EXPECT_GE(result.iterations, 1);
  EXPECT_GE(result.segments_initial, 1);
  EXPECT_GE(result.segments_final, 1);
  ASSERT_NE(result.path, nullptr);
  EXPECT_EQ(result.path->vertices[0], request_.start);
  EXPECT_EQ(result.path->vertices.back(), request_.goal);
  const StageTimes& times = result.times;
  for (const std::int64_t stage_ns : {times.sample_ns, times.shortcut_ns, times.reference_ns,
                                      times.optimize_ns, times.verify_ns}) {
    EXPECT_GE(stage_ns, 0);
  }
  EXPECT_LE(times.sample_ns + times.shortcut_ns + times.reference_ns + times.optimize_ns +
                times.verify_ns,
            times.total_ns);
}

TEST_F(PlannerAnswers, NeverWorseThanItsReference) {
  for (request_.seed = 1; request_.seed <= 10; ++request_.seed) {
    const PlanResult<Point2> result = plan();
    ASSERT_EQ(result.status, PlanStatus::kOk);
    for (std::size_t k = 1; k < result.history.size(); ++k) {
      EXPECT_LE(result.history[k].cost, result.history[k - 1].cost * (1.0 + 1e-9));
    }
    EXPECT_LE(result.path_length, result.history[0].path_length * (1.0 + 1e-9));
  }
}

TEST_F(PlannerAnswers, WithAStraightLineWhereNothingIsInTheWay) {
  request_.start = {1.0, 9.0};
  request_.goal = {4.0, 9.0};
  const PlanResult<Point2> result = plan();
  expect_valid(scene_, request_, result);
  EXPECT_NEAR(result.path_length, 3.0, 1e-6);
}

TEST_F(PlannerAnswers, ByStayingWhenStartIsGoal) {
  request_.goal = request_.start;
  const PlanResult<Point2> result = plan();
  EXPECT_EQ(result.status, PlanStatus::kOk);
  expect_valid(scene_, request_, result);
  ASSERT_TRUE(static_cast<bool>(result.plan));
  EXPECT_EQ(result.plan->trajectory().horizon(), 2);
  EXPECT_EQ(result.path_length, 0.0);
}

TEST_F(PlannerAnswers, WithAShortPlanToANearGoal) {
  for (const double distance_m : {1e-12, 1e-6, 1e-3, 0.05}) {
    request_.goal = request_.start + Vec2(distance_m, 0.0);
    expect_valid(scene_, request_, plan());
  }
}

TEST_F(PlannerAnswers, FromAStartCloserThanTheMargin) {
  const double gap_m = 0.01;  // wanted: 0.05
  request_.start = {4.5 - kBodyRadius_m - gap_m, 5.0};
  const PlanResult<Point2> result = plan();
  EXPECT_EQ(result.status, PlanStatus::kOk);
  expect_valid(scene_, request_, result);
}

TEST_F(PlannerAnswers, ToAGoalInACornerCloserThanTheMargin) {
  request_.goal = {10.0 - kBodyRadius_m - 0.01, 10.0 - kBodyRadius_m - 0.02};
  expect_valid(scene_, request_, plan());
}

TEST_F(PlannerAnswers, FromAndToEndsThatBarelyKeepMinClearance) {
  const double gap_m = 1.5e-4;
  request_.start = {4.5 - kBodyRadius_m - gap_m, 5.0};
  request_.goal = {5.5 + kBodyRadius_m + gap_m, 5.0};
  expect_valid(scene_, request_, plan());
}

TEST_F(PlannerAnswers, WithASmallerMarginThroughANarrowGap) {
  // The wall now spans the room but for a slit with 0.03 m on each side of the body.
  const double slit_m = 2.0 * (kBodyRadius_m + 0.03);
  add(box_between({4.5, 0.0}, {5.5, 1.0}));
  add(box_between({4.5, 1.0 + slit_m}, {5.5, 2.0}));
  add(box_between({4.5, 7.5}, {5.5, 10.0}));
  const PlanResult<Point2> result = plan();
  expect_valid(scene_, request_, result);
  EXPECT_EQ(result.margin_m, 0.5 * request_.options.margin_m);
}

TEST_F(PlannerAnswers, WithAnObstaclesOwnMargin) {
  scene_.obstacles[0].margin_m = 0.5;
  set_scene(scene_);
  const PlanResult<Point2> result = plan();
  expect_valid(scene_, request_, result);
  ASSERT_TRUE(static_cast<bool>(result.plan));
  const Scene only_the_wall = {scene_.bounds, {scene_.obstacles[0]}};
  EXPECT_EQ(result.margin_m, request_.options.margin_m);
  const auto& trajectory = result.plan->trajectory();
  Scene wide = only_the_wall;
  wide.bounds = far_bounds();
  EXPECT_GE(oracle_clearance_m(wide, trajectory, kBodyRadius_m), 0.5 - 1e-6);
}

TEST_F(PlannerAnswers, WithinTheSpeedLimit) {
  Point2 slow = test_planner_.robot;
  slow.v_max_mps = 0.4;
  SerialExecutor executor;
  const MemoryBlock block(Planner<Point2>::required_bytes(small_settings()));
  Arena arena(block);
  Planner<Point2> planner(arena, slow, small_settings(), executor);
  request_.options.speed_mps = 5.0;
  const PlanResult<Point2> result = planner.plan(request_);
  expect_valid(scene_, request_, result);
  ASSERT_TRUE(static_cast<bool>(result.plan));
  for (const Vec2& u : result.plan->trajectory().inputs) EXPECT_LE(u.norm(), 0.4 * (1 + 1e-12));
  EXPECT_GE(result.plan->certificate().worst_limit_margin, -1e-12);
}

TEST_F(PlannerAnswers, UnderEveryOption) {
  const PlanOptions defaults = request_.options;
  const auto expect_with = [&](const char* name, auto&& change) {
    SCOPED_TRACE(name);
    request_.options = defaults;
    change(request_.options);
    expect_valid(scene_, request_, plan());
  };
  expect_with("one tree", [](PlanOptions& o) { o.sampler = SamplerMode::kRrtStar; });
  expect_with("no shortcut", [](PlanOptions& o) { o.shortcut = false; });
  expect_with("no merging", [](PlanOptions& o) { o.merge = MergeRule::kOff; });
  expect_with("no time scaling", [](PlanOptions& o) { o.resampling = Resampling::kOff; });
  expect_with("no iterations", [](PlanOptions& o) { o.max_iterations = 0; });
  expect_with("one stream", [](PlanOptions& o) { o.num_streams = 1; });
  expect_with("one segment", [](PlanOptions& o) { o.num_segments = 1; });
  expect_with("many segments", [](PlanOptions& o) { o.num_segments = 100; });
  expect_with("small windows", [](PlanOptions& o) { o.max_window = 4; });
  expect_with("no tolerance", [](PlanOptions& o) { o.tol_step = 0.0; });
  expect_with("fast", [](PlanOptions& o) { o.speed_mps = 20.0; });
  expect_with("slow", [](PlanOptions& o) { o.speed_mps = 0.3; });
  expect_with("wide margin", [](PlanOptions& o) { o.margin_m = 0.4; });
  expect_with("margin as small as min_clearance", [](PlanOptions& o) { o.margin_m = 1e-4; });
}

TEST_F(PlannerAnswers, InRandomScenes) {
  int num_plans = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Aabb2 bounds = {{0.0, 0.0}, {10.0, 10.0}};
    set_scene(random_scene(random, bounds, 5 + random.index(20), random.uniform(0.2, 1.2)));
    request_.start = random.point(bounds);
    request_.goal = random.point(bounds);
    request_.seed = seed;
    const PlanResult<Point2> result = plan();
    const double start_m = scene_distance(scene_, request_.start, request_.start) - kBodyRadius_m;
    const double goal_m = scene_distance(scene_, request_.goal, request_.goal) - kBodyRadius_m;
    if (start_m < 1e-4) {
      EXPECT_EQ(result.status, PlanStatus::kBadStart);
    } else if (goal_m < 1e-4) {
      EXPECT_EQ(result.status, PlanStatus::kBadGoal);
    } else if (result.status != PlanStatus::kNoPath) {
      expect_valid(scene_, request_, result);
      ++num_plans;
    } else {
      EXPECT_EQ(result.failure.stage, PlanStage::kSample);
    }
  }
  EXPECT_GT(num_plans, 10);
}

TEST_F(PlannerAnswers, AmongFiveThousandObstacles) {
  Scene dense = {{{0.0, 0.0}, {100.0, 100.0}}, {}};
  Random random(11);
  while (dense.obstacles.size() < 5000) {
    const Vec2 center = random.point(dense.bounds);
    if (center.norm() > 3.0 && (center - Vec2(100.0, 100.0)).norm() > 3.0) {
      dense.obstacles.push_back({Disc{center, 0.15}});
    }
  }
  set_scene(dense);
  request_.start = {1.0, 1.0};
  request_.goal = {99.0, 99.0};
  TestPlanner large{PlannerSettings{}};
  expect_valid(scene_, request_, large.planner.plan(request_));
}

TEST_F(PlannerAnswers, SensiblyToExtremeButLegalNumbers) {
  const PlanOptions defaults = request_.options;
  for (const double extreme : {1e-300, 1e-12, 1e12, 1e300}) {
    request_.options = defaults;
    request_.options.speed_mps = extreme;
    PlanResult<Point2> result = plan();
    if (static_cast<int>(result.status) >= 0) expect_valid(scene_, request_, result);
    request_.options = defaults;
    request_.options.dt_s = extreme;
    result = plan();
    if (static_cast<int>(result.status) >= 0) expect_valid(scene_, request_, result);
    request_.options = defaults;
    request_.options.margin_m = extreme;
    request_.options.min_clearance_m = std::min(extreme, 1e-4);
    result = plan();
    if (static_cast<int>(result.status) >= 0) expect_valid(scene_, request_, result);
  }
}

}  // namespace
}  // namespace sopt::oracle
