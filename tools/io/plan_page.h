// What a planner did last as the page of html_page.h: the robot at its waypoints, its states and
// inputs against the limits, and its clearance, exact at the waypoints. Without a plan the page
// shows the scene with the robot at start and goal, and why there is none.
#pragma once

#include "opt/planner.h"
#include "tools/io/html_page.h"
#include "tools/io/robot_scene.h"

namespace sopt {

// `times` stand beside the title.
[[nodiscard]] HtmlScene page_of(const Scene& scene, const PlanRequest<Point2>& request,
                                const PlanResult<Point2>& result, const StageTimes& times);
template <int N>
[[nodiscard]] HtmlScene page_of(const ArmScene<N>& scene, const PlanRequest<Arm<N>>& request,
                                const PlanResult<Arm<N>>& result, const StageTimes& times);

}  // namespace sopt
