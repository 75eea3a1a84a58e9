// Convex shapes of the plane. Every obstacle is a rounded convex polygon: the convex hull of its
// vertices (1: a point, 2: a segment, >= 3: a counter-clockwise polygon) plus a disc of `radius_m`.
// A disc is one vertex with a radius, a box four vertices without. Vertices lie in structure-of-
// arrays storage padded to whole SIMD lanes by repeating the last one, which changes no distance.
#pragma once

#include <Eigen/Core>
#include <array>

#include "models/capacity.h"

namespace sopt {

using Vec2 = Eigen::Vector2d;  // m, world frame

struct Disc {
  Vec2 center = Vec2::Zero();
  double radius_m = 0.0;  // > 0
};

struct Box2 {
  Vec2 center = Vec2::Zero();
  Vec2 size_m = Vec2::Zero();  // full extents, > 0
  double angle_rad = 0.0;      // of the box's x axis against the world's, counter-clockwise
};

struct Polygon2 {
  std::array<Vec2, kMaxPolygonVertices> vertices{};  // counter-clockwise, convex
  int num_vertices = 0;                              // 3..kMaxPolygonVertices
};

struct Aabb2 {
  Vec2 lower = Vec2::Zero();
  Vec2 upper = Vec2::Zero();
};

// Read-only view of one obstacle's padded arrays; i in [0, num_padded).
struct ConvexView {
  const double* x = nullptr;  // vertex i
  const double* y = nullptr;
  const double* edge_x = nullptr;  // vertex i+1 - vertex i
  const double* edge_y = nullptr;
  const double* inv_edge2 = nullptr;  // 1 / |edge i|^2
  const double* normal_x = nullptr;   // outward unit normal of edge i
  const double* normal_y = nullptr;
  const double* offset = nullptr;  // the polygon lies in normal_i . z <= offset_i
  int num_vertices = 0;
  int num_padded = 0;  // multiple of kLanesDouble
  double radius_m = 0.0;
};

}  // namespace sopt
