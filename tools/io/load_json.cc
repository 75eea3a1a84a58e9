// The parser behind load_json: nlohmann's event parser drives a builder that counts depth and
// values and sees duplicate fields, so that limits hold before memory is spent. Neither the parser
// nor the builder recurses.

#include <vector>

#include "tools/io/input_error.h"
#include "tools/io/input_text.h"
#include "tools/io/json_fields.h"

namespace sopt {
namespace {

using nlohmann::json;

class Builder final : public nlohmann::json_sax<json> {
 public:
  Builder(std::string file, json& root) : file_(std::move(file)), root_(root) {}

  bool null() override { return add(json(nullptr)) != nullptr; }
  bool boolean(bool value) override { return add(json(value)) != nullptr; }
  bool number_integer(number_integer_t value) override { return add(json(value)) != nullptr; }
  bool number_unsigned(number_unsigned_t value) override { return add(json(value)) != nullptr; }
  bool number_float(number_float_t value, const string_t& /*text*/) override {
    return add(json(value)) != nullptr;
  }
  bool string(string_t& value) override { return add(json(std::move(value))) != nullptr; }
  bool binary(binary_t& /*value*/) override { return false; }  // text has none
  bool start_object(std::size_t /*size*/) override { return open(json::object()); }
  bool end_object() override { return close(); }
  bool start_array(std::size_t /*size*/) override { return open(json::array()); }
  bool end_array() override { return close(); }

  bool key(string_t& name) override {
    names_.back() = std::move(name);
    if (open_.back()->contains(names_.back())) fail(path() + " appears twice; it must be unique");
    return true;
  }

  bool parse_error(std::size_t position, const std::string& last_token,
                   const nlohmann::detail::exception& error) override {
    constexpr int kNumberOverflow = 406;
    if (error.id == kNumberOverflow) {
      fail(path() + " is " + printable(last_token, 30) + "; it must be a finite number");
    }
    std::string text = error.what();  // "[json.exception.x] parse error at line 1, column 2: ..."
    const std::size_t place = text.find(" at line ");
    if (place == std::string::npos) fail("byte " + std::to_string(position) + ": not valid JSON");
    text = text.substr(place + 4);
    fail("not valid JSON: " + printable(text, 200));
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const {
    throw InputError(file_ + ": " + problem);
  }

  // Of the value that is being read, as in obstacles[3].radius.
  [[nodiscard]] std::string path() const {
    std::string text;
    for (std::size_t i = 0; i < open_.size(); ++i) {
      const bool is_innermost = i + 1 == open_.size();
      if (open_[i]->is_array()) {
        text += '[' + std::to_string(open_[i]->size() - (is_innermost ? 0 : 1)) + ']';
      } else {
        text += (text.empty() ? "" : ".") + field_name(names_[i]);
      }
    }
    return text.empty() ? "the file" : text;
  }

  json* add(json&& value) {
    if (++num_values_ > kMaxJsonValues) {
      fail("holds more than " + std::to_string(kMaxJsonValues) + " values, the limit");
    }
    if (open_.empty()) return &(root_ = std::move(value));
    json& parent = *open_.back();
    if (parent.is_object()) return &(parent[names_.back()] = std::move(value));
    parent.push_back(std::move(value));
    return &parent.back();
  }

  bool open(json&& container) {
    if (open_.size() >= kMaxJsonDepth) {
      fail("is nested deeper than " + std::to_string(kMaxJsonDepth) + " levels, the limit");
    }
    open_.push_back(add(std::move(container)));
    names_.emplace_back();
    return true;
  }

  bool close() {
    open_.pop_back();
    names_.pop_back();
    return true;
  }

  std::string file_;
  json& root_;
  std::vector<json*> open_;         // containers around the value; only the last one grows
  std::vector<std::string> names_;  // per open object: its last field
  std::size_t num_values_ = 0;
};

}  // namespace

nlohmann::json load_json(const std::filesystem::path& file) {
  const std::string shown = printable(file.string(), 400);
  const std::string text = read_input(file, "a JSON file");
  if (text.empty()) throw InputError(shown + ": is empty; it must be a JSON object");
  json root;
  Builder builder(shown, root);
  if (!json::sax_parse(text, &builder)) throw InputError(shown + ": not valid JSON");
  return root;
}

}  // namespace sopt
