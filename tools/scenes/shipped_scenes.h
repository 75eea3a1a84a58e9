// The scenes that benchmarks take when none are given.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace sopt {

// Where they are, seen from the project's root.
inline constexpr const char* kShippedScenes = "tools/scenes/plane";

// Scene files of the arguments (list_files), or the shipped ones. Throws InputError when there
// are none.
[[nodiscard]] std::vector<std::filesystem::path> given_or_shipped_scenes(
    const std::vector<std::string>& arguments);

}  // namespace sopt
