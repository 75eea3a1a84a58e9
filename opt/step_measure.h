// What one step of a trajectory adds to the cost f and to the path length.
//     point  f = sum |dz|^2 / ds                               length |dz|
//     arm    f = sum (|omega dt|^2 + 2 |alpha dt^2|^2) / ds    length |dtheta|
// f equals path length at uniform operating speed; ds is fixed during a request. A step's share
// depends on its own two states alone, so the windows' costs add up to f.
#pragma once

#include "models/arm/arm.h"
#include "models/plane/point2.h"
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
[[nodiscard]] StepMeasure measure_step(const Arm<N>& /*robot*/, const typename Arm<N>::State& from,
                                       const typename Arm<N>::State& to, double dt_s) SOPT_RT {
  const double speed2 = from.template tail<N>().squaredNorm();
  const double change2 = (to.template tail<N>() - from.template tail<N>()).squaredNorm();
  return {dt_s * dt_s * (speed2 + kArmInputWeight * change2),
          (to.template head<N>() - from.template head<N>()).squaredNorm()};
}

}  // namespace sopt
