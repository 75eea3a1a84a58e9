// Windows of random arms among random obstacles: whatever the joints, limits and obstacles are, a
// window keeps its ends to the bit, never raises its cost, and what it leaves is dynamically exact,
// within all limits and clear between its waypoints, found by dense sampling.
#include <cstdio>
#include <string>

#include "opt/arm/arm_window.h"
#include "tests/support/arm_cases.h"
#include "tests/support/arm_segment.h"
#include "tests/support/property.h"
#include "tests/support/test_problem.h"

namespace sopt::oracle {
namespace {

constexpr double kDt_s = 0.05;
constexpr double kStep = 0.05;
constexpr double kMinClearance_m = 1e-4;

template <int N>
struct Optimizer {
  PlannerSettings settings = PlannerSettings::arm();
  InArena<typename WindowOptimizer<Arm<N>>::Shared> shared{settings};
  InArena<WindowOptimizer<Arm<N>>> window{settings, *shared};
};

template <int N>
void check_window(Random& random, CaseReport& report) {
  static Optimizer<N> optimizer;
  static ArmTestWorld test;
  static EmptyArmTrajectory<N> reference;
  RandomArm<N> drawn;
  draw_arm(random, drawn);
  report.expect("the arm is valid", drawn.arm.reset(drawn.description) == ArmStatus::kOk);
  const Arm<N>& arm = drawn.arm;
  const auto way = random_way(random, arm, 1 + random.index(2));
  const double margin_m = random.uniform(1e-3, 0.04);
  draw_obstacles(random, arm, way, random.index(7), 2.0, margin_m + 1e-3, test.world, 100);
  make_arm_reference(arm, way, kStep, kDt_s, reference.trajectory);
  States<N> states(reference.trajectory.states.begin(), reference.trajectory.states.end());
  const int horizon = static_cast<int>(states.size()) - 1;
  const int first = random.index(1 + horizon / 2);
  const Window window{first, std::min(horizon, first + 3 + random.index(120))};
  if (window.num_steps() < 3) return;

  SweepProblem<Arm<N>> problem;
  problem.robot = &arm;
  problem.world = &test.world;
  problem.profile.rule = {margin_m, 1.0, kMinClearance_m + 1e-8};
  problem.trust_m = kArmActivation_m;
  problem.ds_m = kStep;
  problem.dt_s = kDt_s;
  problem.min_clearance_m = kMinClearance_m;
  const States<N> before = states;
  problem.states = states;
  const WindowResult result = optimizer.window->optimize(problem, window, Deadline());

  const auto cost = [&](const States<N>& z) {
    return arm_cost<N>(arm, States<N>(z.begin() + window.first, z.begin() + window.last + 1), kDt_s,
                       kStep);
  };
  report.expect("the window ran", result.status != WindowStatus::kNotRun);
  report.expect_within("cost rises", cost(states) - cost(before), 1e-12 * cost(before));
  report.expect_within("told cost", std::abs(result.cost_after - cost(states)),
                       1e-9 * cost(before));
  for (int t = 0; t <= horizon; ++t) {
    const auto i = static_cast<std::size_t>(t);
    const bool is_inside = t > window.first && t < window.last;
    if (!is_inside) report.expect("outside stays", states[i] == before[i]);
  }
  const TrajectoryFacts facts = examine(arm, test.world, states, kDt_s, 8);
  report.expect_within("defect", facts.defect, 1e-12);
  report.expect("limits", facts.limit_excess <= 0.0);
  report.expect("clear", facts.clearance_m >= kMinClearance_m - 1e-12);
}

std::string check(Random& random, CaseReport& report) {
  return with_joints(4 + random.index(5), [&](auto n) {
    check_window<n>(random, report);
    return "an arm of " + std::to_string(n()) + " joints";
  });
}

}  // namespace
}  // namespace sopt::oracle

int main(int argc, char** argv) {
  return sopt::oracle::run_property("arm_window", argc, argv, sopt::oracle::check);
}
