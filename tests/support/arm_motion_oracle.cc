#include "tests/support/arm_motion_oracle.h"

#include <algorithm>
#include <cmath>

#include "models/space/clearance3.h"

namespace sopt::oracle {
namespace {

// Lowest value of find(t_s) over the trajectory.
template <int N, class Find>
MotionMinimum lowest(const Trajectory<Arm<N>>& motion, int samples_per_step, Find&& find) {
  const int num = motion.horizon() * samples_per_step;
  const double pause_s = motion.dt_s / samples_per_step;
  std::vector<MotionMinimum> samples;
  MotionMinimum best;
  for (int i = 0; i <= num; ++i) {
    samples.push_back(find(i * pause_s));
    samples.back().t_s = i * pause_s;
    if (samples.back().clearance_m < best.clearance_m) best = samples.back();
  }
  constexpr double kNear_m = 0.05;
  const double limit_m = best.clearance_m + kNear_m;
  for (int i = 0; i <= num; ++i) {
    const auto clearance_m = [&](int k) {
      return samples[static_cast<std::size_t>(std::clamp(k, 0, num))].clearance_m;
    };
    if (clearance_m(i) > limit_m || clearance_m(i) > clearance_m(i - 1) ||
        clearance_m(i) > clearance_m(i + 1)) {
      continue;
    }
    double from_s = std::max(0, i - 1) * pause_s;
    double to_s = std::min(num, i + 1) * pause_s;
    for (int k = 0; k < 24; ++k) {
      const double third_s = (to_s - from_s) / 3.0;
      MotionMinimum left = find(from_s + third_s);
      MotionMinimum right = find(to_s - third_s);
      left.t_s = from_s + third_s;
      right.t_s = to_s - third_s;
      const bool go_left = left.clearance_m <= right.clearance_m;
      (go_left ? to_s : from_s) = (go_left ? right : left).t_s;
      if (left.clearance_m < best.clearance_m) best = left;
      if (right.clearance_m < best.clearance_m) best = right;
    }
  }
  return best;
}

}  // namespace

template <int N>
typename Arm<N>::Config configuration_at(const Trajectory<Arm<N>>& motion, double t_s) {
  const int step = std::clamp(static_cast<int>(t_s / motion.dt_s + 1e-12), 0, motion.horizon() - 1);
  const double s = t_s - step * motion.dt_s;
  return motion.states[step].template head<N>() + s * motion.states[step].template tail<N>() +
         0.5 * s * s * motion.inputs[step];
}

template <int N>
MotionMinimum obstacle_clearance(const Arm<N>& arm, const typename Arm<N>::Config& q,
                                 std::span<const Convex3* const> obstacles) {
  typename Arm<N>::Pose pose;
  arm.forward(q, pose);
  MotionMinimum best;
  for (int c = 0; c < arm.num_capsules(); ++c) {
    const Capsule3 capsule = arm.capsule_W(pose, c);
    for (std::size_t i = 0; i < obstacles.size(); ++i) {
      Clearance3 found;
      if (!compute_clearance_within(*obstacles[i], capsule, best.clearance_m, found)) continue;
      if (found.distance_m >= best.clearance_m) continue;
      best = {found.distance_m, 0.0, arm.capsule_link(c), static_cast<int>(i), -1};
    }
  }
  return best;
}

template <int N>
MotionMinimum self_clearance(const Arm<N>& arm, const typename Arm<N>::Config& q) {
  typename Arm<N>::Pose pose;
  arm.forward(q, pose);
  MotionMinimum best;
  for (const auto& pair : arm.self_collision_pairs()) {
    const ArmBody& a = arm.body(pair.i_body_a);
    const ArmBody& b = arm.body(pair.i_body_b);
    for (int i = a.first; i < a.last; ++i) {
      const Convex3 one = to_convex(arm.capsule_W(pose, i));
      for (int k = b.first; k < b.last; ++k) {
        const double distance_m = compute_clearance(one, arm.capsule_W(pose, k)).distance_m;
        if (distance_m >= best.clearance_m) continue;
        best = {distance_m, 0.0, b.i_link, kNoObstacle, a.i_link};
      }
    }
  }
  return best;
}

template <int N>
MotionMinimum obstacle_minimum(const Arm<N>& arm, const Trajectory<Arm<N>>& motion,
                               std::span<const Convex3* const> obstacles, int samples_per_step) {
  return lowest<N>(motion, samples_per_step, [&](double t_s) {
    return obstacle_clearance(arm, configuration_at<N>(motion, t_s), obstacles);
  });
}

template <int N>
MotionMinimum self_minimum(const Arm<N>& arm, const Trajectory<Arm<N>>& motion,
                           int samples_per_step) {
  return lowest<N>(motion, samples_per_step, [&](double t_s) {
    return self_clearance(arm, configuration_at<N>(motion, t_s));
  });
}

template <int N>
ArmTrajectory<N> random_motion(Random& random, const Arm<N>& arm, int horizon, double dt_s) {
  std::vector<typename Arm<N>::Input> inputs(static_cast<std::size_t>(horizon),
                                             Arm<N>::Input::Zero());
  typename Arm<N>::Config start;
  for (int j = 0; j < N; ++j) {
    std::vector<double> alpha;
    const double wave = random.uniform(0.5, 4.0);
    const double phase = random.uniform(0.0, 6.28);
    const double noise = random.chance(0.5) ? 0.0 : 1.0;
    for (int t = 0; t < horizon; ++t) {
      alpha.push_back(std::sin(wave * 6.28 * (t + 0.5) / horizon + phase) +
                      noise * random.uniform(-1.0, 1.0));
    }
    double mean = 0.0;
    for (const double a : alpha) mean += a / horizon;
    double q = 0.0, omega = 0.0, low = 0.0, high = 0.0, fastest = 0.0, sharpest = 0.0;
    for (double& a : alpha) {
      a -= mean;
      for (int k = 1; k <= 8; ++k) {  // of the parabola
        const double s = dt_s * k / 8;
        low = std::min(low, q + s * omega + 0.5 * s * s * a);
        high = std::max(high, q + s * omega + 0.5 * s * s * a);
      }
      q += dt_s * omega + 0.5 * dt_s * dt_s * a;
      omega += dt_s * a;
      fastest = std::max(fastest, std::abs(omega));
      sharpest = std::max(sharpest, std::abs(a));
    }
    const bool is_free = arm.joint(j).kind == JointKind::kContinuous;
    const double room = is_free ? 20.0 : arm.upper()[j] - arm.lower()[j];
    const double scale = random.uniform(0.2, 0.9) *
                         std::min({arm.v_max()[j] / (fastest + 1e-9),
                                   arm.a_max()[j] / (sharpest + 1e-9), room / (high - low + 1e-9)});
    for (std::size_t t = 0; t < alpha.size(); ++t) inputs[t][j] = scale * alpha[t];
    const double lowest = is_free ? -10.0 : arm.lower()[j];
    start[j] = lowest - scale * low + random.uniform(0.04, 0.96) * (room - scale * (high - low));
  }
  return ArmTrajectory<N>(start, inputs, dt_s);
}

#define SOPT_INSTANTIATE(N)                                                           \
  template Arm<N>::Config configuration_at<N>(const Trajectory<Arm<N>>&, double);     \
  template MotionMinimum obstacle_clearance(const Arm<N>&, const Arm<N>::Config&,     \
                                            std::span<const Convex3* const>);         \
  template MotionMinimum self_clearance(const Arm<N>&, const Arm<N>::Config&);        \
  template MotionMinimum obstacle_minimum(const Arm<N>&, const Trajectory<Arm<N>>&,   \
                                          std::span<const Convex3* const>, int);      \
  template MotionMinimum self_minimum(const Arm<N>&, const Trajectory<Arm<N>>&, int); \
  template ArmTrajectory<N> random_motion(Random&, const Arm<N>&, int, double)
SOPT_INSTANTIATE(4);
SOPT_INSTANTIATE(5);
SOPT_INSTANTIATE(6);
SOPT_INSTANTIATE(7);
SOPT_INSTANTIATE(8);
#undef SOPT_INSTANTIATE

}  // namespace sopt::oracle
