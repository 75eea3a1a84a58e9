#include "tools/io/json_fields.h"

#include <algorithm>

#include "tools/io/input_error.h"

namespace sopt {
namespace {

using nlohmann::json;

std::string describe(const json& value) {
  constexpr std::size_t kShortArray = 6;
  if (value.is_string()) return in_quotes(value.get_ref<const std::string&>());
  if (value.is_object()) return "an object";
  if (value.is_array()) {
    const bool show = value.size() <= kShortArray && !value.empty() &&
                      std::all_of(value.begin(), value.end(),
                                  [](const json& e) { return e.is_primitive() && !e.is_string(); });
    return show ? value.dump() : "an array of " + std::to_string(value.size());
  }
  return value.dump();
}

}  // namespace

std::string printable(std::string_view text, std::size_t max_length) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const bool starts_character = (byte & 0xC0U) != 0x80U;
    if (starts_character && result.size() >= max_length) return result + "...";
    if (byte < 0x20U || byte == 0x7FU) {
      constexpr const char* kHex = "0123456789abcdef";
      result += "\\x";
      result += kHex[byte >> 4U];
      result += kHex[byte & 0xFU];
    } else {
      result += text[i];
    }
  }
  return result;
}

std::string field_name(std::string_view name) {
  const bool plain =
      !name.empty() && name.find_first_not_of(
                           "abcdefghijklmnopqrstuvwxyz"
                           "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") == std::string_view::npos;
  return plain && name.size() <= 60 ? std::string(name) : in_quotes(name);
}

std::string show(double number) { return json(number).dump(); }

std::string in_quotes(std::string_view name) { return '"' + printable(name) + '"'; }

std::string valid_utf8(const std::string& text) {
  const std::string quoted = json(text).dump(-1, ' ', false, json::error_handler_t::replace);
  return json::parse(quoted).get<std::string>();
}

void JsonField::fail(std::string_view allowed) const {
  fail_as("is " + describe(*value_), allowed);
}

void JsonField::fail_as(std::string_view problem, std::string_view allowed) const {
  std::string line = *file_ + ": ";
  line += path_.empty() ? "the file" : path_;
  line.append(" ").append(problem).append("; it must be ").append(allowed);
  throw InputError(line);
}

std::string JsonField::path_to(std::string_view name) const {
  return path_.empty() ? field_name(name) : path_ + '.' + field_name(name);
}

void JsonField::check_fields(std::initializer_list<std::string_view> known,
                             bool (*is_ignored)(std::string_view name)) const {
  if (!value_->is_object()) fail("an object");
  for (const auto& item : value_->items()) {
    const std::string& name = item.key();
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    if (is_ignored != nullptr && is_ignored(name)) continue;
    std::string line = *file_ + ": " + path_to(name) + " is not a known field; known: ";
    for (const std::string_view& k : known) {
      line.append(k == *known.begin() ? "" : ", ").append(k);
    }
    throw InputError(line);
  }
}

void JsonField::check_array(std::size_t lowest, std::size_t highest,
                            std::string_view allowed) const {
  if (!value_->is_array()) fail(allowed);
  if (size() < lowest || size() > highest) {
    fail_as("has " + std::to_string(size()) + (size() == 1 ? " element" : " elements"), allowed);
  }
}

JsonField JsonField::at(const char* name, std::string_view allowed) const {
  const std::optional<JsonField> field = find(name);
  if (!field) {
    std::string line = *file_ + ": " + path_to(name) + " is missing; it must be ";
    throw InputError(line.append(allowed));
  }
  return *field;
}

std::optional<JsonField> JsonField::find(const char* name) const {
  const auto it = value_->find(name);
  if (it == value_->end()) return std::nullopt;
  return JsonField(*this, *it, path_to(name));
}

double JsonField::number_at(const char* name, const NumberRule& rule) const {
  return at(name, rule.allowed).number(rule);
}

std::optional<double> JsonField::find_number(const char* name, const NumberRule& rule) const {
  const std::optional<JsonField> field = find(name);
  return field ? std::optional(field->number(rule)) : std::nullopt;
}

JsonField JsonField::operator[](std::size_t i) const {
  return JsonField(*this, (*value_)[i], path_ + '[' + std::to_string(i) + ']');
}

double JsonField::number(const NumberRule& rule) const {
  if (!value_->is_number()) fail(rule.allowed);
  const auto number = value_->get<double>();
  if (!rule.accepts(number)) fail(rule.allowed);
  return number;
}

std::string JsonField::text() const {
  if (!value_->is_string() || value_->get_ref<const std::string&>().empty()) {
    fail("a string that is not empty");
  }
  return value_->get<std::string>();
}

void JsonField::numbers(const NumberRule& rule, std::string_view allowed,
                        std::span<double> out) const {
  if (!value_->is_array() || size() != out.size()) fail(allowed);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const nlohmann::json& element = (*value_)[i];
    if (!element.is_number() || !rule.accepts(element.get<double>())) fail(allowed);
    out[i] = element.get<double>();
  }
}

Vec2 JsonField::pair(const NumberRule& rule, std::string_view allowed) const {
  Vec2 pair;
  numbers(rule, allowed, {pair.data(), 2});
  return pair;
}

Vec2 JsonField::point() const { return pair(kCoordinate, kPointAllowed); }

}  // namespace sopt
