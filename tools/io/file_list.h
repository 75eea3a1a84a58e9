// Files as given on a command line, where a folder stands for the files in it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace sopt {

// Arguments that are no folders as they are; folders by their files with `extension` (".json") in
// name order. Throws InputError when a folder has none.
[[nodiscard]] std::vector<std::filesystem::path> list_files(
    const std::vector<std::string>& arguments, const std::string& extension);

}  // namespace sopt
