#include "tools/shipped_scenes.h"

#include "tools/bench_plan.h"
#include "tools/input_error.h"

namespace sopt {

std::vector<std::filesystem::path> given_or_shipped_scenes(
    const std::vector<std::string>& arguments) {
  if (!arguments.empty()) return list_scenes(arguments);
  if (std::filesystem::is_directory(kShippedScenes)) return list_scenes({kShippedScenes});
  throw InputError(std::string("SCENE: none given, and there is no folder ") + kShippedScenes +
                   " here; give scene files or a folder of them");
}

}  // namespace sopt
