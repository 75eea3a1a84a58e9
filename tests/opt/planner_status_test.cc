// Every status of the planner other than a plan, with its evidence, and the leases of its slots.
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "opt/planner.h"
#include "tests/support/planner_fixture.h"

namespace sopt::oracle {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

class PlannerRefuses : public PlannerTest {
 protected:
  PlanResult<Point2> plan() { return test_planner_.planner.plan(request_); }

  TestPlanner test_planner_;
};

void expect_failed(const PlanResult<Point2>& result, PlanStatus status, PlanStage stage) {
  EXPECT_EQ(result.status, status) << static_cast<int>(result.status) << result.failure.reason;
  EXPECT_EQ(result.failure.stage, stage);
  EXPECT_FALSE(static_cast<bool>(result.plan));
  EXPECT_FALSE(std::string(result.failure.reason).empty());
}

TEST_F(PlannerRefuses, ABadStartWithTheObstacleItIsIn) {
  request_.start = {3.1, 2.0};  // 0.5 inside disc 2, with a body of 0.1
  const PlanResult<Point2> result = plan();
  expect_failed(result, PlanStatus::kBadStart, PlanStage::kRequest);
  EXPECT_EQ(result.failure.i_obstacle, 2);
  EXPECT_NEAR(result.failure.amount, -0.6, 1e-9);
}

TEST_F(PlannerRefuses, ABadStartWhenItIsCloserThanMinClearance) {
  request_.start = {4.5 - kBodyRadius_m - 0.5e-4, 5.0};
  const PlanResult<Point2> result = plan();
  expect_failed(result, PlanStatus::kBadStart, PlanStage::kRequest);
  EXPECT_EQ(result.failure.i_obstacle, 0);
  EXPECT_NEAR(result.failure.amount, 0.5e-4, 1e-9);
}

TEST_F(PlannerRefuses, ABadStartOutsideTheBounds) {
  for (const Vec2& start : {Vec2(-0.5, 5.0), Vec2(1.0, 10.05), Vec2(1.0, 9.95)}) {
    request_.start = start;
    const PlanResult<Point2> result = plan();
    expect_failed(result, PlanStatus::kBadStart, PlanStage::kRequest);
    EXPECT_EQ(result.failure.i_obstacle, kBoundsObstacle);
  }
}

TEST_F(PlannerRefuses, ABadGoalWithTheObstacleItIsIn) {
  request_.goal = {7.5, 3.0};
  const PlanResult<Point2> result = plan();
  expect_failed(result, PlanStatus::kBadGoal, PlanStage::kRequest);
  EXPECT_EQ(result.failure.i_obstacle, 3);
  EXPECT_NEAR(result.failure.amount, -0.35, 1e-9);
}

TEST_F(PlannerRefuses, ABadGoalOutsideTheBounds) {
  request_.goal = {9.0, -3.0};
  const PlanResult<Point2> result = plan();
  expect_failed(result, PlanStatus::kBadGoal, PlanStage::kRequest);
  EXPECT_EQ(result.failure.i_obstacle, kBoundsObstacle);
}

TEST_F(PlannerRefuses, APathIntoASealedRoom) {
  seal_the_goal();
  request_.options.num_samples = 500;
  for (const SamplerMode mode : {SamplerMode::kRrtStar, SamplerMode::kRrtStarConnect}) {
    request_.options.sampler = mode;
    expect_failed(plan(), PlanStatus::kNoPath, PlanStage::kSample);
  }
}

TEST_F(PlannerRefuses, APathBeyondTheSmallestBudget) {
  seal_the_goal();
  request_.options.num_samples = 1;
  request_.options.num_batches = 1;
  expect_failed(plan(), PlanStatus::kNoPath, PlanStage::kSample);
}

TEST_F(PlannerRefuses, APathThatNeedsMoreStepsThanThereAre) {
  PlannerSettings settings = small_settings();
  settings.max_horizon = 20;
  TestPlanner little(settings);
  const PlanResult<Point2> result = little.planner.plan(request_);
  expect_failed(result, PlanStatus::kCapacity, PlanStage::kReference);
  EXPECT_GT(result.failure.amount, 20.0);
}

TEST_F(PlannerRefuses, APathThatNeedsMoreVerticesThanThereAre) {
  // A slalom: three walls with gaps at alternate ends, so at least five edges.
  Scene slalom = {scene_.bounds,
                  {{box_between({2.0, 0.0}, {3.0, 9.0})},
                   {box_between({4.5, 1.0}, {5.5, 10.0})},
                   {box_between({7.0, 0.0}, {8.0, 9.0})}}};
  set_scene(slalom);
  PlannerSettings settings = small_settings();
  settings.max_path_vertices = 4;
  TestPlanner little(settings);
  expect_failed(little.planner.plan(request_), PlanStatus::kCapacity, PlanStage::kSample);
  expect_valid(scene_, request_, plan());
}

TEST_F(PlannerRefuses, AFourthPlanWhileThreeAreHeld) {
  PlanResult<Point2> first = plan();
  PlanResult<Point2> second = plan();
  const PlanResult<Point2> third = plan();
  ASSERT_TRUE(first.plan && second.plan && third.plan);
  expect_failed(plan(), PlanStatus::kNoSlot, PlanStage::kRequest);
  second.plan.reset();
  EXPECT_FALSE(static_cast<bool>(second.plan));
  { EXPECT_EQ(plan().status, PlanStatus::kOk); }
  EXPECT_EQ(plan().status, PlanStatus::kOk);  // the temporary before gave its slot back
  PlanLease<Point2> moved = std::move(first.plan);
  EXPECT_FALSE(static_cast<bool>(first.plan));
  const PlanResult<Point2> fourth = plan();
  EXPECT_EQ(fourth.status, PlanStatus::kOk);
  EXPECT_EQ(plan().status, PlanStatus::kNoSlot);
  moved.reset();
  EXPECT_EQ(plan().status, PlanStatus::kOk);
}

TEST_F(PlannerRefuses, WithoutUsingUpASlot) {
  PlanRequest<Point2> bad = request_;
  bad.start = {3.0, 2.0};
  for (int i = 0; i < 5; ++i)
    EXPECT_EQ(test_planner_.planner.plan(bad).status, PlanStatus::kBadStart);
  EXPECT_EQ(plan().status, PlanStatus::kOk);
}

TEST_F(PlannerRefuses, ToTouchPlansThatAreHeld) {
  const PlanResult<Point2> held = plan();
  ASSERT_TRUE(static_cast<bool>(held.plan));
  const std::vector<double> before = numbers_of(held);
  for (int i = 0; i < 6; ++i) {
    request_.seed = 100 + static_cast<std::uint64_t>(i);
    std::swap(request_.start, request_.goal);
    ASSERT_EQ(plan().status, PlanStatus::kOk);
  }
  EXPECT_EQ(numbers_of(held), before);
}

TEST_F(PlannerRefuses, ToLoseALeaseThatReplacesAnother) {
  PlanLease<Point2> lease = plan().plan;
  for (int i = 0; i < 8; ++i) {
    PlanResult<Point2> next = plan();
    ASSERT_EQ(next.status, PlanStatus::kOk);
    lease = std::move(next.plan);
  }
  PlanLease<Point2>& same = lease;
  lease = std::move(same);
  EXPECT_TRUE(static_cast<bool>(lease));
}

// --- bad input

TEST_F(PlannerRefuses, EveryMalformedRequest) {
  const PlanRequest<Point2> good = request_;
  const auto expect_bad = [&](const char* name, auto&& spoil) {
    SCOPED_TRACE(name);
    request_ = good;
    spoil(request_);
    expect_failed(plan(), PlanStatus::kBadInput, PlanStage::kRequest);
  };
  using Request = PlanRequest<Point2>;
  expect_bad("no world", [](Request& r) { r.world = nullptr; });
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    expect_bad("start x", [&](Request& r) { r.start.x() = bad; });
    expect_bad("goal y", [&](Request& r) { r.goal.y() = bad; });
    expect_bad("speed", [&](Request& r) { r.options.speed_mps = bad; });
    expect_bad("dt", [&](Request& r) { r.options.dt_s = bad; });
    expect_bad("margin", [&](Request& r) { r.options.margin_m = bad; });
    expect_bad("min_clearance", [&](Request& r) { r.options.min_clearance_m = bad; });
    expect_bad("tol_step", [&](Request& r) { r.options.tol_step = bad; });
  }
  for (const double bad : {0.0, -1.0, kNan, -kInfinity}) {
    expect_bad("deadline", [&](Request& r) { r.deadline_s = bad; });
  }
  expect_bad("negative speed", [](Request& r) { r.options.speed_mps = -1.0; });
  expect_bad("dt of zero", [](Request& r) { r.options.dt_s = 0.0; });
  expect_bad("negative dt", [](Request& r) { r.options.dt_s = -0.1; });
  expect_bad("negative margin", [](Request& r) { r.options.margin_m = -0.1; });
  expect_bad("negative clearance", [](Request& r) { r.options.min_clearance_m = -0.1; });
  expect_bad("margin below clearance", [](Request& r) { r.options.min_clearance_m = 0.06; });
  expect_bad("no samples", [](Request& r) { r.options.num_samples = 0; });
  expect_bad("negative samples", [](Request& r) { r.options.num_samples = -5; });
  expect_bad("no batches", [](Request& r) { r.options.num_batches = 0; });
  expect_bad("negative streams", [](Request& r) { r.options.num_streams = -1; });
  expect_bad("too many streams", [](Request& r) { r.options.num_streams = 99; });
  expect_bad("negative segments", [](Request& r) { r.options.num_segments = -1; });
  expect_bad("too many segments", [](Request& r) { r.options.num_segments = 1 << 30; });
  expect_bad("negative window", [](Request& r) { r.options.max_window = -1; });
  expect_bad("too wide a window", [](Request& r) { r.options.max_window = 1000; });
  expect_bad("negative iterations", [](Request& r) { r.options.max_iterations = -1; });
  expect_bad("too many iterations", [](Request& r) { r.options.max_iterations = 1 << 30; });
  expect_bad("negative tolerance", [](Request& r) { r.options.tol_step = -1e-3; });
  request_ = good;
  EXPECT_EQ(plan().status, PlanStatus::kOk);
}

TEST_F(PlannerRefuses, EverythingWhenItWasBuiltWithInvalidSettings) {
  const auto expect_useless = [&](const char* name, auto&& spoil) {
    SCOPED_TRACE(name);
    PlannerSettings settings = small_settings();
    spoil(settings);
    TestPlanner useless(settings);
    expect_failed(useless.planner.plan(request_), PlanStatus::kBadInput, PlanStage::kRequest);
  };
  for (const int bad : {0, -1, -1000, std::numeric_limits<int>::min()}) {
    expect_useless("max_horizon", [&](PlannerSettings& s) { s.max_horizon = bad; });
    expect_useless("num_streams", [&](PlannerSettings& s) { s.num_streams = bad; });
    expect_useless("nodes_per_stream", [&](PlannerSettings& s) { s.nodes_per_stream = bad; });
    expect_useless("max_path_vertices", [&](PlannerSettings& s) { s.max_path_vertices = bad; });
    expect_useless("max_window", [&](PlannerSettings& s) { s.max_window = bad; });
  }
  expect_useless("rows_per_window", [](PlannerSettings& s) { s.rows_per_window = -1; });
  expect_useless("too many streams", [](PlannerSettings& s) { s.num_streams = kMaxStreams + 1; });
}

TEST_F(PlannerRefuses, EverythingWhenItGotTooLittleMemory) {
  SerialExecutor executor;
  const MemoryBlock block(4096);
  Arena arena(block);
  Planner<Point2> planner(arena, test_planner_.robot, small_settings(), executor);
  EXPECT_TRUE(arena.exhausted());
  expect_failed(planner.plan(request_), PlanStatus::kBadInput, PlanStage::kRequest);
}

TEST(PlanResult, IsAFailureByDefault) {
  const PlanResult<Point2> result;
  EXPECT_LT(static_cast<int>(result.status), 0);
  EXPECT_FALSE(static_cast<bool>(result.plan));
}

}  // namespace
}  // namespace sopt::oracle
