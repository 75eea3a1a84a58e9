// An axis between two cores and the tolerances of everything that looks for one.
#pragma once

#include <limits>

#include "models/space/shape3.h"

namespace sopt {

inline constexpr double kParallel2 = 1e-20;  // squared sine below which an edge cross is no axis
inline constexpr double kTie_m = 1e-12;      // what an edge axis must gain over a face
inline constexpr double kPush_m = 0.1;       // gap at which the points of an overlap are read off

// The unit axis from a to b along which two cores are farthest apart. separation_m < 0: minus the
// depth of overlap; > 0: the cores are apart, and at least by that much.
struct SeparatingAxis3 {
  double separation_m = -std::numeric_limits<double>::infinity();
  Vec3 normal = Vec3::UnitX();

  void keep_wider(double candidate_m, const Vec3& unit, double gain_m) SOPT_RT {
    if (candidate_m > separation_m + gain_m) *this = {candidate_m, unit};
  }
};

}  // namespace sopt
