// Answers about convex solids of space that share no code with the library's geometry. A solid is a
// list of points, or a cylinder, plus a radius. A distance is proven, not recomputed: two points,
// one in each solid, bound it from above, and the gap between the solids along a direction, found
// by looking at every point, bounds it from below. The depth of an overlap of polytopes is the
// least over all directions that can be a facet of their difference: across every three points of
// one and across every two and two of both, whether they are edges or not. With a cylinder also the
// best direction across its axis and across every two points, searched on a circle. Slow, for tests
// only. Units m, world frame.
#pragma once

#include <string>
#include <vector>

#include "models/space/shape3.h"
#include "models/space/world3.h"
#include "tests/support/oracle2.h"

namespace sopt::oracle {

enum class SolidKind { kSphere, kCapsule, kBox, kCylinder, kHull };
inline constexpr int kNumSolidKinds = 5;

struct Solid {
  SolidKind kind = SolidKind::kSphere;
  Sphere3 sphere;
  Capsule3 capsule;
  Box3 box;
  Cylinder3 cylinder;
  std::vector<Vec3> hull;

  [[nodiscard]] std::vector<Vec3> points() const;  // none of a cylinder
  [[nodiscard]] double radius_m() const;
  [[nodiscard]] bool is_round() const {
    return kind == SolidKind::kSphere || kind == SolidKind::kCapsule;
  }
};

// The solid as the library stores it; false when it refuses.
[[nodiscard]] bool try_make(const Solid& solid, HullData& storage, Convex3& out);

[[nodiscard]] WorldStatus add_to(World3& world, const Solid& solid,
                                 double margin_m = kDefaultMargin);

// How far z is outside of the solid, 0 inside; of a hull at least that far.
[[nodiscard]] double excess(const Solid& solid, const Vec3& z);

// Gap between the solids along unit direction n, from a to b; negative when they overlap in it.
[[nodiscard]] double gap_along(const Solid& a, const Solid& b, const Vec3& n);

// Widest gap of solids that overlap: minus the depth. Of two polytopes, or of a cylinder and a
// sphere or capsule; of others a lower bound.
[[nodiscard]] double widest_gap(const Solid& a, const Solid& b);

[[nodiscard]] Solid moved(const Solid& solid, const Pose3& motion);
[[nodiscard]] Mat3 random_rotation(Random& random);
[[nodiscard]] Vec3 random_vector(Random& random, double reach);
// Somewhere within `reach_m` of the origin, 0.05 to 2 m large; on the grid: integers, axis-aligned.
[[nodiscard]] Solid random_solid(Random& random, SolidKind kind, double reach_m, bool on_grid);
[[nodiscard]] std::string to_text(const Solid& solid);

}  // namespace sopt::oracle
