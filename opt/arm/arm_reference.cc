// Rest-to-rest motions of arms. Along a motion of the path d = b - a the share sigma in [0, 1] has
// rate and acceleration limits of its own,
//     rate <= v = min(speed / |d|, min_j v_max_j / |d_j|)     |d| in the path metric
//     |acceleration| <= a = min_j a_max_j / |d_j|
// and on a grid of n steps, in step units, the largest rates from rest to rest at waypoints
// 0 < k < n are min(a k, v, a (n - k)). n is the least with a sum of at least 1; all rates are then
// multiplied by what makes it 1, which keeps every limit. sigma is the running mean of neighbouring
// rates: exact for an acceleration constant over each step.
#include <algorithm>
#include <cmath>

#include "opt/reference.h"

namespace sopt {
namespace {

// References stay this much inside the limits, which leaves the optimiser room for rounding.
constexpr double kLimitGuard = 1.0 - 1e-8;

// Limits of the share, per step.
struct ShareLimits {
  double rate = 1.0;
  double acceleration = 1.0;

  [[nodiscard]] double rate_at(int k, int num_steps) const noexcept {
    return std::min(rate, acceleration * std::min(k, num_steps - k));
  }
  // Sum of rate_at over 0 <= k <= num_steps.
  [[nodiscard]] double reach(int num_steps) const noexcept {
    const double ramp = std::floor(rate / acceleration);  // waypoints below the rate
    if (num_steps - 1 <= 2.0 * ramp) {
      const int middle = num_steps / 2;
      return acceleration * (middle * (num_steps - middle));
    }
    return acceleration * ramp * (ramp + 1.0) + rate * (num_steps - 1 - 2.0 * ramp);
  }
};

template <int N>
ShareLimits limits_of(const Arm<N>& robot, const typename Arm<N>::Config& way, double step_length,
                      double dt_s) noexcept {
  ShareLimits limits;  // 1: one step
  limits.rate = std::min(1.0, step_length / robot.motion_length(way));
  for (int j = 0; j < N; ++j) {
    const double travel = std::abs(way[j]);
    limits.rate = std::min(limits.rate, kLimitGuard * robot.v_max()[j] * dt_s / travel);
    limits.acceleration =
        std::min(limits.acceleration, kLimitGuard * robot.a_max()[j] * dt_s * dt_s / travel);
  }
  return limits;
}

// The least number of steps with reach >= 1, or max_steps + 1.
int count_steps(const ShareLimits& limits, int max_steps) noexcept {
  int low = 1;  // not enough
  int high = max_steps + 1;
  while (high - low > 1) {
    const int middle = low + (high - low) / 2;
    (limits.reach(middle) >= 1.0 ? high : low) = middle;
  }
  return high;
}

template <int N>
bool try_append_motion(const Arm<N>& robot, const typename Arm<N>::Config& to, double step_length,
                       double dt_s, Trajectory<Arm<N>>& out) noexcept {
  using State = typename Arm<N>::State;
  const typename Arm<N>::Config from = out.states.back().template head<N>();
  const typename Arm<N>::Config way = to - from;
  if (way.isZero(0.0)) return true;
  const ShareLimits limits = limits_of(robot, way, step_length, dt_s);
  const int max_steps = out.states.capacity() - out.states.size();
  const int num_steps = count_steps(limits, max_steps);
  if (num_steps > max_steps) return false;
  const double scale = 1.0 / limits.reach(num_steps);
  double share = 0.0;
  double rate = 0.0;
  for (int k = 1; k <= num_steps; ++k) {
    const double next = scale * limits.rate_at(k, num_steps);
    share += 0.5 * (rate + next);
    rate = next;
    State state;
    state.template head<N>() = k == num_steps ? to : from + share * way;
    state.template tail<N>() = (rate / dt_s) * way;
    (void)out.states.try_push_back(state);
  }
  return true;
}

}  // namespace

template <int N>
bool make_reference(const Arm<N>& robot, const Path<Arm<N>>& path, double step_length, double dt_s,
                    Trajectory<Arm<N>>& out) SOPT_RT {
  using State = typename Arm<N>::State;
  const auto& v = path.vertices;
  out.dt_s = dt_s;
  out.states.clear();
  State state = State::Zero();
  state.template head<N>() = v[0];
  if (!out.states.try_push_back(state)) return false;
  for (int i = 1; i < v.size(); ++i) {
    const auto to = robot.unwrapped(out.states.back().template head<N>(), v[i]);
    if (!try_append_motion(robot, to, step_length, dt_s, out)) return false;
  }
  while (out.horizon() < 2) {  // an arm that stays
    const State last = out.states.back();
    if (!out.states.try_push_back(last)) return false;
  }
  return true;
}

template bool make_reference(const Arm<4>&, const Path<Arm<4>>&, double, double,
                             Trajectory<Arm<4>>&) SOPT_RT;
template bool make_reference(const Arm<5>&, const Path<Arm<5>>&, double, double,
                             Trajectory<Arm<5>>&) SOPT_RT;
template bool make_reference(const Arm<6>&, const Path<Arm<6>>&, double, double,
                             Trajectory<Arm<6>>&) SOPT_RT;
template bool make_reference(const Arm<7>&, const Path<Arm<7>>&, double, double,
                             Trajectory<Arm<7>>&) SOPT_RT;
template bool make_reference(const Arm<8>&, const Path<Arm<8>>&, double, double,
                             Trajectory<Arm<8>>&) SOPT_RT;

}  // namespace sopt
