// Clearance of random segments from random shapes against the brute-force oracle: generic, thin,
// 16-gon, rounded, integer-grid (exact touching is common) and constructed touching cases.
#include <algorithm>
#include <cmath>

#include "models/plane/clearance2.h"
#include "tests/support/property.h"
#include "tests/support/test_world.h"

namespace {

using namespace sopt;
using namespace sopt::oracle;

constexpr double kTolDistance_m = 1e-9;
constexpr double kTouching_m = 1e-9;

struct Case {
  Shape shape;
  double extra_radius_m = 0.0;  // of a rounded polygon
  Vec2 p = Vec2::Zero();
  Vec2 q = Vec2::Zero();
};

Vec2 grid_point(Random& random, int reach) {
  const int x = random.index(2 * reach + 1) - reach;
  return {static_cast<double>(x), static_cast<double>(random.index(2 * reach + 1) - reach)};
}

Shape grid_shape(Random& random) {
  const int kind = random.index(3);
  if (kind == 0) return Disc{grid_point(random, 3), 1.0 + random.index(3)};
  if (kind == 1) {
    const double width = 1.0 + random.index(4);
    const double height = 1.0 + random.index(4);
    return Box2{grid_point(random, 3), {width, height}, 0.0};
  }
  return random_grid_polygon(random, 4);
}

Vec2 on_outline(Random& random, const Outline& outline) {
  const auto n = static_cast<int>(outline.vertices.size());
  const int i = random.index(n);
  const Vec2 a = outline.vertices[static_cast<std::size_t>(i)];
  const Vec2 b = outline.vertices[static_cast<std::size_t>((i + 1) % n)];
  if (outline.radius_m > 0.0) {
    const double angle = random.uniform(0.0, 6.28);
    return a + outline.radius_m * Vec2(std::cos(angle), std::sin(angle));
  }
  return random.chance(0.5) ? a : Vec2(a + random.uniform(0.0, 1.0) * (b - a));
}

Case draw_generic(Random& random) {
  const Aabb2 area = {{-8.0, -8.0}, {8.0, 8.0}};
  Case c;
  const Vec2 center = random.point({{-3.0, -3.0}, {3.0, 3.0}});
  switch (random.index(4)) {
    case 0:
      c.shape = random_polygon(random, center, 3.0, 1e-3);
      break;
    case 1:
      c.shape = random_polygon(random, center, 3.0, 0.1);
      c.extra_radius_m = random.uniform(0.01, 1.0);
      break;
    default:
      c.shape = random_shape(random, center, 3.0);
  }
  c.p = random.point(area);
  c.q = random.point(area);
  if (random.chance(0.2)) c.q = c.p;
  if (random.chance(0.3)) c.q = c.p + 0.05 * (c.q - c.p);
  return c;
}

Case draw_case(Random& random) {
  const int kind = random.index(10);
  if (kind < 5) return draw_generic(random);
  Case c;
  if (kind < 8) {
    c.shape = grid_shape(random);
    c.p = grid_point(random, 6);
    c.q = random.chance(0.2) ? c.p : grid_point(random, 6);
    return c;
  }
  // Touching or nearly so: a segment through a point of the outline.
  c.shape = random_shape(random, random.point({{-3.0, -3.0}, {3.0, 3.0}}), 2.0);
  const Outline outline = outline_of(c.shape);
  c.p = on_outline(random, outline);
  c.q = random.chance(0.3) ? on_outline(random, outline) : random.point({{-8, -8}, {8, 8}});
  if (random.chance(0.3)) c.p += std::pow(10.0, random.uniform(-13.0, -3.0)) * (c.q - c.p);
  return c;
}

std::string to_text(const Case& c) {
  return sopt::oracle::to_text(c.shape) + " extra radius " + std::to_string(c.extra_radius_m) +
         ", segment " + sopt::oracle::to_text(c.p) + " to " + sopt::oracle::to_text(c.q);
}

double reach_along(const Outline& outline, const Vec2& n) {
  double reach = -1e300;
  for (const Vec2& v : outline.vertices) reach = std::max(reach, n.dot(v));
  return reach + outline.radius_m;
}

double point_to_segment(const Vec2& z, const Vec2& p, const Vec2& q) {
  return min_point_distance({{z}, 0.0}, p, q);
}

void check_closest_points(const Case& c, const Outline& outline, const Clearance2& found,
                          CaseReport& report) {
  const Vec2 gap = found.on_segment - found.on_obstacle;
  report.expect_within("closest points span the distance",
                       (gap - found.distance_m * found.normal).norm(), 4e-9);
  report.expect_within("on_segment lies on the segment",
                       point_to_segment(found.on_segment, c.p, c.q), 1e-8);
  report.expect_within("on_obstacle lies on the surface",
                       std::abs(point_distance(outline, found.on_obstacle)), 4e-9);
}

// Where the cores are apart the plane through on_obstacle separates; its direction is known to
// about the rounding of the coordinates over the gap.
void check_separation(const Case& c, const Outline& outline, double core_distance_m,
                      const Clearance2& found, CaseReport& report) {
  const double tolerance = 1e-9 + 1e-14 / core_distance_m;
  const double offset = found.normal.dot(found.on_obstacle);
  report.expect_within("obstacle beyond the plane", reach_along(outline, found.normal) - offset,
                       tolerance);
  report.expect_within(
      "segment before the plane",
      offset + found.distance_m - std::min(found.normal.dot(c.p), found.normal.dot(c.q)),
      tolerance);
}

// One-sided differences of the oracle's distance; only where they agree is it smooth.
void check_gradient(const Case& c, const Outline& outline, double distance_m,
                    const Clearance2& found, CaseReport& report) {
  constexpr double kStep_m = 1e-6;
  for (int axis = 0; axis < 2; ++axis) {
    Vec2 step = Vec2::Zero();
    step[axis] = kStep_m;
    const double ahead = segment_distance(outline, c.p + step, c.q + step) - distance_m;
    const double behind = distance_m - segment_distance(outline, c.p - step, c.q - step);
    if (std::abs(ahead - behind) > 1e-3 * kStep_m) return;
    report.expect_within("normal is the gradient",
                         std::abs(0.5 * (ahead + behind) / kStep_m - found.normal[axis]), 1e-3);
  }
}

void check_limits(Random& random, const Case& c, const ConvexView& view, double distance_m,
                  const Clearance2& found, CaseReport& report) {
  const double spread = std::pow(10.0, random.uniform(-8.5, 0.5));
  const double limit_m = distance_m + (random.chance(0.5) ? spread : -spread);
  Clearance2 within;
  within.distance_m = 12345.0;
  const bool is_found = compute_clearance_within(view, c.p, c.q, limit_m, within);
  report.expect("within a limit exactly when the distance is", is_found == (distance_m < limit_m));
  report.expect_within("distance within a limit",
                       std::abs(within.distance_m - (is_found ? found.distance_m : 12345.0)),
                       1e-12);
  for (const double radius_m : {limit_m, 0.0}) {
    if (radius_m < 0.0 || std::abs(distance_m - radius_m) < kTouching_m) continue;
    report.expect("is_within agrees with the distance",
                  is_within(view, c.p, c.q, radius_m) == (distance_m < radius_m));
  }
}

std::string check_case(Random& random, CaseReport& report) {
  const Case c = draw_case(random);
  TestWorld test_world({1, 16});
  World2& world = test_world.world;
  if (fill({far_bounds(), {{c.shape, kDefaultMargin}}}, world) != WorldStatus::kOk) {
    report.fail("the world refuses a valid shape");
    return to_text(c);
  }
  ConvexView view = world.obstacle(0);
  view.radius_m += c.extra_radius_m;
  Outline outline = outline_of(c.shape);
  outline.radius_m += c.extra_radius_m;

  const double expected_m = segment_distance(outline, c.p, c.q);
  const double core_m = expected_m + outline.radius_m;
  const Clearance2 found = compute_clearance(view, c.p, c.q);
  report.expect_within("distance", std::abs(found.distance_m - expected_m), kTolDistance_m);
  report.expect_within("normal has length one", std::abs(found.normal.norm() - 1.0), 1e-12);
  report.expect_within("distance of the reversed segment",
                       std::abs(compute_clearance(view, c.q, c.p).distance_m - found.distance_m),
                       1e-12);
  check_closest_points(c, outline, found, report);
  if (core_m > kTouching_m) check_separation(c, outline, core_m, found, report);
  if (std::abs(core_m) > 1e-4) check_gradient(c, outline, expected_m, found, report);
  check_limits(random, c, view, expected_m, found, report);
  if (found.distance_m < 0.0) {
    const Vec2 move = -found.distance_m * found.normal;
    report.expect_within("moved out by its depth it touches",
                         std::abs(segment_distance(outline, c.p + move, c.q + move)), 4e-9);
  }
  return to_text(c);
}

}  // namespace

int main(int argc, char** argv) { return run_property("clearance", argc, argv, check_case); }
