// Clearance of random pairs of solids, half of them grid-aligned (exact touching, parallel faces
// and edges are common): proven by closest points and separating direction, depth against the
// oracle's enumeration, symmetry, invariance under motion, gradient, limits, libccd, and the
// strictness of the float lanes.
#include <algorithm>
#include <cmath>

#include "models/space/ccd_check.h"
#include "models/space/clearance3.h"
#include "models/space/gjk3.h"
#include "models/space/sphere_lanes3.h"
#include "tests/support/oracle3.h"
#include "tests/support/property.h"
#include "tests/support/test_arm.h"

namespace {

using namespace sopt;
using namespace sopt::oracle;

constexpr double kTol_m = 1e-9;

struct Case {
  Solid a, b;
  HullData hull_a, hull_b;
  Convex3 shape_a, shape_b;

  [[nodiscard]] bool has_cylinder() const {
    return a.kind == SolidKind::kCylinder || b.kind == SolidKind::kCylinder;
  }
  // The library promises a lower bound only.
  [[nodiscard]] bool is_bound() const { return has_cylinder() && !a.is_round() && !b.is_round(); }
};

// False for hulls without a volume, which a grid gives now and then.
bool try_make(Case& c) {
  return try_make(c.a, c.hull_a, c.shape_a) && try_make(c.b, c.hull_b, c.shape_b);
}

void draw(Random& random, Case& c) {
  const bool on_grid = random.chance(0.5);
  const auto kind = [&] { return static_cast<SolidKind>(random.index(kNumSolidKinds)); };
  do {
    c.a = random_solid(random, kind(), 1.0, on_grid);
    c.b = random_solid(random, kind(), random.chance(0.3) ? 1.0 : 3.0, on_grid);
  } while (!try_make(c));
}

void check_proof(const Case& c, const Clearance3& found, CaseReport& report) {
  report.expect_within("normal has length one", std::abs(found.normal.norm() - 1.0), 1e-12);
  const Vec3 gap = found.on_body - found.on_obstacle;
  report.expect_within("points span the distance", (gap - found.distance_m * found.normal).norm(),
                       4e-9);
  report.expect_within("the gap along the normal is the distance",
                       std::abs(gap_along(c.a, c.b, found.normal) - found.distance_m), kTol_m);
  if (found.distance_m < 0.0 && c.is_bound()) return;
  const double outside_m = c.is_bound() ? 1e-7 : 1e-8;
  report.expect_within("on_obstacle lies in the obstacle", excess(c.a, found.on_obstacle),
                       outside_m);
  report.expect_within("on_body lies in the body", excess(c.b, found.on_body), outside_m);
}

void check_depth(const Case& c, double core_m, double distance_m, CaseReport& report) {
  if (core_m > 0.0 || c.is_bound()) return;
  report.expect_within("depth", std::abs(widest_gap(c.a, c.b) - distance_m), kTol_m);
}

void check_symmetry(Random& random, const Case& c, double distance_m, CaseReport& report) {
  if (c.is_bound() && distance_m < kTol_m) return;
  report.expect_within("the other way round",
                       std::abs(compute_clearance(c.shape_b, c.shape_a).distance_m - distance_m),
                       kTol_m);
  Case turned;
  const Pose3 motion{random_rotation(random), random_vector(random, 5.0)};
  turned.a = moved(c.a, motion);
  turned.b = moved(c.b, motion);
  if (!try_make(turned)) return report.fail("the moved solids are refused");
  report.expect_within(
      "moved together",
      std::abs(compute_clearance(turned.shape_a, turned.shape_b).distance_m - distance_m), kTol_m);
}

double distance_at(const Case& c, const Vec3& step) {
  Convex3 b = c.shape_b;
  b.center += step;
  return compute_clearance(c.shape_a, b).distance_m;
}

// One-sided differences; only where they agree is the distance smooth.
void check_gradient(const Case& c, const Clearance3& found, CaseReport& report) {
  constexpr double kStep_m = 1e-6;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 step = kStep_m * Vec3::Unit(axis);
    const double ahead = distance_at(c, step) - found.distance_m;
    const double behind = found.distance_m - distance_at(c, -step);
    if (std::abs(ahead - behind) > 1e-3 * kStep_m) return;
    report.expect_within("normal is the gradient",
                         std::abs(0.5 * (ahead + behind) / kStep_m - found.normal[axis]), 2e-3);
  }
}

void check_limits(Random& random, const Case& c, const Clearance3& found, CaseReport& report) {
  if (c.is_bound() && found.distance_m < kTol_m) return;  // how tight the bound is, is not promised
  const double spread = std::pow(10.0, random.uniform(-8.5, 0.5));
  const double limit_m = found.distance_m + (random.chance(0.5) ? spread : -spread);
  Clearance3 within;
  within.distance_m = 12345.0;
  const bool is_found = compute_clearance_within(c.shape_a, c.shape_b, limit_m, within);
  report.expect("within a limit exactly when the distance is",
                is_found == (found.distance_m < limit_m));
  report.expect_within("distance within a limit",
                       std::abs(within.distance_m - (is_found ? found.distance_m : 12345.0)),
                       1e-12);
  if (limit_m >= 0.0) {
    report.expect("is_within agrees with the distance",
                  is_within(c.shape_a, c.shape_b, limit_m) == (found.distance_m < limit_m));
  }
  if (!c.b.is_round()) return;
  const Clearance3 of_capsule = compute_clearance(c.shape_a, to_capsule(c.shape_b));
  report.expect_within("as a capsule", std::abs(of_capsule.distance_m - found.distance_m), 1e-12);
}

void check_ccd(Random& random, const Case& c, double distance_m, CaseReport& report) {
  const double inflate_m = random.chance(0.5) ? 0.0 : random.uniform(0.0, 1.0);
  const double gap_m = distance_m - inflate_m;
  const bool overlap = may_overlap(c.shape_a, c.shape_b, inflate_m);
  if (gap_m <= 0.0 && !(c.is_bound() && distance_m < 0.0)) {
    report.expect("libccd sees the overlap", overlap);
  }
  if (gap_m > 1e-3) report.expect("libccd sees the gap", !overlap);
}

// Spheres about where the obstacle's required clearance begins, against the exact answer.
void check_lanes(Random& random, const Case& c, CaseReport& report) {
  TestWorld3 test({1, 1});
  World3& world = test.world;
  if (add_to(world, c.a) != WorldStatus::kOk) return report.fail("the world refuses a solid");
  world.build();
  const ClearanceRule rule{random.uniform(0.0, 0.1)};
  SphereLanes spheres;
  double slack_m[kLanesFloat];
  for (int i = 0; i < kLanesFloat; ++i) {
    Vec3 z = c.shape_a.center + random_vector(random, 2.0);
    const auto radius_m = static_cast<float>(random.uniform(0.0, 0.3));
    for (const double push : {1.0, 0.0}) {
      const Capsule3 ball{z, z, static_cast<double>(radius_m)};
      const Clearance3 at = compute_clearance(c.shape_a, ball);
      slack_m[i] = at.distance_m - world.required_m(0, rule);
      z += push * (random.uniform(-1e-6, 1e-6) - slack_m[i]) * at.normal;
    }
    spheres.x[i] = static_cast<float>(z.x());
    spheres.y[i] = static_cast<float>(z.y());
    spheres.z[i] = static_cast<float>(z.z());
    spheres.radius_m[i] = radius_m;
  }
  const unsigned near = world.lanes_near(spheres, rule);
  for (int i = 0; i < kLanesFloat; ++i) {
    report.expect("no sphere that is near is called clear",
                  slack_m[i] >= 0.0 || ((near >> i) & 1U) != 0);
  }
}

std::string check_case(Random& random, CaseReport& report) {
  Case c;
  draw(random, c);
  const Clearance3 found = compute_clearance(c.shape_a, c.shape_b);
  const double core_m = found.distance_m + c.shape_a.radius_m + c.shape_b.radius_m;
  check_proof(c, found, report);
  check_depth(c, core_m, found.distance_m, report);
  check_symmetry(random, c, found.distance_m, report);
  if (std::abs(core_m) > 1e-3 && !(c.is_bound() && core_m < 0.0)) check_gradient(c, found, report);
  check_limits(random, c, found, report);
  check_ccd(random, c, found.distance_m, report);
  check_lanes(random, c, report);
  return to_text(c.a) + "\n  and " + to_text(c.b);
}

}  // namespace

int main(int argc, char** argv) { return run_property("clearance3", argc, argv, check_case); }
