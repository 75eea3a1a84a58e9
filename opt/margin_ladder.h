// The clearance profiles that a request may be planned with, rung by rung (models/margin.h): the
// margin times the rung, never less than min_clearance, relaxed over the steps next to an end that
// is itself closer.
#pragma once

#include "models/arm/arm.h"
#include "models/margin.h"
#include "models/plane/point2.h"
#include "models/trajectory.h"
#include "rt/annotations.h"

namespace sopt {

// For steps of nominal length step_length > 0, in the robot's path metric; profiles relax at most
// max_horizon steps at an end.
template <class Robot>
[[nodiscard]] MarginLadder make_margin_ladder(const Robot& robot, const PlanRequest<Robot>& request,
                                              double step_length, int max_horizon) SOPT_RT;

extern template MarginLadder make_margin_ladder(const Point2&, const PlanRequest<Point2>&, double,
                                                int) SOPT_RT;
extern template MarginLadder make_margin_ladder(const Arm<4>&, const PlanRequest<Arm<4>>&, double,
                                                int) SOPT_RT;
extern template MarginLadder make_margin_ladder(const Arm<5>&, const PlanRequest<Arm<5>>&, double,
                                                int) SOPT_RT;
extern template MarginLadder make_margin_ladder(const Arm<6>&, const PlanRequest<Arm<6>>&, double,
                                                int) SOPT_RT;
extern template MarginLadder make_margin_ladder(const Arm<7>&, const PlanRequest<Arm<7>>&, double,
                                                int) SOPT_RT;
extern template MarginLadder make_margin_ladder(const Arm<8>&, const PlanRequest<Arm<8>>&, double,
                                                int) SOPT_RT;

}  // namespace sopt
