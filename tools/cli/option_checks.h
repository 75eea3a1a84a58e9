// Checks of command-line values, for CLI11's `Option::check`: the whole text must be a number in
// range, and the error names what is allowed.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tools/io/json_fields.h"

namespace sopt {

using OptionCheck = std::function<std::string(const std::string& text)>;  // "" when it is allowed

[[nodiscard]] OptionCheck number_check(const NumberRule& rule);
[[nodiscard]] OptionCheck integer_check(std::uint64_t lowest, std::uint64_t highest);
// An integer in range, or `word`.
[[nodiscard]] OptionCheck integer_or_word_check(std::uint64_t lowest, std::uint64_t highest,
                                                const char* word);
[[nodiscard]] OptionCheck file_check();  // not empty, as a shell variable that is not set would be
[[nodiscard]] OptionCheck word_check(const std::vector<std::string>& words);

}  // namespace sopt
