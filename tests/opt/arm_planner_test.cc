// What Planner<Arm<N>> answers when there is a plan: valid by an oracle of its own, the report that
// comes with it, and plans that only get shorter when there is time for more.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/arm_planner_fixture.h"

namespace sopt::oracle {
namespace {

using Robot = Arm<5>;

class ArmPlannerAnswers : public ArmPlannerTest {
 protected:
  PlanResult<Robot> plan() { return test_planner_.planner.plan(request_); }
  void expect_plan(const char* what) {
    SCOPED_TRACE(what);
    const PlanResult<Robot> result = plan();
    EXPECT_EQ(result.status, PlanStatus::kOk);
    expect_valid(robot_, request_, result);
  }

  TestArmPlanner<5> test_planner_{robot_};
};

TEST_F(ArmPlannerAnswers, WithAVerifiedPlanAroundAPillar) {
  const Robot::Config middle = robot_.interpolate(request_.start, request_.goal, 0.52);
  ASSERT_LT(PlainArm<5>(robot_).clearance_m(test_.world, middle), 0.0);
  for (request_.seed = 1; request_.seed <= 20; ++request_.seed) {
    SCOPED_TRACE(request_.seed);
    const PlanResult<Robot> result = plan();
    EXPECT_EQ(result.status, PlanStatus::kOk);
    expect_valid(robot_, request_, result);
    EXPECT_GT(result.path_length, robot_.path_distance(request_.start, request_.goal));
    EXPECT_FALSE(result.fell_back);
  }
}

TEST_F(ArmPlannerAnswers, WithItsHistoryAndItsTimes) {
  ManualClock manual(1000);
  TestArmPlanner<5> timed(robot_, small_arm_settings(), manual.clock());
  const PlanResult<Robot> result = timed.planner.plan(request_);
  ASSERT_EQ(result.status, PlanStatus::kOk);
  ASSERT_EQ(result.history.size(), static_cast<std::size_t>(result.iterations) + 1);
  for (std::size_t k = 1; k < result.history.size(); ++k) {
    EXPECT_LE(result.history[k].cost, result.history[k - 1].cost);
    EXPECT_GE(result.history[k].time_ns, result.history[k - 1].time_ns);
  }
  EXPECT_EQ(result.history.back().path_length, result.path_length);
  EXPECT_LT(result.path_length, result.history.front().path_length);
  EXPECT_EQ(result.margin_m, request_.options.margin_m);
  ASSERT_NE(result.path, nullptr);
  EXPECT_NEAR(result.path->length(robot_), result.history.front().path_length, 1e-9);
  EXPECT_LE(result.path->length(robot_), result.sampler_path_length);
  EXPECT_EQ(result.splits.front(), 0);
  EXPECT_EQ(result.splits.back(), result.plan->trajectory().horizon());
  for (const std::int64_t stage_ns : {result.times.sample_ns, result.times.reference_ns,
                                      result.times.optimize_ns, result.times.verify_ns}) {
    EXPECT_GT(stage_ns, 0);
    EXPECT_LT(stage_ns, result.times.total_ns);
  }
}

TEST_F(ArmPlannerAnswers, WithAStraightMotionWhereNothingIsInTheWay) {
  request_.goal = {-0.6, -0.4, 0.6, 0.5, -0.4};
  const PlanResult<Robot> result = plan();
  expect_valid(robot_, request_, result);
  EXPECT_NEAR(result.path_length, robot_.path_distance(request_.start, request_.goal), 1e-6);
}

TEST_F(ArmPlannerAnswers, ByStayingWhenStartIsGoal) {
  request_.goal = request_.start;
  const PlanResult<Robot> result = plan();
  EXPECT_EQ(result.status, PlanStatus::kOk);
  expect_valid(robot_, request_, result);
  EXPECT_EQ(result.path_length, 0.0);
  EXPECT_EQ(result.plan->trajectory().horizon(), 2);
  for (const auto& state : result.plan->trajectory().states) {
    EXPECT_EQ(state.head<5>(), request_.start);
    EXPECT_EQ(state.tail<5>().norm(), 0.0);
  }
}

TEST_F(ArmPlannerAnswers, ToAGoalNextToTheStart) {
  for (const double step : {1e-12, 1e-6, 1e-3, 0.05}) {
    request_.goal = request_.start + step * Robot::Config::Unit(2);
    expect_plan(std::to_string(step).c_str());
  }
}

TEST_F(ArmPlannerAnswers, FromAndToEndsAtTheLimitsOfTheirJoints) {
  for (int j = 0; j < 5; ++j) {
    if (j == 1 || j == 2) continue;  // would put the arm into itself
    request_.start[j] = robot_.lower()[j];
    request_.goal[j] = robot_.upper()[j];
  }
  expect_plan("at the limits");
}

TEST_F(ArmPlannerAnswers, FromAndToEndsCloserThanTheMargin) {
  for (auto* end : {&request_.start, &request_.goal}) {
    ArmPose<5> pose;
    robot_.forward(*end, pose);
    const Capsule3 forearm = robot_.capsule_W(pose, robot_.num_capsules() - 1);
    const Vec3 ahead = (forearm.p1 - forearm.p0).normalized();
    add(Sphere3{forearm.p1 + (forearm.radius_m + 0.03 + 1e-3) * ahead, 0.03});
  }
  ASSERT_LT(1e-3, request_.options.margin_m);
  expect_plan("1 mm");
}

TEST_F(ArmPlannerAnswers, WithAnObjectInItsGrasp) {
  Robot loaded = robot_;
  const LinkCapsule bar = {4, {0.0, 0.0, 0.1}, {0.0, 0.0, -0.25}, 0.03};
  ASSERT_EQ(loaded.try_attach({&bar, 1}), ArmStatus::kOk);
  TestArmPlanner<5> carrier(loaded);
  for (request_.seed = 1; request_.seed <= 5; ++request_.seed) {
    const PlanResult<Robot> result = carrier.planner.plan(request_);
    EXPECT_EQ(result.status, PlanStatus::kOk);
    expect_valid(loaded, request_, result);
  }
}

TEST_F(ArmPlannerAnswers, WithAnObstaclesOwnMargin) {
  ASSERT_EQ(test_.world.try_add(Sphere3{{0.0, -0.7, 0.6}, 0.05}, 0.15), WorldStatus::kOk);
  test_.world.build();
  TestWorld3 alone;
  ASSERT_EQ(alone.world.try_add(Sphere3{{0.0, -0.7, 0.6}, 0.05}), WorldStatus::kOk);
  alone.world.build();
  const PlanResult<Robot> result = plan();
  expect_valid(robot_, request_, result);
  ASSERT_EQ(result.margin_m, request_.options.margin_m);
  const PlanFacts facts =
      examine_plan(robot_, alone.world, result.plan->trajectory(), request_.start, request_.goal);
  EXPECT_GE(facts.clearance_m, 0.5 * 0.15);  // what a waypoint must keep at least
}

TEST_F(ArmPlannerAnswers, UnderEveryOption) {
  PlannerSettings settings = small_arm_settings();
  settings.dense_solver = true;
  TestArmPlanner<5> dense(robot_, settings);
  const auto expect_with = [&](const char* name, auto&& change) {
    SCOPED_TRACE(name);
    request_.options = PlanOptions::arm();
    change(request_.options);
    const PlanResult<Robot> result = dense.planner.plan(request_);
    EXPECT_EQ(result.status, PlanStatus::kOk);
    expect_valid(robot_, request_, result);
  };
  expect_with("one tree", [](PlanOptions& o) { o.sampler = SamplerMode::kRrtStar; });
  expect_with("no shortcut", [](PlanOptions& o) { o.shortcut = false; });
  expect_with("one stream", [](PlanOptions& o) { o.num_streams = 1; });
  expect_with("waypoint rows", [](PlanOptions& o) { o.rows = RowMode::kWaypoint; });
  expect_with("dense", [](PlanOptions& o) { o.solver = WindowSolver::kDense; });
  expect_with("no time scaling", [](PlanOptions& o) { o.resampling = Resampling::kOff; });
  expect_with("no sweep", [](PlanOptions& o) { o.max_iterations = 0; });
  expect_with("every sweep", [](PlanOptions& o) { o.tol_step = 0.0; });
  expect_with("nine windows", [](PlanOptions& o) { o.num_segments = 9; });
  expect_with("short windows", [](PlanOptions& o) { o.max_window = 10; });
  expect_with("wide margin", [](PlanOptions& o) { o.margin_m = 0.1; });
  expect_with("slow", [](PlanOptions& o) { o.speed_mps = 0.3; });
  expect_with("fast", [](PlanOptions& o) { o.speed_mps = 5.0; });
  expect_with("paper", [](PlanOptions& o) { o = PlanOptions::paper_arm(); });
  for (const MergeRule merge : {MergeRule::kOff, MergeRule::kPaired, MergeRule::kPrinted}) {
    expect_with("merging", [&](PlanOptions& o) { o.merge = merge; });
  }
}

// Linearised about rest, the first step of the only window is refused: its halves are tried.
TEST_F(ArmPlannerAnswers, WithASweepOverTheHalvesOfAWindowThatFailed) {
  request_.options.zero_input_start = true;
  const PlanResult<Robot> result = plan();
  expect_valid(robot_, request_, result);
  EXPECT_EQ(result.optimizer_counts.windows_failed, 1);
  EXPECT_GT(result.segments_final, 1);
  EXPECT_LT(result.path_length, 0.9 * result.history.front().path_length);
}

template <int N>
void expect_plans_for_chains(int num_wanted) {
  SCOPED_TRACE(N);
  Random random(40 + N);
  int num_planned = 0;
  for (int i = 0; i < 30 && num_planned < num_wanted; ++i) {
    RandomArm<N> drawn;
    ASSERT_TRUE(draw_chain(random, drawn));
    TestWorld3 test;
    scatter_obstacles(random, drawn.arm, 5, test.world);
    PlanRequest<Arm<N>> request;
    request.world = &test.world;
    request.options = PlanOptions::arm();
    const ClearanceRule rule{request.options.margin_m, 1.0, 1e-4};
    if (!draw_request(random, drawn.arm, test.world, rule, request.start, request.goal)) continue;
    TestArmPlanner<N> test_planner(drawn.arm);
    request.options.num_samples = 2000;
    request.options.num_batches = 1;
    const PlanResult<Arm<N>> result = test_planner.planner.plan(request);
    if (result.status == PlanStatus::kNoPath) {  // there may be none
      EXPECT_EQ(result.failure.stage, PlanStage::kSample);
      continue;
    }
    expect_valid(drawn.arm, request, result);
    ++num_planned;
  }
  EXPECT_EQ(num_planned, num_wanted);
}

TEST(ArmPlanner, PlansForFourToEightJointsOfAllKinds) {
  expect_plans_for_chains<4>(3);
  expect_plans_for_chains<5>(3);
  expect_plans_for_chains<6>(3);
  expect_plans_for_chains<7>(3);
  expect_plans_for_chains<8>(3);
}

// --- improving

class ArmPlannerImprove : public ArmPlannerTest {
 protected:
  PlanResult<Robot> plan(double improve_s) {
    request_.options.improve_s = improve_s;
    return test_planner_.planner.plan(request_);
  }

  ManualClock clock_{100};
  TestArmPlanner<5> test_planner_{robot_, small_arm_settings(), clock_.clock()};
};

TEST_F(ArmPlannerImprove, NeverLengthensAPlan) {
  int num_improved = 0;
  for (request_.seed = 1; request_.seed <= 12; ++request_.seed) {
    SCOPED_TRACE(request_.seed);
    const double first_length = plan(0.0).path_length;
    const PlanResult<Robot> result = plan(1e-3);
    ASSERT_EQ(result.status, PlanStatus::kOk);
    expect_valid(robot_, request_, result);
    ASSERT_FALSE(result.improvements.empty());
    EXPECT_EQ(result.improvements.front().path_length, first_length);
    EXPECT_EQ(result.improvements.back().path_length, result.path_length);
    for (std::size_t i = 1; i < result.improvements.size(); ++i) {
      EXPECT_LT(result.improvements[i].path_length, result.improvements[i - 1].path_length);
      EXPECT_GT(result.improvements[i].time_ns, result.improvements[i - 1].time_ns);
    }
    num_improved += result.improvements.size() > 1 ? 1 : 0;
  }
  EXPECT_GT(num_improved, 3);
}

TEST_F(ArmPlannerImprove, OfALongerSearchIsNoLonger) {
  double length = plan(0.0).path_length;
  for (const double improve_s : {1e-4, 3e-4, 1e-3, 3e-3}) {
    const double longer_search = plan(improve_s).path_length;
    EXPECT_LE(longer_search, length) << improve_s;
    length = longer_search;
  }
}

TEST_F(ArmPlannerImprove, LeavesTheOtherSlotsAsTheyAre) {
  const PlanResult<Robot> one = plan(0.0);
  const PlanResult<Robot> two = plan(1e-3);
  const std::vector<double> before[] = {numbers_of(one), numbers_of(two)};
  EXPECT_EQ(plan(1e-3).status, PlanStatus::kOk);
  EXPECT_EQ(numbers_of(one), before[0]);
  EXPECT_EQ(numbers_of(two), before[1]);
}

}  // namespace
}  // namespace sopt::oracle
