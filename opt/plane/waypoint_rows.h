// Rows of one window on waypoints alone, as the paper makes them [Leu22, Alg. 2; Liu, Lin, Tomizuka
// 2018]: at waypoint t, from its closest point o on an obstacle with normal n,
//     n . z_t >= n . o + b        b: clearance asked there, plus r
// of every obstacle within trust_m + b, or of the nearest one alone. The latter is the role of the
// paper's watershed: it labels free space by the nearest obstacle. Deviation: here the nearest
// obstacle is found exactly, not on a grid of pixels. Nothing keeps the motion between waypoints
// clear, nor, with one obstacle, the waypoint itself from the others: opt/plane/obstacle_rows.h
// does.
#pragma once

#include <cstdint>
#include <span>

#include "models/config.h"
#include "models/margin.h"
#include "models/plane/point2.h"
#include "opt/qp/point_rows.h"
#include "opt/splits.h"
#include "rt/annotations.h"

namespace sopt {

// As make_obstacle_rows; `mode` is kWaypoint or kLabelMap.
[[nodiscard]] bool make_waypoint_rows(RowMode mode, const Point2& robot, const World2& world,
                                      const MarginProfile& profile, std::span<const Vec2> states,
                                      const Window& window, double trust_m, PointRows& rows,
                                      std::int64_t& num_queries) SOPT_RT;

}  // namespace sopt
