#include "tools/bench/bench_scenes.h"

#include <string>

#include "tools/io/input_error.h"
#include "tools/io/json_fields.h"

namespace sopt {

const char* length_unit(SceneKind kind) {
  return kind == SceneKind::kPlane ? kPathUnit<Point2> : kPathUnit<Arm<kMinArmJoints>>;
}

BenchScenes load_bench_scenes(const std::vector<std::filesystem::path>& files) {
  BenchScenes result;
  for (const std::filesystem::path& file : files) {
    AnyScene scene = load_any_scene(file);
    const SceneKind kind = kind_of(scene);
    if (result.scenes.empty()) result.kind = kind;
    if (kind != result.kind) {
      const auto words = [](SceneKind k) {
        return k == SceneKind::kPlane ? "the plane" : "an arm";
      };
      throw InputError(
          printable(file.string(), 400) + ": a scene of " + words(kind) +
          ", and those before it are of " + words(result.kind) +
          "; lengths in m and rad have no common mean, so they must be measured apart");
    }
    result.scenes.push_back(std::move(scene));
  }
  return result;
}

}  // namespace sopt
