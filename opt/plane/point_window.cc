#include "opt/plane/point_window.h"

#include <algorithm>
#include <cmath>

#include "opt/plane/waypoint_rows.h"

namespace sopt {
namespace {

// Moves and relative gains below these are rounding, not progress.
constexpr double kConverged_m = 1e-9;
constexpr double kConvergedGain = 1e-13;

double window_cost(std::span<const Vec2> states, const Window& window, double ds_m) noexcept {
  double sum = 0.0;
  for (int t = window.first; t < window.last; ++t) {
    const auto i = static_cast<std::size_t>(t);
    sum += (states[i + 1] - states[i]).squaredNorm();
  }
  return sum / ds_m;
}

std::size_t to_size(int i) noexcept { return static_cast<std::size_t>(i); }

double rows_cost(const PointRows& rows, double ds_m) noexcept {
  double sum = 0.0;
  for (int t = 0; t < rows.num_steps(); ++t) {
    sum += (rows.position(t + 1) - rows.position(t)).squaredNorm();
  }
  return sum / ds_m;
}

double max_displacement(const PointRows& rows, const Vec2* reference) noexcept {
  double largest2 = 0.0;
  for (int t = 1; t < rows.num_steps(); ++t) {
    largest2 = std::max(largest2, (rows.position(t) - reference[t]).squaredNorm());
  }
  return std::sqrt(largest2);
}

}  // namespace

// A waypoint of the plane has at most two linearly independent active rows.
WindowOptimizer<Point2>::WindowOptimizer(Arena& arena, const PlannerSettings& settings,
                                         const Shared& /*shared*/) noexcept
    : max_window_(settings.max_window),
      rows_(arena, settings.max_window, settings.rows_per_window),
      qp_(arena, 2 * settings.max_window),
      offsets_(arena, settings.max_window + 1) {
  if (settings.dense_solver) {
    dense_ = DenseWindow(arena, settings.max_window, settings.rows_per_window);
  }
}

WindowResult WindowOptimizer<Point2>::optimize(const SweepProblem<Point2>& problem,
                                               const Window& window,
                                               const Deadline& deadline) SOPT_RT {
  WindowResult result;
  result.cost_before = window_cost(problem.states, window, problem.ds_m);
  result.cost_after = result.cost_before;
  if (window.num_steps() < 2) {
    result.status = WindowStatus::kTooShort;
    return result;
  }
  if (window.num_steps() > max_window_) {
    result.status = WindowStatus::kNoRows;
    return result;
  }
  if (deadline.expired()) return result;

  double trust_m = problem.trust_m;
  int halvings = 0;
  while (!make_rows(problem, window, trust_m, result.clearance_queries)) {
    trust_m *= 0.5;
    if (++halvings > kMaxTrustHalvings) {
      result.status = WindowStatus::kNoRows;
      return result;
    }
  }
  if (problem.linearize_about_rest) linearize_about_rest(&problem.states[to_size(window.first)]);
  QpOptions<double> options;
  options.violation_tolerance = kQpTolerance_m;
  const QpResult<double> qp = problem.solver == WindowSolver::kDense
                                  ? dense_.solve(rows_, options, deadline)
                                  : qp_.solve(rows_, options, deadline);
  result.qp_status = qp.status;
  result.qp_solves = 1;
  result.qp_steps = qp.num_steps;
  result.has_active_rows = qp.num_active > 0;
  if (qp.status != QpStatus::kOptimal) {
    result.status = WindowStatus::kQpFailed;
  } else {
    result.status = problem.accept ? take_step(problem, window, trust_m, result)
                                   : take_solution(problem, window, result);
  }
  return result;
}

bool WindowOptimizer<Point2>::make_rows(const SweepProblem<Point2>& problem, const Window& window,
                                        double trust_m, std::int64_t& num_queries) SOPT_RT {
  if (problem.rows == RowMode::kEdge) {
    return make_obstacle_rows(*problem.robot, *problem.world, problem.profile, problem.states,
                              window, trust_m, rows_, num_queries);
  }
  return make_waypoint_rows(problem.rows, *problem.robot, *problem.world, problem.profile,
                            problem.states, window, trust_m, rows_, num_queries);
}

// h(z_ref) + grad h . (z(u) - z(0)) >= 0 with u = 0 in place of the reference's inputs [Leu22,
// III-D]: the row's z_ref is exchanged for the first point of the window.
void WindowOptimizer<Point2>::linearize_about_rest(const Vec2* reference) SOPT_RT {
  (void)offsets_.try_resize(rows_.num_steps() + 1);
  for (int t = 0; t <= rows_.num_steps(); ++t) offsets_[t] = reference[0] - reference[t];
  rows_.shift_bounds(offsets_.begin());
}

// The QP's solution as it is.
WindowStatus WindowOptimizer<Point2>::take_solution(const SweepProblem<Point2>& problem,
                                                    const Window& window,
                                                    WindowResult& result) SOPT_RT {
  Vec2* const reference = problem.states.data() + window.first;
  result.displacement_m = max_displacement(rows_, reference);
  if (result.displacement_m <= kConverged_m) return WindowStatus::kConverged;
  for (int t = 1; t < rows_.num_steps(); ++t) reference[t] = rows_.position(t);
  result.cost_after = rows_cost(rows_, problem.ds_m);
  return WindowStatus::kMoved;
}

// Shortens the way to the QP's solution until it is within the trust radius, keeps all rows and
// does not raise the cost; then writes it.
WindowStatus WindowOptimizer<Point2>::take_step(const SweepProblem<Point2>& problem,
                                                const Window& window, double trust_m,
                                                WindowResult& result) SOPT_RT {
  Vec2* const reference = problem.states.data() + window.first;
  const double full_m = max_displacement(rows_, reference);
  const double full_cost = rows_cost(rows_, problem.ds_m);
  if (full_m <= kConverged_m || full_cost >= result.cost_before * (1.0 - kConvergedGain)) {
    return WindowStatus::kConverged;
  }
  double displacement_m = full_m;
  if (full_m > trust_m) {
    rows_.shorten_step(reference, trust_m / full_m);
    displacement_m = trust_m;
    result.was_shortened = true;
  }
  for (int halving = 0; halving <= kMaxStepHalvings; ++halving) {
    if (halving > 0) {
      rows_.shorten_step(reference, 0.5);
      displacement_m *= 0.5;
    }
    const double cost = rows_cost(rows_, problem.ds_m);
    if (cost > result.cost_before) continue;
    if (rows_.most_violated(kRowTolerance_m) >= 0) continue;
    for (int t = 1; t < rows_.num_steps(); ++t) reference[t] = rows_.position(t);
    result.cost_after = cost;
    result.displacement_m = displacement_m;
    return WindowStatus::kMoved;
  }
  return WindowStatus::kRejected;
}

}  // namespace sopt
