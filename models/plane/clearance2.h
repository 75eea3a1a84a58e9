// Signed distance between a segment (or a point: both ends equal) and a rounded convex polygon, in
// closed form. Apart: the smallest of vertex-to-segment and end-to-edge distances. Overlapping: the
// least separation over the axes of the Minkowski difference, that is all face normals and the
// segment's normal (SAT), which is minus the exact penetration depth. Source: Ericson, Real-Time
// Collision Detection, 5.1 and 5.2. Cost: 3 projections per vertex, 4 vertices at a time; no heap.
// Conventions: the normal points from the obstacle to the segment and is the gradient of the
// distance; next to a corner it is the corner-to-point direction, inside it is the shallowest
// axis, and where the cores touch (|d| < 1e-9) it is the separating axis, never an amplified
// rounding error. The obstacle lies in normal . z <= normal . on_obstacle whenever cores are apart.
#pragma once

#include "models/plane/convex2.h"
#include "rt/annotations.h"

namespace sopt {

struct Clearance2 {
  double distance_m = 0.0;          // < 0: penetration depth
  Vec2 normal = Vec2::UnitX();      // unit, out of the obstacle
  Vec2 on_obstacle = Vec2::Zero();  // closest (or deepest) point of the obstacle's surface
  Vec2 on_segment = Vec2::Zero();   // closest (or deepest) point of the segment
};

// Of segment [p, q].
[[nodiscard]] Clearance2 compute_clearance(const ConvexView& obstacle, const Vec2& p,
                                           const Vec2& q) SOPT_RT;

// As above when the distance is at most `limit_m`; otherwise false, usually after one pass over the
// faces, and `out` is not written.
[[nodiscard]] bool compute_clearance_within(const ConvexView& obstacle, const Vec2& p,
                                            const Vec2& q, double limit_m, Clearance2& out) SOPT_RT;

// True when the distance of segment [p, q] is less than `radius_m` >= 0.
[[nodiscard]] bool is_within(const ConvexView& obstacle, const Vec2& p, const Vec2& q,
                             double radius_m) SOPT_RT;

}  // namespace sopt
