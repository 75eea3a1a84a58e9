// What a request must be before anything is planned: its numbers, one rule a line, then its ends.
// An end of an arm must be within the limits, its continuous joints not wound up beyond measure,
// and keep more than min_clearance: motion checks ask for more, so that the way to or from an end
// that is closer is found by luck or not at all. Cost: one exact clearance query per end. Units m,
// rad.
#pragma once

#include "models/arm/arm.h"
#include "models/arm/arm_motion.h"
#include "models/config.h"
#include "models/plane/point2.h"
#include "models/trajectory.h"
#include "models/world_status.h"
#include "rt/annotations.h"

namespace sopt {

struct BrokenRule {
  const char* reason = nullptr;  // static text; null: none is broken
  double value = 0.0;            // the offending number, when there is one
};

// The first rule that `request` breaks for a planner with these settings.
template <class Robot>
[[nodiscard]] BrokenRule find_broken_rule(const PlanRequest<Robot>& request,
                                          const PlannerSettings& settings) SOPT_RT;

// What an arm's end must keep above min_clearance: what its first or last motion needs at middles,
// and a thousandth for the guard of 1e-8 m that the margin ladder puts on its floor.
inline constexpr double kEndRoom_m = 1.001 * kMotionRoom_m;

// How far a continuous joint's end may be from 0, either way: 1000 turns. Plans pass verify up to
// 1e5 turns; from 1e6 on the rounding of a state exceeds kMaxDynamicsDefect.
inline constexpr double kMaxWound_rad = 1e3 * 6.283185307179586;

// What is wrong with an end of a request.
struct BrokenEnd {
  const char* reason = nullptr;  // static text; null: nothing is
  int i_link = 0;
  int i_other_link = kNoLink;    // with kSelfObstacle
  int i_obstacle = kNoObstacle;  // what i_link is too close to
  int i_joint = kNoJoint;        // or what is too far out
  double amount = 0.0;           // the clearance, m; or the joint's position
  double lower = 0.0;            // least that is allowed
  double upper = 0.0;            // most that is allowed of a joint
};

// Of the start or the goal of a request that breaks no rule.
template <class Robot>
[[nodiscard]] BrokenEnd find_broken_end(const Robot& robot, const PlanRequest<Robot>& request,
                                        bool is_start) SOPT_RT;

extern template BrokenRule find_broken_rule(const PlanRequest<Point2>&,
                                            const PlannerSettings&) SOPT_RT;
extern template BrokenRule find_broken_rule(const PlanRequest<Arm<4>>&,
                                            const PlannerSettings&) SOPT_RT;
extern template BrokenRule find_broken_rule(const PlanRequest<Arm<5>>&,
                                            const PlannerSettings&) SOPT_RT;
extern template BrokenRule find_broken_rule(const PlanRequest<Arm<6>>&,
                                            const PlannerSettings&) SOPT_RT;
extern template BrokenRule find_broken_rule(const PlanRequest<Arm<7>>&,
                                            const PlannerSettings&) SOPT_RT;
extern template BrokenRule find_broken_rule(const PlanRequest<Arm<8>>&,
                                            const PlannerSettings&) SOPT_RT;

extern template BrokenEnd find_broken_end(const Point2&, const PlanRequest<Point2>&, bool) SOPT_RT;
extern template BrokenEnd find_broken_end(const Arm<4>&, const PlanRequest<Arm<4>>&, bool) SOPT_RT;
extern template BrokenEnd find_broken_end(const Arm<5>&, const PlanRequest<Arm<5>>&, bool) SOPT_RT;
extern template BrokenEnd find_broken_end(const Arm<6>&, const PlanRequest<Arm<6>>&, bool) SOPT_RT;
extern template BrokenEnd find_broken_end(const Arm<7>&, const PlanRequest<Arm<7>>&, bool) SOPT_RT;
extern template BrokenEnd find_broken_end(const Arm<8>&, const PlanRequest<Arm<8>>&, bool) SOPT_RT;

}  // namespace sopt
