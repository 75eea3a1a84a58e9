// A Planner<Arm<N>> with its memory, random chains that fold freely, and an independent check of
// what a planner returns.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "models/arm/arm_pairs.h"
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

// Links of one capsule, from joint to joint, that may collide when they are apart at home; joints
// of all kinds about any axis. About 1.5 m long. False when it is refused.
template <int N>
[[nodiscard]] bool draw_chain(Random& random, RandomArm<N>& out) {
  out.description = {};
  if (random.chance(0.5)) out.description.X_WB = random_pose(random, 1.0);
  out.capsules.clear();
  for (int i = 0; i <= N; ++i) {
    const Vec3 end = random.uniform(0.08, 2.0 / N) * Vec3::UnitZ();
    out.capsules.push_back({i, Vec3::Zero(), end, random.uniform(0.02, 0.05)});
    if (i == N) break;
    ArmJoint& joint = out.description.joints[static_cast<std::size_t>(i)];
    joint.origin = random_pose(random, 0.0);
    joint.origin.position = end;
    joint.axis = random_axis(random);
    const int kind = random.index(6);
    joint.kind = kind == 0   ? JointKind::kPrismatic
                 : kind == 1 ? JointKind::kContinuous
                             : JointKind::kRevolute;
    const double reach = kind == 0 ? 0.2 : 3.0;
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    joint.lower = kind == 1 ? -kInfinity : random.uniform(-reach, -0.3 * reach);
    joint.upper = kind == 1 ? kInfinity : random.uniform(0.3 * reach, reach);
    joint.v_max = random.uniform(0.3, 3.0);
    joint.a_max = random.uniform(1.0, 15.0);
  }
  out.description.capsules = out.capsules;
  if (out.arm.reset(out.description) != ArmStatus::kOk) return false;
  const LinkPairList pairs = find_pairs_apart(out.arm);
  out.description.pairs = pairs.view();
  const ArmStatus status = out.arm.reset(out.description);
  out.description.pairs = {};
  return status == ArmStatus::kOk;
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
