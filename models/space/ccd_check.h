// Second opinion on collisions by libccd, the only file that calls it. Only its boolean GJK, which
// uses no heap, is used, with at most kMaxCcdIterations iterations. libccd answers "apart" also
// when shapes touch, when it gives up and when its simplex degenerates (two equal points: seen for
// capsules that overlap by 1e-6 m). So its "apart" counts only with a proof: the support callback
// keeps how far each shape reached in the last direction, and the two must not meet there. Shapes
// are inflated by kCcdPad_m on top of what is asked for, so that touching counts. Errs towards
// collision only. Cost: 0.1 us apart, 0.4 us overlapping.
#pragma once

#include "models/space/shape3.h"

namespace sopt {

inline constexpr int kMaxCcdIterations = 64;
inline constexpr double kCcdPad_m = 1e-6;

// False only when libccd has proven the shapes, one of them grown by inflate_m >= 0, to be apart.
[[nodiscard]] bool may_overlap(const Convex3& a, const Convex3& b, double inflate_m) SOPT_RT;
[[nodiscard]] bool may_overlap(const Convex3& a, const Capsule3& b, double inflate_m) SOPT_RT;

}  // namespace sopt
