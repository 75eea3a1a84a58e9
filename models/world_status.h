// What worlds of two and three dimensions share: why an obstacle was refused, and how a query names
// what it found.
#pragma once

#include <cstdint>
#include <limits>

namespace sopt {

enum class WorldStatus : std::int8_t {
  kOk = 0,
  kNotReset = -1,          // default: nothing was done
  kNotFinite = -2,         // a coordinate or size is NaN or infinite
  kBadBounds = -3,         // lower >= upper on an axis
  kBadSize = -4,           // radius or extent <= 0, or margin < 0
  kBadVertexCount = -5,    // fewer or more vertices than a polygon or hull may have
  kNotConvex = -6,         // a vertex turns right, or the outline winds more than once
  kClockwise = -7,         // convex, but listed clockwise
  kDegenerate = -8,        // vertices coincide or enclose no area or volume
  kTooManyObstacles = -9,  // the capacity's max_obstacles
  kTooManyVertices = -10,  // the capacity's max_vertices or max_hulls
  kBadRotation = -11,      // not a right-handed orthonormal matrix
};

// Stands for the bounds where an obstacle's index is expected.
inline constexpr int kBoundsObstacle = -1;
// Stands for "no obstacle near".
inline constexpr int kNoObstacle = -2;
// Stands for the robot itself where an obstacle's index is expected.
inline constexpr int kSelfObstacle = -3;

// The nearest thing to a segment or capsule.
struct NearestObstacle {
  double distance_m = std::numeric_limits<double>::infinity();
  int i_obstacle = kNoObstacle;
};

}  // namespace sopt
