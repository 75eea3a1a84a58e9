#include "opt/reference.h"

#include <algorithm>
#include <cmath>

namespace sopt {

template <class Robot>
double choose_step_length(const Robot& robot, const typename Robot::World& world,
                          const PlanOptions& options) SOPT_RT {
  const double wanted =
      options.speed_mps > 0.0 ? options.speed_mps * options.dt_s : robot.default_step_length(world);
  if constexpr (requires { robot.v_max_mps; }) {
    constexpr double kRoundingGuard = 1.0 - 1e-12;  // dividing by dt must not round above v_max
    return std::min(wanted, robot.v_max_mps * options.dt_s * kRoundingGuard);
  }
  return wanted;
}

template <class Robot>
bool make_reference(const Robot& robot, const Path<Robot>& path, double step_length, double dt_s,
                    Trajectory<Robot>& out) SOPT_RT {
  const auto& v = path.vertices;
  out.dt_s = dt_s;
  out.states.clear();
  if (!out.states.try_push_back(v[0])) return false;
  const int min_steps = v.size() == 2 ? 2 : 1;  // one window needs a waypoint to move
  for (int i = 0; i + 1 < v.size(); ++i) {
    const double exact = std::ceil(robot.path_distance(v[i], v[i + 1]) / step_length);
    if (exact > out.states.capacity()) return false;
    const int num_steps = std::max(min_steps, static_cast<int>(exact));
    for (int k = 1; k < num_steps; ++k) {
      const double share = static_cast<double>(k) / num_steps;
      if (!out.states.try_push_back(robot.interpolate(v[i], v[i + 1], share))) return false;
    }
    if (!out.states.try_push_back(v[i + 1])) return false;
  }
  return true;
}

template double choose_step_length(const Point2&, const World2&, const PlanOptions&) SOPT_RT;
template double choose_step_length(const Arm<4>&, const World3&, const PlanOptions&) SOPT_RT;
template double choose_step_length(const Arm<5>&, const World3&, const PlanOptions&) SOPT_RT;
template double choose_step_length(const Arm<6>&, const World3&, const PlanOptions&) SOPT_RT;
template double choose_step_length(const Arm<7>&, const World3&, const PlanOptions&) SOPT_RT;
template double choose_step_length(const Arm<8>&, const World3&, const PlanOptions&) SOPT_RT;
template bool make_reference(const Point2&, const Path<Point2>&, double, double,
                             Trajectory<Point2>&) SOPT_RT;

}  // namespace sopt
