// A Planner<Point2> with its memory and a world, and an independent check of what it returns.
#pragma once

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "opt/planner.h"
#include "rt/executor.h"
#include "tests/support/oracle2.h"
#include "tests/support/test_world.h"

namespace sopt::oracle {

inline constexpr double kBodyRadius_m = 0.1;

[[nodiscard]] inline PlannerSettings small_settings() {
  PlannerSettings settings;
  settings.max_horizon = 600;
  settings.num_streams = 2;
  settings.nodes_per_stream = 4000;
  settings.max_path_vertices = 256;
  return settings;
}

struct TestPlanner {
  explicit TestPlanner(const PlannerSettings& settings = small_settings(),
                       Clock clock = monotonic_clock())
      : TestPlanner(settings, clock, serial) {}
  TestPlanner(const PlannerSettings& settings, Clock clock, Executor& executor)
      : block(Planner<Point2>::required_bytes(settings, executor.num_workers())),
        arena(block),
        planner(arena, robot, settings, executor, clock) {}

  Point2 robot{kBodyRadius_m, std::numeric_limits<double>::infinity()};
  SerialExecutor serial;
  MemoryBlock block;
  Arena arena;
  Planner<Point2> planner;
};

// The states as numbers: equal exactly when the plans are the same bytes.
[[nodiscard]] inline std::vector<double> numbers_of(const PlanResult<Point2>& result) {
  std::vector<double> numbers;
  if (!result.plan) return numbers;
  const Trajectory<Point2>& trajectory = result.plan->trajectory();
  numbers.push_back(trajectory.dt_s);
  for (const Vec2& z : trajectory.states) numbers.insert(numbers.end(), {z.x(), z.y()});
  for (const Vec2& u : trajectory.inputs) numbers.insert(numbers.end(), {u.x(), u.y()});
  return numbers;
}

// Smallest clearance of the plan's body over the whole motion, by the oracle.
[[nodiscard]] inline double oracle_clearance_m(const Scene& scene,
                                               const Trajectory<Point2>& trajectory,
                                               double radius_m) {
  double clearance_m = std::numeric_limits<double>::infinity();
  for (int t = 0; t < trajectory.horizon(); ++t) {
    clearance_m = std::min(clearance_m,
                           scene_distance(scene, trajectory.states[t], trajectory.states[t + 1]));
  }
  return clearance_m - radius_m;
}

// Fails unless the status says that there is a plan and the plan holds what it must.
inline void expect_valid(const Scene& scene, const PlanRequest<Point2>& request,
                         const PlanResult<Point2>& result, double radius_m = kBodyRadius_m) {
  ASSERT_GE(static_cast<int>(result.status), 0)
      << result.failure.reason << " " << result.failure.amount;
  ASSERT_TRUE(static_cast<bool>(result.plan));
  const Trajectory<Point2>& trajectory = result.plan->trajectory();
  ASSERT_GE(trajectory.horizon(), 1);
  ASSERT_EQ(trajectory.inputs.size(), trajectory.horizon());
  EXPECT_EQ(trajectory.states[0], request.start);
  EXPECT_EQ(trajectory.states[trajectory.horizon()], request.goal);
  EXPECT_GT(trajectory.dt_s, 0.0);
  double length_m = 0.0;
  for (int t = 0; t < trajectory.horizon(); ++t) {
    const Vec2 step = trajectory.states[t + 1] - trajectory.states[t];
    EXPECT_LE((step - trajectory.dt_s * trajectory.inputs[t]).norm(), kMaxDynamicsDefect);
    length_m += step.norm();
  }
  EXPECT_NEAR(result.path_length, length_m, 1e-9 * (1.0 + length_m));
  const double clearance_m = oracle_clearance_m(scene, trajectory, radius_m);
  EXPECT_GE(clearance_m, request.options.min_clearance_m - 1e-9);
  EXPECT_NEAR(result.plan->certificate().min_clearance_m, clearance_m, 1e-9);
}

// 10 m x 10 m with a wall between start and goal, open at both its ends, and some clutter.
class PlannerTest : public testing::Test {
 protected:
  void SetUp() override {
    scene_.bounds = {{0.0, 0.0}, {10.0, 10.0}};
    scene_.obstacles = {{box_between({4.5, 1.5}, {5.5, 8.0})},
                        {Disc{{7.0, 8.0}, 0.7}},
                        {Disc{{3.0, 2.0}, 0.6}},
                        {Box2{{7.5, 3.0}, {1.5, 0.5}, 0.6}},
                        {polygon_of({{1.5, 6.0}, {2.6, 5.5}, {3.2, 6.4}, {2.0, 7.2}})}};
    set_scene(scene_);
    request_.start = {1.0, 5.0};
    request_.goal = {9.0, 5.0};
    request_.world = &test_world_.world;
    request_.seed = 3;
  }

  void set_scene(const Scene& scene) {
    scene_ = scene;
    ASSERT_EQ(fill(scene_, test_world_.world), WorldStatus::kOk);
  }
  void add(const Shape& shape, double margin_m = kDefaultMargin) {
    scene_.obstacles.push_back({shape, margin_m});
    set_scene(scene_);
  }
  // Four walls around the goal; the outermost obstacle indices are theirs.
  void seal_the_goal() {
    add(box_between({8.0, 4.0}, {8.2, 6.0}));
    add(box_between({8.0, 5.8}, {10.0, 6.0}));
    add(box_between({8.0, 4.0}, {10.0, 4.2}));
  }

  Scene scene_;
  TestWorld test_world_{{6000, 24000}};
  PlanRequest<Point2> request_;
};

}  // namespace sopt::oracle
