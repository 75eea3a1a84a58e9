// Keeps the waypoints and changes the step time [Leu22, III-B "resample_traj"]. Deviation: the
// paper chooses a new horizon and resamples; scaling dt is exact, keeps W and the verified
// geometry.
//     dt = max( dt_0 L / L_0,  max_t |dz_t| / v_max )
// L_0, dt_0: length and step time of the reference; so the mean speed stays the operating speed.
// Only for robots at rest at both ends among obstacles that do not move.
#pragma once

#include "models/point2.h"
#include "models/trajectory.h"
#include "rt/annotations.h"

namespace sopt {

// Sets dt_s of `trajectory`, whose step time is that of the reference; inputs are not touched. A
// trajectory that does not move keeps dt_s.
void scale_time(const Point2& robot, double reference_length_m,
                Trajectory<Point2>& trajectory) SOPT_RT;

// Sets the inputs that belong to the states and dt_s: u_t = (z_{t+1} - z_t) / dt. False when they
// do not fit.
[[nodiscard]] bool fill_inputs(Trajectory<Point2>& trajectory) SOPT_RT;

// Sum of |z_{t+1} - z_t|, m.
[[nodiscard]] double path_length(const Trajectory<Point2>& trajectory) SOPT_RT;

}  // namespace sopt
