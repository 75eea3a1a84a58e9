// Strict reading of JSON files. `load_json` refuses what could hurt before anything is built: files
// that are too large, nesting that is too deep, too many values, duplicate fields, numbers beyond
// double, text that is not UTF-8. `JsonField` is a cursor that knows where it is, so that every
// error is one line: file, field, value, what is allowed.
#pragma once

#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "models/plane/convex2.h"

namespace sopt {

inline constexpr int kMaxJsonDepth = 32;
inline constexpr std::size_t kMaxJsonValues = std::size_t{1} << 22;

// A number allowed in a field; `allowed` is how errors call it.
struct NumberRule {
  double lowest = -std::numeric_limits<double>::max();
  double highest = std::numeric_limits<double>::max();
  const char* allowed = "a finite number";

  [[nodiscard]] bool accepts(double value) const noexcept {
    return value >= lowest && value <= highest;
  }
};

inline constexpr NumberRule kFinite{};
// Lengths, times and speeds: beyond a million the 1e-9 of the checks drowns in rounding.
inline constexpr NumberRule kCoordinate{-1e6, 1e6, "a number from -1e6 to 1e6"};
inline constexpr NumberRule kPositive{1e-9, 1e6, "a number > 0, from 1e-9 to 1e6"};
inline constexpr NumberRule kNotNegative{0.0, 1e6, "a number >= 0, up to 1e6"};
inline constexpr const char* kPointAllowed = "[x, y], two numbers from -1e6 to 1e6";

class JsonField {
 public:
  // The whole of `file`. Both must outlive this and every field got from it.
  JsonField(const nlohmann::json& value, const std::string& file) : value_(&value), file_(&file) {}

  // Throws InputError: "FILE: FIELD is VALUE; it must be ALLOWED".
  [[noreturn]] void fail(std::string_view allowed) const;
  // The same with a description in place of the value: "FILE: FIELD PROBLEM; it must be ALLOWED".
  [[noreturn]] void fail_as(std::string_view problem, std::string_view allowed) const;

  // Throws unless this is an object whose fields are all in `known` or match `is_ignored`.
  void check_fields(std::initializer_list<std::string_view> known,
                    bool (*is_ignored)(std::string_view name) = nullptr) const;
  // Throws unless this is an array of `lowest` to `highest` elements.
  void check_array(std::size_t lowest, std::size_t highest, std::string_view allowed) const;

  // Members of an object.
  [[nodiscard]] JsonField at(const char* name, std::string_view allowed) const;
  [[nodiscard]] std::optional<JsonField> find(const char* name) const;
  [[nodiscard]] double number_at(const char* name, const NumberRule& rule) const;
  [[nodiscard]] std::optional<double> find_number(const char* name, const NumberRule& rule) const;

  // Elements of an array.
  [[nodiscard]] std::size_t size() const { return value_->size(); }
  [[nodiscard]] JsonField operator[](std::size_t i) const;

  [[nodiscard]] double number(const NumberRule& rule) const;
  [[nodiscard]] std::string text() const;  // not empty
  // Fills `out` with as many numbers that `rule` accepts.
  void numbers(const NumberRule& rule, std::string_view allowed, std::span<double> out) const;
  // Two of them.
  [[nodiscard]] Vec2 pair(const NumberRule& rule, std::string_view allowed) const;
  [[nodiscard]] Vec2 point() const;  // [x, y], coordinates
  [[nodiscard]] const nlohmann::json& value() const { return *value_; }

 private:
  JsonField(const JsonField& parent, const nlohmann::json& value, std::string path)
      : value_(&value), file_(parent.file_), path_(std::move(path)) {}

  [[nodiscard]] std::string path_to(std::string_view name) const;

  const nlohmann::json* value_;
  const std::string* file_;
  std::string path_;  // as in obstacles[3].radius; empty for the whole file
};

// Parses a file into one JSON value; throws InputError.
[[nodiscard]] nlohmann::json load_json(const std::filesystem::path& file);

// Plain names bare, all others quoted and escaped.
[[nodiscard]] std::string field_name(std::string_view name);

// Replaces what is not UTF-8; JSON and SVG cannot hold it.
[[nodiscard]] std::string valid_utf8(const std::string& text);

// A number as JSON has it, and a name in quotes, for errors.
[[nodiscard]] std::string show(double number);
[[nodiscard]] std::string in_quotes(std::string_view name);

// Safe to show on one line: control characters escaped, cut after `max_length` characters.
[[nodiscard]] std::string printable(std::string_view text, std::size_t max_length = 60);

}  // namespace sopt
