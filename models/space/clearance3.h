// Signed distance between two convex shapes of space: the distance of their cores minus both radii.
// Point and segment cores (spheres, capsules) against points, segments, boxes and cylinders: closed
// forms (segment_core3.h). Every other pair: GJK while the cores are apart (gjk3.h; two boxes begin
// with their separating axis), the widest axis when they overlap (overlap3.h). No heap, every loop
// bounded. Cost, apart and overlapping: capsule-box 80 and 95 ns, box-box 200 and 140 ns,
// capsule-hull 0.2 and 1.7 us; cylinder against box, hull or cylinder 1.4 us and overlap3.h.
// Conventions: the normal points from the obstacle to the body and is the gradient of the distance;
// next to a corner it is the corner-to-point direction, inside it is the shallowest axis, and where
// the cores touch (|d| < 1e-9) it is the separating axis, never an amplified rounding error. The
// obstacle lies in normal . z <= normal . on_obstacle whenever cores are apart.
// Two answers are lower bounds instead of exact: GJK that did not converge to 1e-10 (its best
// proven bound; cylinders only), and a cylinder that overlaps a box, hull or cylinder (overlap3.h).
#pragma once

#include "models/space/shape3.h"

namespace sopt {

struct Clearance3 {
  double distance_m = 0.0;          // < 0: penetration depth
  Vec3 normal = Vec3::UnitX();      // unit, out of the obstacle
  Vec3 on_obstacle = Vec3::Zero();  // closest (or deepest) point of the obstacle's surface
  Vec3 on_body = Vec3::Zero();      // likewise of the body's; on_obstacle + distance_m * normal
};

[[nodiscard]] Clearance3 compute_clearance(const Convex3& obstacle, const Capsule3& body) SOPT_RT;
[[nodiscard]] Clearance3 compute_clearance(const Convex3& obstacle, const Convex3& body) SOPT_RT;

// As above when the distance is at most `limit_m`; otherwise false, often early, and `out` is not
// written.
[[nodiscard]] bool compute_clearance_within(const Convex3& obstacle, const Capsule3& body,
                                            double limit_m, Clearance3& out) SOPT_RT;
[[nodiscard]] bool compute_clearance_within(const Convex3& obstacle, const Convex3& body,
                                            double limit_m, Clearance3& out) SOPT_RT;

// True when the distance is less than `radius_m` >= 0, or not a number.
[[nodiscard]] bool is_within(const Convex3& obstacle, const Capsule3& body,
                             double radius_m) SOPT_RT;
[[nodiscard]] bool is_within(const Convex3& obstacle, const Convex3& body, double radius_m) SOPT_RT;

}  // namespace sopt
