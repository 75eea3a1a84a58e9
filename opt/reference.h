// Path -> plan 0 [Leu22, III-A "generate_reference"]. Dynamically exact from the first moment, with
// a waypoint at every vertex: the reference follows the checked path exactly, keeps its clearances,
// and the planner can be stopped at any time from here on.
// Point: every motion of the path is cut into equal steps no longer than the operating speed
// allows. Arm: every motion goes from rest to rest on as few steps as operating speed, v_max and
// a_max of all joints allow, accelerating constantly within each step: a trapezoid or triangle.
// Deviation: the paper starts from u = 0 with states from the path.
#pragma once

#include "models/arm/arm.h"
#include "models/config.h"
#include "models/plane/point2.h"
#include "models/trajectory.h"
#include "rt/annotations.h"

namespace sopt {

// Nominal length of a step in the robot's path metric: speed x dt, or the robot's default; at most
// what v_max allows in dt.
template <class Robot>
[[nodiscard]] double choose_step_length(const Robot& robot, const typename Robot::World& world,
                                        const PlanOptions& options) SOPT_RT;

// Fills `out.states` and dt. Point: steps have path length in [step_length / 2, step_length], but
// for motions of the path shorter than half a step. Arm: step_length / dt_s is the largest speed.
// At least 2 steps. False when the horizon exceeds the capacity of `out`. The path has at least two
// vertices; step_length > 0.
template <class Robot>
[[nodiscard]] bool make_reference(const Robot& robot, const Path<Robot>& path, double step_length,
                                  double dt_s, Trajectory<Robot>& out) SOPT_RT;
template <int N>
[[nodiscard]] bool make_reference(const Arm<N>& robot, const Path<Arm<N>>& path, double step_length,
                                  double dt_s, Trajectory<Arm<N>>& out) SOPT_RT;

extern template double choose_step_length(const Point2&, const World2&, const PlanOptions&) SOPT_RT;
extern template bool make_reference(const Point2&, const Path<Point2>&, double, double,
                                    Trajectory<Point2>&) SOPT_RT;

}  // namespace sopt
