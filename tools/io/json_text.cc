#include "tools/io/json_text.h"

#include <cmath>
#include <cstdio>

namespace sopt {
namespace {

using Json = nlohmann::ordered_json;

void append_number(double number, std::string& text) {
  char buffer[32];
  const int length = std::snprintf(buffer, sizeof buffer, "%.17g", number);
  text.append(buffer, static_cast<std::size_t>(length));
}

bool has_rows(const Json& value) {
  return value.is_array() && !value.empty() && value.front().is_structured();
}

// The documents of the program are at most four levels deep.
void append(const Json& value, int level, std::string& text) {
  if (value.is_number_float()) {
    const double number = value.get<double>();
    if (std::isfinite(number)) {
      append_number(number, text);
    } else {
      text += "null";
    }
    return;
  }
  if (!value.is_structured()) {
    text += value.dump();
    return;
  }
  const bool spread = level == 0 || (level == 1 && has_rows(value));
  const auto spaces = 2 * static_cast<std::size_t>(level);
  const std::string indent = spread ? '\n' + std::string(spaces + 2, ' ') : "";
  text += value.is_object() ? '{' : '[';
  bool first = true;
  for (const auto& item : value.items()) {
    if (!first) text += spread ? "," : ", ";
    first = false;
    text += indent;
    if (value.is_object()) text += Json(item.key()).dump() + ": ";
    append(item.value(), level + 1, text);
  }
  if (spread && !first) text += '\n' + std::string(spaces, ' ');
  text += value.is_object() ? '}' : ']';
}

}  // namespace

std::string to_text(const nlohmann::ordered_json& document) {
  std::string text;
  append(document, 0, text);
  text += '\n';
  return text;
}

}  // namespace sopt
