// A World2 with its own memory, for tests.
#pragma once

#include "alloc/arena.h"
#include "alloc/memory_block.h"
#include "models/plane/world2.h"
#include "tests/support/oracle2.h"

namespace sopt::oracle {

struct TestWorld {
  explicit TestWorld(const WorldCapacity& capacity = {64, 1024})
      : block(World2::required_bytes(capacity)), arena(block), world(arena, capacity) {}

  MemoryBlock block;
  Arena arena;
  World2 world;
};

inline constexpr double kFar_m = 1e6;

// Bounds that nothing comes near.
[[nodiscard]] inline Aabb2 far_bounds() {
  return {Vec2::Constant(-kFar_m), Vec2::Constant(kFar_m)};
}

// Axis-aligned box from corner to corner.
[[nodiscard]] inline Box2 box_between(const Vec2& lower, const Vec2& upper) {
  return {0.5 * (lower + upper), upper - lower, 0.0};
}

[[nodiscard]] inline Polygon2 polygon_of(const std::vector<Vec2>& vertices) {
  Polygon2 polygon;
  polygon.num_vertices = static_cast<int>(vertices.size());
  for (std::size_t i = 0; i < vertices.size() && i < polygon.vertices.size(); ++i) {
    polygon.vertices[i] = vertices[i];
  }
  return polygon;
}

}  // namespace sopt::oracle
