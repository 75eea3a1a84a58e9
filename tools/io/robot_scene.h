// What code that is generic in the robot asks of its scene: which type it is, the robot in it, and
// the words for its states.
#pragma once

#include <algorithm>
#include <string>

#include "tools/io/arm_scene.h"
#include "tools/io/scene_file.h"

namespace sopt {

template <class Robot>
struct SceneTypes;
template <>
struct SceneTypes<Point2> {
  using Type = Scene;
};
template <int N>
struct SceneTypes<Arm<N>> {
  using Type = ArmScene<N>;
};
template <class Robot>
using SceneOf = typename SceneTypes<Robot>::Type;

[[nodiscard]] inline const Point2& robot_of(const Scene& scene) { return scene.robot; }
template <int N>
[[nodiscard]] const Arm<N>& robot_of(const ArmScene<N>& scene) {
  return scene.arm;
}

// Memory for requests on an arm's scene with `options`, as for the plane (scene_file.h).
template <int N>
[[nodiscard]] PlannerSettings make_settings(const ArmScene<N>& /*scene*/,
                                            const PlanOptions& options) {
  PlannerSettings settings = PlannerSettings::arm();
  settings.nodes_per_stream = std::max(settings.nodes_per_stream, options.num_samples);
  settings.max_window = std::max(settings.max_window, options.max_window);
  settings.dense_solver = options.solver == WindowSolver::kDense;
  if (options.num_streams > 0) settings.num_streams = options.num_streams;
  return settings;
}

// Of lengths in the path metric.
template <class Robot>
inline constexpr const char* kPathUnit = "rad";
template <>
inline constexpr const char* kPathUnit<Point2> = "m";

// What a state and an input look like in a file.
template <class Robot>
[[nodiscard]] std::string state_words() {
  return "[theta.., omega..] of " + std::to_string(2 * Robot::kDof) + " numbers";
}
template <>
[[nodiscard]] inline std::string state_words<Point2>() {
  return "[x, y]";
}
template <class Robot>
[[nodiscard]] std::string input_words() {
  return "[alpha..] of " + std::to_string(Robot::kDof) + " numbers";
}
template <>
[[nodiscard]] inline std::string input_words<Point2>() {
  return "[vx, vy]";
}

}  // namespace sopt
