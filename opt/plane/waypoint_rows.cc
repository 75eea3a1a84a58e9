#include "opt/plane/waypoint_rows.h"

#include <cmath>

namespace sopt {
namespace {

struct Waypoint {
  int t = 0;  // in the window
  Vec2 z = Vec2::Zero();
  ClearanceRule rule;
};

// What all waypoints of a window have in common.
struct WaypointRows {
  const Point2& robot;
  const World2& world;
  PointRows& rows;
  std::int64_t& num_queries;

  [[nodiscard]] double inset_m(int i_obstacle, const Waypoint& at) const noexcept {
    return robot.radius_m + world.required_m(i_obstacle, at.rule);
  }
  [[nodiscard]] bool try_add(const Waypoint& at, const Clearance2& c, int i_obstacle) noexcept {
    return rows.try_add(at.t, c.normal, c.normal.dot(c.on_obstacle) + inset_m(i_obstacle, at));
  }

  [[nodiscard]] bool add_bounds(const Waypoint& at, double trust_m) noexcept {
    const double inset = inset_m(kBoundsObstacle, at);
    for (int axis = 0; axis < 2; ++axis) {
      const Vec2 inwards = axis == 0 ? Vec2::UnitX() : Vec2::UnitY();
      const double lower = world.bounds().lower[axis] + inset;
      const double upper = world.bounds().upper[axis] - inset;
      if (at.z[axis] - lower < trust_m && !rows.try_add(at.t, inwards, lower)) return false;
      if (upper - at.z[axis] < trust_m && !rows.try_add(at.t, -inwards, -upper)) return false;
    }
    return true;
  }

  [[nodiscard]] bool add_all(const Waypoint& at, double trust_m) noexcept {
    const double reach = robot.radius_m + world.max_required_m(at.rule) + trust_m;
    return add_bounds(at, trust_m) && world.for_each_near(at.z, at.z, reach, [&](int i) {
      Clearance2 c;
      ++num_queries;
      const double limit = inset_m(i, at) + trust_m;
      return !compute_clearance_within(world.obstacle(i), at.z, at.z, limit, c) ||
             try_add(at, c, i);
    });
  }

  // Looks ever farther until some obstacle is there, at most a diagonal away.
  [[nodiscard]] bool add_nearest(const Waypoint& at) noexcept {
    constexpr int kDoublings = 6;
    double reach = std::ldexp((world.bounds().upper - world.bounds().lower).norm(), -kDoublings);
    Clearance2 nearest;
    int i_nearest = kNoObstacle;
    for (int k = 0; k <= kDoublings && i_nearest == kNoObstacle; ++k, reach *= 2.0) {
      world.for_each_near(at.z, at.z, reach, [&](int i) {
        Clearance2 c;
        ++num_queries;
        const double limit = i_nearest == kNoObstacle ? reach : nearest.distance_m;
        if (!compute_clearance_within(world.obstacle(i), at.z, at.z, limit, c)) return true;
        nearest = c;
        i_nearest = i;
        return true;
      });
    }
    return i_nearest == kNoObstacle || try_add(at, nearest, i_nearest);
  }
};

}  // namespace

bool make_waypoint_rows(RowMode mode, const Point2& robot, const World2& world,
                        const MarginProfile& profile, std::span<const Vec2> states,
                        const Window& window, double trust_m, PointRows& rows,
                        std::int64_t& num_queries) SOPT_RT {
  const auto state = [&](int t) { return states[static_cast<std::size_t>(window.first + t)]; };
  const int horizon = static_cast<int>(states.size()) - 1;
  const int n = window.num_steps();
  rows.reset(n, state(0), state(n));
  WaypointRows maker{robot, world, rows, num_queries};
  for (int t = 1; t < n; ++t) {
    // The waypoint belongs to two steps, whose rules differ next to the ends; the reference keeps
    // both.
    const ClearanceRule before = profile.at_step(window.first + t - 1, horizon);
    const ClearanceRule after = profile.at_step(window.first + t, horizon);
    const Waypoint at = {t, state(t), before.cap_m > after.cap_m ? before : after};
    const bool fits =
        mode == RowMode::kLabelMap ? maker.add_nearest(at) : maker.add_all(at, trust_m);
    if (!fits) return false;
  }
  return true;
}

}  // namespace sopt
