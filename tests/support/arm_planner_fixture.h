// A Planner<Arm<N>> with its memory, and an independent check of what it returns.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "models/arm/arm_presets.h"
#include "opt/planner.h"
#include "rt/executor.h"
#include "tests/support/arm_oracle.h"
#include "tests/support/arm_plan_oracle.h"
#include "tests/support/test_arm.h"

namespace sopt::oracle {

[[nodiscard]] inline PlannerSettings small_arm_settings() {
  PlannerSettings settings = PlannerSettings::arm();
  settings.num_streams = 2;
  settings.nodes_per_stream = 2000;
  settings.max_path_vertices = 256;
  settings.max_lattice_points = 0;
  return settings;
}

template <int N>
struct TestArmPlanner {
  explicit TestArmPlanner(const Arm<N>& arm, const PlannerSettings& settings = small_arm_settings(),
                          Clock clock = monotonic_clock())
      : TestArmPlanner(arm, settings, clock, serial) {}
  TestArmPlanner(const Arm<N>& arm, const PlannerSettings& settings, Clock clock,
                 Executor& executor)
      : block(Planner<Arm<N>>::required_bytes(settings, executor.num_workers())),
        arena(block),
        planner(arena, arm, settings, executor, clock) {}

  SerialExecutor serial;
  MemoryBlock block;
  Arena arena;
  Planner<Arm<N>> planner;
};

// The plan as numbers: equal exactly when plans are the same bytes. None without a plan.
template <int N>
[[nodiscard]] std::vector<double> numbers_of(const PlanResult<Arm<N>>& result) {
  std::vector<double> numbers;
  if (!result.plan) return numbers;
  const Trajectory<Arm<N>>& plan = result.plan->trajectory();
  numbers.push_back(plan.dt_s);
  for (const auto& z : plan.states) numbers.insert(numbers.end(), z.data(), z.data() + z.size());
  for (const auto& u : plan.inputs) numbers.insert(numbers.end(), u.data(), u.data() + u.size());
  return numbers;
}

// Fails unless the status says that there is a plan and the plan holds what it must.
template <int N>
void expect_valid(const Arm<N>& arm, const PlanRequest<Arm<N>>& request,
                  const PlanResult<Arm<N>>& result) {
  ASSERT_GE(static_cast<int>(result.status), 0)
      << result.failure.reason << " " << result.failure.amount;
  ASSERT_TRUE(static_cast<bool>(result.plan));
  const PlanFacts facts =
      examine_plan(arm, *request.world, result.plan->trajectory(), request.start, request.goal);
  EXPECT_STREQ(find_fault(facts, request.options.min_clearance_m), "");
  EXPECT_NEAR(result.path_length, facts.length, 1e-9 * (1.0 + facts.length));
  EXPECT_LE(result.plan->certificate().min_clearance_m, facts.clearance_m + 1e-9);
  EXPECT_LE(result.plan->certificate().min_self_clearance_m, facts.self_clearance_m + 1e-9);
}

// The LR Mate turns past a pillar that its forearm does not pass stretched.
class ArmPlannerTest : public testing::Test {
 protected:
  using Robot = Arm<5>;

  void SetUp() override {
    add(Box3{{Mat3::Identity(), {0.4, 0.0, 0.4}}, {0.1, 0.1, 0.8}});
    add(Sphere3{{-0.3, 0.5, 0.2}, 0.1});
    test_.world.build();
    request_.start = {-1.2, 0.3, 0.1, 0.0, 0.0};
    request_.goal = {1.1, 0.5, 0.0, 0.5, -0.4};
    request_.world = &test_.world;
    request_.options = PlanOptions::arm();
    request_.seed = 3;
  }

  template <class Shape>
  void add(const Shape& shape) {
    ASSERT_EQ(test_.world.try_add(shape), WorldStatus::kOk);
    test_.world.build();
  }

  const Robot robot_ = lr_mate_200id_7l();
  TestWorld3 test_;
  PlanRequest<Robot> request_;
};

}  // namespace sopt::oracle
