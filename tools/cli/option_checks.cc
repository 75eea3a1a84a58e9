#include "tools/cli/option_checks.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

namespace sopt {
namespace {

template <class Number>
bool parse(const std::string& text, Number& number) {
  const char* const end = text.data() + text.size();
  const std::from_chars_result result = std::from_chars(text.data(), end, number);
  return result.ec == std::errc() && result.ptr == end;
}

std::string refusal(const std::string& text, const std::string& allowed) {
  return '"' + printable(text) + "\" is not allowed; it must be " + allowed;
}

}  // namespace

OptionCheck number_check(const NumberRule& rule) {
  return [rule](const std::string& text) {
    double number = 0.0;
    const bool accepted = parse(text, number) && std::isfinite(number) && rule.accepts(number);
    return accepted ? "" : refusal(text, rule.allowed);
  };
}

OptionCheck integer_check(std::uint64_t lowest, std::uint64_t highest) {
  return [=](const std::string& text) {
    std::uint64_t number = 0;
    if (parse(text, number) && number >= lowest && number <= highest) return std::string();
    return refusal(text,
                   "an integer from " + std::to_string(lowest) + " to " + std::to_string(highest));
  };
}

OptionCheck integer_or_word_check(std::uint64_t lowest, std::uint64_t highest, const char* word) {
  return [=, check = integer_check(lowest, highest)](const std::string& text) {
    if (text == word) return std::string();
    const std::string refused = check(text);
    return refused.empty() ? refused : refused + " or \"" + word + '"';
  };
}

OptionCheck file_check() {
  return [](const std::string& text) { return text.empty() ? refusal(text, "a file name") : ""; };
}

OptionCheck word_check(const std::vector<std::string>& words) {
  return [words](const std::string& text) {
    if (std::find(words.begin(), words.end(), text) != words.end()) return std::string();
    std::string allowed;
    for (const std::string& word : words) allowed += (allowed.empty() ? "\"" : ", \"") + word + '"';
    return refusal(text, (words.size() > 1 ? "one of " : "") + allowed);
  };
}

}  // namespace sopt
