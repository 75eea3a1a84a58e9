// Reads an input file, or a pipe, whole.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace sopt {

inline constexpr std::size_t kMaxInputSize_B = std::size_t{64} << 20;

// At most kMaxInputSize_B, also from pipes, whose size nobody knows. Throws InputError; `allowed`
// says what the file must be, as in "a JSON file".
[[nodiscard]] std::string read_input(const std::filesystem::path& file, const char* allowed);

}  // namespace sopt
