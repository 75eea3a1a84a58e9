// Brute-force answers about the plane, computed from the raw shape definitions and sharing no code
// with the library's geometry: signed distance of a point by crossing-number point-in-polygon and
// per-edge point distances; of a segment by sampling, refined by golden section between samples
// (the distance to a convex set is convex along a line); depth of overlap by trying every direction
// of a fine fan and of all vertex pairs. Slow, simple, for tests only. Units m, world frame.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <variant>
#include <vector>

#include "models/plane/convex2.h"
#include "models/plane/world2.h"

namespace sopt::oracle {

using Shape = std::variant<Disc, Box2, Polygon2>;

struct Obstacle {
  Shape shape;
  double margin_m = kDefaultMargin;
};

struct Scene {
  Aabb2 bounds;
  std::vector<Obstacle> obstacles;
};

// A shape as the hull of vertices (1, or >= 3 counter-clockwise) plus a disc.
struct Outline {
  std::vector<Vec2> vertices;
  double radius_m = 0.0;
};
[[nodiscard]] Outline outline_of(const Shape& shape);

// Negative inside.
[[nodiscard]] double point_distance(const Outline& outline, const Vec2& z);
// Smallest point distance of segment [p, q]; `s_at` receives its place, in [0, 1]. Where the
// segment enters the outline this is the deepest point's depth, not the depth of the overlap.
[[nodiscard]] double min_point_distance(const Outline& outline, const Vec2& p, const Vec2& q,
                                        double* s_at = nullptr);
// Length of the shortest translation that takes overlapping shapes apart; when they are apart,
// minus their distance rounded up to the fan's directions.
[[nodiscard]] double overlap_depth(const Outline& outline, const Vec2& p, const Vec2& q);
// Distance when apart, minus the depth of overlap otherwise.
[[nodiscard]] double segment_distance(const Outline& outline, const Vec2& p, const Vec2& q);

// Distance of a point to the nearest wall, positive inside.
[[nodiscard]] double wall_distance(const Aabb2& bounds, const Vec2& z);
// Smallest point distance of [p, q] over all obstacles and walls; `i_nearest` receives the index.
[[nodiscard]] double scene_distance(const Scene& scene, const Vec2& p, const Vec2& q,
                                    int* i_nearest = nullptr);

// --- random scenes

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  [[nodiscard]] double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  [[nodiscard]] int index(int count) {  // in [0, count)
    return static_cast<int>(engine_() % static_cast<std::uint64_t>(count));
  }
  [[nodiscard]] bool chance(double probability) { return uniform(0.0, 1.0) < probability; }
  [[nodiscard]] Vec2 point(const Aabb2& box) {
    const double x = uniform(box.lower.x(), box.upper.x());
    return {x, uniform(box.lower.y(), box.upper.y())};
  }

 private:
  std::mt19937_64 engine_;
};

// Strictly convex, counter-clockwise, 3..16 vertices on a turned ellipse with half axes up to
// size_m; the short one may be down to `thinness` of it.
[[nodiscard]] Polygon2 random_polygon(Random& random, const Vec2& center, double size_m,
                                      double thinness);
// Convex hull of random points with integer coordinates in [-reach, reach].
[[nodiscard]] Polygon2 random_grid_polygon(Random& random, int reach);
[[nodiscard]] Shape random_shape(Random& random, const Vec2& center, double size_m);
[[nodiscard]] Scene random_scene(Random& random, const Aabb2& bounds, int num_obstacles,
                                 double size_m);

// Fills and builds `world`; the first status that is not kOk, else kOk.
[[nodiscard]] WorldStatus fill(const Scene& scene, World2& world);

// --- text with 17 digits: what is printed can be read back exactly
[[nodiscard]] std::string to_text(const Vec2& z);
[[nodiscard]] std::string to_text(const Shape& shape);
[[nodiscard]] std::string to_text(const Scene& scene);

}  // namespace sopt::oracle
