// The smallest capsule we find around a set of points. For an axis direction: the circle around the
// points' projections (centre moved towards the farthest point, Badoiu and Clarkson, 2003) gives
// line and radius, then the segment ends follow in closed form; larger radii are tried too, since
// they shorten the segment. Directions: principal axes, coordinate axes, then a pattern search
// around the best. Every point lies inside, rounding included; smallest is not promised.
#pragma once

#include <span>

#include "models/space/shape3.h"

namespace sopt {

// `points` is not empty.
[[nodiscard]] Capsule3 fit_capsule(std::span<const Vec3> points);

[[nodiscard]] double capsule_volume_m3(const Capsule3& capsule);

}  // namespace sopt
