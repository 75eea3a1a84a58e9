// Eight spheres at once, in float, against every obstacle of a world: which of them may come closer
// than the obstacle asks for. Strict: a lane is never called clear when the exact distance in
// double says otherwise. Points against point, segment, box and cylinder cores in closed form; of a
// hull the largest plane distance, a lower bound of the distance. Up to kMaxScan obstacles are all
// tested; more go through the world's broad phase. 5 to 7 ns per obstacle.
//
// The pad. Let u = 2^-24 and m = |x|+|y|+|z| of the sphere plus |center| + sizes of the obstacle
// (1-norms). Against exact arithmetic, each component of a local coordinate is off by at most 2 u m
// (both positions rounded to float), u m (their difference), u m (axes rounded) and 3 u m (a dot
// product); that is 7 u m, or 13 u m for the vector; sizes, clamping and shares along a segment add
// 8 u m, the norm, its square and the squared limit 6 u m. kPad = 2^-18 = 64 u is over twice their
// sum. It is the only thing conservative about a box, segment, cylinder or point: 8 um at m = 2 m.
#pragma once

#include <cstdint>

#include "alloc/fixed_vector.h"
#include "models/margin.h"
#include "models/simd.h"
#include "models/world3.h"
#include "rt/annotations.h"

namespace sopt {

// Sphere i has its middle at (x[i], y[i], z[i]), rounded from double, and a radius that was not
// rounded down.
struct SphereLanes {
  V8f x, y, z;
  V8f radius_m;
};

// What the lanes need of a world, as floats. If a sphere is not finite, all lanes are near.
class LaneWorld3 {
 public:
  LaneWorld3(Arena& arena, const World3Capacity& capacity) noexcept;
  [[nodiscard]] static std::size_t required_bytes(const World3Capacity& capacity) noexcept;

  // Copies the obstacles of a world that is built and outlives this; call after World3::build.
  void build(const World3& world) noexcept;

  // Bit i is set when sphere i may be closer to an obstacle than `rule` asks for.
  [[nodiscard]] unsigned lanes_near(const SphereLanes& spheres,
                                    const ClearanceRule& rule) const SOPT_RT;

 private:
  static constexpr int kMaxScan = 16;
  static constexpr float kPad = 0x1p-18F;

  struct Lanes;  // the spheres and what their pads share

  struct Obstacle {
    CoreKind kind = CoreKind::kPoint;
    float center[3] = {};
    float axis[3][3] = {};  // axis[i]: direction i of box and cylinder; 2: of a segment
    float half[3] = {};
    float radius_m = 0.0F;      // rounded up, own pad added
    float own_margin_m = 0.0F;  // rounded up; < 0: the rule's
    std::int32_t first_plane = 0;
    std::int32_t num_planes = 0;
  };
  struct Plane {
    float normal[3];
    float offset;  // relative to the hull's center
  };

  [[nodiscard]] V8f distance2(const Obstacle& obstacle, const V8f& x, const V8f& y,
                              const V8f& z) const SOPT_RT;
  [[nodiscard]] V8f plane_distance(const Obstacle& obstacle, const V8f& x, const V8f& y,
                                   const V8f& z) const SOPT_RT;
  [[nodiscard]] unsigned lanes_near_one(const Obstacle& obstacle, const Lanes& lanes,
                                        const ClearanceRule& rule) const SOPT_RT;

  FixedVector<Obstacle> obstacles_;
  FixedVector<Plane> planes_;
  const World3* world_ = nullptr;
};

}  // namespace sopt
