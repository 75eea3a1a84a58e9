// The two clearances of a request, never mixed. `margin` is wanted: sampler, shortcut and obstacle
// rows keep it. `min_clearance` is hard: verify rejects below it. When no path keeps the margin the
// request steps down a ladder of rungs (1, 1/2, 1/4, 1/16 of every margin). An end of the request
// may itself be closer than the rung: then the steps next to that end keep a share of the end's own
// clearance instead. The profile is fixed per request and rung, never lowered from an iterate
// (which would erode the margin sweep by sweep).
// Deviation: next to an end the profile is a step over whole trajectory steps, not clearance +
// distance: that ramp can only be followed straight away from the nearest obstacle, so in a corner
// it has no solution. A step of the trajectory is usually longer than the margin, so it is one
// step.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "rt/annotations.h"

namespace sopt {

// "This obstacle has no margin of its own."
inline constexpr double kDefaultMargin = -1.0;

inline constexpr std::array<double, 4> kMarginRungs = {1.0, 0.5, 0.25, 0.0625};

// What one step of the trajectory must keep: rung times the obstacle's own margin, or margin_m for
// one without, but at least floor_m and at most cap_m.
struct ClearanceRule {
  double margin_m = 0.0;
  double rung = 1.0;
  double floor_m = 0.0;
  double cap_m = std::numeric_limits<double>::infinity();

  [[nodiscard]] double required_m(double own_margin_m) const SOPT_RT {
    const double wanted_m = rung * (own_margin_m < 0.0 ? margin_m : own_margin_m);
    return std::min(cap_m, std::max(floor_m, wanted_m));
  }
};

// The rule for every step of a trajectory, fixed for one request and rung.
struct MarginProfile {
  // Share of an end's clearance above min_clearance that the steps next to it keep: less than 1, so
  // that rounding cannot make the end itself infeasible.
  static constexpr double kEndShare = 0.9;

  ClearanceRule rule;                                            // away from the ends
  double start_cap_m = std::numeric_limits<double>::infinity();  // holds for the first steps
  double goal_cap_m = std::numeric_limits<double>::infinity();   // holds for the last steps
  int num_start_steps = 0;
  int num_goal_steps = 0;
  double step_length = 0.0;  // nominal length of a step, in the robot's path metric

  // Rule for step i of a trajectory with `horizon` steps.
  [[nodiscard]] ClearanceRule at_step(int i, int horizon) const SOPT_RT {
    ClearanceRule result = rule;
    if (i < num_start_steps) result.cap_m = std::min(result.cap_m, start_cap_m);
    if (i >= horizon - num_goal_steps) result.cap_m = std::min(result.cap_m, goal_cap_m);
    return result;
  }

  // Path length at an end over which the cap may be used before there are steps. A reference step
  // is at least half of the nominal one, so what is clear under this rule is clear under at_step.
  [[nodiscard]] double start_reach() const SOPT_RT { return 0.5 * step_length * num_start_steps; }
  [[nodiscard]] double goal_reach() const SOPT_RT { return 0.5 * step_length * num_goal_steps; }
  [[nodiscard]] ClearanceRule at_start() const SOPT_RT { return at_step(0, num_goal_steps + 1); }
  [[nodiscard]] ClearanceRule at_goal() const SOPT_RT {
    return at_step(num_start_steps, num_start_steps + 1);
  }
};

// One profile per rung, widest first.
using MarginLadder = std::array<MarginProfile, kMarginRungs.size()>;

}  // namespace sopt
