// The statements of docs/convergence.md (S1 .. S6), each on random worlds, references that may
// touch what they must keep clear of, windows and trust radii, against brute force from the raw
// shapes. Tolerances are those of the QP's rows (2e-9 m) and rounding, except where a limit is
// approached in finitely many sweeps.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "opt/plane/obstacle_rows.h"
#include "opt/segmented_optimizer.h"
#include "opt/time_scaling.h"
#include "tests/support/convergence_oracle.h"
#include "tests/support/property.h"
#include "tests/support/test_problem.h"
#include "tests/support/test_trajectory.h"
#include "tests/support/test_world.h"

namespace {

using namespace sopt;
using namespace sopt::oracle;

using Points = std::vector<Vec2>;
using Windows = std::vector<Window>;

constexpr double kRowTol_m = 4e-9;
constexpr double kCostTol = 1e-12;  // relative

struct Fixture {
  PlannerSettings settings;
  SerialExecutor serial;
  InArena<WindowOptimizer<Point2>> window{settings};
  InArena<SegmentedOptimizer<Point2>> segmented{settings, serial, monotonic_clock()};
  InArena<PointRows> rows{settings.max_window, settings.rows_per_window};
  InArena<ActiveSetQp<double>> qp{2 * settings.max_window};
  TestWorld test;
  TestWorld empty;
};

// --- windows

// Any windows that cover the horizon, whatever their parity: 1..max_window steps each.
Windows draw_windows(Random& random, int horizon, int max_window) {
  Windows windows;
  for (int first = 0; first < horizon;) {
    const int n = std::min(horizon - first, 1 + random.index(max_window));
    windows.push_back({first, first + n, 0, true});
    first += n;
  }
  return windows;
}

double draw_trust(Random& random) { return std::pow(10.0, random.uniform(-3.0, 0.5)); }

SweepProblem<Point2> sweep_problem(const ClearReference& c, const World2& world, double trust_m,
                                   Points& states) {
  return {&c.robot, &world, c.profile, trust_m, c.ds_m, states};
}

OptimizerResult<Point2> optimize(Fixture& f, const ClearReference& c, const World2& world,
                                 const PlanOptions& options, TestTrajectory& test) {
  return f.segmented->optimize({&c.robot, &world, c.profile, c.ds_m, &options}, test.trajectory,
                               Deadline());
}

// --- S1, S2: the rows of a window

struct WindowRows {
  Window window;
  double trust_m = 0.0;
  std::vector<PointRows::Row> rows;  // times within the window
};

WindowRows draw_rows(Random& random, Fixture& f, const ClearReference& c, CaseReport& report) {
  WindowRows result;
  const int n = std::min(c.horizon(), 2 + random.index(f.settings.max_window - 1));
  result.window.first = random.index(c.horizon() - n + 1);
  result.window.last = result.window.first + n;
  result.trust_m = draw_trust(random);
  std::int64_t num_queries = 0;
  while (!make_obstacle_rows(c.robot, f.test.world, c.profile, c.states, result.window,
                             result.trust_m, *f.rows, num_queries)) {
    result.trust_m *= 0.5;
    if (result.trust_m < 1e-9) {
      report.fail("no trust radius makes the rows fit");
      break;
    }
  }
  for (int id = 0; id < f.rows->num_ids(); ++id) {
    if (f.rows->is_free(id)) result.rows.push_back(f.rows->row(id));
  }
  return result;
}

// A row at t, or a fixed point that keeps what the row says.
bool holds_at(const WindowRows& w, const ClearReference& c, int t, const Vec2& n, double bound) {
  if (t == w.window.first || t == w.window.last) {
    return n.dot(c.states[static_cast<std::size_t>(t)]) >= bound - 1e-9;
  }
  return std::any_of(w.rows.begin(), w.rows.end(), [&](const PointRows::Row& row) {
    return row.t == t - w.window.first && (row.normal - n).norm() < 1e-7 &&
           row.bound > bound - 1e-7;
  });
}

// S1, and that S2's rows are all there: everything near an edge is behind a plane at both its ends.
void check_rows(const WindowRows& w, const ClearReference& c, CaseReport& report) {
  for (const PointRows::Row& row : w.rows) {
    const Vec2& z = c.states[static_cast<std::size_t>(w.window.first + row.t)];
    report.expect_within("S1: the reference misses its own row by", row.bound - row.normal.dot(z),
                         1e-11);
    report.expect_within("S1: normal's length", std::abs(row.normal.norm() - 1.0), 1e-12);
  }
  for (int t = w.window.first; t < w.window.last; ++t) {
    const Vec2& p = c.states[static_cast<std::size_t>(t)];
    const Vec2& q = c.states[static_cast<std::size_t>(t) + 1];
    const double inset_m =
        c.robot.radius_m + c.profile.at_step(t, c.horizon()).required_m(kDefaultMargin);
    for (const Obstacle& obstacle : c.scene.obstacles) {
      const Outline outline = outline_of(obstacle.shape);
      const Plane plane = separating_plane(outline, p, q);
      if (plane.distance_m > inset_m + w.trust_m - 1e-9) continue;
      const double bound = plane.offset + inset_m;
      report.expect(
          "S2: rows at both ends of an edge for what is near it",
          holds_at(w, c, t, plane.normal, bound) && holds_at(w, c, t + 1, plane.normal, bound));
    }
  }
}

// S2: points of the set, most of them on its boundary. Rows are one waypoint's each, so every
// waypoint may be pushed as far as its own rows and the trust radius let it.
void check_set(Random& random, const WindowRows& w, const ClearReference& c,
               const SceneOracle& dense, CaseReport& report) {
  Points states = c.states;
  for (int t = w.window.first + 1; t < w.window.last; ++t) {
    const double angle = random.uniform(-std::numbers::pi, std::numbers::pi);
    const Vec2 move = w.trust_m * Vec2(std::cos(angle), std::sin(angle));
    Vec2& z = states[static_cast<std::size_t>(t)];
    double share = random.chance(0.2) ? random.uniform(0.0, 1.0) : 1.0;
    for (const PointRows::Row& row : w.rows) {
      const double fall = -row.normal.dot(move);
      if (row.t != t - w.window.first || fall <= 0.0) continue;
      share = std::min(share, std::max(0.0, row.normal.dot(z) - row.bound) / fall);
    }
    z += share * move;
  }
  report.expect_within("S2: clearance lost within the rows",
                       -dense.trajectory_slack(states, c.robot.radius_m, c.profile), 1e-9);
}

// --- S3: one step

// f(z) - f(z + s v) >= s (2 - s) |v|^2 / ds towards the QP's solution z + v, 0 < s < 2.
void check_step_lengths(Random& random, Fixture& f, const WindowRows& w, const ClearReference& c,
                        CaseReport& report) {
  QpOptions<double> options;
  options.violation_tolerance = 1e-9;
  const QpResult<double> qp = f.qp->solve(*f.rows, options, Deadline());
  report.expect("S1: the window's QP has a solution", qp.status == QpStatus::kOptimal);
  if (qp.status != QpStatus::kOptimal) return;
  const auto first = c.states.begin() + w.window.first;
  const Points reference(first, first + w.window.num_steps() + 1);
  Points solution;
  for (int t = 0; t <= w.window.num_steps(); ++t) solution.push_back(f.rows->position(t));
  const double before = cost_of(reference, c.ds_m);
  const double full = energy_distance2(reference, solution) / c.ds_m;
  for (const double s : {1.0, random.uniform(0.0, 1.0), random.uniform(1.0, 2.0)}) {
    Points step = reference;
    for (std::size_t t = 0; t < step.size(); ++t) step[t] += s * (solution[t] - reference[t]);
    report.expect_within("S3: decrease short of s (2 - s) |v|^2 / ds by",
                         s * (2.0 - s) * full - (before - cost_of(step, c.ds_m)),
                         1e-8 * (1.0 + before));
  }
}

// --- S2, S3, S4: sweeps over any windows

// Sweeps with new windows and a new trust radius every time, windows in either order.
void check_sweeps(Random& random, Fixture& f, const ClearReference& c, const SceneOracle& dense,
                  CaseReport& report) {
  Points states = c.states;
  double moved2 = 0.0;
  const double first_cost = cost_of(states, c.ds_m);
  for (int k = 0; k < 5; ++k) {
    const Windows windows = draw_windows(random, c.horizon(), 3 + random.index(58));
    const double trust_m = draw_trust(random);
    const Points before = states;
    Points reverse = states;
    double gain = 0.0;
    double sum_before = 0.0;
    for (std::size_t i = 0; i < windows.size(); ++i) {
      const WindowResult result = f.window->optimize(
          sweep_problem(c, f.test.world, trust_m, states), windows[i], Deadline());
      (void)f.window->optimize(sweep_problem(c, f.test.world, trust_m, reverse),
                               windows[windows.size() - 1 - i], Deadline());
      report.expect(
          "S1: no window's QP fails, no step is refused",
          result.status != WindowStatus::kQpFailed && result.status != WindowStatus::kRejected);
      sum_before += result.cost_before;
      gain += result.cost_before - result.cost_after;
    }
    const double cost = cost_of(before, c.ds_m);
    const double tol = kCostTol * (1.0 + first_cost);
    const double step2 = energy_distance2(before, states) / c.ds_m;
    report.expect("S2: windows of a sweep do not see each other", same_bytes(states, reverse));
    report.expect_within("S2: clearance lost by a sweep",
                         -dense.trajectory_slack(states, c.robot.radius_m, c.profile), kRowTol_m);
    report.expect_within("S3: windows' costs against f", std::abs(sum_before - cost), tol);
    report.expect_within("S3: windows' gains against f's",
                         std::abs(cost - cost_of(states, c.ds_m) - gain), tol);
    // The QP's rows hold to 1e-9 m, at multipliers of up to 4 |dz| / ds each.
    report.expect_within("S3: gain short of |z+ - z|^2 / ds by", step2 - gain,
                         1e-8 * (1.0 + first_cost));
    moved2 += step2;
  }
  report.expect_within("S3: sum of squared steps above f(0) - f(line) by",
                       moved2 - (first_cost - line_cost(c.states, c.ds_m)),
                       1e-7 * (1.0 + first_cost));
}

// --- S3, S4: the optimiser

void check_time(Random& random, const ClearReference& c, Trajectory<Point2>& trajectory,
                CaseReport& report) {
  const Points states = copy_of(trajectory.states.span());
  Point2 robot = c.robot;
  robot.v_max_mps = random.uniform(0.1, 10.0);
  scale_time(robot, length_of(c.states), trajectory);
  report.expect("S4: inputs fit", fill_inputs(trajectory));
  report.expect("S4: time scaling leaves the geometry",
                same_bytes(states, trajectory.states.span()));
  double speed_mps = 0.0;
  for (const Vec2& u : trajectory.inputs) speed_mps = std::max(speed_mps, u.norm());
  report.expect("S4: the speed limit holds", speed_mps <= robot.v_max_mps);
}

void check_run(Random& random, Fixture& f, const ClearReference& c, const SceneOracle& dense,
               CaseReport& report) {
  PlanOptions options;
  options.tol_step = std::pow(10.0, random.uniform(-5.0, -1.0));
  options.num_segments = random.index(8);
  options.merge = static_cast<MergeRule>(random.index(3));
  options.max_iterations = kMaxIterations;
  TestTrajectory test(c.states);
  const auto result = optimize(f, c, f.test.world, options, test);
  report.expect_within(
      "S4: clearance lost under merging",
      -dense.trajectory_slack(test.trajectory.states.span(), c.robot.radius_m, c.profile),
      kRowTol_m);
  const double min_gain = options.tol_step * c.horizon();
  const double above_line = result.history.front().cost - line_cost(c.states, c.ds_m);
  const double most = std::max(0.0, above_line) / min_gain + 1e-9;
  int num_large = 0;
  for (std::size_t k = 1; k < result.history.size(); ++k) {
    const double gain = result.history[k - 1].cost - result.history[k].cost;
    report.expect_within("S4: cost rises by", -gain, kCostTol * (1.0 + result.cost));
    num_large += gain > min_gain * (1.0 + 1e-9) ? 1 : 0;
  }
  report.expect("S3: no more sweeps with a gain than f allows", num_large <= most);
  if (2.0 * std::floor(most) + 2.0 <= kMaxIterations) {
    report.expect("S3: converges by itself", result.status == OptimizerStatus::kConverged);
    report.expect("S3: and in time", result.iterations <= 2.0 * std::floor(most) + 2.0);
  }
  check_time(random, c, test.trajectory, report);
}

// --- S5: without obstacles

// A straight line along x with an error across it.
Points with_error(double ds_m, const std::vector<double>& error) {
  Points states;
  for (std::size_t t = 0; t < error.size(); ++t) {
    states.emplace_back(ds_m * static_cast<double>(t), error[t]);
  }
  return states;
}

void sweep_empty(Fixture& f, const ClearReference& c, const std::vector<int>& splits,
                 std::size_t first, Points& states) {
  std::vector<int> ends = {splits.front()};
  for (std::size_t i = first; i + 1 < splits.size(); i += 2) ends.push_back(splits[i]);
  ends.push_back(splits.back());
  for (std::size_t i = 1; i < ends.size(); ++i) {
    (void)f.window->optimize(sweep_problem(c, f.empty.world, 1e3, states),
                             {ends[i - 1], ends[i], 0, true}, Deadline());
  }
}

// Any split points: the error's energy falls by `factor` at least in every sweep after the first,
// and its slowest shape by exactly factor per double sweep.
void check_contraction(Random& random, Fixture& f, CaseReport& report) {
  std::vector<int> splits = {0};
  for (int j = 2 + random.index(12); j > 0; --j) {
    splits.push_back(splits.back() + 1 + random.index(30));
  }
  const Contraction theory = contraction_of(splits);
  report.expect("S5: the factor is below 1", theory.factor < 1.0 && theory.factor >= 0.0);
  ClearReference c;
  c.profile = plain_profile(0.05);
  c.ds_m = 0.1;
  const int horizon = splits.back();
  std::vector<double> error(static_cast<std::size_t>(horizon) + 1, 0.0);
  for (int t = 1; t < horizon; ++t) error[static_cast<std::size_t>(t)] = random.uniform(-1.0, 1.0);
  Points states = with_error(c.ds_m, error);
  const Points line = with_error(c.ds_m, std::vector<double>(error.size(), 0.0));
  sweep_empty(f, c, splits, 2, states);
  double energy = energy_distance2(states, line);
  for (const std::size_t first : {1, 2, 1, 2}) {
    sweep_empty(f, c, splits, first, states);
    const double next = energy_distance2(states, line);
    report.expect_within("S5: energy above factor x energy by", next - theory.factor * energy,
                         1e-9);
    energy = next;
  }
  if (theory.map.rows() == 0) return;
  const std::vector<double> mode = interpolate(splits, theory.slow_mode);
  states = with_error(c.ds_m, mode);
  sweep_empty(f, c, splits, 1, states);
  sweep_empty(f, c, splits, 2, states);
  double defect_m = 0.0;
  for (int t = 0; t <= horizon; ++t) {
    const auto i = static_cast<std::size_t>(t);
    defect_m = std::max(defect_m, std::abs(states[i].y() - theory.factor * mode[i]));
  }
  report.expect_within("S5: slowest shape after a double sweep", defect_m, 1e-7);
}

// Uniform split points of the library, its own sweeps: cos^2(pi / 2N), in f per sweep.
void check_uniform(Random& random, Fixture& f, CaseReport& report) {
  const int num_segments = 1 + random.index(9);
  const int n = 1 + random.index(25);  // steps of a split
  std::vector<int> splits;
  for (int j = 0; j <= 2 * num_segments; ++j) splits.push_back(j * n);
  const double half_angle = 0.5 * std::numbers::pi / num_segments;
  const double factor = std::cos(half_angle) * std::cos(half_angle);
  const Contraction theory = contraction_of(splits);
  report.expect_within("S5: factor against cos^2(pi / 2N)", std::abs(theory.factor - factor),
                       1e-12);
  if (num_segments == 1) return;
  ClearReference c;
  c.profile = plain_profile(0.05);
  c.ds_m = random.uniform(0.1, 0.5);
  std::vector<double> mode = interpolate(splits, theory.slow_mode);
  for (double& y : mode) y *= 0.9 * c.ds_m;  // within the trust radius
  TestTrajectory test(with_error(c.ds_m, mode));
  PlanOptions options;
  options.num_segments = num_segments;
  options.merge = MergeRule::kOff;
  options.tol_step = 0.0;
  options.max_iterations = 8;
  const auto result = optimize(f, c, f.empty.world, options, test);
  const double best = line_cost(test.trajectory.states.span(), c.ds_m);
  double expected = result.history.front().cost - best;
  for (std::size_t k = 1; k < result.history.size(); ++k) {
    if (k > 1) expected *= factor;
    report.expect_within("S5: f(k) - f(line) against factor^(k - 1)",
                         std::abs(result.history[k].cost - best - expected), 1e-9 * (1.0 + best));
  }
}

// Stopped by tol_step: what a sweep gains bounds what is left, factor / (1 - factor) times. A sweep
// that was shortened gains at least 4 ds / n, so with tol_step H below that the last ones were not.
void check_stop(Random& random, Fixture& f, CaseReport& report) {
  const int num_segments = 2 + random.index(4);
  const int horizon = 2 * num_segments * (1 + random.index(10));
  ClearReference c;
  c.profile = plain_profile(0.05);
  c.ds_m = random.uniform(0.1, 0.5);
  std::vector<double> error(static_cast<std::size_t>(horizon) + 1, 0.0);
  for (int t = 1; t < horizon; ++t) {
    error[static_cast<std::size_t>(t)] = random.uniform(-3.0, 3.0) * c.ds_m;
  }
  TestTrajectory test(with_error(c.ds_m, error));
  PlanOptions options;
  options.num_segments = num_segments;
  options.merge = MergeRule::kOff;
  options.max_iterations = kMaxIterations;
  const double min_gain =
      random.uniform(0.01, 0.99) * 4.0 * c.ds_m / static_cast<double>(f.settings.max_window);
  options.tol_step = min_gain / horizon;
  const auto result = optimize(f, c, f.empty.world, options, test);
  const double half_angle = 0.5 * std::numbers::pi / num_segments;
  const double factor = std::cos(half_angle) * std::cos(half_angle);
  report.expect("S5: converges", result.status == OptimizerStatus::kConverged);
  report.expect_within("S5: f - f(line) at the stop",
                       result.cost - line_cost(test.trajectory.states.span(), c.ds_m),
                       factor / (1.0 - factor) * min_gain + 1e-9);
}

// --- S6: limits

// Sweeps without end. Excluded: runs that still gain (their limit is elsewhere), and waypoints
// wedged between rows that leave next to no room (the statement's assumption).
void check_limit(Random& random, Fixture& f, const ClearReference& c, CaseReport& report) {
  PlanOptions options;
  options.tol_step = 0.0;
  options.num_segments = 1 + random.index(3);
  options.merge = static_cast<MergeRule>(random.index(3));
  options.max_iterations = kMaxIterations;
  TestTrajectory test(c.states);
  const auto run = optimize(f, c, f.test.world, options, test);
  if (run.history[run.history.size() - 5].cost - run.cost > 1e-12 * run.cost) return;
  double regularity = 1.0;
  double gap = std::numeric_limits<double>::infinity();
  for (const double active_m : {1e-8, 1e-6, 1e-4}) {  // each certifies a gap
    const Optimality limit = optimality_of(c.scene, test.trajectory.states.span(), c.robot.radius_m,
                                           c.profile, c.ds_m, active_m);
    if (active_m <= 1e-6) regularity = limit.regularity;
    gap = std::min(gap, limit.cost_gap);
  }
  if (regularity < 0.01) return;
  report.expect_within("S6: cost above the optimum of its own feasible set", gap,
                       1e-8 * (1.0 + run.cost));
}

std::string check_case(Random& random, CaseReport& report) {
  static Fixture f;
  static const WorldStatus kEmptyStatus = fill({far_bounds(), {}}, f.empty.world);
  const ClearReference c = random_clear_reference(random);
  if (kEmptyStatus != WorldStatus::kOk || fill(c.scene, f.test.world) != WorldStatus::kOk) {
    report.fail("the world refuses a valid scene");
    return to_text(c);
  }
  const SceneOracle dense(c.scene);
  const WindowRows w = draw_rows(random, f, c, report);
  check_rows(w, c, report);
  check_set(random, w, c, dense, report);
  check_step_lengths(random, f, w, c, report);
  check_sweeps(random, f, c, dense, report);
  check_run(random, f, c, dense, report);
  check_contraction(random, f, report);
  check_uniform(random, f, report);
  check_stop(random, f, report);
  check_limit(random, f, c, report);
  return report.failed() ? to_text(c) : std::string();
}

}  // namespace

int main(int argc, char** argv) { return run_property("convergence", argc, argv, check_case); }
