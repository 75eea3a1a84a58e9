#include "opt/plane/rediscretize.h"

#include <algorithm>
#include <cmath>

#include "opt/step_measure.h"

namespace sopt {

bool rediscretize(double step_length, Trajectory<Point2>& trajectory) SOPT_RT {
  auto& states = trajectory.states;
  const int old_horizon = trajectory.horizon();
  // Rounding must not add a step to a path of whole steps.
  const double wanted = std::ceil(path_length(Point2{}, trajectory) / step_length - 1e-9);
  const int horizon = static_cast<int>(std::clamp(wanted, 2.0, states.capacity() - 1.0));
  if (horizon == old_horizon) return false;
  const Vec2 last = states.back();
  const auto interpolate = [&](int i) {
    const double t = static_cast<double>(i) * old_horizon / horizon;
    const int j = std::min(static_cast<int>(t), old_horizon - 1);
    return Vec2(states[j] + (t - j) * (states[j + 1] - states[j]));
  };
  // In place: the source of a state lies behind it when the horizon shrinks, before it when it
  // grows.
  if (horizon < old_horizon) {
    for (int i = 1; i < horizon; ++i) states[i] = interpolate(i);
    (void)states.try_resize(horizon + 1);
  } else {
    (void)states.try_resize(horizon + 1);
    for (int i = horizon - 1; i > 0; --i) states[i] = interpolate(i);
  }
  states.back() = last;
  return true;
}

}  // namespace sopt
