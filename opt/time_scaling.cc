#include "opt/time_scaling.h"

#include <algorithm>

namespace sopt {

double path_length(const Trajectory<Point2>& trajectory) SOPT_RT {
  double length = 0.0;
  for (int t = 0; t < trajectory.horizon(); ++t) {
    length += (trajectory.states[t + 1] - trajectory.states[t]).norm();
  }
  return length;
}

void scale_time(const Point2& robot, double reference_length_m,
                Trajectory<Point2>& trajectory) SOPT_RT {
  double longest_step_m = 0.0;
  for (int t = 0; t < trajectory.horizon(); ++t) {
    longest_step_m =
        std::max(longest_step_m, (trajectory.states[t + 1] - trajectory.states[t]).norm());
  }
  if (longest_step_m == 0.0) return;
  // A hair above the limit's step time: dividing by it again must not round above the limit.
  constexpr double kRoundingGuard = 1.0 + 1e-12;
  trajectory.dt_s = std::max(trajectory.dt_s * path_length(trajectory) / reference_length_m,
                             longest_step_m / robot.v_max_mps * kRoundingGuard);
}

bool fill_inputs(Trajectory<Point2>& trajectory) SOPT_RT {
  if (!trajectory.inputs.try_resize(trajectory.horizon())) return false;
  for (int t = 0; t < trajectory.horizon(); ++t) {
    trajectory.inputs[t] = (trajectory.states[t + 1] - trajectory.states[t]) / trajectory.dt_s;
  }
  return true;
}

}  // namespace sopt
