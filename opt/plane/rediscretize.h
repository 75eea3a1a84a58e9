// A new horizon for a path that became shorter [Leu22, III-B "resample_traj"]: as many steps of the
// nominal length as the path needs, states interpolated in time. Waypoints stay on the path, but
// edges between them cut its corners: what was clear need not stay clear, which is why the library
// scales time instead (opt/time_scaling.h).
#pragma once

#include "models/plane/point2.h"
#include "models/trajectory.h"
#include "rt/annotations.h"

namespace sopt {

// At least 2 steps; at most the capacity of `trajectory`, whose states change and dt does not.
// False when the horizon stays as it is.
bool rediscretize(double step_length, Trajectory<Point2>& trajectory) SOPT_RT;

}  // namespace sopt
