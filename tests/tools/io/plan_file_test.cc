#include "tools/io/plan_file.h"

#include <limits>
#include <nlohmann/json.hpp>

#include "opt/verify/verify.h"
#include "rt/executor.h"
#include "tests/tools/temporary_folder.h"
#include "tools/io/input_error.h"

namespace sopt {
namespace {

class PlanFileTest : public TemporaryFolderTest {
 protected:
  void SetUp() override {
    TemporaryFolderTest::SetUp();
    scene_ = load_scene(data_file("three_obstacles.json"));
  }
  Scene scene_;
};

TEST_F(PlanFileTest, PlansComeBackBitByBit) {
  const PlanRequest<Point2> request = make_request(scene_);
  const PlannerSettings settings = make_settings(scene_, request.options);
  const MemoryBlock memory(Planner<Point2>::required_bytes(settings));
  Arena arena(memory);
  SerialExecutor executor;
  Planner<Point2> planner(arena, scene_.robot, settings, executor);
  ASSERT_FALSE(arena.exhausted());
  const PlanResult<Point2> result = planner.plan(request);
  ASSERT_TRUE(result.plan);
  const ReceivedPlan<Point2> received = load_plan<Point2>(
      write("plan.json", plan_to_text(scene_, request, result, result.times)), "point2d");

  const Trajectory<Point2>& sent = result.plan->trajectory();
  EXPECT_EQ(received.scene_name, "three_obstacles");
  EXPECT_EQ(received.status, "ok");
  EXPECT_EQ(received.trajectory.dt_s, sent.dt_s);
  ASSERT_EQ(received.trajectory.horizon(), sent.horizon());
  for (int i = 0; i <= sent.horizon(); ++i) {
    ASSERT_EQ(received.trajectory.states[i], sent.states[i]);
  }
  for (int i = 0; i < sent.horizon(); ++i) {
    ASSERT_EQ(received.trajectory.inputs[i], sent.inputs[i]);
  }
  VerifyProblem<Point2> problem{scene_.start, scene_.goal, scene_.world.get()};
  EXPECT_TRUE(verify(scene_.robot, received.trajectory, problem).plan);
}

TEST_F(PlanFileTest, RefusedRequestsAreWrittenWithTheirFailure) {
  PlanResult<Point2> result;
  result.status = PlanStatus::kBadGoal;
  result.failure = {
      PlanStage::kRequest, "too close", 0, 1, 0.0, -std::numeric_limits<double>::infinity()};
  const std::string text = plan_to_text(scene_, make_request(scene_), result, {});
  const nlohmann::json json = nlohmann::json::parse(text);
  EXPECT_EQ(json["failure"]["obstacle"], "crate");
  EXPECT_TRUE(json["failure"]["amount"].is_null());
  EXPECT_EQ(json["failure"]["reason"], "too close");
  const ReceivedPlan<Point2> received = load_plan<Point2>(write("plan.json", text), "point2d");
  EXPECT_EQ(received.status, "bad_goal");
  EXPECT_EQ(received.trajectory.horizon(), 0);
}

TEST_F(PlanFileTest, ObstaclesAreIdsElseIndicesElseWords) {
  EXPECT_EQ(obstacle_to_json(scene_.obstacle_ids, 0), 0);
  EXPECT_EQ(obstacle_to_json(scene_.obstacle_ids, 1), "crate");
  EXPECT_EQ(obstacle_to_json(scene_.obstacle_ids, kBoundsObstacle), "bounds");
  EXPECT_TRUE(obstacle_to_json(scene_.obstacle_ids, kNoObstacle).is_null());
}

TEST_F(PlanFileTest, EveryStatusIsReadBack) {
  const nlohmann::json good =
      nlohmann::json::parse(read_file(data_file("three_obstacles_plan.json")));
  for (const PlanStatus status :
       {PlanStatus::kOk, PlanStatus::kDeadlineFeasible, PlanStatus::kNoPath, PlanStatus::kDeadline,
        PlanStatus::kBadStart, PlanStatus::kBadGoal, PlanStatus::kCapacity, PlanStatus::kNoSlot,
        PlanStatus::kBadInput}) {
    nlohmann::json plan = good;
    plan["status"] = to_string(status);
    EXPECT_EQ(load_plan<Point2>(write("plan.json", plan.dump()), "point2d").status,
              to_string(status));
  }
}

}  // namespace
}  // namespace sopt
