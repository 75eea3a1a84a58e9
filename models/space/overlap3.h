// How far two overlapping cores (radii left out) must be moved apart, and along which axis.
// Polytopes, segments and points: the separating axis test over all face normals and edge crosses,
// which are the facet normals of the Minkowski difference, so the depth is exact. With a cylinder
// against a box, hull or cylinder, from the best of the same axes, from the guess and from the line
// of centers, climbs of at most kMaxClimb steps: b is pushed out along the axis at hand, and the
// normal of the distance there is never a worse axis. Every axis bounds the depth from above, so
// the separation is a strict lower bound of the true one. A segment against a cylinder is exact:
// segment_core3.h. Cost: box-box 15 axes, 0.16 us; hull-segment 2 us;
// hull-hull 10 us, with 32 vertices each up to 8200 axes; with a cylinder 40 to 90 us.
#pragma once

#include "models/space/separating_axis3.h"
#include "models/space/shape3.h"

namespace sopt {

inline constexpr int kMaxClimb = 12;

// Minus the exact depth, or a lower bound, as said above.
// `guess` is any direction; it matters for cylinders only.
[[nodiscard]] SeparatingAxis3 widest_axis(const Convex3& a, const Convex3& b,
                                          const Vec3& guess) SOPT_RT;

// As above for two boxes, but ends early with the first axis that is wider than `enough_m`.
[[nodiscard]] SeparatingAxis3 widest_axis_of_boxes(const Convex3& a, const Convex3& b,
                                                   double enough_m) SOPT_RT;

}  // namespace sopt
