#include "opt/margin_ladder.h"

#include <algorithm>
#include <cmath>

#include "models/arm/arm_clearance.h"

namespace sopt {
namespace {

// A rung never asks for less than the hard clearance plus what the rows' tolerance may lose.
constexpr double kFloorGuard_m = 1e-8;

double end_clearance_m(const Point2& robot, const World2& world, const Vec2& end,
                       double limit_m) noexcept {
  return robot.clearance(world, end, limit_m).distance_m;
}

template <int N>
double end_clearance_m(const Arm<N>& robot, const World3& world, const typename Arm<N>::Config& end,
                       double limit_m) noexcept {
  ArmPose<N> pose;
  robot.forward(end, pose);
  return nearest_obstacle(robot, world, pose, limit_m).clearance.distance_m;
}

}  // namespace

template <class Robot>
MarginLadder make_margin_ladder(const Robot& robot, const PlanRequest<Robot>& request,
                                double step_length, int max_horizon) SOPT_RT {
  const PlanOptions& options = request.options;
  MarginLadder ladder;
  for (std::size_t i = 0; i < ladder.size(); ++i) {
    MarginProfile& profile = ladder[i];
    profile.rule = {options.margin_m, kMarginRungs[i], options.min_clearance_m + kFloorGuard_m};
    profile.step_length = step_length;
    const double wanted_m = request.world->max_required_m(profile.rule);
    const auto relax = [&](const typename Robot::Config& end, double& cap_m, int& num_steps) {
      const double clearance_m = end_clearance_m(robot, *request.world, end, wanted_m);
      if (clearance_m >= wanted_m) return;
      cap_m = options.min_clearance_m +
              MarginProfile::kEndShare * (clearance_m - options.min_clearance_m);
      // Two steps at least: a path shorter than one step still has two.
      const double wanted_steps = std::ceil(4.0 * (wanted_m - clearance_m) / step_length);
      num_steps = static_cast<int>(std::clamp(wanted_steps, 2.0, 1.0 * max_horizon));
    };
    relax(request.start, profile.start_cap_m, profile.num_start_steps);
    relax(request.goal, profile.goal_cap_m, profile.num_goal_steps);
  }
  return ladder;
}

template MarginLadder make_margin_ladder(const Point2&, const PlanRequest<Point2>&, double,
                                         int) SOPT_RT;
template MarginLadder make_margin_ladder(const Arm<4>&, const PlanRequest<Arm<4>>&, double,
                                         int) SOPT_RT;
template MarginLadder make_margin_ladder(const Arm<5>&, const PlanRequest<Arm<5>>&, double,
                                         int) SOPT_RT;
template MarginLadder make_margin_ladder(const Arm<6>&, const PlanRequest<Arm<6>>&, double,
                                         int) SOPT_RT;
template MarginLadder make_margin_ladder(const Arm<7>&, const PlanRequest<Arm<7>>&, double,
                                         int) SOPT_RT;
template MarginLadder make_margin_ladder(const Arm<8>&, const PlanRequest<Arm<8>>&, double,
                                         int) SOPT_RT;

}  // namespace sopt
