#include "tools/io/file_list.h"

#include <algorithm>

#include "tools/io/input_error.h"
#include "tools/io/json_fields.h"

namespace sopt {

std::vector<std::filesystem::path> list_files(const std::vector<std::string>& arguments,
                                              const std::string& extension) {
  std::vector<std::filesystem::path> files;
  for (const std::string& argument : arguments) {
    if (!std::filesystem::is_directory(argument)) {
      files.emplace_back(argument);
      continue;
    }
    const std::size_t first = files.size();
    for (const auto& entry : std::filesystem::directory_iterator(argument)) {
      if (entry.path().extension() == extension) files.push_back(entry.path());
    }
    if (files.size() == first) {
      throw InputError(printable(argument, 400) + ": the folder has no *" + extension + " file");
    }
    std::sort(files.begin() + static_cast<std::ptrdiff_t>(first), files.end());
  }
  return files;
}

}  // namespace sopt
