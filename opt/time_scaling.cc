#include "opt/time_scaling.h"

#include <algorithm>
#include <cmath>

#include "opt/step_measure.h"

namespace sopt {

void scale_time(const Point2& robot, double reference_length,
                Trajectory<Point2>& trajectory) SOPT_RT {
  double longest_step_m = 0.0;
  for (int t = 0; t < trajectory.horizon(); ++t) {
    longest_step_m =
        std::max(longest_step_m, (trajectory.states[t + 1] - trajectory.states[t]).norm());
  }
  if (longest_step_m == 0.0) return;
  // A hair above the limit's step time: dividing by it again must not round above the limit.
  constexpr double kRoundingGuard = 1.0 + 1e-12;
  trajectory.dt_s = std::max(trajectory.dt_s * path_length(robot, trajectory) / reference_length,
                             longest_step_m / robot.v_max_mps * kRoundingGuard);
}

template <int N>
void scale_time(const Arm<N>& robot, double reference_length,
                Trajectory<Arm<N>>& trajectory) SOPT_RT {
  double speed = 0.0;         // largest share of a limit
  double acceleration = 0.0;  // likewise
  for (int t = 0; t < trajectory.horizon(); ++t) {
    const auto w = trajectory.states[t].template tail<N>();
    const auto change = trajectory.states[t + 1].template tail<N>() - w;
    speed = std::max(speed, w.cwiseAbs().cwiseQuotient(robot.v_max()).maxCoeff());
    acceleration =
        std::max(acceleration, change.cwiseAbs().cwiseQuotient(robot.a_max()).maxCoeff());
  }
  if (speed == 0.0) return;
  constexpr double kRoundingGuard = 1.0 + 1e-9;
  const double scale =
      std::max({path_length(robot, trajectory) / reference_length, kRoundingGuard * speed,
                kRoundingGuard * std::sqrt(acceleration / trajectory.dt_s)});
  trajectory.dt_s *= scale;
  for (auto& state : trajectory.states) state.template tail<N>() /= scale;
}

template <int N>
bool fill_inputs(Trajectory<Arm<N>>& trajectory) SOPT_RT {
  if (!trajectory.inputs.try_resize(trajectory.horizon())) return false;
  for (int t = 0; t < trajectory.horizon(); ++t) {
    trajectory.inputs[t] =
        (trajectory.states[t + 1] - trajectory.states[t]).template tail<N>() / trajectory.dt_s;
  }
  return true;
}

bool fill_inputs(Trajectory<Point2>& trajectory) SOPT_RT {
  if (!trajectory.inputs.try_resize(trajectory.horizon())) return false;
  for (int t = 0; t < trajectory.horizon(); ++t) {
    trajectory.inputs[t] = (trajectory.states[t + 1] - trajectory.states[t]) / trajectory.dt_s;
  }
  return true;
}

template void scale_time(const Arm<4>&, double, Trajectory<Arm<4>>&) SOPT_RT;
template bool fill_inputs(Trajectory<Arm<4>>&) SOPT_RT;
template void scale_time(const Arm<5>&, double, Trajectory<Arm<5>>&) SOPT_RT;
template bool fill_inputs(Trajectory<Arm<5>>&) SOPT_RT;
template void scale_time(const Arm<6>&, double, Trajectory<Arm<6>>&) SOPT_RT;
template bool fill_inputs(Trajectory<Arm<6>>&) SOPT_RT;
template void scale_time(const Arm<7>&, double, Trajectory<Arm<7>>&) SOPT_RT;
template bool fill_inputs(Trajectory<Arm<7>>&) SOPT_RT;
template void scale_time(const Arm<8>&, double, Trajectory<Arm<8>>&) SOPT_RT;
template bool fill_inputs(Trajectory<Arm<8>>&) SOPT_RT;

}  // namespace sopt
