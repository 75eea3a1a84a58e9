// How far apart a moving body and an obstacle are, both without their radii, for verify alone: no
// code in common with clearance3.h and gjk3.h. The body is the hull of a few points. Every lower
// bound rests on one direction, along which the gap between the two is measured; how the direction
// was found cannot make it wrong. Method: the point x of the difference body - obstacle nearest to
// the origin by Wolfe's corrals [Wolfe 1976, Finding the nearest point in a polytope]; when a
// corral degenerates, one step of Gilbert's from x. No heap, at most kMaxSeparationSteps steps,
// typically 1 to 5; one direction costs about 10 ns, a hull of 32 vertices 40 ns.
#pragma once

#include <span>

#include "models/space/shape3.h"
#include "rt/annotations.h"

namespace sopt {

inline constexpr int kMaxSeparationSteps = 64;
inline constexpr int kMaxSeparationPoints = 8;
// Bounds this close are as good as equal.
inline constexpr double kSeparationTol_m = 1e-7;

struct Separation3 {
  double lower_m = 0.0;            // gap along `direction`; negative where the two overlap in it
  double upper_m = 0.0;            // distance of two points, one of each; 0 when they overlap
  Vec3 direction = Vec3::UnitX();  // unit, from the obstacle to the body
};

// What the bounds are wanted for: to look no further than that.
struct SeparationGoal {
  double enough_m = 0.0;     // a lower bound that needs no improvement
  bool all_or_none = false;  // an upper bound below enough_m needs none either
};

// 1..kMaxSeparationPoints points; `first` is a guess of the direction and may be of any length.
[[nodiscard]] Separation3 separate(const Convex3& obstacle, std::span<const Vec3> points,
                                   const Vec3& first, const SeparationGoal& goal) SOPT_RT;

// Smallest axis-aligned box around an obstacle, radius included.
[[nodiscard]] Aabb3 box_around(const Convex3& obstacle) SOPT_RT;

}  // namespace sopt
