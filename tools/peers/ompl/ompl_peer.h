// Planners of the Open Motion Planning Library as peers: its defaults, this project's robots and
// worlds behind its checkers. Space: the box in which a configuration can be clear. Motions are
// checked either as OMPL does by default, at states no further apart than kResolution, or by the
// robot's own motion test, which needs no resolution. Planner, space and problem are new for every
// run and seeded before, so a run depends on its seed alone, unless the clock ends it.
#pragma once

#include <memory>
#include <string>

#include "tools/peers/peer.h"

namespace sopt {

enum class OmplPlanner {
  kRrtStar,
  kInformedRrtStar,
  kBitStar,
  kRrtConnect,
  kRrtConnectSimplify,  // and PathSimplifier::simplifyMax
};

enum class OmplMotionTest { kDiscrete, kExact };

inline constexpr double kResolution = 0.05;  // m in the plane, rad of an arm

[[nodiscard]] std::string ompl_version();

// A peer that stops at its first solution.
[[nodiscard]] std::unique_ptr<Peer> make_ompl_peer(std::string name, OmplPlanner planner,
                                                   OmplMotionTest test);

// RRT* for `budget_s` of CPU time, however early it has a solution; a slow peer.
[[nodiscard]] std::unique_ptr<Peer> make_ompl_rrt_star_for(std::string name, double budget_s);

}  // namespace sopt
