// What a request must be before anything is planned, one rule a line.
#pragma once

#include "models/arm.h"
#include "models/config.h"
#include "models/point2.h"
#include "models/trajectory.h"
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

}  // namespace sopt
