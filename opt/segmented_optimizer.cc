#include "opt/segmented_optimizer.h"

#include <algorithm>
#include <cmath>
#include <new>

#include "opt/rediscretize.h"
#include "opt/time_scaling.h"

namespace sopt {
namespace {

// First trust radius, in nominal steps and at most in metres: rows are made for everything that
// near.
constexpr double kFirstTrust_steps = 15.0;
constexpr double kFirstTrust_m = 3.0;
// Later sweeps: this many times the largest move of the sweep before, at least one nominal step.
constexpr double kTrustGrowth = 2.0;

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

}  // namespace

int choose_num_segments(const PlanOptions& options, int horizon, int max_window) SOPT_RT {
  const auto windows_of = [&](int num_steps) { return (horizon + num_steps - 1) / num_steps; };
  const int wanted = options.num_segments == 0 ? std::max(2, windows_of(options.steps_per_window))
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
  workers_ = arena.take<WindowOptimizer<Robot>>(static_cast<std::size_t>(num_workers));
  for (int i = 0; i < num_workers; ++i) {
    WindowOptimizer<Robot> worker(arena, settings);
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

  SweepProblem<Robot> sweep_problem{
      problem.robot, problem.world,  problem.profile, first_trust_m(problem.ds_m), problem.ds_m, {},
      options.rows,  options.solver, options.accept};
  history_.clear();
  record(0, result.segments_initial, problem.ds_m, trajectory, begin_ns);

  int small_gains = 0;  // sweeps in a row with little gain
  result.status = OptimizerStatus::kIterationLimit;
  for (int k = 1; k <= options.max_iterations; ++k) {
    splits_.list_windows(k % 2 == 1 ? Parity::kOdd : Parity::kEven, windows_);
    sweep_problem.states = {trajectory.states.begin(), trajectory.states.end()};
    sweep_problem.linearize_about_rest = options.zero_input_start && k == 1;
    const double min_gain = options.tol_step * trajectory.horizon();
    const SweepSummary summary = sweep(sweep_problem, deadline, result.counts);
    result.iterations = k;
    small_gains = std::abs(summary.gain) <= min_gain ? small_gains + 1 : 0;
    if (small_gains == 2 && options.tol_step > 0.0) result.status = OptimizerStatus::kConverged;
    if (summary.was_cut) result.status = OptimizerStatus::kDeadline;
    const int num_segments = splits_.num_segments();
    const bool is_last = result.status != OptimizerStatus::kIterationLimit;
    if (!is_last) {
      adapt_windows(options.merge, 2.0 * min_gain / num_segments, max_window);
    }
    if (options.resampling == Resampling::kRediscretize && rediscretize(problem.ds_m, trajectory)) {
      (void)splits_.try_rescale(trajectory.horizon());
    }
    record(k, num_segments, problem.ds_m, trajectory, begin_ns);
    if (is_last) break;
    sweep_problem.trust_m = next_trust_m(summary, sweep_problem.trust_m, problem.ds_m);
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
    if (may_merge(left) && may_merge(right) && std::abs(gain) <= max_merge_gain &&
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
      return splits_.try_merge(i_split, max_window);
    case MergeRule::kPrinted:
      return splits_.try_merge_as_printed(i_split, max_window);
  }
  return false;
}

template <class Robot>
void SegmentedOptimizer<Robot>::record(int iteration, int num_segments, double ds_m,
                                       const Trajectory<Robot>& trajectory,
                                       std::int64_t begin_ns) SOPT_RT {
  IterationRecord entry;
  entry.iteration = iteration;
  for (int t = 0; t < trajectory.horizon(); ++t) {
    const double step2 = (trajectory.states[t + 1] - trajectory.states[t]).squaredNorm();
    entry.cost += step2 / ds_m;
    entry.path_length += std::sqrt(step2);
  }
  entry.segments = num_segments;
  entry.time_ns = clock_.now_ns() - begin_ns;
  (void)history_.try_push_back(entry);
}

template class SegmentedOptimizer<Point2>;

}  // namespace sopt
