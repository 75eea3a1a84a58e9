// The optimiser on random arms of 4 to 8 joints among random obstacles, after every number of
// sweeps: cost never rises from one sweep to the next, and every iterate is a trajectory that could
// be executed: exact ends, dynamics, limits between waypoints too, and clear of obstacles and of
// itself, by an oracle that shares no geometry with the library.
#include <cstring>
#include <string>

#include "opt/margin_ladder.h"
#include "opt/reference.h"
#include "opt/segmented_optimizer.h"
#include "opt/time_scaling.h"
#include "tests/support/arm_cases.h"
#include "tests/support/arm_planner_fixture.h"
#include "tests/support/arm_segment.h"
#include "tests/support/property.h"
#include "tests/support/test_problem.h"

namespace {

using namespace sopt;
using namespace sopt::oracle;

PlannerSettings settings() {
  PlannerSettings settings = small_arm_settings();
  settings.max_horizon = 500;
  settings.max_window = 100;
  settings.dense_solver = true;
  return settings;
}

template <int N>
struct Workshop {
  SerialExecutor serial;
  ManualClock clock;
  InArena<SegmentedOptimizer<Arm<N>>> optimizer{settings(), serial, clock.clock()};
  EmptyArmTrajectory<N> reference, trajectory;
};

PlanOptions draw_options(Random& random) {
  PlanOptions options = PlanOptions::arm();
  options.num_samples = 1500;
  options.num_batches = 1;
  options.resampling = Resampling::kOff;
  if (random.chance(0.5)) options.margin_m = random.uniform(1e-3, 0.05);
  if (random.chance(0.5)) options.num_segments = 1 + random.index(9);
  if (random.chance(0.5)) options.steps_per_window = 10 + random.index(90);
  options.merge = static_cast<MergeRule>(random.index(4));
  options.rows = random.chance(0.8) ? RowMode::kEdge : RowMode::kWaypoint;
  if (random.chance(0.2)) options.solver = WindowSolver::kDense;
  if (random.chance(0.2)) options.tol_step = 0.0;
  return options;
}

// A reference that a planner accepted.
template <int N>
bool draw_reference(Random& random, const Arm<N>& arm, PlanRequest<Arm<N>>& request,
                    MarginProfile& profile, Trajectory<Arm<N>>& out) {
  const ClearanceRule rule{0.0, 1.0, 2e-3};
  const bool hugs_limits = random.chance(0.4);
  for (auto* end : {&request.start, &request.goal}) {
    draw_free(random, arm, *request.world, rule, 1e-3, 100, *end, [&](auto& q) {
      for (int j = 0; j < N && hugs_limits; ++j) {
        if (!arm.is_continuous(j) && random.chance(0.7)) q[j] = arm.lower()[j];
      }
    });
  }
  PlanRequest<Arm<N>> plain = request;
  plain.options.max_iterations = 0;
  TestArmPlanner<N> test_planner(arm, settings());
  const PlanResult<Arm<N>> result = test_planner.planner.plan(plain);
  if (!result.plan) return false;
  const Trajectory<Arm<N>>& plan = result.plan->trajectory();
  out.dt_s = plan.dt_s;
  const double step_length = choose_step_length(arm, *request.world, request.options);
  for (const MarginProfile& rung : make_margin_ladder(arm, request, step_length, 500)) {
    if (rung.rule.rung * request.options.margin_m == result.margin_m) profile = rung;
  }
  return out.states.try_assign(plan.states.span());
}

template <int N>
std::string check_arm(Random& random, const Arm<N>& arm, CaseReport& report) {
  static Workshop<N> shop;
  TestWorld3 test({16, 16});
  scatter_obstacles(random, arm, random.index(9), test.world);
  PlanRequest<Arm<N>> request;
  request.world = &test.world;
  request.options = draw_options(random);
  MarginProfile profile;
  if (!draw_reference(random, arm, request, profile, shop.reference.trajectory)) return "no path";
  const double step_length = choose_step_length(arm, test.world, request.options);
  double cost = std::numeric_limits<double>::infinity();
  bool is_done = false;
  for (const int max_iterations : {1, 2, 3, 5, 20}) {
    if (is_done) break;
    request.options.max_iterations = max_iterations;
    Trajectory<Arm<N>>& trajectory = shop.trajectory.trajectory;
    (void)trajectory.states.try_assign(shop.reference.trajectory.states.span());
    trajectory.dt_s = shop.reference.trajectory.dt_s;
    const OptimizerResult<Arm<N>> result = shop.optimizer->optimize(
        {&arm, &test.world, profile, step_length, &request.options}, trajectory, Deadline());
    is_done = result.iterations < max_iterations;
    report.expect("every sweep is recorded",
                  result.history.size() == static_cast<std::size_t>(result.iterations) + 1);
    for (std::size_t k = 1; k < result.history.size(); ++k) {
      report.expect("cost never rises", result.history[k].cost <= result.history[k - 1].cost);
    }
    report.expect("more sweeps cost no more", result.cost <= cost);
    cost = result.cost;
    report.expect("inputs fit", fill_inputs(trajectory));
    const PlanFacts facts =
        examine_plan(arm, test.world, trajectory, request.start, request.goal, 5);
    const char* const fault = find_fault(facts, request.options.min_clearance_m);
    if (std::strlen(fault) > 0) {
      report.fail("after " + std::to_string(result.iterations) + " sweeps the iterate " + fault);
    }
    const States<N> states(trajectory.states.begin(), trajectory.states.end());
    const double expected = arm_cost<N>(arm, states, trajectory.dt_s, step_length);
    report.expect_within("told cost", std::abs(result.cost - expected), 1e-9 * (1.0 + expected));
  }
  return std::to_string(N) + " joints, " + std::to_string(test.world.num_obstacles()) +
         " obstacles, margin " + std::to_string(request.options.margin_m);
}

std::string check_case(Random& random, CaseReport& report) {
  return with_chain_or_preset(random, report, 1,
                              [&](const auto& arm) { return check_arm(random, arm, report); });
}

}  // namespace

int main(int argc, char** argv) { return run_property("arm_optimizer", argc, argv, check_case); }
