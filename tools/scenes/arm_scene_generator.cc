#include "tools/scenes/arm_scene_generator.h"

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <optional>

#include "models/arm/arm_presets.h"
#include "sampler/rng.h"
#include "tools/io/arm_scene.h"
#include "tools/io/space_world.h"
#include "tools/scenes/arm_scene_check.h"

namespace sopt {
namespace {

using Config = Arm<5>::Config;
using nlohmann::ordered_json;

constexpr int kScenesPerFamily = 20;
constexpr std::uint64_t kFewSeed = 20400;   // arm_2_NN has seed kFewSeed + NN
constexpr std::uint64_t kManySeed = 20500;  // arm_8_NN likewise
constexpr std::uint64_t kFactorySeed = 20600;
constexpr double kEndClearance_m = 0.03;
constexpr double kMinTipTravel_m = 0.6;

class Random {
 public:
  explicit Random(std::uint64_t seed) : rng_(seed) {}

  double uniform(double lower, double upper) {
    return lower + (upper - lower) * rng_.next_uniform();
  }
  int uniform_int(int lower, int upper) {
    return lower +
           static_cast<int>(rng_.next_u64() % static_cast<std::uint64_t>(upper - lower + 1));
  }
  std::uint64_t seed() { return rng_.next_u64(); }
  Vec3 in_box(const Vec3& lower, const Vec3& upper) {
    return {uniform(lower.x(), upper.x()), uniform(lower.y(), upper.y()),
            uniform(lower.z(), upper.z())};
  }

 private:
  CounterRng rng_;
};

double rounded(double value) { return std::round(value * 1e4) / 1e4; }
ordered_json to_array(const Vec3& v) { return {rounded(v.x()), rounded(v.y()), rounded(v.z())}; }

Vec3 tip_W(const Arm<5>& arm, const Config& q) {
  ArmPose<5> pose;
  arm.forward(q, pose);
  return pose.X_WJ[5].position;
}

// --- obstacles

ordered_json make_box(const Vec3& position, const Vec3& size_m) {
  return {{"type", "box"}, {"position", to_array(position)}, {"size", to_array(size_m)}};
}

ordered_json make_named_box(const char* id, const Vec3& position, const Vec3& size_m) {
  ordered_json box = make_box(position, size_m);
  box["id"] = id;
  return box;
}

void turn(Random& random, ordered_json& shape) {
  Eigen::Vector4d xyzw;
  for (int i = 0; i < 4; ++i) xyzw[i] = random.uniform(-1.0, 1.0);
  if (xyzw.norm() < 0.1) xyzw = Eigen::Vector4d::UnitW();
  xyzw.normalize();
  shape["quaternion_xyzw"] = {rounded(xyzw[0]), rounded(xyzw[1]), rounded(xyzw[2]),
                              rounded(xyzw[3])};
}

// `scale` 1: of the size of the arm's links.
ordered_json make_random_obstacle(Random& random, const Vec3& center, double scale) {
  const int kind = random.uniform_int(0, 3);
  if (kind == 0) {
    const Vec3 size_m = scale * random.in_box(Vec3::Constant(0.10), Vec3::Constant(0.28));
    ordered_json box = make_box(center, size_m);
    turn(random, box);
    return box;
  }
  const double radius_m = rounded(scale * random.uniform(0.05, 0.11));
  if (kind == 1) {
    return {{"type", "sphere"}, {"position", to_array(center)}, {"radius", rounded(radius_m)}};
  }
  const double length_m = rounded(scale * random.uniform(0.15, 0.40));
  if (kind == 2) {
    const Vec3 half = random.in_box(Vec3::Constant(-1.0), Vec3::Constant(1.0));
    const Vec3 along = 0.5 * length_m / std::max(half.norm(), 0.1) * half;
    return {{"type", "capsule"},
            {"p0", to_array(center - along)},
            {"p1", to_array(center + along)},
            {"radius", radius_m}};
  }
  ordered_json cylinder = {{"type", "cylinder"}, {"position", to_array(center)}};
  turn(random, cylinder);
  cylinder["radius"] = radius_m;
  cylinder["height"] = length_m;
  return cylinder;
}

// --- candidates

bool is_clear_at(const Arm<5>& arm, const ordered_json& obstacles, const Config& q) {
  const nlohmann::json root = {{"obstacles", obstacles}};
  const std::string source = "generated";
  const SpaceWorld world = read_space_world(JsonField(root, source));
  return ArmSceneCheck(arm, *world.world).clearance_m(q) >= kEndClearance_m;
}

// Within the middle 90 % of the limits.
Config draw_configuration(Random& random, const Arm<5>& arm) {
  Config q;
  for (int j = 0; j < 5; ++j) {
    const double middle = 0.5 * (arm.lower()[j] + arm.upper()[j]);
    const double half = 0.45 * (arm.upper()[j] - arm.lower()[j]);
    q[j] = rounded(random.uniform(middle - half, middle + half));
  }
  return q;
}

void draw_ends(Random& random, const Arm<5>& arm, GeneratedArmScene& scene) {
  do {
    scene.start = draw_configuration(random, arm);
    scene.goal = draw_configuration(random, arm);
  } while ((tip_W(arm, scene.goal) - tip_W(arm, scene.start)).norm() <= kMinTipTravel_m ||
           (scene.goal - scene.start).cwiseAbs().maxCoeff() > 2.5 ||
           !is_clear_at(arm, scene.obstacles, scene.start) ||
           !is_clear_at(arm, scene.obstacles, scene.goal));
}

// A table below the arm in half of the larger scenes; then every second obstacle where the tip
// passes on the straight motion, the others within reach.
GeneratedArmScene draw_candidate(Random& random, const Arm<5>& arm, int num_obstacles) {
  const bool is_small = num_obstacles <= 2;
  GeneratedArmScene scene;
  scene.obstacles = ordered_json::array();
  if (!is_small && random.uniform_int(0, 1) == 1) {
    scene.obstacles.push_back(make_named_box("table", {0, 0, -0.4}, {2.0, 2.0, 0.1}));
  }
  draw_ends(random, arm, scene);
  while (static_cast<int>(scene.obstacles.size()) < num_obstacles) {
    Vec3 center = random.in_box({-0.85, -0.85, -0.25}, {0.85, 0.85, 0.85});
    if (scene.obstacles.size() % 2 == 0) {
      const double share = random.uniform(0.25, 0.75);
      center = tip_W(arm, scene.start + share * (scene.goal - scene.start)) +
               random.in_box(Vec3::Constant(-0.15), Vec3::Constant(0.15));
    }
    ordered_json with = scene.obstacles;
    with.push_back(make_random_obstacle(random, center, is_small ? 1.6 : 1.0));
    const bool is_near = center.norm() > 0.3 && center.norm() < 1.0;
    if (is_near && is_clear_at(arm, with, scene.start) && is_clear_at(arm, with, scene.goal)) {
      scene.obstacles = with;
    }
  }
  return scene;
}

// One side of a car in the plane x = 0.5, its door open; the opening is 0.62 m wide and 0.70 m
// high. Outside, the arm starts beside the opening; inside, it reaches over the seat.
GeneratedArmScene draw_factory_candidate(Random& random, const Arm<5>& arm) {
  GeneratedArmScene scene;
  scene.obstacles = {make_named_box("sill", {0.52, 0.0, -0.31}, {0.14, 2.2, 0.14}),
                     make_named_box("front_pillar", {0.52, -0.38, 0.11}, {0.08, 0.08, 0.70}),
                     make_named_box("middle_pillar", {0.52, 0.33, 0.11}, {0.10, 0.10, 0.70}),
                     make_named_box("rear_side", {0.52, 0.74, -0.03}, {0.06, 0.72, 0.42}),
                     make_named_box("front_side", {0.52, -0.76, -0.05}, {0.06, 0.68, 0.38}),
                     make_named_box("roof", {0.75, 0.0, 0.50}, {0.60, 2.2, 0.08}),
                     make_named_box("floor", {0.95, 0.0, -0.36}, {0.72, 2.2, 0.04}),
                     make_named_box("seat", {0.92, 0.05, -0.26}, {0.34, 0.44, 0.16})};
  const auto is_placed = [&] {
    const Vec3 outside = tip_W(arm, scene.start);
    const Vec3 inside = tip_W(arm, scene.goal);
    return outside.x() < 0.35 && outside.y() < -0.45 && std::abs(outside.z()) < 0.3 &&
           inside.x() > 0.72 && std::abs(inside.y()) < 0.25 && std::abs(inside.z()) < 0.25;
  };
  do {
    draw_ends(random, arm, scene);
  } while (!is_placed());
  return scene;
}

GeneratedArmScene generate(const std::string& name, std::uint64_t seed,
                           const std::function<GeneratedArmScene(Random&, const Arm<5>&)>& draw) {
  const Arm<5> arm = lr_mate_200id_7l();
  const std::string source = name;
  Random random(seed);
  int num_dropped = 0;
  for (;;) {  // ends: many draws are blocked, nearly all of those solvable
    GeneratedArmScene scene = draw(random, arm);
    const nlohmann::json root = {{"obstacles", scene.obstacles}};
    const SpaceWorld world = read_space_world(JsonField(root, source));
    const ArmSceneCheck check(arm, *world.world);
    if (!check.motion_is_blocked(scene.start, scene.goal)) continue;
    if (!check.is_solvable(scene.start, scene.goal, PlanOptions::arm().margin_m, random.seed())) {
      ++num_dropped;
      continue;
    }
    scene.name = name;
    scene.file = "arm/" + name + ".json";
    scene.seed = seed;
    scene.num_dropped = num_dropped;
    return scene;
  }
}

std::string two_digits(int i) { return (i < 10 ? "0" : "") + std::to_string(i); }

}  // namespace

std::vector<GeneratedArmScene> generate_arm_scenes() {
  std::vector<GeneratedArmScene> scenes;
  for (int i = 1; i <= kScenesPerFamily; ++i) {
    scenes.push_back(
        generate("arm_2_" + two_digits(i), kFewSeed + static_cast<std::uint64_t>(i),
                 [](Random& random, const Arm<5>& arm) { return draw_candidate(random, arm, 2); }));
  }
  for (int i = 1; i <= kScenesPerFamily; ++i) {
    const int num_obstacles = 7 + i % 3;
    scenes.push_back(generate("arm_8_" + two_digits(i), kManySeed + static_cast<std::uint64_t>(i),
                              [num_obstacles](Random& random, const Arm<5>& arm) {
                                return draw_candidate(random, arm, num_obstacles);
                              }));
  }
  scenes.push_back(generate("factory", kFactorySeed, draw_factory_candidate));
  return scenes;
}

std::string to_json_text(const GeneratedArmScene& scene) {
  const auto to_text = [](const Config& q) {
    return ordered_json(std::vector<double>(q.data(), q.data() + 5)).dump();
  };
  std::string text = "{\n  \"name\": \"" + scene.name + '"';
  text += ",\n  \"x_generator\": \"sopt_make_scenes\"";
  text += ",\n  \"x_seed\": " + std::to_string(scene.seed);
  text += ",\n  \"x_unsolvable_candidates_dropped\": " + std::to_string(scene.num_dropped);
  text += ",\n  \"num_obstacles\": " + std::to_string(scene.obstacles.size());
  text += ",\n  \"robot\": \"lr_mate_200id_7l\"";
  text += ",\n  \"start\": " + to_text(scene.start) + ",\n  \"goal\": " + to_text(scene.goal);
  text += ",\n  \"obstacles\": [";
  for (std::size_t i = 0; i < scene.obstacles.size(); ++i) {
    text += (i == 0 ? "\n    " : ",\n    ") + scene.obstacles[i].dump();
  }
  return text + "\n  ]\n}\n";
}

}  // namespace sopt
