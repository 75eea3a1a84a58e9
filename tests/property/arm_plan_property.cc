// Whole plans of random arms of 4 to 8 joints and of the presets, among random obstacles, under
// random options, deadlines and orders of workers: every plan is judged by an oracle that shares no
// geometry with the library, what it says of itself holds, and every failure has its reason.
#include <cstdio>
#include <cstring>
#include <optional>
#include <string>

#include "opt/planner.h"
#include "tests/support/arm_cases.h"
#include "tests/support/arm_planner_fixture.h"
#include "tests/support/property.h"
#include "tests/support/test_arm.h"
#include "tests/support/test_problem.h"

namespace {

using namespace sopt;
using namespace sopt::oracle;

struct Totals {
  int num_planned = 0;
  int num_cut = 0;  // by a deadline
  int num_fell_back = 0;
  int num_no_path = 0;
  int num_refused = 0;  // start or goal
} totals;

PlannerSettings settings_for(const PlanOptions& options) {
  PlannerSettings settings = small_arm_settings();
  settings.max_horizon = 600;
  settings.max_window = 120;
  settings.dense_solver = options.solver == WindowSolver::kDense;
  return settings;
}

PlanOptions draw_options(Random& random) {
  PlanOptions options = random.chance(0.1) ? PlanOptions::paper_arm() : PlanOptions::arm();
  options.num_samples = 1500;
  options.num_batches = 1;
  if (random.chance(0.5)) options.margin_m = random.uniform(2e-4, 0.06);
  if (random.chance(0.2)) options.min_clearance_m = random.uniform(1e-6, options.margin_m);
  if (random.chance(0.2)) options.sampler = SamplerMode::kRrtStar;
  if (random.chance(0.2)) options.shortcut = !options.shortcut;
  if (random.chance(0.3)) options.speed_mps = random.uniform(0.3, 3.0);
  if (random.chance(0.3)) options.dt_s = random.uniform(0.02, 0.12);
  if (random.chance(0.2)) options.num_segments = 1 + random.index(9);
  if (random.chance(0.2)) options.steps_per_window = 10 + random.index(100);
  if (random.chance(0.1)) options.max_window = 4 + random.index(100);
  if (random.chance(0.3)) options.merge = static_cast<MergeRule>(random.index(4));
  if (random.chance(0.2)) options.resampling = static_cast<Resampling>(random.index(2));
  if (random.chance(0.2)) options.rows = static_cast<RowMode>(random.index(3));
  if (random.chance(0.1)) options.solver = WindowSolver::kDense;
  if (random.chance(0.1)) options.accept = !options.accept;
  if (random.chance(0.1)) options.zero_input_start = !options.zero_input_start;
  if (random.chance(0.1)) options.tol_step = 0.0;
  if (random.chance(0.1)) options.improve_s = 1e-4;  // of a clock that counts its readings
  return options;
}

// Free most of the time.
template <int N>
typename Arm<N>::Config draw_end(Random& random, const Arm<N>& arm, const World3& world) {
  typename Arm<N>::Config q;
  draw_free(random, arm, world, {0.0, 0.0, 2e-4}, 2e-4, 201, q);
  if (random.chance(0.1)) {  // against a limit
    const int j = random.index(N);
    if (!arm.is_continuous(j)) q[j] = random.chance(0.5) ? arm.lower()[j] : arm.upper()[j];
  }
  return q;
}

template <int N>
void check_plan(const Arm<N>& arm, const PlanRequest<Arm<N>>& request,
                const PlanResult<Arm<N>>& result, CaseReport& report) {
  const PlanFacts facts =
      examine_plan(arm, *request.world, result.plan->trajectory(), request.start, request.goal, 6);
  const PlanOptions& options = request.options;
  const char* const fault = find_fault(facts, options.min_clearance_m);
  if (std::strlen(fault) > 0) return report.fail(std::string("the plan ") + fault);
  report.expect_within("told length", std::abs(result.path_length - facts.length),
                       1e-9 * (1.0 + facts.length));
  const Certificate& certificate = result.plan->certificate();
  const auto promise = [&](const char* what, double certified_m, double found_m) {
    if (std::isinf(found_m)) return report.expect(what, std::isinf(certified_m));
    report.expect_within(what, certified_m - found_m, 1e-9);
    report.expect_within(what, found_m - certified_m, 2e-3 + 0.02 * std::abs(found_m));
  };
  promise("certified clearance", certificate.min_clearance_m, facts.clearance_m);
  promise("certified clearance between links", certificate.min_self_clearance_m,
          facts.self_clearance_m);
  const double excess = -certificate.worst_limit_margin;
  report.expect_within("limits as certified", excess, 1e-9);
  if (!options.accept) return;
  for (std::size_t k = 1; k < result.history.size(); ++k) {
    report.expect("cost never rises", result.history[k].cost <= result.history[k - 1].cost);
  }
}

template <int N>
void check_failure(const PlanRequest<Arm<N>>& request, const PlanResult<Arm<N>>& result,
                   CaseReport& report) {
  const PlanFailure& failure = result.failure;
  switch (result.status) {
    case PlanStatus::kNoPath:
      ++totals.num_no_path;
      report.expect("plan 0 passes verify", failure.stage == PlanStage::kSample);
      break;
    case PlanStatus::kBadStart:
    case PlanStatus::kBadGoal:
      ++totals.num_refused;
      report.expect("evidence of a bad end", failure.amount < failure.lower);
      break;
    case PlanStatus::kDeadline:
      ++totals.num_cut;
      report.expect("a deadline was set", std::isfinite(request.deadline_s));
      break;
    case PlanStatus::kCapacity:
      report.expect("the path needs too many steps", failure.amount > 100.0);
      break;
    default:
      report.fail("status " + std::to_string(static_cast<int>(result.status)));
  }
}

template <int N>
std::string check_request(Random& random, const Arm<N>& arm, CaseReport& report) {
  TestWorld3 test({16, 16});
  scatter_obstacles(random, arm, random.chance(0.2) ? 0 : random.index(10), test.world);
  PlanRequest<Arm<N>> request;
  request.world = &test.world;
  request.options = draw_options(random);
  request.seed = static_cast<std::uint64_t>(random.index(1000));
  request.start = draw_end(random, arm, test.world);
  request.goal = random.chance(0.03) ? request.start : draw_end(random, arm, test.world);
  if (random.chance(0.2)) request.deadline_s = 1e-9 * std::pow(10.0, random.uniform(1.0, 5.0));

  // Of two clocks that go alike; the order of workers is another one.
  const PlannerSettings settings = settings_for(request.options);
  ManualClock clocks[2] = {ManualClock(100), ManualClock(100)};
  TestArmPlanner<N> planner(arm, settings, clocks[0].clock());
  const PlanResult<Arm<N>> result = planner.planner.plan(request);
  report.expect("a plan exactly when the status says so",
                static_cast<bool>(result.plan) == (static_cast<int>(result.status) >= 0));
  if (result.plan) {
    ++totals.num_planned;
    totals.num_fell_back += result.fell_back ? 1 : 0;
    totals.num_cut += result.status == PlanStatus::kDeadlineFeasible ? 1 : 0;
    check_plan(arm, request, result, report);
  } else {
    check_failure(request, result, report);
  }
  if (std::isinf(request.deadline_s) && request.options.improve_s == 0.0) {
    ReverseExecutor reverse;
    TestArmPlanner<N> other(arm, settings, clocks[1].clock(), reverse);
    const PlanResult<Arm<N>> again = other.planner.plan(request);
    report.expect("the same bytes for three workers",
                  again.status == result.status && numbers_of(again) == numbers_of(result));
  }
  return std::to_string(N) + " joints, " + std::to_string(test.world.num_obstacles()) +
         " obstacles, status " + std::to_string(static_cast<int>(result.status)) + ", stage " +
         std::to_string(static_cast<int>(result.failure.stage)) + ", " + result.failure.reason +
         ", margin " + std::to_string(request.options.margin_m) + " min_clearance " +
         std::to_string(request.options.min_clearance_m);
}

std::string check_case(Random& random, CaseReport& report) {
  return with_chain_or_preset(random, report, 2,
                              [&](const auto& arm) { return check_request(random, arm, report); });
}

}  // namespace

int main(int argc, char** argv) {
  const int code = run_property("arm_plan", argc, argv, check_case);
  std::printf("planned %d, fell back %d, cut %d, no path %d, bad ends %d\n", totals.num_planned,
              totals.num_fell_back, totals.num_cut, totals.num_no_path, totals.num_refused);
  return code;
}
