// Linearised obstacles of one window: the convex feasible set around the reference [Leu22, Alg. 2;
// Liu, Lin, Tomizuka 2018]. In the plane rows stand on edges: the closest points between reference
// edge (z_t, z_t+1) and an obstacle give a separating plane n . z >= o, and both waypoints must
// keep
//     n . z_t >= o + b,   n . z_t+1 >= o + b        b: clearance asked of this edge, plus r
// so the whole edge keeps it, continuously and exactly. All obstacles within `trust_m` + b of the
// edge get rows; waypoints may then move by trust_m, and nothing else can come closer than b.
// Bounds are such planes as well. Deviation: the paper takes one obstacle per waypoint by a
// label map, with rows on waypoints; those leave collisions between waypoints (docs/RESULTS.md).
#pragma once

#include <cstdint>
#include <span>

#include "models/margin.h"
#include "models/plane/point2.h"
#include "opt/qp/point_rows.h"
#include "opt/splits.h"
#include "rt/annotations.h"

namespace sopt {

// Fills `rows` for the window `window` of `states` (a whole trajectory). False when the rows do not
// fit; `rows` is then not usable. Adds the distances computed to `num_queries`.
[[nodiscard]] bool make_obstacle_rows(const Point2& robot, const World2& world,
                                      const MarginProfile& profile, std::span<const Vec2> states,
                                      const Window& window, double trust_m, PointRows& rows,
                                      std::int64_t& num_queries) SOPT_RT;

}  // namespace sopt
