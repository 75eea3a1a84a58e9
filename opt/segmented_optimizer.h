// sOpt [Leu22, Alg. 1 l.6-20]: sweeps over windows, odd and even in turn, until the cost stops
// falling. Cost f: opt/step_measure.h; it equals path length at uniform speed. With both ends of
// every window fixed the windows' costs add up to f, so sweeps are block-coordinate descent: f
// never rises, and every iterate is as feasible as plan 0 (docs/algorithm.md; between the waypoints
// of an arm only min_clearance is kept). Stops after max_iterations, when two sweeps in a row
// (both parities) gain at most tol_step H, or at the deadline; the trajectory is whole at every
// window. A single window is swept every time, and one such sweep is enough. Deviation: for arms a
// gain of more than a tenth of f is never little; long motions, whose f is far below H, would stop
// half-way (docs/RESULTS.md).
// Merging [Leu22, eq. 3]: neighbours that together gained at most 2 tol_step H / N become one
// window. Deviation: the printed epsilon is read per step; with epsilon = 1e-3 H as in the paper's
// stopping rule every window would merge in the first sweep. Windows that failed never merge; a
// window that failed is cut in two, for good. Arms merge eagerly, and sweeps go on while they do:
// their references stop at every vertex, and what is left of that is longer than windows and falls
// off slowly.
#pragma once

#include <cstdint>
#include <span>

#include "models/arm/arm.h"
#include "models/config.h"
#include "models/margin.h"
#include "models/plane/point2.h"
#include "models/trajectory.h"
#include "opt/arm/arm_window.h"
#include "opt/plane/point_window.h"
#include "opt/splits.h"
#include "rt/annotations.h"
#include "rt/clock.h"
#include "rt/deadline.h"
#include "rt/executor.h"

namespace sopt {

// State after one sweep; entry 0 is the reference.
struct IterationRecord {
  int iteration = 0;
  double cost = 0.0;
  double path_length = 0.0;  // m
  int segments = 0;
  std::int64_t time_ns = 0;  // since the optimiser began
};

struct OptimizerCounts {
  std::int64_t clearance_queries = 0;
  std::int64_t qp_solves = 0;
  std::int64_t qp_steps = 0;
  std::int64_t windows_failed = 0;  // no rows, no QP solution, or step rejected
};

enum class OptimizerStatus : std::int8_t {
  kConverged = 0,
  kIterationLimit = 1,
  kDeadline = 2,   // the trajectory is as good as the sweeps that fitted
  kCapacity = -1,  // the splits do not fit
};

template <class Robot>
struct OptimizerProblem {
  const Robot* robot = nullptr;
  const typename Robot::World* world = nullptr;
  MarginProfile profile;
  double ds_m = 0.0;  // nominal step length
  const PlanOptions* options = nullptr;
};

template <class Robot>
struct OptimizerResult {
  OptimizerStatus status = OptimizerStatus::kCapacity;
  int iterations = 0;
  int segments_initial = 0;
  int segments_final = 0;
  double cost = 0.0;
  OptimizerCounts counts;
  std::span<const IterationRecord> history;
  std::span<const int> splits;
};

// What a sweep did, over all its windows.
struct SweepSummary {
  double gain = 0.0;            // of cost
  double displacement_m = 0.0;  // largest move of a waypoint
  bool was_shortened = false;   // a step ended at the trust radius
  bool was_cut = false;         // the deadline kept a window from being optimised
};

// Windows of the odd parity that `options` ask for over a horizon.
[[nodiscard]] int choose_num_segments(const PlanOptions& options, int horizon,
                                      int max_window) SOPT_RT;

// How far waypoints of the point robot may move, which is how far away obstacles get rows: in the
// first sweep, and in the one after `summary`.
[[nodiscard]] double first_trust_m(double ds_m) SOPT_RT;
[[nodiscard]] double next_trust_m(const SweepSummary& summary, double trust_m, double ds_m) SOPT_RT;

template <class Robot>
class SegmentedOptimizer {
 public:
  SegmentedOptimizer(Arena& arena, const PlannerSettings& settings, Executor& executor,
                     Clock clock) noexcept;

  // Improves trajectory.states in place; inputs and dt are the caller's. At least 2 steps. An arm's
  // states keep its limits and their dynamics.
  [[nodiscard]] OptimizerResult<Robot> optimize(const OptimizerProblem<Robot>& problem,
                                                Trajectory<Robot>& trajectory,
                                                const Deadline& deadline) SOPT_RT;

 private:
  [[nodiscard]] SweepSummary sweep(const SweepProblem<Robot>& problem, const Deadline& deadline,
                                   OptimizerCounts& counts) SOPT_RT;
  void adapt_windows(MergeRule merge, double max_merge_gain, int max_window) SOPT_RT;
  [[nodiscard]] bool try_merge(MergeRule merge, int i_split, int max_window) SOPT_RT;
  void record(int iteration, int num_segments, const OptimizerProblem<Robot>& problem,
              const Trajectory<Robot>& trajectory, std::int64_t begin_ns) SOPT_RT;

  PlannerSettings settings_;
  Executor* executor_;
  Clock clock_;
  Splits splits_;
  FixedVector<Window> windows_;        // of the current sweep
  FixedVector<WindowResult> results_;  // of the same windows
  FixedVector<IterationRecord> history_;
  WindowOptimizer<Robot>* workers_ = nullptr;  // one per worker
};

extern template class SegmentedOptimizer<Point2>;
extern template class SegmentedOptimizer<Arm<4>>;
extern template class SegmentedOptimizer<Arm<5>>;
extern template class SegmentedOptimizer<Arm<6>>;
extern template class SegmentedOptimizer<Arm<7>>;
extern template class SegmentedOptimizer<Arm<8>>;

}  // namespace sopt
