// Every compile-time capacity of the library, in one place. Capacities chosen at setup are members
// of PlannerSettings, WorldCapacity and World3Capacity (models/config.h).
#pragma once

namespace sopt {

inline constexpr int kMaxPolygonVertices = 16;  // vertices of one convex polygon
inline constexpr int kMinHullVertices = 4;      // vertices of one hull
inline constexpr int kMaxHullVertices = 32;
inline constexpr int kMaxHullPlanes = 2 * kMaxHullVertices - 4;
inline constexpr int kMaxHullEdges = 3 * kMaxHullVertices - 6;
inline constexpr int kMinArmJoints = 4;
inline constexpr int kMaxArmJoints = 8;
inline constexpr int kMaxLinkCapsules = 128;  // of all links together, attached ones included
inline constexpr int kMaxCoverSpheres = 512;  // of an arm
inline constexpr int kMaxBodies = 32;         // of all links together
inline constexpr int kMaxBodyPairs = 64;
inline constexpr int kMaxStreams = 16;       // sampler streams
inline constexpr int kMaxIterations = 256;   // sweeps over the windows; the default is 20
inline constexpr int kMaxWindow = 4096;      // steps of one window, whatever the settings say
inline constexpr int kMaxImprovements = 64;  // plans on record that improved on the one before
inline constexpr int kMaxSegments = 256;     // windows of one parity
inline constexpr int kMaxNeighbors = 32;     // rewiring candidates of one new node
inline constexpr int kNumPlanSlots = 3;      // plans that can be held at the same time

}  // namespace sopt
