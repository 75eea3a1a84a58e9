// What one step of a trajectory adds to the cost f and to the path length.
//     point  f = sum |dz|^2 / ds                               length |dz|
//     arm    f = sum (|omega dt|^2 + 2 |alpha dt^2|^2) / ds    length |dtheta|
// where an arm's norms are those of its path metric: joints times their weights.
// f equals path length at uniform operating speed; ds is fixed during a request. A step's share
// depends on its own two states alone, so the windows' costs add up to f.
#pragma once

#include <cmath>

#include "models/arm/arm.h"
#include "models/plane/point2.h"
#include "models/trajectory.h"
#include "rt/annotations.h"

namespace sopt {

// Weight of the input next to that of the velocity.
inline constexpr double kArmInputWeight = 2.0;

struct StepMeasure {
  double cost_ds = 0.0;  // cost times ds
  double length2 = 0.0;  // squared length, in the robot's path metric
};

[[nodiscard]] inline StepMeasure measure_step(const Point2& /*robot*/, const Vec2& from,
                                              const Vec2& to, double /*dt_s*/) SOPT_RT {
  const double length2 = (to - from).squaredNorm();
  return {length2, length2};
}

template <int N>
[[nodiscard]] StepMeasure measure_step(const Arm<N>& robot, const typename Arm<N>::State& from,
                                       const typename Arm<N>::State& to, double dt_s) SOPT_RT {
  const auto square = [&](const typename Arm<N>::Config& d) {
    return robot.weights().cwiseProduct(d).squaredNorm();
  };
  const double speed2 = square(from.template tail<N>());
  const double change2 = square(to.template tail<N>() - from.template tail<N>());
  return {dt_s * dt_s * (speed2 + kArmInputWeight * change2),
          square(to.template head<N>() - from.template head<N>())};
}

// Sum over steps of the change of position.
template <class Robot>
[[nodiscard]] double path_length(const Robot& robot, const Trajectory<Robot>& trajectory) SOPT_RT {
  double length = 0.0;
  for (int t = 0; t < trajectory.horizon(); ++t) {
    length += std::sqrt(
        measure_step(robot, trajectory.states[t], trajectory.states[t + 1], trajectory.dt_s)
            .length2);
  }
  return length;
}

}  // namespace sopt
