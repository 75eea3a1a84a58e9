// The clearance profiles that a request may be planned with, rung by rung (models/margin.h): the
// margin times the rung, never less than min_clearance, relaxed over the steps next to an end that
// is itself closer.
#pragma once

#include "models/margin.h"
#include "models/point2.h"
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

}  // namespace sopt
