// Whether a straight joint motion keeps clear of obstacles and of the arm itself, certified. The
// motion is cut into pieces and eight of their middles are looked at in each turn. A middle that is
// closer than `rule` asks for (or a pair of links closer than `self_clearance_m`), by the exact
// answer, blocks the motion. A piece is done when no link can, on its way from the middle to the
// piece's ends, come closer than `rule` asks for; or when that way is at most kRoomShare of the
// clearance asked for above rule.floor_m, so that nothing between comes closer than floor_m, nor a
// pair of links to touch. Other pieces are halved. So a motion in the open costs one turn, and only
// what is near obstacles is looked at closely.
// In a turn: forward kinematics in float lanes (arm_lanes.h), bounding spheres of links against all
// obstacles, then, with bounds on what each capsule moves, spheres that cover the capsules
// (arm_cover.h); balls inside the capsules settle most hits, the exact answer the rest. No step
// calls clear what a later one would not. About 0.1 us per middle with 8 obstacles.
#pragma once

#include "models/arm/arm.h"
#include "models/space/world3.h"

namespace sopt {

// The least room that a piece is given, whatever is asked for: so much more than rule.floor_m is
// kept at the middles, so that motions to or from what keeps less are blocked as a rule.
inline constexpr double kMotionRoom_m = 2e-5;

// Straight from a, continuous joints the short way. When `rule` asks for no more than its floor, or
// self_clearance_m is less than kSelfClearance_m, that much more than the floor, or that, is kept
// at the middles: without it nothing could be proven of what lies between. Also false when the
// bounded number of turns does not suffice, and for configurations that are not finite.
template <int N>
[[nodiscard]] bool motion_is_clear(const Arm<N>& arm, const World3& world,
                                   const ClearanceRule& rule, double self_clearance_m,
                                   const typename Arm<N>::Config& a,
                                   const typename Arm<N>::Config& b) SOPT_RT;

}  // namespace sopt
