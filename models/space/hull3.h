// Planes and edges of the convex hull of up to 32 points. Every triple of points whose plane has
// all points on one side is part of a face; points within a tolerance of the plane belong to the
// same face, so coplanar vertices make one plane, taken through the widest of their triples. An
// edge joins two faces that share two points. Points inside the hull do no harm. Slivers thinner
// than the tolerance give no plane of their own: the planes then bound a slightly larger body.
#pragma once

#include "models/space/shape3.h"

namespace sopt {

// Fills `out` relative to `center`, the middle of the hull's box; on a status other than kOk both
// hold nothing of use.
[[nodiscard]] WorldStatus build_hull(const Hull3& hull, HullData& out, Vec3& center) noexcept;

}  // namespace sopt
