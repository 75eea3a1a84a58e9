#include "tools/scenes/shipped_scenes.h"

#include "tools/io/file_list.h"
#include "tools/io/input_error.h"

namespace sopt {

std::vector<std::filesystem::path> given_or_shipped_scenes(
    const std::vector<std::string>& arguments) {
  if (!arguments.empty()) return list_files(arguments, ".json");
  if (std::filesystem::is_directory(kShippedScenes)) return list_files({kShippedScenes}, ".json");
  throw InputError(std::string("SCENE: none given, and there is no folder ") + kShippedScenes +
                   " here; give scene files or a folder of them");
}

}  // namespace sopt
