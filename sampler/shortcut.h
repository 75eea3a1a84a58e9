// Shortens a path: vertices that can be skipped are dropped, stretches between two random points
// are replaced by a straight motion when that is clear [Geraerts, Overmars 2007], and vertices are
// dropped once more. Makes the optimised result nearly independent of the number of
// segments and halves its iterations (docs/RESULTS.md). Deviation: the paper has no such step.
// Never lengthens a path and keeps both ends exactly. At most SamplerTuning::kShortcutTries + 2
// kMaxSkip n checks for a path of n vertices.
#pragma once

#include "models/arm/arm.h"
#include "models/plane/point2.h"
#include "models/trajectory.h"
#include "rt/deadline.h"
#include "sampler/motion_checker.h"
#include "sampler/rng.h"

namespace sopt {

inline constexpr int kMaxSkip = 16;  // vertices dropped at once

template <class Robot>
void shortcut_path(MotionChecker<Robot>& checker, CounterRng& rng, const Deadline& deadline,
                   Path<Robot>& path) SOPT_RT;

extern template void shortcut_path(MotionChecker<Point2>&, CounterRng&, const Deadline&,
                                   Path<Point2>&) SOPT_RT;
extern template void shortcut_path(MotionChecker<Arm<4>>&, CounterRng&, const Deadline&,
                                   Path<Arm<4>>&) SOPT_RT;
extern template void shortcut_path(MotionChecker<Arm<5>>&, CounterRng&, const Deadline&,
                                   Path<Arm<5>>&) SOPT_RT;
extern template void shortcut_path(MotionChecker<Arm<6>>&, CounterRng&, const Deadline&,
                                   Path<Arm<6>>&) SOPT_RT;
extern template void shortcut_path(MotionChecker<Arm<7>>&, CounterRng&, const Deadline&,
                                   Path<Arm<7>>&) SOPT_RT;
extern template void shortcut_path(MotionChecker<Arm<8>>&, CounterRng&, const Deadline&,
                                   Path<Arm<8>>&) SOPT_RT;

}  // namespace sopt
