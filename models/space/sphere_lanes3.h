// Eight spheres at once, in float, against the obstacles of a world: which of them may come closer
// than the obstacle asks for. Strict: a lane is never called clear when the exact distance in
// double says otherwise. Points against point, segment, box and cylinder cores in closed form; of a
// hull the largest plane distance, a lower bound of the distance. 5 to 7 ns per obstacle. World3
// owns the obstacles' side and says which of them to test.
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
#include "models/space/shape3.h"
#include "rt/annotations.h"

namespace sopt {

// Sphere i has its middle at (x[i], y[i], z[i]), rounded from double, and a radius that was not
// rounded down.
struct SphereLanes {
  V8f x, y, z;
  V8f radius_m;
};

inline constexpr unsigned kAllLanes = 0xFF;

// Spheres with their share of the pad.
struct PaddedLanes {
  SphereLanes spheres;
  V8f padded_radius_m;

  explicit PaddedLanes(const SphereLanes& s) noexcept
      : spheres(s), padded_radius_m(s.radius_m + kPad * (abs8(s.x) + abs8(s.y) + abs8(s.z))) {}

  static constexpr float kPad = 0x1p-18F;
};

// No more than the distances between the spheres and sphere `lane` of `others`.
[[gnu::always_inline]] inline V8f distance_bounds(const PaddedLanes& spheres,
                                                  const PaddedLanes& others, int lane) noexcept {
  const V8f x = spheres.spheres.x - others.spheres.x[lane];
  const V8f y = spheres.spheres.y - others.spheres.y[lane];
  const V8f z = spheres.spheres.z - others.spheres.z[lane];
  return sqrt8(x * x + y * y + z * z) - (spheres.padded_radius_m + others.padded_radius_m[lane]);
}

// Spheres around the same middles, told apart in one test, with their shares of the pad.
struct NestedLanes {
  V8f x, y, z;   // rounded from double
  V8f wide_m;    // radius, not rounded down
  V8f radius_m;  // likewise, at most wide_m
  V8f inner_m;   // radius, not rounded up; may be negative

  NestedLanes(const V8f& at_x, const V8f& at_y, const V8f& at_z, float radius, const V8f& wider_by,
              float inner) noexcept
      : x(at_x), y(at_y), z(at_z) {
    const V8f pad_m = PaddedLanes::kPad * (abs8(x) + abs8(y) + abs8(z));
    radius_m = radius + pad_m;
    wide_m = radius_m + wider_by;
    inner_m = inner - 2.0F * pad_m;
  }
};
// Lanes where the wide sphere and the sphere may be closer to an obstacle than `rule` asks for, and
// lanes where the inner one is, for sure.
struct NestedNear {
  unsigned wide, sphere, inner;
};

// Obstacles as floats.
class ObstacleLanes3 {
 public:
  ObstacleLanes3(Arena& arena, int max_obstacles, int max_hulls) noexcept;

  void clear() noexcept;
  // `margin_m` as World3::try_add takes it, `box` around the shape. Beyond the capacity: ignored.
  void add(const Convex3& shape, const Aabb3& box, double margin_m) noexcept;
  [[nodiscard]] int size() const SOPT_RT { return obstacles_.size(); }

  // Bit i is set when sphere i may be closer to the obstacle than `rule` asks for; where squares
  // overflow or are undefined, too.
  [[nodiscard]] unsigned lanes_near(int i_obstacle, const PaddedLanes& lanes,
                                    const ClearanceRule& rule) const SOPT_RT;
  [[nodiscard]] NestedNear lanes_near(int i_obstacle, const NestedLanes& lanes,
                                      const ClearanceRule& rule) const SOPT_RT;
  // Of any obstacle.
  [[nodiscard]] unsigned lanes_near(const PaddedLanes& lanes,
                                    const ClearanceRule& rule) const SOPT_RT;
  // No more than the distance of sphere i from the obstacle, negative when they may touch.
  [[nodiscard]] V8f distance_bounds(int i_obstacle, const PaddedLanes& lanes) const SOPT_RT;

 private:
  struct Obstacle {
    CoreKind kind = CoreKind::kPoint;
    float center[3] = {};
    float axis[3][3] = {};  // axis[i]: direction i of box and cylinder; 2: of a segment
    float half[3] = {};
    float radius_m = 0.0F;      // rounded up, own pad added
    float pad_m = 0.0F;         // of that
    float own_margin_m = 0.0F;  // rounded up; < 0: the rule's
    std::int32_t first_plane = 0;
    std::int32_t num_planes = 0;

    // Between core and middle, for a sphere without radius.
    [[nodiscard]] float reach_m(const ClearanceRule& rule) const SOPT_RT {
      return static_cast<float>(rule.required_m(static_cast<double>(own_margin_m))) + radius_m;
    }
  };
  struct Plane {
    float normal[3];
    float offset;  // relative to the hull's center
  };

  // Of points in the world from the core.
  [[nodiscard]] V8f distance2(const Obstacle& obstacle, const V8f& x_W, const V8f& y_W,
                              const V8f& z_W) const SOPT_RT;
  [[nodiscard]] V8f plane_distance(const Obstacle& obstacle, const V8f& x, const V8f& y,
                                   const V8f& z) const SOPT_RT;
  [[nodiscard]] unsigned lanes_near_one(const Obstacle& obstacle, const PaddedLanes& lanes,
                                        const ClearanceRule& rule) const SOPT_RT;

  FixedVector<Obstacle> obstacles_;
  FixedVector<Plane> planes_;
};

}  // namespace sopt
