#include "opt/segmented_optimizer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <type_traits>

#include "opt/plane/rediscretize.h"
#include "opt/step_measure.h"
#include "opt/time_scaling.h"

namespace sopt {
namespace {

// First trust radius, in nominal steps and at most in metres: rows are made for everything that
// near.
constexpr double kFirstTrust_steps = 15.0;
constexpr double kFirstTrust_m = 3.0;
// A sweep that gains more than this share of the cost has not gained little, whatever tol_step
// says.
constexpr double kSmallGain = 0.1;
// Later sweeps: this many times the largest move of the sweep before, at least one nominal step.
constexpr double kTrustGrowth = 2.0;

double first_trust_m(const Point2& /*robot*/, double ds_m) noexcept {
  return sopt::first_trust_m(ds_m);
}

double next_trust_m(const Point2& /*robot*/, const SweepSummary& summary, double trust_m,
                    double ds_m) noexcept {
  return sopt::next_trust_m(summary, trust_m, ds_m);
}

// Arms move as far as the check lets them; this is how far away things get rows at most.
template <int N>
double first_trust_m(const Arm<N>& /*robot*/, double /*ds_m*/) noexcept {
  return kArmActivation_m;
}

template <int N>
double next_trust_m(const Arm<N>& /*robot*/, const SweepSummary& /*summary*/, double trust_m,
                    double /*ds_m*/) noexcept {
  return trust_m;
}

double min_gain_of(const Point2& /*robot*/, double tolerance, double /*cost*/) noexcept {
  return tolerance;
}

template <int N>
double min_gain_of(const Arm<N>& /*robot*/, double tolerance, double cost) noexcept {
  return std::min(tolerance, kSmallGain * cost);
}

bool failed(const WindowResult& result) noexcept {
  return result.status == WindowStatus::kNoRows || result.status == WindowStatus::kQpFailed ||
         result.status == WindowStatus::kRejected;
}

bool was_cut(const WindowResult& result) noexcept {
  return result.status == WindowStatus::kNotRun || result.qp_status == QpStatus::kDeadline;
}

bool may_merge(const WindowResult& result) noexcept {
  return result.status == WindowStatus::kMoved || result.status == WindowStatus::kConverged;
}

// Two neighbours merge when together they gained at most this.
double max_merge_gain(MergeRule merge, double min_gain, int num_segments) noexcept {
  return merge == MergeRule::kEager ? std::numeric_limits<double>::infinity()
                                    : 2.0 * min_gain / num_segments;
}

}  // namespace

int choose_num_segments(const PlanOptions& options, int horizon, int max_window) SOPT_RT {
  const auto windows_of = [&](int num_steps) { return (horizon + num_steps - 1) / num_steps; };
  const int fewest_wanted = options.accept ? 1 : 2;  // two in the paper
  const int wanted = options.num_segments == 0
                         ? std::max(fewest_wanted, windows_of(options.steps_per_window))
                         : options.num_segments;
  const int fewest = windows_of(max_window);
  return std::clamp(wanted, fewest, std::max(fewest, horizon / 2));
}

double first_trust_m(double ds_m) SOPT_RT {
  return std::min(kFirstTrust_m, kFirstTrust_steps * ds_m);
}

double next_trust_m(const SweepSummary& summary, double trust_m, double ds_m) SOPT_RT {
  if (summary.was_shortened) return trust_m;
  // Steps may be longer than the first trust radius.
  return std::max(ds_m, std::min(kTrustGrowth * summary.displacement_m, first_trust_m(ds_m)));
}

template <class Robot>
SegmentedOptimizer<Robot>::SegmentedOptimizer(Arena& arena, const PlannerSettings& settings,
                                              Executor& executor, Clock clock) noexcept
    : settings_(settings),
      executor_(&executor),
      clock_(clock),
      splits_(arena, settings.max_horizon),
      windows_(arena, settings.max_horizon / 2 + 2),
      results_(arena, settings.max_horizon / 2 + 2),
      history_(arena, kMaxIterations + 1) {
  const int num_workers = executor.num_workers();
  // At an address that stays when this moves.
  using Shared = typename WindowOptimizer<Robot>::Shared;
  Shared shared(arena, settings);
  Shared* const kept = arena.take<Shared>(1);
  if (kept != nullptr) *kept = static_cast<Shared&&>(shared);
  workers_ = arena.take<WindowOptimizer<Robot>>(static_cast<std::size_t>(num_workers));
  for (int i = 0; i < num_workers; ++i) {
    WindowOptimizer<Robot> worker(arena, settings, kept != nullptr ? *kept : shared);
    if (workers_ != nullptr) workers_[i] = static_cast<WindowOptimizer<Robot>&&>(worker);
  }
}

template <class Robot>
OptimizerResult<Robot> SegmentedOptimizer<Robot>::optimize(const OptimizerProblem<Robot>& problem,
                                                           Trajectory<Robot>& trajectory,
                                                           const Deadline& deadline) SOPT_RT {
  const std::int64_t begin_ns = clock_.now_ns();
  const PlanOptions& options = *problem.options;
  const int horizon = trajectory.horizon();
  const int max_window = options.max_window == 0
                             ? settings_.max_window
                             : std::min(options.max_window, settings_.max_window);
  OptimizerResult<Robot> result;
  if (!splits_.try_reset(horizon, choose_num_segments(options, horizon, max_window))) {
    return result;
  }
  result.segments_initial = splits_.num_segments();

  SweepProblem<Robot> sweep_problem{problem.robot,   problem.world,
                                    problem.profile, first_trust_m(*problem.robot, problem.ds_m),
                                    problem.ds_m,    {},
                                    options.rows,    options.solver,
                                    options.accept};
  sweep_problem.dt_s = trajectory.dt_s;
  sweep_problem.min_clearance_m = options.min_clearance_m;
  history_.clear();
  record(0, result.segments_initial, problem, trajectory, begin_ns);

  int small_gains = 0;  // sweeps in a row with little gain
  result.status = OptimizerStatus::kIterationLimit;
  for (int k = 1; k <= options.max_iterations; ++k) {
    // Deviation: one window over all steps is swept every time, its halves would find no more.
    const bool is_single = options.accept && splits_.num_segments() == 1;
    splits_.list_windows(is_single || k % 2 == 1 ? Parity::kOdd : Parity::kEven, windows_);
    sweep_problem.states = {trajectory.states.begin(), trajectory.states.end()};
    sweep_problem.linearize_about_rest = options.zero_input_start && k == 1;
    const double min_gain =
        min_gain_of(*problem.robot, options.tol_step * trajectory.horizon(), history_.back().cost);
    const SweepSummary summary = sweep(sweep_problem, deadline, result.counts);
    result.iterations = k;
    // A window that failed is worth another sweep: over its halves.
    const bool has_all = is_single && std::none_of(results_.begin(), results_.end(), failed);
    small_gains = std::abs(summary.gain) <= min_gain ? small_gains + (has_all ? 2 : 1) : 0;
    const int num_segments = splits_.num_segments();
    const bool has_converged = small_gains >= 2 && options.tol_step > 0.0;
    // Where windows merge whatever they gain, the larger ones have yet to show what they can.
    const bool adapts = !has_converged || options.merge == MergeRule::kEager;
    if (!summary.was_cut && adapts) {
      adapt_windows(options.merge, max_merge_gain(options.merge, min_gain, num_segments),
                    max_window);
      if (splits_.num_segments() < num_segments && options.merge == MergeRule::kEager) {
        small_gains = 0;
      }
    }
    if (has_converged && small_gains >= 2) result.status = OptimizerStatus::kConverged;
    if (summary.was_cut) result.status = OptimizerStatus::kDeadline;
    const bool is_last = result.status != OptimizerStatus::kIterationLimit;
    if constexpr (std::is_same_v<Robot, Point2>) {  // breaks the dynamics of others
      if (options.resampling == Resampling::kRediscretize &&
          rediscretize(problem.ds_m, trajectory)) {
        (void)splits_.try_rescale(trajectory.horizon());
      }
    }
    record(k, num_segments, problem, trajectory, begin_ns);
    if (is_last) break;
    sweep_problem.trust_m =
        next_trust_m(*problem.robot, summary, sweep_problem.trust_m, problem.ds_m);
  }
  result.cost = history_.back().cost;
  result.segments_final = splits_.num_segments();
  result.history = history_.span();
  result.splits = splits_.indices();
  return result;
}

template <class Robot>
SweepSummary SegmentedOptimizer<Robot>::sweep(const SweepProblem<Robot>& problem,
                                              const Deadline& deadline,
                                              OptimizerCounts& counts) SOPT_RT {
  (void)results_.try_resize(windows_.size());
  auto optimize_window = [&](int i_worker, int i) {
    results_[i] = workers_[i_worker].optimize(problem, windows_[i], deadline);
  };
  executor_->run(Task(optimize_window), windows_.size());

  SweepSummary summary;
  for (const WindowResult& result : results_) {
    summary.gain += result.cost_before - result.cost_after;
    summary.displacement_m = std::max(summary.displacement_m, result.displacement_m);
    summary.was_shortened = summary.was_shortened || result.was_shortened;
    summary.was_cut = summary.was_cut || was_cut(result);
    counts.clearance_queries += result.clearance_queries;
    counts.qp_solves += result.qp_solves;
    counts.qp_steps += result.qp_steps;
    counts.windows_failed += failed(result) ? 1 : 0;
  }
  return summary;
}

// Cuts windows that failed (not in the paper) and joins neighbours that gained at most
// max_merge_gain together. From
// the last window to the first, so that positions in W to the left stay valid; pairs are disjoint.
template <class Robot>
void SegmentedOptimizer<Robot>::adapt_windows(MergeRule merge, double max_merge_gain,
                                              int max_window) SOPT_RT {
  const auto is_blocked = [&](const WindowResult& result) {
    return !may_merge(result) || (merge == MergeRule::kEager && result.was_shortened);
  };
  for (int i = windows_.size() - 1; i >= 0; --i) {
    if (!windows_[i].is_full) continue;
    if (failed(results_[i])) {
      if (merge != MergeRule::kPrinted) (void)splits_.try_split(windows_[i].i_split);
      continue;
    }
    if (i == 0 || !windows_[i - 1].is_full) continue;
    const WindowResult& left = results_[i - 1];
    const WindowResult& right = results_[i];
    const double gain = left.cost_before - left.cost_after + right.cost_before - right.cost_after;
    if (!is_blocked(left) && !is_blocked(right) && std::abs(gain) <= max_merge_gain &&
        try_merge(merge, windows_[i - 1].i_split, max_window)) {
      --i;
    }
  }
}

template <class Robot>
bool SegmentedOptimizer<Robot>::try_merge(MergeRule merge, int i_split, int max_window) SOPT_RT {
  switch (merge) {
    case MergeRule::kOff:
      return false;
    case MergeRule::kPaired:
    case MergeRule::kEager:
      return splits_.try_merge(i_split, max_window);
    case MergeRule::kPrinted:
      return splits_.try_merge_as_printed(i_split, max_window);
  }
  return false;
}

template <class Robot>
void SegmentedOptimizer<Robot>::record(int iteration, int num_segments,
                                       const OptimizerProblem<Robot>& problem,
                                       const Trajectory<Robot>& trajectory,
                                       std::int64_t begin_ns) SOPT_RT {
  IterationRecord entry;
  entry.iteration = iteration;
  for (int t = 0; t < trajectory.horizon(); ++t) {
    const StepMeasure step = measure_step(*problem.robot, trajectory.states[t],
                                          trajectory.states[t + 1], trajectory.dt_s);
    entry.cost += step.cost_ds / problem.ds_m;
    entry.path_length += std::sqrt(step.length2);
  }
  entry.segments = num_segments;
  entry.time_ns = clock_.now_ns() - begin_ns;
  (void)history_.try_push_back(entry);
}

template class SegmentedOptimizer<Point2>;
template class SegmentedOptimizer<Arm<4>>;
template class SegmentedOptimizer<Arm<5>>;
template class SegmentedOptimizer<Arm<6>>;
template class SegmentedOptimizer<Arm<7>>;
template class SegmentedOptimizer<Arm<8>>;

}  // namespace sopt
