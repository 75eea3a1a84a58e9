#include "opt/planner.h"

#include <algorithm>
#include <cmath>

#include "opt/reference.h"
#include "opt/time_scaling.h"
#include "rt/float_env.h"

namespace sopt {
namespace {

// Work bounds of verify, from docs/RESULTS.md, generous: what the optimiser leaves of the deadline.
constexpr double kVerifyPerStep_s = 1e-6;
constexpr double kVerifyPerBox_s = 1e-8;  // per obstacle and run of 16 steps

// A rung never asks for less than the hard clearance plus what the rows' tolerance may lose.
constexpr double kFloorGuard_m = 1e-8;

double verify_reserve_s(int horizon, int num_obstacles) noexcept {
  const double runs = horizon / 16.0 + 1.0;
  return kVerifyPerStep_s * horizon + kVerifyPerBox_s * runs * num_obstacles;
}

template <class Robot>
bool fail(PlanResult<Robot>& result, PlanStatus status, PlanStage stage, const char* reason,
          double amount = 0.0, int i_obstacle = kNoObstacle) noexcept {
  result.status = status;
  result.failure = {stage, reason, 0, i_obstacle, 0.0, amount};
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
      optimizer_(arena, settings_, executor, clock) {
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
    plan_into(*slot, request, Deadline(clock_, begin_ns, request.deadline_s), result);
  }
  result.times.total_ns = clock_.now_ns() - begin_ns;
  return result;
}

template <class Robot>
void Planner<Robot>::plan_into(Slot& slot, const PlanRequest<Robot>& request,
                               const Deadline& deadline, PlanResult<Robot>& result) SOPT_RT {
  const double step_length = choose_step_length(robot_, *request.world, request.options);
  const MarginLadder ladder = make_ladder(request, step_length);
  std::int64_t stage_ns = clock_.now_ns();
  const auto lap_ns = [&] {
    const std::int64_t before_ns = stage_ns;
    stage_ns = clock_.now_ns();
    return stage_ns - before_ns;
  };

  int i_rung = 0;
  if (!sample(request, ladder, deadline, i_rung, result)) return;
  (void)lap_ns();
  if (!make_plan_0(request, step_length, slot, result)) return;
  const double reference_length = path_length(slot.trajectory);
  result.times.reference_ns = lap_ns();

  const double reserve_s =
      verify_reserve_s(slot.trajectory.horizon(), request.world->num_obstacles());
  const OptimizerResult<Robot> optimized =
      optimizer_.optimize({&robot_, request.world, ladder[static_cast<std::size_t>(i_rung)],
                           step_length, &request.options},
                          slot.trajectory, deadline.earlier_by(reserve_s));
  if (request.options.resampling == Resampling::kScale) {
    scale_time(robot_, reference_length, slot.trajectory);
  }
  (void)fill_inputs(slot.trajectory);
  report_optimizer(optimized, result);
  result.times.optimize_ns = lap_ns();

  if (deadline.expired()) {
    fail(result, PlanStatus::kDeadline, PlanStage::kOptimize,
         "the deadline passed before verification");
    return;
  }
  bool is_verified = try_verify(request, slot, result);
  if (!is_verified && make_plan_0(request, step_length, slot, result)) {
    // The optimiser's result was refused: plan 0 leaves instead, if it passes.
    result.fell_back = true;
    result.cost = optimized.history.front().cost;
    result.path_length = optimized.history.front().path_length;
    is_verified = fill_inputs(slot.trajectory) && try_verify(request, slot, result);
  }
  result.times.verify_ns = lap_ns();
  if (!is_verified) return;
  result.status = optimized.status == OptimizerStatus::kDeadline ? PlanStatus::kDeadlineFeasible
                                                                 : PlanStatus::kOk;
}

template <class Robot>
bool Planner<Robot>::check_request(const PlanRequest<Robot>& request,
                                   PlanResult<Robot>& result) const SOPT_RT {
  const PlanOptions& o = request.options;
  struct Rule {
    bool holds;
    const char* reason;
    double value;
  };
  const auto positive = [](double v) { return v > 0.0 && std::isfinite(v); };
  const auto not_negative = [](double v) { return v >= 0.0 && std::isfinite(v); };
  const Rule rules[] = {
      {is_ready_, "the planner has invalid settings or too little memory", 0.0},
      {request.world != nullptr, "world is missing", 0.0},
      {request.start.allFinite(), "start is not finite", 0.0},
      {request.goal.allFinite(), "goal is not finite", 0.0},
      {request.deadline_s > 0.0, "deadline_s must be positive", request.deadline_s},
      {not_negative(o.speed_mps), "speed_mps must be finite and not negative", o.speed_mps},
      {positive(o.dt_s), "dt_s must be finite and positive", o.dt_s},
      {positive(o.min_clearance_m), "min_clearance_m must be finite and positive",
       o.min_clearance_m},
      {std::isfinite(o.margin_m) && o.margin_m >= o.min_clearance_m,
       "margin_m must be finite and at least min_clearance_m", o.margin_m},
      {o.num_samples > 0, "num_samples must be positive", static_cast<double>(o.num_samples)},
      {o.num_batches > 0, "num_batches must be positive", static_cast<double>(o.num_batches)},
      {o.num_streams >= 0 && o.num_streams <= settings_.num_streams,
       "num_streams must be 0 or at most PlannerSettings::num_streams",
       static_cast<double>(o.num_streams)},
      {o.num_segments >= 0 && o.num_segments <= settings_.max_horizon,
       "num_segments must be 0 or at most max_horizon", static_cast<double>(o.num_segments)},
      {o.steps_per_window >= 2, "steps_per_window must be at least 2",
       static_cast<double>(o.steps_per_window)},
      {o.solver != WindowSolver::kDense || settings_.dense_solver,
       "solver is kDense without PlannerSettings::dense_solver", 0.0},
      {o.max_window == 0 || (o.max_window >= 4 && o.max_window <= settings_.max_window),
       "max_window must be 0 or in [4, PlannerSettings::max_window]",
       static_cast<double>(o.max_window)},
      {o.max_iterations >= 0 && o.max_iterations <= kMaxIterations,
       "max_iterations must be in [0, kMaxIterations]", static_cast<double>(o.max_iterations)},
      {not_negative(o.tol_step), "tol_step must be finite and not negative", o.tol_step},
  };
  for (const Rule& rule : rules) {
    if (!rule.holds) {
      return fail(result, PlanStatus::kBadInput, PlanStage::kRequest, rule.reason, rule.value);
    }
  }
  return true;
}

template <class Robot>
bool Planner<Robot>::check_end(const PlanRequest<Robot>& request, bool is_start,
                               PlanResult<Robot>& result) const SOPT_RT {
  const NearestObstacle nearest = robot_.clearance(
      *request.world, is_start ? request.start : request.goal, request.options.min_clearance_m);
  if (nearest.distance_m >= request.options.min_clearance_m) return true;
  const PlanStatus status = is_start ? PlanStatus::kBadStart : PlanStatus::kBadGoal;
  const char* const reason =
      is_start ? "start is closer than min_clearance" : "goal is closer than min_clearance";
  return fail(result, status, PlanStage::kRequest, reason, nearest.distance_m, nearest.i_obstacle);
}

template <class Robot>
MarginLadder Planner<Robot>::make_ladder(const PlanRequest<Robot>& request,
                                         double step_length) const SOPT_RT {
  const PlanOptions& options = request.options;
  MarginLadder ladder;
  for (std::size_t i = 0; i < ladder.size(); ++i) {
    MarginProfile& profile = ladder[i];
    profile.rule = {options.margin_m, kMarginRungs[i], options.min_clearance_m + kFloorGuard_m};
    profile.step_length = step_length;
    const double wanted_m = request.world->max_required_m(profile.rule);
    const auto relax = [&](const typename Robot::Config& end, double& cap_m, int& num_steps) {
      const double clearance_m = robot_.clearance(*request.world, end, wanted_m).distance_m;
      if (clearance_m >= wanted_m) return;
      cap_m = options.min_clearance_m +
              MarginProfile::kEndShare * (clearance_m - options.min_clearance_m);
      // Two steps at least: a path shorter than one step still has two.
      const double wanted_steps = std::ceil(4.0 * (wanted_m - clearance_m) / step_length);
      num_steps = static_cast<int>(std::clamp(wanted_steps, 2.0, 1.0 * settings_.max_horizon));
    };
    relax(request.start, profile.start_cap_m, profile.num_start_steps);
    relax(request.goal, profile.goal_cap_m, profile.num_goal_steps);
  }
  return ladder;
}

template <class Robot>
bool Planner<Robot>::sample(const PlanRequest<Robot>& request, const MarginLadder& ladder,
                            const Deadline& deadline, int& i_rung,
                            PlanResult<Robot>& result) SOPT_RT {
  const SamplerResult<Robot> sampled =
      sampler_.find_path({&robot_, request.world, request.start, request.goal, &ladder,
                          request.seed, &request.options},
                         deadline);
  i_rung = sampled.i_rung;
  result.path = sampled.path;
  result.sampler_path_length = sampled.raw_length;
  result.sampler_counts = sampled.counts;
  result.times.sample_ns = sampled.sample_ns;
  result.times.shortcut_ns = sampled.shortcut_ns;
  result.margin_m = kMarginRungs[static_cast<std::size_t>(i_rung)] * request.options.margin_m;
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
bool Planner<Robot>::make_plan_0(const PlanRequest<Robot>& request, double step_length, Slot& slot,
                                 PlanResult<Robot>& result) SOPT_RT {
  if (make_reference(*result.path, step_length, request.options.dt_s, slot.trajectory)) return true;
  return fail(result, PlanStatus::kCapacity, PlanStage::kReference,
              "the trajectory needs more steps than max_horizon",
              std::ceil(result.path->length() / step_length));
}

template <class Robot>
void Planner<Robot>::report_optimizer(const OptimizerResult<Robot>& optimized,
                                      PlanResult<Robot>& result) SOPT_RT {
  result.iterations = optimized.iterations;
  result.segments_initial = optimized.segments_initial;
  result.segments_final = optimized.segments_final;
  result.history = optimized.history;
  result.splits = optimized.splits;
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
    result.status = PlanStatus::kNoPath;
    result.failure = {
        PlanStage::kVerify, reason_of(v.kind), v.i_link, v.i_obstacle, v.t_s, v.amount};
    return false;
  }
  result.plan.plan_ = verified.plan;
  result.plan.is_held_ = &slot.is_held;
  slot.is_held = true;
  return true;
}

template class PlanLease<Point2>;
template class Planner<Point2>;

}  // namespace sopt
