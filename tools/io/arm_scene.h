// Scene files of arms, read as strictly as those of the plane (scene_file.h), and scenes of any
// robot. Fields: robot (a preset's name, or any name with robot_file), robot_file (relative to the
// scene file), joints (the free ones in the order of start and goal), locked_joints {name: value},
// base {position, quaternion_xyzw}, at most kMaxBase_m from the origin, start, goal, obstacles,
// speed (rad/s, of the weighted joints), dt, margin, min_clearance, start_velocity and
// goal_velocity (zeros), limits {lower, upper, v_max, a_max}: arrays in the order of start, null
// where the robot's own limit holds; they may narrow what the robot allows, and give accelerations
// freely, which few robots publish; joint_weights, likewise, of the path metric (ArmJoint::weight).
// Obstacles: box {size}, cylinder {radius, height along local z}, sphere {radius}, all with
// position and quaternion_xyzw (absent: not turned); capsule {p0, p1, radius}; hull {vertices}, the
// convex hull of 4 to 32 points. A start or goal outside the limits by at most kLimitSlack is moved
// onto them: published files round. Further outside is an error of the file; a collision is the
// planner's to answer.
#pragma once

#include <variant>

#include "models/arm/arm.h"
#include "models/space/world3.h"
#include "tools/io/scene_fields.h"
#include "tools/io/scene_file.h"

namespace sopt {

inline constexpr double kLimitSlack = 1e-5;  // rad or m

template <int N>
struct ArmScene {
  std::filesystem::path file;
  std::string name;  // the file's stem when the scene has none
  std::string robot_name;
  Arm<N> arm;
  std::vector<std::string> joint_names;                    // N
  std::vector<std::string> link_names;                     // N + 1
  std::unique_ptr<MemoryBlock> memory;                     // of the world
  std::unique_ptr<World3> world;                           // built
  typename Arm<N>::Config start = Arm<N>::Config::Zero();  // within the limits
  typename Arm<N>::Config goal = Arm<N>::Config::Zero();
  PlanOptions options;                     // the scene's values over PlanOptions::arm()
  std::vector<std::string> obstacle_ids;   // one per obstacle; empty string: it has none
  std::optional<double> reference_length;  // of a known path, rad; for benchmarks
};

using AnyScene =
    std::variant<Scene, ArmScene<4>, ArmScene<5>, ArmScene<6>, ArmScene<7>, ArmScene<8>>;

// Throws InputError; its what() is one line: file, field, value, what is allowed.
// `robot`, as --robot gives it, replaces the scene's unless empty: "point2d", a preset's name,
// whose joints are all free, or a robot file, to which the scene's joints and locked_joints apply.
[[nodiscard]] AnyScene load_any_scene(const std::filesystem::path& file,
                                      const std::string& robot = "");

// The scene's problem, seed 1, no deadline. Points into `scene`.
template <int N>
[[nodiscard]] PlanRequest<Arm<N>> make_request(const ArmScene<N>& scene) {
  PlanRequest<Arm<N>> request;
  request.start = scene.start;
  request.goal = scene.goal;
  request.world = scene.world.get();
  request.options = scene.options;
  return request;
}

// "obstacle 7", "obstacle \"pillar\"" or "nothing".
template <int N>
[[nodiscard]] std::string obstacle_name(const ArmScene<N>& scene, int i_obstacle) {
  return obstacle_name(scene.obstacle_ids, i_obstacle);
}

}  // namespace sopt
