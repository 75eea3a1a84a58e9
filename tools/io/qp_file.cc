#include "tools/io/qp_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "tools/io/input_error.h"
#include "tools/io/input_text.h"
#include "tools/io/json_fields.h"

namespace sopt {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// What is read: a section, one of its elements, a part of that.
struct Place {
  std::string_view section;
  int index = -1;
  std::string_view part{};

  [[nodiscard]] std::string text() const {
    std::string text(section);
    if (index >= 0) text += '[' + std::to_string(index) + ']';
    if (!part.empty()) text.append(".").append(part);
    return text;
  }
};

// Walks through the words of a file and knows its line.
class Words {
 public:
  Words(std::string file, std::string_view text) : file_(std::move(file)), text_(text) {}

  // Throws "FILE: line N: PROBLEM; it must be ALLOWED".
  [[noreturn]] void fail(const std::string& problem, const std::string& allowed) const {
    throw InputError(file_ + ": line " + std::to_string(line_) + ": " + problem + "; it must be " +
                     allowed);
  }
  // About the word read last, which is what stands at `place`.
  [[noreturn]] void fail_at(const Place& place, const std::string& allowed) const {
    fail(place.text() + " is \"" + printable(word_) + '"', allowed);
  }

  // Empty at the end of the file.
  std::string_view next() {
    std::size_t begin = at_;
    while (begin < text_.size() && is_blank(text_[begin])) line_ += text_[begin++] == '\n' ? 1 : 0;
    at_ = begin;
    while (at_ < text_.size() && !is_blank(text_[at_])) ++at_;
    word_ = text_.substr(begin, at_ - begin);
    return word_;
  }

  std::string rest_of_line() {
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string_view rest = text_.substr(at_, end - at_);
    at_ = end;
    while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);
    while (!rest.empty() && is_blank(rest.back())) rest.remove_suffix(1);
    return std::string(rest);
  }

  std::string_view required(const Place& place, const std::string& allowed) {
    const std::string_view word = next();
    if (word.empty()) fail(place.text() + " is missing", allowed);
    return word;
  }

  void keyword(const char* name) {
    const std::string allowed = '"' + std::string(name) + '"';
    const std::string_view word = required({"the next section"}, allowed);
    if (word != name) fail_at({"the next section"}, allowed);
  }

  int integer(const Place& place, int highest, const char* reason = "") {
    const std::string allowed = "an integer from 0 to " + std::to_string(highest) + reason;
    const std::string_view word = required(place, allowed);
    std::int64_t number = 0;
    if (!is_whole(word, number) || number < 0 || number > highest) fail_at(place, allowed);
    return static_cast<int>(number);
  }

  double number(const Place& place) {
    return accepted_number(place, "a number between -1e20 and 1e20",
                           [](double v) { return std::abs(v) < kQpInfinity; });
  }
  double lower_bound(const Place& place) {
    return accepted_number(place, "a number below 1e20", [](double v) { return v < kQpInfinity; });
  }
  double upper_bound(const Place& place) {
    return accepted_number(place, "a number above -1e20",
                           [](double v) { return v > -kQpInfinity; });
  }

 private:
  static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f';
  }

  template <class Number>
  static bool is_whole(std::string_view word, Number& number) {
    const char* const end = word.data() + word.size();
    const std::from_chars_result result = std::from_chars(word.data(), end, number);
    return result.ec == std::errc() && result.ptr == end;
  }

  double accepted_number(const Place& place, const char* allowed, bool (*accepts)(double)) {
    const std::string_view word = required(place, allowed);
    double value = 0.0;
    if (!is_whole(word, value) || !accepts(value)) fail_at(place, allowed);
    return std::abs(value) < kQpInfinity ? value : std::copysign(kInfinity, value);
  }

  std::string file_;
  std::string_view text_;
  std::string_view word_;  // read last
  std::size_t at_ = 0;
  int line_ = 1;
};

struct MatrixShape {
  int num_rows = 0;
  int num_columns = 0;
  bool is_lower_triangle = false;

  [[nodiscard]] int max_entries() const {
    return is_lower_triangle ? num_rows * (num_rows + 1) / 2 : num_rows * num_columns;
  }
};

std::vector<double> read_matrix(Words& words, const char* name, const MatrixShape& shape) {
  words.keyword(name);
  const auto size =
      static_cast<std::size_t>(shape.num_rows) * static_cast<std::size_t>(shape.num_columns);
  std::vector<double> matrix(size);
  std::vector<bool> is_given(size);
  const int num_entries = words.integer({name, -1, "count"}, shape.max_entries());
  for (int k = 0; k < num_entries; ++k) {
    const int i = words.integer({name, k, "row"}, shape.num_rows - 1);
    const int j =
        shape.is_lower_triangle
            ? words.integer({name, k, "column"}, i, ", its row: only the lower triangle is given")
            : words.integer({name, k, "column"}, shape.num_columns - 1);
    const auto at = static_cast<std::size_t>(i) * static_cast<std::size_t>(shape.num_columns) +
                    static_cast<std::size_t>(j);
    if (is_given[at]) {
      words.fail(Place{name, k}.text() + " is at row " + std::to_string(i) + ", column " +
                     std::to_string(j) + " again",
                 "at a place of its own");
    }
    is_given[at] = true;
    matrix[at] = words.number({name, k, "value"});
  }
  return matrix;
}

void mirror_lower_triangle(std::vector<double>& matrix, int n) {
  const auto size = static_cast<std::size_t>(n);
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j < i; ++j) matrix[j * size + i] = matrix[i * size + j];
  }
}

using ReadNumber = double (Words::*)(const Place& place);

std::vector<double> read_numbers(Words& words, const char* name, int count, ReadNumber read) {
  std::vector<double> numbers;
  numbers.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) numbers.push_back((words.*read)({name, i}));
  return numbers;
}

void read_row_bounds(Words& words, QpProblem& problem) {
  const auto is_equality = [](int i) { return ": row " + std::to_string(i) + " is an equality"; };
  words.keyword("lA");
  for (int i = 0; i < problem.num_rows; ++i) {
    problem.row_lower.push_back(words.lower_bound({"lA", i}));
    if (i < problem.num_equalities && problem.row_lower.back() == -kInfinity) {
      words.fail_at({"lA", i}, "above -1e20" + is_equality(i));
    }
  }
  words.keyword("uA");
  for (int i = 0; i < problem.num_rows; ++i) {
    problem.row_upper.push_back(words.upper_bound({"uA", i}));
    if (i < problem.num_equalities &&
        problem.row_lower[static_cast<std::size_t>(i)] != problem.row_upper.back()) {
      words.fail_at({"uA", i}, "lA[" + std::to_string(i) + ']' + is_equality(i));
    }
  }
}

void read_optimum(Words& words, QpProblem& problem) {
  std::string_view word = words.next();
  if (word == "fstar") {
    problem.optimum = words.number({"fstar"});
    word = words.next();
  }
  if (word == "xstar") {
    problem.optimum_point = read_numbers(words, "xstar", problem.num_variables, &Words::number);
    word = words.next();
  }
  if (!word.empty()) {
    words.fail_at({"the next section"},
                  "\"fstar\", \"xstar\", each once and in this order, or the end of the file");
  }
}

}  // namespace

QpProblem load_qp(const std::filesystem::path& file) {
  const std::string text = read_input(file, "a QP1 file");
  Words words(printable(file.string(), 400), text);
  const std::string_view magic = words.required({"the format"}, "\"QP1\"");
  if (magic != "QP1") words.fail_at({"the format"}, "\"QP1\"");
  QpProblem problem;
  problem.name = words.rest_of_line();
  if (problem.name.empty()) words.fail("the name is missing", "behind \"QP1\" on its line");
  problem.num_variables = words.integer({"n"}, kMaxQpVariables);
  problem.num_rows = words.integer({"m"}, kMaxQpRows);
  problem.num_equalities = words.integer({"neq"}, problem.num_rows, ", the number of rows");
  const int n = problem.num_variables;
  problem.hessian = read_matrix(words, "H", {n, n, true});
  mirror_lower_triangle(problem.hessian, n);
  words.keyword("f");
  problem.gradient = read_numbers(words, "f", n, &Words::number);
  problem.rows = read_matrix(words, "A", {problem.num_rows, n});
  read_row_bounds(words, problem);
  words.keyword("lb");
  problem.lower = read_numbers(words, "lb", n, &Words::lower_bound);
  words.keyword("ub");
  problem.upper = read_numbers(words, "ub", n, &Words::upper_bound);
  read_optimum(words, problem);
  return problem;
}

}  // namespace sopt
