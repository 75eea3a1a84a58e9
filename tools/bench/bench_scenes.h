// The scenes of a measurement, read before anything is measured: of any robots, but either of the
// plane or of arms, because lengths in m and in rad have no common mean.
#pragma once

#include <filesystem>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "tools/io/robot_scene.h"

namespace sopt {

enum class SceneKind { kPlane, kArm };

[[nodiscard]] inline SceneKind kind_of(const AnyScene& scene) {
  return std::holds_alternative<Scene>(scene) ? SceneKind::kPlane : SceneKind::kArm;
}
// Of lengths in the path metric.
[[nodiscard]] const char* length_unit(SceneKind kind);

struct BenchScenes {
  SceneKind kind = SceneKind::kPlane;  // of all
  std::vector<AnyScene> scenes;
};

// Throws InputError, also when the kinds differ.
[[nodiscard]] BenchScenes load_bench_scenes(const std::vector<std::filesystem::path>& files);

// Length of a known path, in the path metric.
[[nodiscard]] inline std::optional<double> reference_of(const Scene& scene) {
  return scene.reference_feasible_length;
}
template <int N>
[[nodiscard]] std::optional<double> reference_of(const ArmScene<N>& scene) {
  return scene.reference_length;
}

template <class SomeScene>
using RobotOf = std::decay_t<decltype(robot_of(std::declval<const SomeScene&>()))>;

}  // namespace sopt
