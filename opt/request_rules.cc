#include "opt/request_rules.h"

#include <cmath>

#include "models/arm/arm_clearance.h"

namespace sopt {
namespace {

BrokenEnd find_broken_end(const Point2& robot, const World2& world, const Vec2& end, bool is_start,
                          double min_clearance_m) noexcept {
  BrokenEnd broken;
  const NearestObstacle nearest = robot.clearance(world, end, min_clearance_m);
  if (nearest.distance_m >= min_clearance_m) return broken;
  broken.reason =
      is_start ? "start is closer than min_clearance" : "goal is closer than min_clearance";
  broken.i_obstacle = nearest.i_obstacle;
  broken.amount = nearest.distance_m;
  broken.lower = min_clearance_m;
  return broken;
}

template <int N>
BrokenEnd find_broken_joint(const Arm<N>& robot, const typename Arm<N>::Config& end,
                            bool is_start) noexcept {
  BrokenEnd broken;
  const auto breaks = [&](const char* reason, int i_joint, double lower, double upper) {
    broken.reason = reason;
    broken.i_joint = i_joint;
    broken.amount = end[i_joint];
    broken.lower = lower;
    broken.upper = upper;
  };
  const int i_joint = robot.joint_outside_limits(end);
  if (i_joint != kNoJoint) {
    breaks(
        is_start ? "a joint's start is outside its limits" : "a joint's goal is outside its limits",
        i_joint, robot.lower()[i_joint], robot.upper()[i_joint]);
    return broken;
  }
  for (int j = 0; j < N; ++j) {
    if (!robot.is_continuous(j) || std::abs(end[j]) <= kMaxWound_rad) continue;
    breaks(is_start ? "a joint's start is more than 1000 turns from 0"
                    : "a joint's goal is more than 1000 turns from 0",
           j, -kMaxWound_rad, kMaxWound_rad);
    return broken;
  }
  return broken;
}

const char* reason_of(const ArmContact& contact, bool is_start, double min_clearance_m) noexcept {
  if (contact.i_obstacle == kSelfObstacle) {
    return is_start ? "start is in self-collision" : "goal is in self-collision";
  }
  if (contact.clearance.distance_m < min_clearance_m) {
    return is_start ? "start is closer than min_clearance" : "goal is closer than min_clearance";
  }
  return is_start ? "start is too near min_clearance to prove a motion from it clear"
                  : "goal is too near min_clearance to prove a motion to it clear";
}

template <int N>
BrokenEnd find_broken_end(const Arm<N>& robot, const World3& world,
                          const typename Arm<N>::Config& end, bool is_start,
                          double min_clearance_m) noexcept {
  BrokenEnd broken = find_broken_joint(robot, end, is_start);
  if (broken.reason != nullptr) return broken;
  const double needed_m = min_clearance_m + kEndRoom_m;
  const ArmContact contact = robot.clearance(world, end, needed_m);
  const bool is_self = contact.i_obstacle == kSelfObstacle;
  if (!is_self && contact.clearance.distance_m >= needed_m) return broken;
  broken.reason = reason_of(contact, is_start, min_clearance_m);
  broken.i_link = contact.i_link;
  broken.i_other_link = contact.i_other_link;
  broken.i_obstacle = contact.i_obstacle;
  broken.amount = contact.clearance.distance_m;
  broken.lower = is_self ? kSelfClearance_m : needed_m;
  return broken;
}

}  // namespace

template <class Robot>
BrokenRule find_broken_rule(const PlanRequest<Robot>& request,
                            const PlannerSettings& settings) SOPT_RT {
  const PlanOptions& o = request.options;
  struct Rule {
    bool holds;
    const char* reason;
    double value;
  };
  const auto positive = [](double v) { return v > 0.0 && std::isfinite(v); };
  const auto not_negative = [](double v) { return v >= 0.0 && std::isfinite(v); };
  const Rule rules[] = {
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
      {o.num_streams >= 0 && o.num_streams <= settings.num_streams,
       "num_streams must be 0 or at most PlannerSettings::num_streams",
       static_cast<double>(o.num_streams)},
      {o.num_segments >= 0 && o.num_segments <= settings.max_horizon,
       "num_segments must be 0 or at most max_horizon", static_cast<double>(o.num_segments)},
      {o.steps_per_window >= 2, "steps_per_window must be at least 2",
       static_cast<double>(o.steps_per_window)},
      {o.solver != WindowSolver::kDense || settings.dense_solver,
       "solver is kDense without PlannerSettings::dense_solver", 0.0},
      {o.max_window == 0 || (o.max_window >= 4 && o.max_window <= settings.max_window),
       "max_window must be 0 or in [4, PlannerSettings::max_window]",
       static_cast<double>(o.max_window)},
      {o.max_iterations >= 0 && o.max_iterations <= kMaxIterations,
       "max_iterations must be in [0, kMaxIterations]", static_cast<double>(o.max_iterations)},
      {not_negative(o.improve_s), "improve_s must be finite and not negative", o.improve_s},
      {not_negative(o.tol_step), "tol_step must be finite and not negative", o.tol_step},
  };
  for (const Rule& rule : rules) {
    if (!rule.holds) return {rule.reason, rule.value};
  }
  return {};
}

template <class Robot>
BrokenEnd find_broken_end(const Robot& robot, const PlanRequest<Robot>& request,
                          bool is_start) SOPT_RT {
  return find_broken_end(robot, *request.world, is_start ? request.start : request.goal, is_start,
                         request.options.min_clearance_m);
}

template BrokenRule find_broken_rule(const PlanRequest<Point2>&, const PlannerSettings&) SOPT_RT;
template BrokenRule find_broken_rule(const PlanRequest<Arm<4>>&, const PlannerSettings&) SOPT_RT;
template BrokenRule find_broken_rule(const PlanRequest<Arm<5>>&, const PlannerSettings&) SOPT_RT;
template BrokenRule find_broken_rule(const PlanRequest<Arm<6>>&, const PlannerSettings&) SOPT_RT;
template BrokenRule find_broken_rule(const PlanRequest<Arm<7>>&, const PlannerSettings&) SOPT_RT;
template BrokenRule find_broken_rule(const PlanRequest<Arm<8>>&, const PlannerSettings&) SOPT_RT;

template BrokenEnd find_broken_end(const Point2&, const PlanRequest<Point2>&, bool) SOPT_RT;
template BrokenEnd find_broken_end(const Arm<4>&, const PlanRequest<Arm<4>>&, bool) SOPT_RT;
template BrokenEnd find_broken_end(const Arm<5>&, const PlanRequest<Arm<5>>&, bool) SOPT_RT;
template BrokenEnd find_broken_end(const Arm<6>&, const PlanRequest<Arm<6>>&, bool) SOPT_RT;
template BrokenEnd find_broken_end(const Arm<7>&, const PlanRequest<Arm<7>>&, bool) SOPT_RT;
template BrokenEnd find_broken_end(const Arm<8>&, const PlanRequest<Arm<8>>&, bool) SOPT_RT;

}  // namespace sopt
