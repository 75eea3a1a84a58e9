// Keeps the waypoints and changes the step time [Leu22, III-B "resample_traj"]. Deviation: the
// paper chooses a new horizon and resamples; scaling dt is exact, keeps W and the verified
// geometry.
//     point  dt = max( dt_0 L / L_0,  max_t |dz_t| / v_max )
//     arm    dt = dt_0 max( L / L_0,  max |omega| / v_max,  sqrt(max |alpha| / a_max) )
// L_0, dt_0: length and step time of the reference; so the mean speed stays the operating speed. An
// arm's velocities change by dt_0 / dt with it: what the waypoints and the motion between them are
// does not change at all.
// Only for robots at rest at both ends among obstacles that do not move.
#pragma once

#include "models/arm/arm.h"
#include "models/plane/point2.h"
#include "models/trajectory.h"
#include "rt/annotations.h"

namespace sopt {

// Sets dt_s of `trajectory`, whose step time is that of the reference, and the velocities in its
// states; inputs are not touched. A trajectory that does not move stays as it is.
void scale_time(const Point2& robot, double reference_length,
                Trajectory<Point2>& trajectory) SOPT_RT;
template <int N>
void scale_time(const Arm<N>& robot, double reference_length,
                Trajectory<Arm<N>>& trajectory) SOPT_RT;

// Sets the inputs that belong to the states and dt_s: u_t = (z_{t+1} - z_t) / dt, of an arm the
// change of velocity. False when they do not fit.
[[nodiscard]] bool fill_inputs(Trajectory<Point2>& trajectory) SOPT_RT;
template <int N>
[[nodiscard]] bool fill_inputs(Trajectory<Arm<N>>& trajectory) SOPT_RT;

}  // namespace sopt
