#include "tools/bench/world_build.h"

#include <array>
#include <cstdint>
#include <variant>
#include <vector>

#include "alloc/arena.h"
#include "alloc/memory_block.h"
#include "models/config.h"
#include "tools/io/input_error.h"

namespace sopt {
namespace {

// Obstacles as a program holds them before they are a world.
template <class World>
struct Shapes;

template <>
struct Shapes<World2> {
  using Capacity = WorldCapacity;
  Aabb2 bounds;
  std::vector<std::variant<Disc, Polygon2>> shapes;  // a box is a polygon here

  explicit Shapes(const World2& world) : bounds(world.bounds()) {
    for (int i = 0; i < world.num_obstacles(); ++i) add(world.obstacle(i));
  }

  [[nodiscard]] bool empty(World2& world) const { return world.reset(bounds) == WorldStatus::kOk; }

 private:
  void add(const ConvexView& view) {
    if (view.num_vertices == 1) {
      shapes.emplace_back(Disc{{view.x[0], view.y[0]}, view.radius_m});
      return;
    }
    Polygon2 polygon;
    polygon.num_vertices = view.num_vertices;
    for (int k = 0; k < view.num_vertices; ++k) {
      polygon.vertices[static_cast<std::size_t>(k)] = {view.x[k], view.y[k]};
    }
    shapes.emplace_back(polygon);
  }
};

template <>
struct Shapes<World3> {
  using Capacity = World3Capacity;
  std::vector<std::vector<Vec3>> vertices;  // of hulls
  std::vector<std::variant<Sphere3, Capsule3, Box3, Cylinder3, Hull3>> shapes;

  explicit Shapes(const World3& world) {
    for (int i = 0; i < world.num_obstacles(); ++i) add(world.obstacle(i));
  }

  [[nodiscard]] bool empty(World3& world) const {
    world.reset();
    return true;
  }

 private:
  void add(const Convex3& shape) {
    const Pose3 pose{shape.axes, shape.center};
    switch (shape.kind) {
      case CoreKind::kPoint:
        shapes.emplace_back(Sphere3{shape.center, shape.radius_m});
        return;
      case CoreKind::kSegment:
        shapes.emplace_back(to_capsule(shape));
        return;
      case CoreKind::kBox:
        shapes.emplace_back(Box3{pose, 2.0 * shape.half_m});
        return;
      case CoreKind::kCylinder:
        shapes.emplace_back(Cylinder3{pose, shape.half_m.x(), 2.0 * shape.half_m.z()});
        return;
      case CoreKind::kHull:
        add_hull(shape.center, *shape.hull);
        return;
    }
  }
  void add_hull(const Vec3& center, const HullData& hull) {
    std::vector<Vec3>& points = vertices.emplace_back();
    for (int k = 0; k < hull.num_vertices; ++k) {
      points.push_back(center + Vec3(hull.x[k], hull.y[k], hull.z[k]));
    }
    shapes.emplace_back(Hull3{points});
  }
};

template <class World>
bool fill(World& world, const Shapes<World>& shapes) {
  bool ok = shapes.empty(world);
  for (const auto& any : shapes.shapes) {
    ok = std::visit([&](const auto& shape) { return world.try_add(shape); }, any) ==
             WorldStatus::kOk &&
         ok;
  }
  world.build();
  return ok;
}

template <class World>
double measure_build_us(const World& like, const Clock& clock) {
  const typename Shapes<World>::Capacity capacity;
  const MemoryBlock memory(World::required_bytes(capacity));
  Arena arena(memory);
  World world(arena, capacity);
  const Shapes<World> shapes(like);
  if (!fill(world, shapes)) throw HostError("a copy of the world was refused");
  const std::int64_t begin_ns = clock.now_ns();
  (void)fill(world, shapes);
  return 1e-3 * static_cast<double>(clock.now_ns() - begin_ns);
}

}  // namespace

double measure_world_build_us(const World2& like, const Clock& clock) {
  return measure_build_us(like, clock);
}
double measure_world_build_us(const World3& like, const Clock& clock) {
  return measure_build_us(like, clock);
}

}  // namespace sopt
