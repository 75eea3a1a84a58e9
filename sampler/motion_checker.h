// Whether a straight motion of the robot keeps the clearance that a request's margin profile asks
// for, counting the checks. Motions that begin at the start or end at the goal may use the
// profile's relaxed rule on the first or last piece.
#pragma once

#include <algorithm>
#include <cstdint>

#include "models/margin.h"
#include "rt/annotations.h"

namespace sopt {

// Which end of the request a configuration is, if any.
enum class RequestEnd : std::int8_t { kNone, kStart, kGoal };

template <class Robot>
class MotionChecker {
 public:
  using Config = typename Robot::Config;
  using World = typename Robot::World;

  MotionChecker(const Robot& robot, const World& world, const MarginProfile& profile) noexcept
      : robot_(&robot), world_(&world), profile_(&profile) {}

  [[nodiscard]] bool is_clear(const Config& a, RequestEnd a_end, const Config& b,
                              RequestEnd b_end) SOPT_RT {
    ++num_checks_;
    const double a_reach = reach(a_end);
    const double b_reach = reach(b_end);
    if (a_reach == 0.0 && b_reach == 0.0) {
      return robot_->motion_is_clear(*world_, profile_->rule, a, b);
    }
    const double length = robot_->path_distance(a, b);
    if (length == 0.0) return robot_->motion_is_clear(*world_, loosest(a_end, b_end), a, b);
    const double leave = std::min(1.0, a_reach / length);
    const double arrive = std::max(leave, 1.0 - b_reach / length);
    const Config left = robot_->interpolate(a, b, leave);
    const Config back = arrive < 1.0 ? robot_->interpolate(a, b, arrive) : b;
    return (leave == 0.0 || robot_->motion_is_clear(*world_, rule_at(a_end), a, left)) &&
           (arrive <= leave || robot_->motion_is_clear(*world_, profile_->rule, left, back)) &&
           (arrive == 1.0 || robot_->motion_is_clear(*world_, rule_at(b_end), back, b));
  }

  // How far, up to `limit_m`, the robot at `q` can move in any direction and stay clear away from
  // the ends; not positive when it cannot say.
  [[nodiscard]] double excess_clearance(const Config& q, double limit_m) SOPT_RT {
    ++num_checks_;
    const double required_m = world_->max_required_m(profile_->rule);
    return robot_->clearance(*world_, q, required_m + limit_m).distance_m - required_m;
  }

  [[nodiscard]] const Robot& robot() const SOPT_RT { return *robot_; }
  [[nodiscard]] auto sampling_box() const SOPT_RT {
    return robot_->sampling_box(*world_, profile_->rule);
  }
  [[nodiscard]] const MarginProfile& profile() const SOPT_RT { return *profile_; }
  [[nodiscard]] std::int64_t num_checks() const SOPT_RT { return num_checks_; }

 private:
  [[nodiscard]] double reach(RequestEnd end) const SOPT_RT {
    if (end == RequestEnd::kStart) return profile_->start_reach();
    return end == RequestEnd::kGoal ? profile_->goal_reach() : 0.0;
  }
  [[nodiscard]] ClearanceRule rule_at(RequestEnd end) const SOPT_RT {
    if (end == RequestEnd::kStart) return profile_->at_start();
    return end == RequestEnd::kGoal ? profile_->at_goal() : profile_->rule;
  }
  [[nodiscard]] ClearanceRule loosest(RequestEnd a, RequestEnd b) const SOPT_RT {
    ClearanceRule rule = rule_at(a);
    rule.cap_m = std::min(rule.cap_m, rule_at(b).cap_m);
    return rule;
  }

  const Robot* robot_;
  const World* world_;
  const MarginProfile* profile_;
  std::int64_t num_checks_ = 0;
};

}  // namespace sopt
