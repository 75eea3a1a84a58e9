// RRT*-sOpt as one call: request -> path -> reference -> segmented optimisation -> verified plan
// [Leu22, Alg. 1]. Construct once from an arena (may fail, may block), then call `plan` as often as
// wanted from one thread: no heap, no lock, no system call, no unbounded loop. The answer depends
// on the request alone: the same bytes on every run and for any number of workers, unless the clock
// cuts it short (status kDeadlineFeasible, still verified) or improve_s lets it say how far to
// search.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "alloc/arena.h"
#include "models/config.h"
#include "models/plane/point2.h"
#include "models/trajectory.h"
#include "opt/segmented_optimizer.h"
#include "opt/verify/verify.h"
#include "rt/clock.h"
#include "rt/executor.h"
#include "sampler/sampler.h"

namespace sopt {

enum class PlanStatus : std::int8_t {
  kOk = 0,                // verified; converged or within its work budget
  kDeadlineFeasible = 1,  // verified, but the deadline cut the optimisation short
  kNoPath = -1,           // the sampling budget ended without a path, or no plan passed verify
  kDeadline = -2,         // the deadline passed before there was a verified plan
  kBadStart = -3,         // start outside bounds or limits, too close to an obstacle or to itself
  kBadGoal = -4,          // likewise the goal
  kCapacity = -5,         // the path needs more steps or vertices than the settings allow
  kNoSlot = -6,           // all kNumPlanSlots plans are still held
  kBadInput = -7,         // the request itself is malformed; nothing was planned
};

enum class PlanStage : std::int8_t { kRequest, kSample, kReference, kOptimize, kVerify };

// Evidence for a status < 0.
struct PlanFailure {
  PlanStage stage = PlanStage::kRequest;
  const char* reason = "not planned";  // static text: what went wrong, in words
  int i_link = 0;
  int i_obstacle = kNoObstacle;     // kBoundsObstacle: the bounds
  double t_s = 0.0;                 // along the rejected plan, when there was one
  double amount = 0.0;              // of the violation, or the offending value
  int i_other_link = kNoLink;       // with kSelfObstacle: the link that i_link is too close to
  int i_joint = kNoJoint;           // whose position `amount` is not within lower and upper
  double lower = 0.0, upper = 0.0;  // of an end that is too close, lower: the clearance it needs
};

struct StageTimes {
  std::int64_t sample_ns = 0;
  std::int64_t first_path_ns = 0;  // of that, until there was a path, not yet shortened
  std::int64_t shortcut_ns = 0;
  std::int64_t reference_ns = 0;
  std::int64_t optimize_ns = 0;
  std::int64_t verify_ns = 0;
  std::int64_t improve_ns = 0;  // all that came after the first plan
  std::int64_t total_ns = 0;
};

// A verified plan in one of the planner's slots, held until the lease is reset or destroyed. The
// planner must outlive it. Movable, not copyable; empty when default constructed.
template <class Robot>
class PlanLease {
 public:
  PlanLease() noexcept = default;
  PlanLease(PlanLease&& other) noexcept { *this = static_cast<PlanLease&&>(other); }
  PlanLease& operator=(PlanLease&& other) noexcept;
  ~PlanLease() { reset(); }

  [[nodiscard]] explicit operator bool() const SOPT_RT { return plan_.has_value(); }
  [[nodiscard]] const VerifiedPlan<Robot>& operator*() const SOPT_RT { return *plan_; }
  [[nodiscard]] const VerifiedPlan<Robot>* operator->() const SOPT_RT { return &*plan_; }
  void reset() SOPT_RT;

 private:
  template <class R>
  friend class Planner;
  std::optional<VerifiedPlan<Robot>> plan_;
  bool* is_held_ = nullptr;  // of the slot
};

// A plan that replaced a longer one, or the first one.
struct ImprovementRecord {
  std::int64_t time_ns = 0;  // since the call
  double path_length = 0.0;
};

// What one call of `plan` did. Pointers and spans look into the planner and are valid until its
// next call; the lease is valid for as long as it is held.
template <class Robot>
struct PlanResult {
  PlanStatus status = PlanStatus::kBadInput;
  PlanLease<Robot> plan;              // present exactly when status >= 0
  PlanFailure failure;                // meaningful when status < 0
  const Path<Robot>* path = nullptr;  // the sampler's path after shortcutting; may be null
  double sampler_path_length = 0.0;   // before shortcutting
  double path_length = 0.0;           // of the plan
  double cost = 0.0;                  // f of the plan, see opt/segmented_optimizer.h
  double margin_m = 0.0;              // rung x margin that was kept
  bool fell_back = false;             // the optimiser's result was refused: plan 0 left
  int iterations = 0;
  int segments_initial = 0;
  int segments_final = 0;
  std::span<const IterationRecord> history;  // entry 0 is the reference
  std::span<const int> splits;               // final W, see opt/splits.h
  // With improve_s > 0 and kOk: entry 0 is the first plan, the last one is `plan`.
  std::span<const ImprovementRecord> improvements;
  SamplerCounts sampler_counts;
  OptimizerCounts optimizer_counts;
  StageTimes times;
};

template <class Robot>
class Planner {
 public:
  // Bytes of arena that a planner with these settings takes.
  [[nodiscard]] static std::size_t required_bytes(const PlannerSettings& settings,
                                                  int num_workers = 1) noexcept;

  // Takes all its memory from `arena`. `executor` must outlive the planner. Deadlines count on
  // `clock`.
  Planner(Arena& arena, const Robot& robot, const PlannerSettings& settings, Executor& executor,
          Clock clock = monotonic_clock()) noexcept;
  Planner(const Planner&) = delete;
  Planner& operator=(const Planner&) = delete;

  // False when the settings are not valid or the arena was too small: `plan` then answers
  // kBadInput.
  [[nodiscard]] bool is_ready() const noexcept { return is_ready_; }

  // Plans `request`. Degenerate: start == goal gives a plan that stays (horizon 2).
  [[nodiscard]] PlanResult<Robot> plan(const PlanRequest<Robot>& request) SOPT_RT;

  // The trees of the last call, for pictures; stream in [0, num_streams()).
  [[nodiscard]] int num_streams() const noexcept { return sampler_.num_streams(); }
  [[nodiscard]] const SamplerStream<Robot>& stream(int i) const noexcept {
    return sampler_.stream(i);
  }
  [[nodiscard]] const Robot& robot() const noexcept { return robot_; }

 private:
  struct Slot {
    Trajectory<Robot> trajectory;
    bool is_held = false;
  };

  [[nodiscard]] bool check_request(const PlanRequest<Robot>& request,
                                   PlanResult<Robot>& result) const SOPT_RT;
  [[nodiscard]] bool check_end(const PlanRequest<Robot>& request, bool is_start,
                               PlanResult<Robot>& result) const SOPT_RT;
  // A request under way.
  struct Call {
    const PlanRequest<Robot>& request;
    const Deadline& deadline;
    std::int64_t begin_ns = 0;
    double step_length = 0.0;
    MarginLadder ladder{};
    int i_rung = 0;  // of the ladder that is kept
  };
  void plan_into(Slot& slot, Call& call, PlanResult<Robot>& result) SOPT_RT;
  [[nodiscard]] bool sample(Call& call, PlanResult<Robot>& result) SOPT_RT;
  [[nodiscard]] bool make_plan_0(const Call& call, Trajectory<Robot>& trajectory,
                                 PlanResult<Robot>& result) SOPT_RT;
  [[nodiscard]] OptimizerResult<Robot> optimize(const Call& call, const Deadline& deadline,
                                                Trajectory<Robot>& trajectory) SOPT_RT;
  void improve(Slot& slot, Call& call, PlanResult<Robot>& result) SOPT_RT;
  [[nodiscard]] bool try_replace(const Call& call, const OptimizerResult<Robot>& optimized,
                                 Slot& slot, PlanResult<Robot>& result) SOPT_RT;
  void record_improvement(const Call& call, PlanResult<Robot>& result) SOPT_RT;
  void report_optimizer(const OptimizerResult<Robot>& optimized, PlanResult<Robot>& result) SOPT_RT;
  [[nodiscard]] bool try_verify(const PlanRequest<Robot>& request, Slot& slot,
                                PlanResult<Robot>& result) SOPT_RT;

  Robot robot_;
  PlannerSettings settings_;
  Clock clock_;
  Sampler<Robot> sampler_;
  SegmentedOptimizer<Robot> optimizer_;
  std::array<Slot, kNumPlanSlots> slots_;
  // Of the plan that is the best so far while others are tried.
  Path<Robot> best_path_;
  Path<Robot> known_path_;  // the shortest one, whose plan need not be
  FixedVector<IterationRecord> best_history_;
  FixedVector<int> best_splits_;
  Trajectory<Robot> candidate_;
  FixedVector<ImprovementRecord> improvements_;
  bool is_ready_ = false;
};

extern template class PlanLease<Point2>;
extern template class PlanLease<Arm<4>>;
extern template class PlanLease<Arm<5>>;
extern template class PlanLease<Arm<6>>;
extern template class PlanLease<Arm<7>>;
extern template class PlanLease<Arm<8>>;
extern template class Planner<Point2>;
extern template class Planner<Arm<4>>;
extern template class Planner<Arm<5>>;
extern template class Planner<Arm<6>>;
extern template class Planner<Arm<7>>;
extern template class Planner<Arm<8>>;

}  // namespace sopt
