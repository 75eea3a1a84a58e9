// Every compile-time capacity of the library, in one place. Capacities chosen at setup are members
// of PlannerSettings and WorldCapacity (models/config.h).
#pragma once

namespace sopt {

inline constexpr int kMaxPolygonVertices = 16;  // vertices of one convex polygon
inline constexpr int kMaxStreams = 16;          // sampler streams
inline constexpr int kMaxIterations = 256;      // sweeps over the windows; the default is 20
inline constexpr int kMaxWindow = 4096;         // steps of one window, whatever the settings say
inline constexpr int kMaxImprovements = 64;     // plans on record that improved on the one before
inline constexpr int kMaxSegments = 256;        // windows of one parity
inline constexpr int kMaxNeighbors = 32;        // rewiring candidates of one new node
inline constexpr int kNumPlanSlots = 3;         // plans that can be held at the same time

}  // namespace sopt
