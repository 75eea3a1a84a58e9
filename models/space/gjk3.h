// Distance between the cores of two convex shapes (radii left out) by the algorithm of Gilbert,
// Johnson and Keerthi: descends to the point v of the Minkowski difference b - a that is nearest to
// the origin. Source: Ericson, Real-Time Collision Detection, 9.5; closest points of simplices by
// Voronoi regions (5.1), each face projected afresh, which keeps sliver simplices of grid-aligned
// shapes exact. Ends on a polytope when no vertex improves, on a curved core at 1e-14 relative. No
// heap; at most kMaxGjkIterations iterations, typically 3 to 6.
#pragma once

#include <cstdint>

#include "models/space/shape3.h"

namespace sopt {

inline constexpr int kMaxGjkIterations = 64;
// Cores this near touch: the direction between them is rounding noise.
inline constexpr double kTouching_m = 1e-9;

enum class GjkStatus : std::int8_t {
  kApart = 0,        // exact
  kBounded = 1,      // not converged: distance_m and normal are the best proven lower bound
  kBeyondLimit = 2,  // proven farther than the limit; only distance_m, a lower bound, is set
  kTouching = -1,    // cores overlap or are within kTouching_m; normal is the widest axis seen
};

struct GjkResult {
  GjkStatus status = GjkStatus::kTouching;
  int num_iterations = 0;
  double distance_m = 0.0;      // of the cores
  Vec3 normal = Vec3::UnitX();  // unit, from a to b
  Vec3 on_a = Vec3::Zero();     // closest points of the cores, world frame
  Vec3 on_b = Vec3::Zero();
};

// `first` is a guess of the normal and may be zero.
[[nodiscard]] GjkResult compute_core_distance(const Convex3& a, const Convex3& b, double limit_m,
                                              const Vec3& first) SOPT_RT;

}  // namespace sopt
