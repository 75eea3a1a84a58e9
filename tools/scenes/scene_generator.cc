#include "tools/scenes/scene_generator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>

namespace sopt {
namespace {

using Point = std::array<double, 2>;

constexpr int kNumPlaneScenes = 25;
constexpr int kMinObstacles = 5;
constexpr int kMaxObstacles = 20;
constexpr std::uint64_t kFirstSeed = 20220;  // plane_NN has seed kFirstSeed + NN
constexpr std::uint64_t kLongSeed = 20300;
constexpr double kEndClearance_m = 0.3;  // of the robot's hull at start and goal

// splitmix64 (Steele, Lea, Flood 2014); value i depends on seed and i alone.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  double uniform(double lower, double upper) {
    return lower + (upper - lower) * static_cast<double>(next() >> 11U) * 0x1.0p-53;
  }
  int uniform_int(int lower, int upper) {
    return lower + static_cast<int>(next() % static_cast<std::uint64_t>(upper - lower + 1));
  }

 private:
  std::uint64_t next() {
    state_ += 0x9E3779B97F4A7C15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31U);
  }

  std::uint64_t state_;
};

double rounded(double value) { return std::round(value * 1e4) / 1e4; }
Point rounded(double x, double y) { return {rounded(x), rounded(y)}; }

Point rotated(double x, double y, double angle_rad) {
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  return {c * x - s * y, s * x + c * y};
}

GeneratedObstacle make_disc(Point center, double radius_m) {
  GeneratedObstacle disc;
  disc.kind = GeneratedObstacle::Kind::kDisc;
  disc.center_m = rounded(center[0], center[1]);
  disc.radius_m = rounded(radius_m);
  return disc;
}

GeneratedObstacle make_box(Point center, Point size, double angle_rad) {
  GeneratedObstacle box;
  box.kind = GeneratedObstacle::Kind::kBox;
  box.center_m = rounded(center[0], center[1]);
  box.size_m = rounded(size[0], size[1]);
  box.angle_rad = rounded(angle_rad);
  for (const Point corner : {Point{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
    const Point arm = rotated(corner[0] * box.size_m[0], corner[1] * box.size_m[1], box.angle_rad);
    box.outline_m.push_back({box.center_m[0] + arm[0], box.center_m[1] + arm[1]});
  }
  return box;
}

// Vertices on an ellipse, hence convex; none closer than 0.4 of the even spacing.
GeneratedObstacle make_polygon(Random& random, Point center, double size_m) {
  GeneratedObstacle polygon;
  polygon.kind = GeneratedObstacle::Kind::kPolygon;
  const int num_vertices = random.uniform_int(3, 8);
  const double aspect = random.uniform(0.55, 1.0);
  const double turn_rad = random.uniform(0.0, 2.0 * std::numbers::pi);
  for (int i = 0; i < num_vertices; ++i) {
    const double share = (i + random.uniform(-0.3, 0.3)) / num_vertices;
    const double angle_rad = 2.0 * std::numbers::pi * share;
    const Point arm = rotated(0.5 * size_m * std::cos(angle_rad),
                              0.5 * size_m * aspect * std::sin(angle_rad), turn_rad);
    polygon.outline_m.push_back(rounded(center[0] + arm[0], center[1] + arm[1]));
  }
  return polygon;
}

GeneratedObstacle make_random_obstacle(Random& random, Point center, double min_size_m,
                                       double max_size_m) {
  const int kind = random.uniform_int(0, 9);
  const double size_m = random.uniform(min_size_m, max_size_m);
  if (kind < 2) return make_disc(center, 0.5 * size_m);
  if (kind < 5) {
    const double width_m = std::max(1.0, size_m * random.uniform(0.35, 1.0));
    return make_box(center, {size_m, width_m}, random.uniform(0.0, std::numbers::pi));
  }
  return make_polygon(random, center, size_m);
}

bool keeps_ends_clear(const GeneratedScene& scene, const GeneratedObstacle& obstacle) {
  const double wanted_m = scene.radius_m + kEndClearance_m;
  return signed_distance_m(obstacle, scene.start_m[0], scene.start_m[1]) >= wanted_m &&
         signed_distance_m(obstacle, scene.goal_m[0], scene.goal_m[1]) >= wanted_m;
}

// True when the straight line from start to goal enters an obstacle.
bool straight_line_is_blocked(const GeneratedScene& scene) {
  constexpr int kNumSamples = 4000;
  for (int i = 0; i <= kNumSamples; ++i) {
    const double share = static_cast<double>(i) / kNumSamples;
    const double x = std::lerp(scene.start_m[0], scene.goal_m[0], share);
    const double y = std::lerp(scene.start_m[1], scene.goal_m[1], share);
    for (const GeneratedObstacle& obstacle : scene.obstacles) {
      if (signed_distance_m(obstacle, x, y) < 0.0) return true;
    }
  }
  return false;
}

// A square world; half of the obstacles near the diagonal, where they are in the way.
GeneratedScene draw_plane_candidate(Random& random, int num_obstacles) {
  GeneratedScene scene;
  const double width_m = 0.5 * random.uniform_int(40, 60);
  scene.size_m = {width_m, width_m};
  scene.radius_m = 0.1;
  scene.start_m = {1.0, 1.0};
  scene.goal_m = {width_m - 1.0, width_m - 1.0};
  while (static_cast<int>(scene.obstacles.size()) < num_obstacles) {
    Point center{random.uniform(1.0, width_m - 1.0), random.uniform(1.0, width_m - 1.0)};
    if (scene.obstacles.size() % 2 == 0) {
      const double along = random.uniform(0.15, 0.85) * width_m;
      const double across = random.uniform(-0.12, 0.12) * width_m;
      center = {along - across, along + across};
    }
    const GeneratedObstacle obstacle = make_random_obstacle(random, center, 1.0, 3.5);
    if (keeps_ends_clear(scene, obstacle)) scene.obstacles.push_back(obstacle);
  }
  return scene;
}

bool is_crowded(const GeneratedScene& scene, const Point& center, double distance_m) {
  return std::any_of(scene.obstacles.begin(), scene.obstacles.end(),
                     [&](const GeneratedObstacle& other) {
                       return signed_distance_m(other, center[0], center[1]) < distance_m;
                     });
}

// Four slanted walls, alternately from below and above, make a slalom; smaller things stand in the
// rooms between them.
GeneratedScene draw_long_candidate(Random& random) {
  constexpr Point kSize_m{40.0, 25.0};
  constexpr int kNumWalls = 4;
  constexpr int kNumObstacles = 22;
  GeneratedScene scene;
  scene.size_m = kSize_m;
  scene.radius_m = 0.2;
  scene.start_m = {2.0, 2.0};
  scene.goal_m = {38.0, 23.0};
  for (int i = 0; i < kNumWalls; ++i) {
    const double length_m = random.uniform(15.5, 18.5);
    const double x = kSize_m[0] * (i + 1) / (kNumWalls + 1) + random.uniform(-0.5, 0.5);
    const double y = i % 2 == 0 ? kSize_m[1] - 0.48 * length_m : 0.48 * length_m;
    const double lean_rad = random.uniform(-0.12, 0.12);
    scene.obstacles.push_back(make_box({x, y}, {0.9, length_m}, lean_rad));
  }
  while (static_cast<int>(scene.obstacles.size()) < kNumObstacles) {
    const Point center{random.uniform(3.0, kSize_m[0] - 3.0),
                       random.uniform(1.5, kSize_m[1] - 1.5)};
    const GeneratedObstacle obstacle = make_random_obstacle(random, center, 1.2, 3.2);
    if (!is_crowded(scene, center, 2.6) && keeps_ends_clear(scene, obstacle))
      scene.obstacles.push_back(obstacle);
  }
  return scene;
}

GeneratedScene generate(const std::string& folder, const std::string& name, std::uint64_t seed,
                        const std::function<GeneratedScene(Random&)>& draw) {
  Random random(seed);
  int num_dropped = 0;
  for (;;) {  // ends: nearly every draw is blocked and solvable
    GeneratedScene scene = draw(random);
    if (!straight_line_is_blocked(scene)) continue;
    if (!is_solvable(scene)) {
      ++num_dropped;
      continue;
    }
    scene.name = name;
    scene.file = folder + name + ".json";
    scene.seed = seed;
    scene.num_dropped = num_dropped;
    return scene;
  }
}

}  // namespace

std::vector<GeneratedScene> generate_scenes() {
  std::vector<GeneratedScene> scenes;
  for (int i = 1; i <= kNumPlaneScenes; ++i) {
    const int num_obstacles =
        kMinObstacles + (kMaxObstacles - kMinObstacles) * (i - 1) / (kNumPlaneScenes - 1);
    const std::string name = (i < 10 ? "plane_0" : "plane_") + std::to_string(i);
    scenes.push_back(generate(
        "plane/", name, kFirstSeed + static_cast<std::uint64_t>(i),
        [num_obstacles](Random& random) { return draw_plane_candidate(random, num_obstacles); }));
  }
  scenes.push_back(generate("", "plane_long", kLongSeed, draw_long_candidate));
  return scenes;
}

}  // namespace sopt
