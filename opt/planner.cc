#include "opt/planner.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "opt/margin_ladder.h"
#include "opt/reference.h"
#include "opt/request_rules.h"
#include "opt/step_measure.h"
#include "opt/time_scaling.h"
#include "rt/float_env.h"

namespace sopt {
namespace {

// Work bounds of verify, from docs/RESULTS.md, generous: what the optimiser leaves of the deadline.
template <class Robot>
constexpr double kVerifyPerStep_s = 1e-5;
template <>
constexpr double kVerifyPerStep_s<Point2> = 1e-6;
constexpr double kVerifyPerBox_s = 1e-8;  // per obstacle and run of 16 steps

// A path has to be this much shorter, relative, to be worth optimising: below it is the same way.
constexpr double kWorthwhileGain = 1e-3;
constexpr int kMaxImproveRounds = 1 << 20;

// Twice one verification: a result that is refused is followed by plan 0, an improvement is
// verified before and after it takes its place.
template <class Robot>
double verify_reserve_s(int horizon, int num_obstacles) noexcept {
  const double runs = horizon / 16.0 + 1.0;
  return 2.0 * (kVerifyPerStep_s<Robot> * horizon + kVerifyPerBox_s * runs * num_obstacles);
}

template <class Robot>
bool fail(PlanResult<Robot>& result, PlanStatus status, PlanStage stage, const char* reason,
          double amount = 0.0, int i_obstacle = kNoObstacle) noexcept {
  result.status = status;
  result.failure = PlanFailure();
  result.failure.stage = stage;
  result.failure.reason = reason;
  result.failure.i_obstacle = i_obstacle;
  result.failure.amount = amount;
  return false;
}

const char* reason_of(ViolationKind kind) noexcept {
  switch (kind) {
    case ViolationKind::kNone:
      return "no violation";
    case ViolationKind::kShape:
      return "trajectory has no steps or no positive dt";
    case ViolationKind::kNotFinite:
      return "trajectory is not finite";
    case ViolationKind::kStart:
      return "trajectory does not begin at the start";
    case ViolationKind::kGoal:
      return "trajectory does not end at the goal";
    case ViolationKind::kDynamics:
      return "dynamics defect";
    case ViolationKind::kSpeed:
      return "speed limit exceeded";
    case ViolationKind::kCollision:
      return "clearance below min_clearance";
    case ViolationKind::kNotAtRest:
      return "trajectory moves at its start or goal";
    case ViolationKind::kPosition:
      return "joint limit exceeded";
    case ViolationKind::kVelocity:
      return "velocity limit exceeded";
    case ViolationKind::kAcceleration:
      return "acceleration limit exceeded";
    case ViolationKind::kSelfCollision:
      return "links too close to each other";
    case ViolationKind::kSecondOpinion:
      return "the second collision checker found contact";
  }
  return "unknown violation";
}

}  // namespace

template <class Robot>
PlanLease<Robot>& PlanLease<Robot>::operator=(PlanLease&& other) noexcept {
  if (this == &other) return *this;
  reset();
  plan_ = other.plan_;
  is_held_ = other.is_held_;
  other.plan_.reset();
  other.is_held_ = nullptr;
  return *this;
}

template <class Robot>
void PlanLease<Robot>::reset() SOPT_RT {
  if (is_held_ != nullptr) *is_held_ = false;
  is_held_ = nullptr;
  plan_.reset();
}

template <class Robot>
std::size_t Planner<Robot>::required_bytes(const PlannerSettings& settings,
                                           int num_workers) noexcept {
  // Stands for an executor with that many workers; nothing is run while measuring.
  class MeasuringExecutor final : public Executor {
   public:
    explicit MeasuringExecutor(int count) noexcept : count_(count) {}
    [[nodiscard]] int num_workers() const noexcept override { return count_; }
    void run(Task /*task*/, int /*num_tasks*/) SOPT_RT override {}

   private:
    int count_;
  };
  MeasuringExecutor executor(num_workers);
  Arena arena = Arena::measuring();
  const Planner planner(arena, Robot{}, settings, executor, Clock{});
  return arena.used_B();
}

template <class Robot>
Planner<Robot>::Planner(Arena& arena, const Robot& robot, const PlannerSettings& settings,
                        Executor& executor, Clock clock) noexcept
    : robot_(robot),
      settings_(settings.is_valid() ? settings : PlannerSettings::smallest()),
      clock_(clock),
      sampler_(arena, settings_, executor, clock),
      optimizer_(arena, settings_, executor, clock),
      best_path_(arena, settings_.max_path_vertices),
      known_path_(arena, settings_.max_path_vertices),
      best_history_(arena, kMaxIterations + 1),
      best_splits_(arena, settings_.max_horizon + 1),
      candidate_(arena, settings_.max_horizon),
      improvements_(arena, kMaxImprovements) {
  for (Slot& slot : slots_) slot.trajectory = Trajectory<Robot>(arena, settings_.max_horizon);
  is_ready_ = settings.is_valid() && !arena.exhausted();
}

template <class Robot>
PlanResult<Robot> Planner<Robot>::plan(const PlanRequest<Robot>& request) SOPT_RT {
  const ScopedFlushDenormals flush_denormals;
  const std::int64_t begin_ns = clock_.now_ns();
  PlanResult<Robot> result;
  const auto slot =
      std::find_if(slots_.begin(), slots_.end(), [](const Slot& s) { return !s.is_held; });
  if (!check_request(request, result)) {
    // reported
  } else if (slot == slots_.end()) {
    fail(result, PlanStatus::kNoSlot, PlanStage::kRequest, "all plan slots are held");
  } else if (check_end(request, true, result) && check_end(request, false, result)) {
    const Deadline deadline(clock_, begin_ns, request.deadline_s);
    Call call{request, deadline, begin_ns};
    plan_into(*slot, call, result);
  }
  result.times.total_ns = clock_.now_ns() - begin_ns;
  return result;
}

template <class Robot>
void Planner<Robot>::plan_into(Slot& slot, Call& call, PlanResult<Robot>& result) SOPT_RT {
  const PlanRequest<Robot>& request = call.request;
  call.step_length = choose_step_length(robot_, *request.world, request.options);
  if (!(call.step_length > 0.0)) {
    fail(result, PlanStatus::kBadInput, PlanStage::kRequest, "speed_mps times dt_s is too small");
    return;
  }
  call.ladder = make_margin_ladder(robot_, request, call.step_length, settings_.max_horizon);
  std::int64_t stage_ns = clock_.now_ns();
  const auto lap_ns = [&] {
    const std::int64_t before_ns = stage_ns;
    stage_ns = clock_.now_ns();
    return stage_ns - before_ns;
  };

  if (!sample(call, result)) return;
  (void)lap_ns();
  if (!make_plan_0(call, slot.trajectory, result)) return;
  result.times.reference_ns = lap_ns();
  const double reserve_s =
      verify_reserve_s<Robot>(slot.trajectory.horizon(), request.world->num_obstacles());
  const OptimizerResult<Robot> optimized =
      optimize(call, call.deadline.earlier_by(reserve_s), slot.trajectory);
  report_optimizer(optimized, result);
  result.times.optimize_ns = lap_ns();

  if (call.deadline.expired()) {
    fail(result, PlanStatus::kDeadline, PlanStage::kOptimize,
         "the deadline passed before verification");
    return;
  }
  bool is_verified = try_verify(request, slot, result);
  if (!is_verified && make_plan_0(call, slot.trajectory, result)) {
    // The optimiser's result was refused: plan 0 leaves instead, if it passes.
    result.cost = optimized.history.front().cost;
    result.path_length = optimized.history.front().path_length;
    is_verified = fill_inputs(slot.trajectory) && try_verify(request, slot, result);
    result.fell_back = is_verified;
  }
  result.times.verify_ns = lap_ns();
  if (!is_verified) return;
  result.status = optimized.status == OptimizerStatus::kDeadline ? PlanStatus::kDeadlineFeasible
                                                                 : PlanStatus::kOk;
  if (request.options.improve_s > 0.0 && result.status == PlanStatus::kOk) {
    improve(slot, call, result);
    result.times.improve_ns = lap_ns();
  }
}

// From plan 0 to a trajectory with inputs on its time grid.
template <class Robot>
OptimizerResult<Robot> Planner<Robot>::optimize(const Call& call, const Deadline& deadline,
                                                Trajectory<Robot>& trajectory) SOPT_RT {
  const PlanRequest<Robot>& request = call.request;
  const double reference_length = path_length(robot_, trajectory);
  const OptimizerResult<Robot> optimized = optimizer_.optimize(
      {&robot_, request.world, call.ladder[static_cast<std::size_t>(call.i_rung)], call.step_length,
       &request.options},
      trajectory, deadline);
  if (request.options.resampling == Resampling::kScale) {
    scale_time(robot_, reference_length, trajectory);
  }
  (void)fill_inputs(trajectory);
  return optimized;
}

// Other ways to the goal, as long as the budget lasts: what is shorter as a path is optimised, what
// is shorter as a verified plan takes the place of the one that is there.
template <class Robot>
void Planner<Robot>::improve(Slot& slot, Call& call, PlanResult<Robot>& result) SOPT_RT {
  const PlanRequest<Robot>& request = call.request;
  (void)best_path_.vertices.try_assign(result.path->vertices.span());
  (void)known_path_.vertices.try_assign(result.path->vertices.span());
  result.path = &best_path_;
  improvements_.clear();
  record_improvement(call, result);
  const double reserve_s =
      verify_reserve_s<Robot>(slot.trajectory.horizon(), request.world->num_obstacles());
  const Deadline until =
      Deadline::earliest(call.deadline.earlier_by(reserve_s),
                         Deadline(clock_, clock_.now_ns(), request.options.improve_s));
  // A straight path is the shortest there is.
  const auto may_improve = [&] { return known_path_.vertices.size() > 2 && !until.expired(); };
  for (int i_round = 0; i_round < kMaxImproveRounds && may_improve(); ++i_round) {
    const SamplerResult<Robot> sampled =
        sampler_.improve_path({&robot_, request.world, request.start, request.goal, &call.ladder,
                               request.seed, &request.options},
                              call.i_rung, i_round, known_path_, until);
    result.sampler_counts.edges += sampled.counts.edges;
    result.sampler_counts.rounds += sampled.counts.rounds;
    const double worthwhile = (1.0 - kWorthwhileGain) * known_path_.length(robot_);
    if (sampled.path == nullptr || sampled.path->length(robot_) > worthwhile) continue;
    if (until.expired()) break;
    (void)known_path_.vertices.try_assign(sampled.path->vertices.span());
    if (!make_reference(robot_, known_path_, call.step_length, request.options.dt_s, candidate_))
      continue;
    const OptimizerResult<Robot> optimized = optimize(call, until, candidate_);
    if (optimized.history.empty() || optimized.history.back().path_length >= result.path_length) {
      continue;
    }
    if (try_replace(call, optimized, slot, result)) record_improvement(call, result);
  }
}

template <class Robot>
bool Planner<Robot>::try_replace(const Call& call, const OptimizerResult<Robot>& optimized,
                                 Slot& slot, PlanResult<Robot>& result) SOPT_RT {
  const PlanRequest<Robot>& request = call.request;
  const VerifyResult<Robot> verified =
      verify(robot_, candidate_,
             {request.start, request.goal, request.world, request.options.min_clearance_m});
  if (!verified.plan) return false;
  result.plan.reset();
  std::swap(slot.trajectory, candidate_);
  (void)best_path_.vertices.try_assign(known_path_.vertices.span());
  report_optimizer(optimized, result);
  result.fell_back = false;
  return try_verify(request, slot, result);  // the same numbers again, now in the slot
}

template <class Robot>
void Planner<Robot>::record_improvement(const Call& call, PlanResult<Robot>& result) SOPT_RT {
  const ImprovementRecord record{clock_.now_ns() - call.begin_ns, result.path_length};
  if (!improvements_.try_push_back(record)) improvements_.back() = record;
  result.improvements = improvements_.span();
}

template <class Robot>
bool Planner<Robot>::check_request(const PlanRequest<Robot>& request,
                                   PlanResult<Robot>& result) const SOPT_RT {
  if (!is_ready_) {
    return fail(result, PlanStatus::kBadInput, PlanStage::kRequest,
                "the planner has invalid settings or too little memory");
  }
  const BrokenRule broken = find_broken_rule(request, settings_);
  if (broken.reason == nullptr) return true;
  return fail(result, PlanStatus::kBadInput, PlanStage::kRequest, broken.reason, broken.value);
}

template <class Robot>
bool Planner<Robot>::check_end(const PlanRequest<Robot>& request, bool is_start,
                               PlanResult<Robot>& result) const SOPT_RT {
  const BrokenEnd broken = find_broken_end(robot_, request, is_start);
  if (broken.reason == nullptr) return true;
  fail(result, is_start ? PlanStatus::kBadStart : PlanStatus::kBadGoal, PlanStage::kRequest,
       broken.reason, broken.amount, broken.i_obstacle);
  result.failure.i_link = broken.i_link;
  result.failure.i_other_link = broken.i_other_link;
  result.failure.i_joint = broken.i_joint;
  result.failure.lower = broken.lower;
  result.failure.upper = broken.upper;
  return false;
}

template <class Robot>
bool Planner<Robot>::sample(Call& call, PlanResult<Robot>& result) SOPT_RT {
  const PlanRequest<Robot>& request = call.request;
  const SamplerResult<Robot> sampled =
      sampler_.find_path({&robot_, request.world, request.start, request.goal, &call.ladder,
                          request.seed, &request.options},
                         call.deadline);
  call.i_rung = sampled.i_rung;
  result.path = sampled.path;
  result.sampler_path_length = sampled.raw_length;
  result.sampler_counts = sampled.counts;
  result.times.sample_ns = sampled.sample_ns;
  result.times.first_path_ns = sampled.first_path_ns;
  result.times.shortcut_ns = sampled.shortcut_ns;
  result.margin_m = kMarginRungs[static_cast<std::size_t>(call.i_rung)] * request.options.margin_m;
  switch (sampled.status) {
    case SamplerStatus::kOk:
      return true;
    case SamplerStatus::kNoPath:
      return fail(result, PlanStatus::kNoPath, PlanStage::kSample,
                  "no path within the budget of samples");
    case SamplerStatus::kDeadline:
      return fail(result, PlanStatus::kDeadline, PlanStage::kSample,
                  "the deadline passed before a path was found");
    case SamplerStatus::kCapacity:
      return fail(result, PlanStatus::kCapacity, PlanStage::kSample,
                  "the path has more vertices than max_path_vertices",
                  static_cast<double>(settings_.max_path_vertices));
  }
  return false;
}

template <class Robot>
bool Planner<Robot>::make_plan_0(const Call& call, Trajectory<Robot>& trajectory,
                                 PlanResult<Robot>& result) SOPT_RT {
  if (make_reference(robot_, *result.path, call.step_length, call.request.options.dt_s,
                     trajectory)) {
    return true;
  }
  return fail(result, PlanStatus::kCapacity, PlanStage::kReference,
              "the trajectory needs more steps than max_horizon",
              std::ceil(result.path->length(robot_) / call.step_length));
}

template <class Robot>
void Planner<Robot>::report_optimizer(const OptimizerResult<Robot>& optimized,
                                      PlanResult<Robot>& result) SOPT_RT {
  result.iterations = optimized.iterations;
  result.segments_initial = optimized.segments_initial;
  result.segments_final = optimized.segments_final;
  (void)best_history_.try_assign(optimized.history);
  (void)best_splits_.try_assign(optimized.splits);
  result.history = best_history_.span();
  result.splits = best_splits_.span();
  result.optimizer_counts = optimized.counts;
  if (optimized.history.empty()) return;
  result.cost = optimized.history.back().cost;
  result.path_length = optimized.history.back().path_length;
}

template <class Robot>
bool Planner<Robot>::try_verify(const PlanRequest<Robot>& request, Slot& slot,
                                PlanResult<Robot>& result) SOPT_RT {
  const VerifyResult<Robot> verified =
      verify(robot_, slot.trajectory,
             {request.start, request.goal, request.world, request.options.min_clearance_m});
  if (!verified.plan) {
    const Violation& v = verified.violation;
    fail(result, PlanStatus::kNoPath, PlanStage::kVerify, reason_of(v.kind), v.amount,
         v.i_obstacle);
    result.failure.i_link = v.i_link;
    result.failure.i_other_link = v.i_other_link;
    result.failure.i_joint = v.i_joint;
    result.failure.t_s = v.t_s;
    return false;
  }
  result.plan.plan_ = verified.plan;
  result.plan.is_held_ = &slot.is_held;
  slot.is_held = true;
  return true;
}

template class PlanLease<Point2>;
template class PlanLease<Arm<4>>;
template class PlanLease<Arm<5>>;
template class PlanLease<Arm<6>>;
template class PlanLease<Arm<7>>;
template class PlanLease<Arm<8>>;
template class Planner<Point2>;
template class Planner<Arm<4>>;
template class Planner<Arm<5>>;
template class Planner<Arm<6>>;
template class Planner<Arm<7>>;
template class Planner<Arm<8>>;

}  // namespace sopt
