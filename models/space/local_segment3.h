// What the closed forms of segment_core3.h share: the segment in the obstacle's own frame and the
// way from a closest pair or, when the cores overlap, the widest axis to a clearance in the world.
#pragma once

#include <cmath>

#include "models/space/gjk3.h"
#include "models/space/segment_core3.h"
#include "models/space/separating_axis3.h"

namespace sopt {

// A segment in the frame of a box or cylinder.
struct LocalSegment {
  Vec3 p, along;

  LocalSegment(const Convex3& o, const Capsule3& body) noexcept
      : p(o.axes.transpose() * (body.p0 - o.center)),
        along(o.axes.transpose() * (body.p1 - body.p0)) {}
  [[nodiscard]] Vec3 at(double t) const noexcept { return p + t * along; }
  [[nodiscard]] Vec3 middle() const noexcept { return at(0.5); }
};

struct CorePair {
  Vec3 on_core, on_segment;
};

inline CoreClearance3 core_to_world(const Convex3& o, double separation_m, const Vec3& normal,
                                    const CorePair& pair) noexcept {
  return {separation_m, o.axes * normal, o.center + o.axes * pair.on_core,
          o.center + o.axes * pair.on_segment};
}

// ClosestPair(segment) and WidestAxis(segment) of one kind of obstacle -> the clearance.
template <class ClosestPair, class WidestAxis>
CoreClearance3 clearance_by(const Convex3& o, const LocalSegment& s, const ClosestPair& closest,
                            const WidestAxis& widest) noexcept {
  const CorePair pair = closest(s);
  const Vec3 gap = pair.on_segment - pair.on_core;
  const double distance2 = gap.squaredNorm();
  if (distance2 > kTouching_m * kTouching_m) {
    const double distance_m = std::sqrt(distance2);
    return core_to_world(o, distance_m, gap / distance_m, pair);
  }
  const SeparatingAxis3 axis = widest(s);
  // Pushed out along the axis, the closest points are those that touch last.
  LocalSegment pushed = s;
  pushed.p += (kPush_m - axis.separation_m) * axis.normal;
  CorePair touching = closest(pushed);
  touching.on_segment = touching.on_core + axis.separation_m * axis.normal;
  return core_to_world(o, axis.separation_m, axis.normal, touching);
}

}  // namespace sopt
