// Planar point robot: a disc of radius r that moves along z+ = z + dt u. State z = (x, y) in m,
// world frame; input u = (vx, vy) in m/s; configuration = state. Between waypoints the motion is a
// straight line at constant speed. Its velocity may jump between steps. [Leu22, IV-A.1]
// This file is also what the library asks of a robot: the types, the path metric, and what the
// sampler needs to know of a motion.
#pragma once

#include <algorithm>
#include <limits>

#include "models/margin.h"
#include "models/plane/world2.h"
#include "rt/annotations.h"

namespace sopt {

struct Point2 {
  static constexpr int kDof = 2;
  using Config = Vec2;
  using State = Vec2;
  using Input = Vec2;
  using World = World2;

  double radius_m = 0.0;                                       // >= 0
  double v_max_mps = std::numeric_limits<double>::infinity();  // speed, 2-norm

  // Length of the motion from a to b in the path metric: m.
  [[nodiscard]] static double path_distance(const Config& a, const Config& b) SOPT_RT {
    return (b - a).norm();
  }
  // The configuration at share s in [0, 1] of the motion from a to b.
  [[nodiscard]] static Config interpolate(const Config& a, const Config& b, double s) SOPT_RT {
    return a + s * (b - a);
  }

  // Of a coordinate in the path metric.
  [[nodiscard]] static Vec2 weights() SOPT_RT { return Vec2::Ones(); }
  // Nothing turns without end.
  [[nodiscard]] static constexpr bool is_continuous(int /*i_dof*/) SOPT_RT { return false; }
  [[nodiscard]] static Config unwrapped(const Config& /*a*/, const Config& b) SOPT_RT { return b; }

  // Nominal length of a trajectory step when the request gives no speed, m.
  [[nodiscard]] double default_step_length(const World& world) const SOPT_RT {
    const double share_m = (world.bounds().upper - world.bounds().lower).norm() / 200.0;
    return radius_m > 0.0 ? std::min(share_m, 4.0 * radius_m) : share_m;
  }

  // Box that holds every configuration that can be clear under `rule`.
  [[nodiscard]] Aabb2 sampling_box(const World& world, const ClearanceRule& rule) const SOPT_RT {
    const Vec2 inset = Vec2::Constant(radius_m + rule.required_m(kDefaultMargin));
    return {world.bounds().lower + inset, world.bounds().upper - inset};
  }

  // True when the whole motion from a to b keeps the clearance that `rule` asks for. Exact.
  [[nodiscard]] bool motion_is_clear(const World& world, const ClearanceRule& rule, const Config& a,
                                     const Config& b) const SOPT_RT {
    return world.is_clear(a, b, radius_m, rule);
  }

  // Signed clearance of the robot at `q`, exact up to limit_m, and what is nearest.
  [[nodiscard]] NearestObstacle clearance(const World& world, const Config& q,
                                          double limit_m) const SOPT_RT {
    NearestObstacle nearest = world.nearest(q, q, limit_m + radius_m);
    const bool found = nearest.i_obstacle != kNoObstacle;
    nearest.distance_m = found ? nearest.distance_m - radius_m : limit_m;
    return nearest;
  }
};

}  // namespace sopt
