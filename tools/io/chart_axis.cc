#include "tools/io/chart_axis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace sopt {
namespace {

constexpr double kLargest = 1e300;  // sums and differences of what is shown stay finite
constexpr double kRounding = 1e-9;  // of a step

// digit 10^exponent, rounded once where a power of ten is exact.
double decimal(double digits, int exponent) {
  return exponent >= 0 ? digits * std::pow(10.0, exponent) : digits / std::pow(10.0, -exponent);
}

int exponent_of(double magnitude) { return static_cast<int>(std::floor(std::log10(magnitude))); }

std::string power_of_ten(int exponent) {
  constexpr std::array<const char*, 10> kDigits = {"⁰", "¹", "²", "³", "⁴",
                                                   "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = exponent < 0 ? "10⁻" : "10";
  for (const char digit : std::to_string(std::abs(exponent))) {
    text += kDigits[static_cast<std::size_t>(digit - '0')];
  }
  return text;
}

std::string fixed(double value, int num_decimals) {
  char text[64];
  (void)std::snprintf(text, sizeof text, "%.*f", num_decimals, std::abs(value));
  return (value < 0.0 ? "−" : "") + std::string(text);
}

// 1, 2 or 5 times a power of ten.
struct Step {
  int digit = 1;
  int exponent = 0;
  [[nodiscard]] double size() const { return decimal(digit, exponent); }
  [[nodiscard]] Step previous() const {
    return digit == 1 ? Step{5, exponent - 1} : Step{digit == 5 ? 2 : 1, exponent};
  }
};

// The smallest that is not less than `size` > 0.
Step step_not_less(double size) {
  Step step{1, exponent_of(size)};
  for (const int digit : {1, 2, 5, 10}) {
    step.digit = digit;
    if (step.size() * (1.0 + kRounding) >= size) break;
  }
  return step.digit == 10 ? Step{1, step.exponent + 1} : step;
}

// Whether values up to `largest` > 0 are better read with a power of ten.
bool needs_power(double largest) { return largest < 0.999e-3 || largest > 0.999e6; }

}  // namespace

ChartAxis::ChartAxis(std::span<const double> values, bool is_log, int max_ticks) : is_log_(is_log) {
  double min = is_log ? 1.0 : 0.0;
  double max = is_log ? 10.0 : 1.0;
  bool any = false;
  bool integers_only = true;
  for (const double value : values) {
    if (!can_show(value, is_log)) continue;
    min = any ? std::min(min, value) : value;
    max = any ? std::max(max, value) : value;
    integers_only = integers_only && value == std::floor(value);
    any = true;
  }
  if (!is_log) {
    make_linear(min, max, any && integers_only, max_ticks);
  } else {
    make_log(min, max, max_ticks);
  }
}

bool ChartAxis::can_show(double value, bool is_log) {
  return std::abs(value) <= kLargest && (!is_log || value >= 1.0 / kLargest);
}

double ChartAxis::position(double value) const {
  const double from_lower =
      is_log_ ? (std::log10(value) - std::log10(lower_)) / (std::log10(upper_) - std::log10(lower_))
              : (value - lower_) / (upper_ - lower_);
  return std::clamp(from_lower, 0.0, 1.0);
}

void ChartAxis::make_linear(double min, double max, bool integers_only, int max_ticks) {
  const double largest = std::max(std::abs(min), std::abs(max));
  if (max - min <= 1e-10 * largest || largest < 1.0 / kLargest) {  // all equal
    const double around = largest < 1.0 / kLargest ? 1.0 : 0.05 * largest;
    min -= around;
    max += around;
  }
  Step step = step_not_less((max - min) / std::max(1, max_ticks - 1));
  if (integers_only && step.exponent < 0) step = {1, 0};
  const double size = step.size();
  const double first = std::floor(min / size + kRounding);
  const double last = std::ceil(max / size - kRounding);
  const double end = std::max(std::abs(first), std::abs(last)) * size;
  const int power = needs_power(end) ? exponent_of(end * (1.0 + kRounding)) : 0;
  for (double i = first; i <= last; ++i) {
    const double digits = i * step.digit;
    std::string label =
        fixed(decimal(digits, step.exponent - power), std::max(0, power - step.exponent));
    if (i == 0.0) {
      label = "0";
    } else if (power != 0) {
      label += "×" + power_of_ten(power);
    }
    ticks_.push_back({decimal(digits, step.exponent), label});
  }
  lower_ = ticks_.front().value;
  upper_ = ticks_.back().value;
}

void ChartAxis::make_log(double min, double max, int max_ticks) {
  const double num_decades = std::log10(max) - std::log10(min);
  if (num_decades > max_ticks) return make_many_decades(min, max, max_ticks);
  const bool all_equal = num_decades < kRounding;
  Step lower = step_not_less(min);
  if (all_equal || lower.size() > min * (1.0 + kRounding)) lower = lower.previous();
  const Step upper = step_not_less(all_equal ? 1.1 * max : max);
  lower_ = lower.size();
  upper_ = upper.size();
  const bool label_all_steps = num_decades <= 2.5;
  const bool powers = needs_power(lower_) || needs_power(upper_);
  for (int exponent = lower.exponent; exponent <= upper.exponent; ++exponent) {
    for (int digit = 1; digit < 10; ++digit) {
      const bool is_before = exponent == lower.exponent && digit < lower.digit;
      const bool is_beyond = exponent == upper.exponent && digit > upper.digit;
      if (is_before || is_beyond) continue;
      const double value = decimal(digit, exponent);
      std::string label;
      if (digit == 1 || (label_all_steps && (digit == 2 || digit == 5))) {
        label = powers ? (digit == 1 ? "" : std::to_string(digit) + "×") + power_of_ten(exponent)
                       : fixed(value, std::max(0, -exponent));
      }
      ticks_.push_back({value, label});
    }
  }
}

void ChartAxis::make_many_decades(double min, double max, int max_ticks) {
  const Step step = step_not_less((std::log10(max) - std::log10(min)) / std::max(1, max_ticks - 1));
  const int stride = std::max(1, static_cast<int>(step.size()));
  const int first = stride * static_cast<int>(std::floor(std::log10(min) / stride + kRounding));
  const int last = stride * static_cast<int>(std::ceil(std::log10(max) / stride - kRounding));
  for (int exponent = first; exponent <= last; ++exponent) {
    const bool has_label = exponent % stride == 0;
    if (!has_label && stride > 10) continue;
    ticks_.push_back({decimal(1.0, exponent), has_label ? power_of_ten(exponent) : ""});
  }
  lower_ = ticks_.front().value;
  upper_ = ticks_.back().value;
}

}  // namespace sopt
