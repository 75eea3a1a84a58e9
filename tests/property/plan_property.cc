// Whole plans in random worlds: 0..40 obstacles, robots of several sizes, some ends within the
// margin. A plan must be accepted by brute force from the raw shapes and keep the margin it
// reports; without a plan there must be a reason, and no wide way through the world. The same bytes
// on every run and for any order of work; a plan for every number of segments; no heap. With the
// paper's choices among the options cost and margin are not promised, the rest is.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <queue>
#include <string>
#include <vector>

#include "opt/planner.h"
#include "tests/support/property.h"
#include "tests/support/rt_guard.h"
#include "tests/support/test_problem.h"
#include "tests/support/test_world.h"

namespace {

using namespace sopt;
using namespace sopt::oracle;

constexpr double kTol_m = 1e-9;
// The optimiser may use up rows' tolerance in every sweep.
constexpr double kMarginTol_m = 1e-7;
constexpr double kExtent_m = 10.0;
constexpr double kRadii_m[] = {0.0, 0.05, 0.2};

PlannerSettings small_settings() {
  PlannerSettings settings;
  settings.nodes_per_stream = 4000;
  settings.max_horizon = 1024;
  settings.dense_solver = true;
  return settings;
}

// One planner per radius and executor, used for all cases.
struct Fixture {
  SerialExecutor serial;
  ReverseExecutor reverse;
  InArena<Planner<Point2>> planners[3] = {
      InArena<Planner<Point2>>(Point2{kRadii_m[0]}, small_settings(), serial),
      InArena<Planner<Point2>>(Point2{kRadii_m[1]}, small_settings(), serial),
      InArena<Planner<Point2>>(Point2{kRadii_m[2]}, small_settings(), serial)};
  InArena<Planner<Point2>> reverse_planners[3] = {
      InArena<Planner<Point2>>(Point2{kRadii_m[0]}, small_settings(), reverse),
      InArena<Planner<Point2>>(Point2{kRadii_m[1]}, small_settings(), reverse),
      InArena<Planner<Point2>>(Point2{kRadii_m[2]}, small_settings(), reverse)};
  TestWorld test;
};

struct Case {
  Scene scene;
  int i_radius = 0;
  PlanRequest<Point2> request;

  [[nodiscard]] double radius_m() const { return kRadii_m[i_radius]; }
};

// True when the sweeps promise that cost never rises and the margin is kept.
bool is_monotone(const PlanOptions& options) {
  return options.rows == RowMode::kEdge && options.accept && !options.zero_input_start &&
         options.resampling != Resampling::kRediscretize;
}

// All of the paper's choices, or any of them.
void draw_paper_choices(Random& random, PlanOptions& options) {
  const PlanOptions paper = PlanOptions::paper();
  const bool is_all = random.chance(0.3);
  const auto take = [&](auto PlanOptions::*member) {
    if (is_all || random.chance(0.3)) options.*member = paper.*member;
  };
  take(&PlanOptions::sampler);
  take(&PlanOptions::shortcut);
  take(&PlanOptions::lattice);
  take(&PlanOptions::steps_per_window);
  take(&PlanOptions::merge);
  take(&PlanOptions::resampling);
  take(&PlanOptions::rows);
  take(&PlanOptions::solver);
  take(&PlanOptions::accept);
  take(&PlanOptions::zero_input_start);
  if (!is_all && random.chance(0.2)) options.rows = RowMode::kWaypoint;
}

Case draw_case(Random& random) {
  Case c;
  const Aabb2 bounds = {Vec2::Zero(), Vec2::Constant(kExtent_m)};
  c.scene = random_scene(random, bounds, random.index(41), random.uniform(0.2, 1.2));
  c.i_radius = random.index(3);
  c.request.seed = static_cast<std::uint64_t>(random.index(1000));
  PlanOptions& options = c.request.options;
  options.margin_m = random.chance(0.5) ? 0.05 : random.uniform(1e-4, 0.4);
  options.sampler = random.chance(0.7) ? SamplerMode::kRrtStarConnect : SamplerMode::kRrtStar;
  options.num_samples = 3000;
  options.num_batches = 1;
  options.merge = random.chance(0.8) ? MergeRule::kPaired : MergeRule::kOff;
  options.shortcut = random.chance(0.8);
  options.lattice = random.chance(0.8);
  options.resampling = random.chance(0.8) ? Resampling::kScale : Resampling::kOff;
  if (random.chance(0.2)) options.tol_step = 0.0;
  if (random.chance(0.2)) options.max_window = 4 + random.index(57);
  if (random.chance(0.5)) draw_paper_choices(random, options);
  // Ends are free by the hard minimum most of the time; some closer than the margin.
  const SceneOracle dense(c.scene);
  const double wanted_m = random.chance(0.9) ? options.min_clearance_m + 1e-6 : -kFar_m;
  const Aabb2 inner = {Vec2::Constant(c.radius_m() + 1e-3),
                       Vec2::Constant(kExtent_m - c.radius_m() - 1e-3)};
  for (Vec2* end : {&c.request.start, &c.request.goal}) {
    for (int k = 0; k < 200; ++k) {
      *end = random.point(inner);
      if (dense.clearance(*end, *end, c.radius_m()) >= wanted_m) break;
    }
  }
  return c;
}

std::string to_text(const Case& c) {
  const PlanOptions& o = c.request.options;
  char rest[500];
  std::snprintf(
      rest, sizeof rest,
      ",\"radius\":%.17g,\"seed\":%d,\"margin\":%.17g,\"sampler\":%d,\"merge\":%d,"
      "\"shortcut\":%d,\"lattice\":%d,\"resampling\":%d,\"tol_step\":%.17g,\"max_window\":%d,"
      "\"rows\":%d,\"solver\":%d,\"accept\":%d,\"zero_input_start\":%d,"
      "\"steps_per_window\":%d}",
      c.radius_m(), static_cast<int>(c.request.seed), o.margin_m, static_cast<int>(o.sampler),
      static_cast<int>(o.merge), o.shortcut, o.lattice, static_cast<int>(o.resampling), o.tol_step,
      o.max_window, static_cast<int>(o.rows), static_cast<int>(o.solver), o.accept,
      o.zero_input_start, o.steps_per_window);
  return "{" + sopt::oracle::to_text(c.scene) +
         ",\"start\":" + sopt::oracle::to_text(c.request.start) +
         ",\"goal\":" + sopt::oracle::to_text(c.request.goal) + rest;
}

// True when a way of grid moves keeps `clearance_m`: then any planner should find one with less.
bool has_wide_way(const Case& c, const SceneOracle& dense, double clearance_m) {
  constexpr int kSide = 50;
  constexpr double kCell_m = kExtent_m / kSide;
  const auto center = [](int i) {
    const int column = i % kSide;
    const int row = i / kSide;
    return Vec2((column + 0.5) * kCell_m, (row + 0.5) * kCell_m);
  };
  const auto cell_of = [](const Vec2& z) {
    return static_cast<int>(z.x() / kCell_m) + kSide * static_cast<int>(z.y() / kCell_m);
  };
  const auto is_free = [&](const Vec2& a, const Vec2& b) {
    return dense.clearance(a, b, c.radius_m()) >= clearance_m;
  };
  const int first = cell_of(c.request.start);
  const int last = cell_of(c.request.goal);
  if (!is_free(c.request.start, center(first)) || !is_free(c.request.goal, center(last))) {
    return false;
  }
  std::vector<bool> is_seen(kSide * kSide);
  std::queue<int> queue;
  queue.push(first);
  is_seen[static_cast<std::size_t>(first)] = true;
  while (!queue.empty()) {
    const int i = queue.front();
    queue.pop();
    if (i == last) return true;
    const int neighbors[] = {i % kSide > 0 ? i - 1 : -1, i % kSide < kSide - 1 ? i + 1 : -1,
                             i - kSide, i + kSide};
    for (const int k : neighbors) {
      if (k < 0 || k >= kSide * kSide || is_seen[static_cast<std::size_t>(k)]) continue;
      if (!is_free(center(i), center(k))) continue;
      is_seen[static_cast<std::size_t>(k)] = true;
      queue.push(k);
    }
  }
  return false;
}

void check_motion(const Case& c, const SceneOracle& dense, const PlanResult<Point2>& result,
                  CaseReport& report) {
  const Trajectory<Point2>& plan = result.plan->trajectory();
  const auto states = plan.states.span();
  const double clearance_m = dense.min_clearance(states, c.radius_m());
  report.expect_within("clearance below the minimum",
                       c.request.options.min_clearance_m - clearance_m, kTol_m);
  report.expect_within("certified clearance",
                       std::abs(result.plan->certificate().min_clearance_m - clearance_m), kTol_m);
  report.expect("start is exact", states.front() == c.request.start);
  report.expect("goal is exact", states.back() == c.request.goal);
  double defect = 0.0;
  for (int t = 0; t < plan.horizon(); ++t) {
    const Vec2 next = plan.states[t] + plan.dt_s * plan.inputs[t];
    defect = std::max(defect, (next - plan.states[t + 1]).norm());
  }
  report.expect_within("dynamics defect", defect, 1e-12);
  if (!is_monotone(c.request.options) && !result.fell_back) return;
  // Where both ends have the margin, the whole plan keeps what it reports.
  MarginProfile profile = plain_profile(result.margin_m, c.request.options.min_clearance_m);
  const bool ends_have_it =
      dense.slack(states.front(), states.front(), c.radius_m(), profile.rule) > kMarginTol_m &&
      dense.slack(states.back(), states.back(), c.radius_m(), profile.rule) > kMarginTol_m;
  if (ends_have_it) {
    report.expect_within("margin that is not kept",
                         -dense.trajectory_slack(states, c.radius_m(), profile), kMarginTol_m);
  }
}

void check_report(const Case& c, const PlanResult<Point2>& result, CaseReport& report) {
  const Trajectory<Point2>& plan = result.plan->trajectory();
  const auto states = plan.states.span();
  report.expect_within("path length", std::abs(result.path_length - length_of(states)), 1e-9);
  if (result.history.empty() || result.path == nullptr) {
    report.fail("history or path is missing");
    return;
  }
  const bool promises_cost = is_monotone(c.request.options);
  report.expect("the sweeps' result is taken", !promises_cost || !result.fell_back);
  for (std::size_t i = 1; promises_cost && i < result.history.size(); ++i) {
    report.expect_within("cost rises by", result.history[i].cost / result.history[i - 1].cost - 1.0,
                         1e-12);
  }
  const IterationRecord& left = result.fell_back ? result.history.front() : result.history.back();
  report.expect_within("cost of the plan", std::abs(result.cost - left.cost), 1e-9);
  report.expect_within("length of the reference",
                       std::abs(result.history.front().path_length - result.path->length(Point2{})),
                       1e-9);
  report.expect("iterations within the limit",
                result.iterations <= c.request.options.max_iterations);
  report.expect("margin is a rung", result.margin_m <= c.request.options.margin_m);
}

void check_failure(const Case& c, const SceneOracle& dense, const PlanResult<Point2>& result,
                   CaseReport& report) {
  report.expect("no plan without success", !result.plan);
  report.expect("a reason", result.failure.reason != nullptr && *result.failure.reason != '\0');
  const double min_m = c.request.options.min_clearance_m;
  const double start_m = dense.clearance(c.request.start, c.request.start, c.radius_m());
  const double goal_m = dense.clearance(c.request.goal, c.request.goal, c.radius_m());
  switch (result.status) {
    case PlanStatus::kBadStart:
      report.expect("the start is bad", start_m < min_m + kTol_m);
      break;
    case PlanStatus::kBadGoal:
      report.expect("the goal is bad", goal_m < min_m + kTol_m);
      break;
    case PlanStatus::kNoPath:
      report.expect("the ends are good", start_m > min_m - kTol_m && goal_m > min_m - kTol_m);
      report.expect("no wide way is overlooked", !has_wide_way(c, dense, 0.2));
      break;
    case PlanStatus::kOk:
    case PlanStatus::kDeadlineFeasible:
    case PlanStatus::kDeadline:
    case PlanStatus::kCapacity:
    case PlanStatus::kNoSlot:
    case PlanStatus::kBadInput:
      report.fail("unexpected status " + std::to_string(static_cast<int>(result.status)));
      break;
  }
}

void check_repeats(Fixture& f, Case& c, const PlanResult<Point2>& first, CaseReport& report) {
  const auto i = static_cast<std::size_t>(c.i_radius);
  const auto states = first.plan->trajectory().states.span();
  const auto inputs = first.plan->trajectory().inputs.span();
  for (Planner<Point2>* planner : {&*f.planners[i], &*f.reverse_planners[i]}) {
    const PlanResult<Point2> again = planner->plan(c.request);
    if (!again.plan) {
      report.fail("a repeated request fails");
      continue;
    }
    const Trajectory<Point2>& other = again.plan->trajectory();
    report.expect("the same bytes", same_bytes(states, other.states.span()) &&
                                        same_bytes(inputs, other.inputs.span()) &&
                                        first.plan->trajectory().dt_s == other.dt_s);
  }
}

void check_segment_counts(Fixture& f, const Case& c, const SceneOracle& dense, CaseReport& report) {
  for (const int num_segments : {1, 2, 3, 5, 9}) {
    PlanRequest<Point2> request = c.request;
    request.options.num_segments = num_segments;
    const auto result = f.planners[static_cast<std::size_t>(c.i_radius)]->plan(request);
    if (result.status != PlanStatus::kOk) {
      report.fail("no plan with " + std::to_string(num_segments) +
                  " segments: " + result.failure.reason);
      continue;
    }
    check_motion(c, dense, result, report);
  }
}

std::string check_case(Random& random, CaseReport& report) {
  static Fixture f;
  Case c = draw_case(random);
  if (fill(c.scene, f.test.world) != WorldStatus::kOk) {
    report.fail("the world refuses a valid scene");
    return to_text(c);
  }
  c.request.world = &f.test.world;
  const SceneOracle dense(c.scene);
  const auto i = static_cast<std::size_t>(c.i_radius);
  const RtGuard guard;
  const PlanResult<Point2> result = f.planners[i]->plan(c.request);
  const bool used_host = guard.num_allocations() + guard.num_releases() + guard.num_locks() > 0;
  report.expect("no heap and no lock", !used_host);
  if (static_cast<int>(result.status) < 0) {
    check_failure(c, dense, result, report);
  } else if (!result.plan || result.status != PlanStatus::kOk) {
    report.fail("no plan, or cut short without a deadline");
  } else {
    check_motion(c, dense, result, report);
    check_report(c, result, report);
    check_repeats(f, c, result, report);
    check_segment_counts(f, c, dense, report);
  }
  return report.failed() ? to_text(c) : std::string();
}

}  // namespace

int main(int argc, char** argv) { return run_property("plan", argc, argv, check_case); }
