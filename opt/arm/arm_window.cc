#include "opt/arm/arm_window.h"

#include <algorithm>
#include <cmath>

#include "opt/step_measure.h"

namespace sopt {
namespace {

// Tables of the kernel for windows of up to this many steps.
constexpr int kMaxTable = 60;
// Moves and relative gains below these are rounding, not progress.
constexpr double kConverged_m = 1e-9;
constexpr double kConvergedGain = 1e-13;
// Steps tried towards the solution: 1, 1/2, .. 1/16.
constexpr int kMaxStepHalvings = 4;
// Rows between links: this far beyond what they keep, at most.
constexpr double kSelfActivation_m = 0.1;
// Rows look this many times as far as the links would have moved without them, and at least this
// far, beyond the margin.
constexpr double kActivationShare = 1.5;
constexpr double kLeastActivation_m = 0.02;
// The check looks this far beyond the margin.
constexpr double kCheckReach_m = 0.03;
// Parts of a step that the check looks at one by one, at most.
constexpr double kLeastShare = 1.0 / 64.0;
// Velocities and accelerations stay this much inside their limits, so that the QP's tolerance and
// rounding cannot pass them; references keep more (opt/reference.h).
constexpr double kLimitGuard = 1.0 - 1e-9;

std::size_t to_size(int i) noexcept { return static_cast<std::size_t>(i); }

// Of waypoint t of the window: the weaker of the two steps that meet there.
template <class Robot>
ClearanceRule rule_at(const SweepProblem<Robot>& problem, const Window& window, int i) noexcept {
  const MarginProfile& profile = problem.profile;
  const int horizon = static_cast<int>(problem.states.size()) - 1;
  const int t = window.first + i;
  ClearanceRule rule = profile.at_step(std::min(t, horizon - 1), horizon);
  rule.cap_m = std::min(rule.cap_m, profile.at_step(std::max(t - 1, 0), horizon).cap_m);
  return rule;
}

template <int N>
double cost_of(const Arm<N>& robot, const typename Arm<N>::State* states, int num_steps,
               double dt_s, double ds_m) noexcept {
  double sum = 0.0;
  for (int t = 0; t < num_steps; ++t) {
    sum += measure_step(robot, states[t], states[t + 1], dt_s).cost_ds;
  }
  return sum / ds_m;
}

}  // namespace

template <int N>
WindowOptimizer<Arm<N>>::Shared::Shared(Arena& arena, const PlannerSettings& settings) noexcept
    : kernel(arena, 2, {0.0, 1.0, kArmInputWeight}, settings.max_window,
             std::min(settings.max_window, kMaxTable)) {}

template <int N>
WindowOptimizer<Arm<N>>::WindowOptimizer(Arena& arena, const PlannerSettings& settings,
                                         const Shared& shared) noexcept
    : max_window_(settings.max_window),
      rows_(arena, settings.rows_per_window),
      qp_(arena, settings, shared.kernel) {
  const int num_waypoints = settings.max_window + 1;
  const auto make = [&](auto& vector) {
    vector = {arena, num_waypoints};
    (void)vector.try_resize(vector.capacity());
  };
  make(lower_);
  make(upper_);
  make(gaps_);
  make(candidate_gaps_);
  make(is_measured_);
  make(solution_);
  make(candidate_);
  make(move_m_);
}

template <int N>
WindowResult WindowOptimizer<Arm<N>>::optimize(const SweepProblem<Robot>& problem,
                                               const Window& window,
                                               const Deadline& deadline) SOPT_RT {
  const int n = window.num_steps();
  const State* const reference = problem.states.data() + window.first;
  WindowResult result;
  result.cost_before = cost_of(*problem.robot, reference, n, problem.dt_s, problem.ds_m);
  result.cost_after = result.cost_before;
  if (n < kMinSteps) {
    result.status = WindowStatus::kTooShort;
    return result;
  }
  if (n > max_window_) {
    result.status = WindowStatus::kNoRows;
    return result;
  }
  if (deadline.expired()) return result;

  num_steps_ = n;
  finder_.reset(*problem.robot, *problem.world, problem.min_clearance_m);
  result.status = improve(problem, window, deadline, result);
  result.clearance_queries = finder_.num_queries();
  return result;
}

template <int N>
WindowStatus WindowOptimizer<Arm<N>>::improve(const SweepProblem<Robot>& problem,
                                              const Window& window, const Deadline& deadline,
                                              WindowResult& result) SOPT_RT {
  State* const reference = problem.states.data() + window.first;
  rows_.clear();
  ArmSegment<N> segment = make_segment(problem, reference);
  for (int t = 0; t <= num_steps_; ++t) move_m_[t].fill(problem.trust_m);
  // The paper's choices take rows as they are.
  if (problem.accept && problem.solver == WindowSolver::kClosedForm) {
    result.qp_status = solve(problem, segment, reference, deadline, result);
    if (result.qp_status != QpStatus::kOptimal) return WindowStatus::kQpFailed;
    if (!gains(problem, result)) return WindowStatus::kConverged;
    if (keeps_margin(problem, window)) return write(problem, reference, 1.0, result);
  }
  linearize(problem, window);
  segment.rows = rows_.rows();
  result.qp_status = solve(problem, segment, reference, deadline, result);
  if (result.qp_status != QpStatus::kOptimal) return WindowStatus::kQpFailed;
  if (!problem.accept) return write(problem, reference, 1.0, result);
  if (!gains(problem, result)) return WindowStatus::kConverged;
  return take_step(problem, window, result);
}

// Solves and takes the solution for the candidate.
template <int N>
QpStatus WindowOptimizer<Arm<N>>::solve(const SweepProblem<Robot>& problem,
                                        const ArmSegment<N>& segment, const State* reference,
                                        const Deadline& deadline, WindowResult& result) SOPT_RT {
  QpResult<double> qp = qp_.solve(segment, problem.solver, deadline);
  ++result.qp_solves;
  result.qp_steps += qp.num_steps;
  const bool is_hopeless = qp.status == QpStatus::kInfeasible || qp.status == QpStatus::kInaccurate;
  if (is_hopeless && !segment.rows.empty()) {
    qp = qp_.solve_soft(segment, problem.solver, deadline);
    ++result.qp_solves;
    result.qp_steps += qp.num_steps;
  }
  result.has_active_rows = qp.num_active > 0;
  if (qp.status != QpStatus::kOptimal) return qp.status;
  full_m_ = 0.0;
  solution_[0] = reference[0];
  solution_[num_steps_] = reference[num_steps_];
  for (int t = 1; t < num_steps_; ++t) {
    solution_[t].template head<N>() = qp_.position(t);
    solution_[t].template tail<N>() = qp_.velocity(t) / problem.dt_s;
    ArmMove<N> move;
    finder_.bound_move((solution_[t] - reference[t]).template head<N>().cwiseAbs(), move);
    move_m_[t] = move.world_m;
    full_m_ = std::max(full_m_, *std::max_element(move.world_m.begin(), move.world_m.end()));
  }
  std::copy_n(solution_.begin(), num_steps_ + 1, candidate_.begin());
  return qp.status;
}

// Rows of all interior waypoints, and the clearances there and at the ends.
template <int N>
void WindowOptimizer<Arm<N>>::linearize(const SweepProblem<Robot>& problem,
                                        const Window& window) SOPT_RT {
  const State& first = problem.states[to_size(window.first)];
  for (int t = 0; t <= num_steps_; ++t) {
    const Config q = problem.states[to_size(window.first + t)].template head<N>();
    const ClearanceRule rule = rule_at(problem, window, t);
    const double required_m = problem.world->max_required_m(rule);
    if (t == 0 || t == num_steps_) {
      finder_.find(q, rule, required_m + kCheckReach_m, kSelfRow_m + kCheckReach_m, gaps_[t]);
      continue;
    }
    LinkRadii<N> radius_m;
    double activation_m = 0.0;
    for (std::size_t l = 0; l <= N; ++l) {
      const double wanted_m = kActivationShare * move_m_[t][l];
      radius_m[l] = required_m + std::clamp(wanted_m, kLeastActivation_m, problem.trust_m);
      activation_m = std::max(activation_m, radius_m[l] - required_m);
    }
    const double self_radius_m = kSelfRow_m + std::min(activation_m, kSelfActivation_m);
    // h(z_ref) + grad h . (z(u) - z(0)) >= 0 with u = 0 [Leu22, III-D].
    const Config at =
        problem.linearize_about_rest
            ? Config(first.template head<N>() + t * problem.dt_s * first.template tail<N>())
            : q;
    finder_.find(q, rule, radius_m, self_radius_m, gaps_[t],
                 [&](const ArmPose<N>& pose, const ArmContact& contact) {
                   const double kept_m = contact.i_other_link != kNoLink
                                             ? kSelfRow_m
                                             : problem.world->required_m(contact.i_obstacle, rule);
                   rows_.add(t, at, contact_gradient(*problem.robot, pose, contact),
                             contact.clearance.distance_m, kept_m);
                 });
  }
  rows_.trim();
}

// Positions stay a_max dt^2 / 8 away from their limits, which is how far a parabola may pass its
// waypoints, or where the reference is.
template <int N>
ArmSegment<N> WindowOptimizer<Arm<N>>::make_segment(const SweepProblem<Robot>& problem,
                                                    const State* reference) SOPT_RT {
  const int num_steps = num_steps_;
  const Robot& robot = *problem.robot;
  const double dt_s = problem.dt_s;
  const Config inset = robot.a_max() * (dt_s * dt_s / 8.0);
  for (int t = 0; t <= num_steps; ++t) {
    const Config q = reference[t].template head<N>();
    lower_[t] = q.cwiseMin(robot.lower() + inset);
    upper_[t] = q.cwiseMax(robot.upper() - inset);
  }
  ArmSegment<N> segment;
  segment.num_steps = num_steps;
  segment.first_position = reference[0].template head<N>();
  segment.last_position = reference[num_steps].template head<N>();
  segment.first_velocity = dt_s * reference[0].template tail<N>();
  segment.last_velocity = dt_s * reference[num_steps].template tail<N>();
  segment.rows = rows_.rows();
  segment.lower = lower_.span();
  segment.upper = upper_.span();
  segment.v_max = robot.v_max() * (dt_s * kLimitGuard);
  segment.a_max = robot.a_max() * (dt_s * dt_s * kLimitGuard);
  segment.factors = robot.weights().cwiseAbs2();
  return segment;
}

template <int N>
double WindowOptimizer<Arm<N>>::candidate_cost(const SweepProblem<Robot>& problem) const SOPT_RT {
  return cost_of(*problem.robot, candidate_.begin(), num_steps_, problem.dt_s, problem.ds_m);
}

// True when the candidate is elsewhere and better.
template <int N>
bool WindowOptimizer<Arm<N>>::gains(const SweepProblem<Robot>& problem,
                                    const WindowResult& result) const SOPT_RT {
  return full_m_ > kConverged_m &&
         candidate_cost(problem) < result.cost_before * (1.0 - kConvergedGain);
}

// The candidate, at `share` of the way to the solution, becomes the trajectory.
template <int N>
WindowStatus WindowOptimizer<Arm<N>>::write(const SweepProblem<Robot>& problem, State* reference,
                                            double share, WindowResult& result) SOPT_RT {
  std::copy_n(candidate_.begin() + 1, num_steps_ - 1, reference + 1);
  result.cost_after = candidate_cost(problem);
  result.displacement_m = share * full_m_;
  result.was_shortened = share < 1.0;
  return WindowStatus::kMoved;
}

// Shortens the way to the QP's solution until it passes the check and does not raise the cost.
template <int N>
WindowStatus WindowOptimizer<Arm<N>>::take_step(const SweepProblem<Robot>& problem,
                                                const Window& window,
                                                WindowResult& result) SOPT_RT {
  State* const reference = problem.states.data() + window.first;
  double share = 1.0;
  for (int halving = 0; halving <= kMaxStepHalvings; ++halving, share *= 0.5) {
    for (int t = 1; t < num_steps_ && halving > 0; ++t) {
      candidate_[t] = reference[t] + share * (solution_[t] - reference[t]);
    }
    if (candidate_cost(problem) > result.cost_before || !passes(problem, window)) continue;
    return write(problem, reference, share, result);
  }
  return WindowStatus::kRejected;
}

// The whole margin at every waypoint of the candidate, and a clear motion between them.
template <int N>
bool WindowOptimizer<Arm<N>>::keeps_margin(const SweepProblem<Robot>& problem,
                                           const Window& window) SOPT_RT {
  if (!keeps_limits(*problem.robot, problem.dt_s)) return false;
  for (int t = 0; t <= num_steps_; ++t) {
    const ClearanceRule rule = rule_at(problem, window, t);
    const double radius_m = problem.world->max_required_m(rule) + kCheckReach_m;
    finder_.find(candidate_[t].template head<N>(), rule, radius_m, kCheckReach_m,
                 candidate_gaps_[t]);
    const bool is_end = t == 0 || t == num_steps_;
    if (!is_end && !finder_.keeps_all(candidate_gaps_[t])) return false;
    is_measured_[t] = true;
  }
  return steps_are_clear(problem, window);
}

template <int N>
bool WindowOptimizer<Arm<N>>::passes(const SweepProblem<Robot>& problem,
                                     const Window& window) SOPT_RT {
  return keeps_limits(*problem.robot, problem.dt_s) && keeps_waypoints(problem, window) &&
         steps_are_clear(problem, window);
}

template <int N>
bool WindowOptimizer<Arm<N>>::steps_are_clear(const SweepProblem<Robot>& problem,
                                              const Window& window) SOPT_RT {
  for (int t = 0; t < num_steps_; ++t) {
    if (!step_is_clear(problem, window, t)) return false;
  }
  return true;
}

// Velocities change linearly within a step, so that they are largest at waypoints; positions are
// where velocities change sign.
template <int N>
bool WindowOptimizer<Arm<N>>::keeps_limits(const Robot& robot, double dt_s) const SOPT_RT {
  for (int t = 0; t < num_steps_; ++t) {
    const auto q = candidate_[t].template head<N>();
    const auto w = candidate_[t].template tail<N>();
    const auto w_next = candidate_[t + 1].template tail<N>();
    for (int j = 0; j < N; ++j) {
      const double turn = w[j] * w_next[j] < 0.0 ? w[j] / (w[j] - w_next[j]) : 0.0;
      const double extreme = q[j] + 0.5 * turn * dt_s * w[j];
      const bool holds = q[j] >= robot.lower()[j] && q[j] <= robot.upper()[j] &&
                         extreme >= robot.lower()[j] && extreme <= robot.upper()[j] &&
                         std::abs(w[j]) <= robot.v_max()[j] &&
                         std::abs(w_next[j] - w[j]) <= robot.a_max()[j] * dt_s;
      if (!holds) return false;
    }
  }
  return true;
}

template <int N>
bool WindowOptimizer<Arm<N>>::keeps_waypoints(const SweepProblem<Robot>& problem,
                                              const Window& window) SOPT_RT {
  const State* const reference = problem.states.data() + window.first;
  for (int t : {0, num_steps_}) {
    candidate_gaps_[t] = gaps_[t];
    is_measured_[t] = true;
  }
  for (int t = 1; t < num_steps_; ++t) {
    ArmMove<N> move;
    finder_.bound_move((candidate_[t] - reference[t]).template head<N>().cwiseAbs(), move);
    finder_.lower(gaps_[t], move, candidate_gaps_[t]);
    is_measured_[t] = false;
    if (finder_.keeps(candidate_gaps_[t], gaps_[t])) continue;
    measure(problem, window, t);
    if (!finder_.keeps(candidate_gaps_[t], gaps_[t])) return false;
  }
  return true;
}

// Exact clearances of the candidate's waypoint t, unless they are known.
template <int N>
void WindowOptimizer<Arm<N>>::measure(const SweepProblem<Robot>& problem, const Window& window,
                                      int t) SOPT_RT {
  if (is_measured_[t]) return;
  const ClearanceRule rule = rule_at(problem, window, t);
  const double radius_m = problem.world->max_required_m(rule) + kCheckReach_m;
  ArmGaps<N> exact;
  finder_.find(candidate_[t].template head<N>(), rule, radius_m, kCheckReach_m, exact);
  candidate_gaps_[t].raise_to(exact);
  is_measured_[t] = true;
}

// Walks along the parabola from waypoint t to the next, in parts as short as it takes.
template <int N>
bool WindowOptimizer<Arm<N>>::step_is_clear(const SweepProblem<Robot>& problem,
                                            const Window& window, int t) SOPT_RT {
  const Config q = candidate_[t].template head<N>();
  const Config v = problem.dt_s * candidate_[t].template tail<N>();
  const Config a = problem.dt_s * candidate_[t + 1].template tail<N>() - v;
  ArmMove<N> move;
  // The integral of |v + s a| over [begin, end] is at most that of its chord.
  const auto bound = [&](double begin, double end) {
    const Config speeds = (v + begin * a).cwiseAbs() + (v + end * a).cwiseAbs();
    finder_.bound_move(0.5 * (end - begin) * speeds, move);
  };
  bound(0.0, 1.0);
  if (finder_.motion_is_clear(candidate_gaps_[t], candidate_gaps_[t + 1], move)) return true;
  measure(problem, window, t);
  measure(problem, window, t + 1);
  if (finder_.motion_is_clear(candidate_gaps_[t], candidate_gaps_[t + 1], move)) return true;

  const ClearanceRule rule = rule_at(problem, window, t);
  const double radius_m = problem.min_clearance_m + kCheckReach_m;
  ArmGaps<N> from = candidate_gaps_[t];
  ArmGaps<N> to;
  double begin = 0.0;
  double part = 0.5;
  while (part >= kLeastShare) {
    const double end = begin + part;
    if (end < 1.0) {
      finder_.find(q + end * v + 0.5 * end * end * a, rule, radius_m, kCheckReach_m, to);
    } else {
      to = candidate_gaps_[t + 1];
    }
    bound(begin, end);
    if (!finder_.motion_is_clear(from, to, move)) {
      part *= 0.5;
      continue;
    }
    if (end >= 1.0) return true;
    from = to;
    begin = end;
  }
  return false;
}

template class WindowOptimizer<Arm<4>>;
template class WindowOptimizer<Arm<5>>;
template class WindowOptimizer<Arm<6>>;
template class WindowOptimizer<Arm<7>>;
template class WindowOptimizer<Arm<8>>;

}  // namespace sopt
