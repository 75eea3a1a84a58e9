// Signed distance between the core of an obstacle and a segment (or point) in closed form, radii
// left out. Apart, the squared distance along the segment is convex in the parameter t: against a
// box its derivative is piecewise linear and is solved exactly between two of its eight knots;
// against a cylinder it is solved piece by piece, by safeguarded Newton steps (at most 64, usually
// 4) only where the nearest point is on a rim. Overlapping, the separation is the largest over the
// facets of the Minkowski difference, which is minus the exact depth: faces and edge crosses of a
// box; of a cylinder its caps, its side seen along the axis (a stadium) and its rim seen along the
// segment (an ellipse stretched along its minor axis).
#pragma once

#include "models/space/shape3.h"

namespace sopt {

// Of two cores; the points are their closest, or their deepest ones.
struct CoreClearance3 {
  double separation_m = 0.0;
  Vec3 normal = Vec3::UnitX();  // unit, from the obstacle to the body
  Vec3 on_obstacle = Vec3::Zero();
  Vec3 on_body = Vec3::Zero();
};

// Of the segment p0 p1 of `body`. The obstacle is a point or segment; a box; a cylinder.
[[nodiscard]] CoreClearance3 segment_to_segment(const Convex3& obstacle,
                                                const Capsule3& body) SOPT_RT;
[[nodiscard]] CoreClearance3 segment_to_box(const Convex3& box, const Capsule3& body) SOPT_RT;
[[nodiscard]] CoreClearance3 segment_to_cylinder(const Convex3& cylinder,
                                                 const Capsule3& body) SOPT_RT;

}  // namespace sopt
