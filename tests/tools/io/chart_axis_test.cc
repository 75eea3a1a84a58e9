#include "tools/io/chart_axis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace sopt {
namespace {

std::vector<std::string> labels(const ChartAxis& axis) {
  std::vector<std::string> result;
  for (const Tick& tick : axis.ticks()) {
    if (!tick.label.empty()) result.push_back(tick.label);
  }
  return result;
}

void expect_covers(const ChartAxis& axis, double min, double max) {
  const double slack = 1e-6 * (axis.upper() - axis.lower());
  EXPECT_TRUE(std::isfinite(axis.lower()) && std::isfinite(axis.upper()));
  EXPECT_LT(axis.lower(), axis.upper());
  EXPECT_LE(axis.lower(), min + slack);
  EXPECT_GE(axis.upper(), max - slack);
  ASSERT_GE(axis.ticks().size(), 2U);
  EXPECT_EQ(axis.ticks().front().value, axis.lower());
  EXPECT_EQ(axis.ticks().back().value, axis.upper());
  EXPECT_TRUE(std::is_sorted(axis.ticks().begin(), axis.ticks().end(),
                             [](const Tick& a, const Tick& b) { return a.value < b.value; }));
}

TEST(ChartAxis, HasStepsOfOneTwoOrFive) {
  EXPECT_EQ(labels(ChartAxis(std::array{0.0, 1.0}, false, 6)),
            (std::vector<std::string>{"0", "1"}));  // integers
  EXPECT_EQ(labels(ChartAxis(std::array{0.0, 0.5, 1.0}, false, 6)),
            (std::vector<std::string>{"0", "0.2", "0.4", "0.6", "0.8", "1.0"}));
  EXPECT_EQ(labels(ChartAxis(std::array{51.2, 58.7}, false, 6)),
            (std::vector<std::string>{"50", "52", "54", "56", "58", "60"}));
  EXPECT_EQ(labels(ChartAxis(std::array{-0.03, 0.11}, false, 5)),
            (std::vector<std::string>{"−0.05", "0", "0.05", "0.10", "0.15"}));
}

TEST(ChartAxis, CoversRandomRangesWithNiceTicks) {
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> exponent(-20.0, 20.0);
  std::uniform_real_distribution<double> mantissa(-1.0, 1.0);
  for (int i = 0; i < 2000; ++i) {
    const double scale = std::pow(10.0, exponent(generator));
    const std::array values = {scale * mantissa(generator), scale * mantissa(generator)};
    const auto [min, max] = std::minmax(values[0], values[1]);
    const int max_ticks = 3 + i % 9;
    const ChartAxis axis(values, false, max_ticks);
    SCOPED_TRACE(testing::Message() << min << " to " << max << ", " << max_ticks << " ticks");
    expect_covers(axis, min, max);
    EXPECT_LE(axis.ticks().size(), static_cast<std::size_t>(max_ticks) + 1);
    const double step = axis.ticks()[1].value - axis.ticks()[0].value;
    const double digit = step / std::pow(10.0, std::floor(std::log10(step) + 1e-6));
    EXPECT_LT(std::min({std::abs(digit - 1), std::abs(digit - 2), std::abs(digit - 5)}), 1e-4);
    for (std::size_t k = 0; k < axis.ticks().size(); ++k) {
      EXPECT_NEAR(axis.ticks()[k].value, axis.lower() + static_cast<double>(k) * step, 1e-6 * step);
    }
    if (std::abs(min) + std::abs(max) > 0.1 && std::abs(min) + std::abs(max) < 1e5) {
      for (const Tick& tick : axis.ticks()) {
        const bool is_negative = tick.label.starts_with("−");
        const double size = std::stod(is_negative ? tick.label.substr(3) : tick.label);
        EXPECT_NEAR(is_negative ? -size : size, tick.value, 1e-6 * step) << tick.label;
      }
    }
  }
}

TEST(ChartAxis, HasNoTicksBetweenIntegers) {
  EXPECT_EQ(labels(ChartAxis(std::array{0.0, 1.0, 2.0, 3.0}, false, 20)),
            (std::vector<std::string>{"0", "1", "2", "3"}));
  EXPECT_EQ(labels(ChartAxis(std::array{7.0}, false, 8)),
            (std::vector<std::string>{"6", "7", "8"}));
}

TEST(ChartAxis, WidensRangesOfOneValue) {
  for (const double value : {0.3, -4e-7, 123456.789, 1e299, 0.0}) {
    for (const bool is_log : {false, true}) {
      if (!ChartAxis::can_show(value, is_log)) continue;
      const ChartAxis axis(std::array{value, value}, is_log, 6);
      expect_covers(axis, value, value);
      EXPECT_GT(axis.position(value), 0.1) << value;
      EXPECT_LT(axis.position(value), 0.9) << value;
    }
  }
  const double next = std::nextafter(0.3, 1.0);
  expect_covers(ChartAxis(std::array{0.3, next}, false, 6), 0.3, next);
}

TEST(ChartAxis, LabelsDecades) {
  EXPECT_EQ(labels(ChartAxis(std::array{0.003, 400.0}, true, 9)),
            (std::vector<std::string>{"0.01", "0.1", "1", "10", "100"}));
  EXPECT_EQ(labels(ChartAxis(std::array{2e-6, 0.3}, true, 9)),
            (std::vector<std::string>{"10⁻⁵", "10⁻⁴", "10⁻³", "10⁻²", "10⁻¹"}));
  const ChartAxis axis(std::array{0.003, 400.0}, true, 9);
  EXPECT_EQ(axis.lower(), 0.002);
  EXPECT_EQ(axis.upper(), 500.0);
  EXPECT_EQ(std::count_if(axis.ticks().begin(), axis.ticks().end(),
                          [](const Tick& tick) { return tick.value > 1.5 && tick.value < 9.5; }),
            8);
}

TEST(ChartAxis, LabelsTwoAndFiveOverFewDecades) {
  EXPECT_EQ(labels(ChartAxis(std::array{50.0, 3000.0}, true, 9)),
            (std::vector<std::string>{"50", "100", "200", "500", "1000", "2000", "5000"}));
  EXPECT_EQ(labels(ChartAxis(std::array{3e-5, 8e-5}, true, 9)),
            (std::vector<std::string>{"2×10⁻⁵", "5×10⁻⁵", "10⁻⁴"}));
  EXPECT_EQ(labels(ChartAxis(std::array{10.0}, true, 9)),
            (std::vector<std::string>{"5", "10", "20"}));
}

TEST(ChartAxis, LabelsEveryFewDecadesOverVeryMany) {
  EXPECT_EQ(labels(ChartAxis(std::array{1e-9, 1e9}, true, 6)),
            (std::vector<std::string>{"10⁻¹⁰", "10⁻⁵", "10⁰", "10⁵", "10¹⁰"}));
  const ChartAxis axis(std::array{1e-300, 1e300}, true, 8);
  expect_covers(axis, 1e-300, 1e300);
  EXPECT_LE(axis.ticks().size(), 9U);
}

TEST(ChartAxis, PlacesLogarithmsEvenly) {
  const ChartAxis axis(std::array{1.0, 10000.0}, true, 8);
  EXPECT_EQ(axis.position(1.0), 0.0);
  EXPECT_NEAR(axis.position(10.0), 0.25, 1e-12);
  EXPECT_NEAR(axis.position(1000.0), 0.75, 1e-12);
  EXPECT_EQ(axis.position(10000.0), 1.0);
}

TEST(ChartAxis, WritesVeryLargeAndSmallNumbersWithPowersOfTen) {
  EXPECT_EQ(labels(ChartAxis(std::array{0.0, 3e7}, false, 4)),
            (std::vector<std::string>{"0", "1×10⁷", "2×10⁷", "3×10⁷"}));
  EXPECT_EQ(labels(ChartAxis(std::array{-1e-12, 1e-12}, false, 3)),
            (std::vector<std::string>{"−1×10⁻¹²", "0", "1×10⁻¹²"}));
  EXPECT_EQ(labels(ChartAxis(std::array{0.0, 200000.0}, false, 3)),
            (std::vector<std::string>{"0", "100000", "200000"}));
}

TEST(ChartAxis, IgnoresWhatItCannotShow) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const ChartAxis linear(std::array{nan, 1.5, kInf, 3.0, -kInf, 1e301}, false, 5);
  EXPECT_EQ(linear.lower(), 1.5);
  EXPECT_EQ(linear.upper(), 3.0);
  const ChartAxis log(std::array{0.0, -5.0, 10.0, nan, 100.0, kInf}, true, 5);
  EXPECT_EQ(log.lower(), 10.0);
  EXPECT_EQ(log.upper(), 100.0);
  EXPECT_EQ(ChartAxis({}, false, 5).upper(), 1.0);
  EXPECT_EQ(ChartAxis(std::array{-1.0}, true, 5).upper(), 10.0);
  expect_covers(ChartAxis(std::array{-1e300, 1e300}, false, 6), -1e300, 1e300);
}

}  // namespace
}  // namespace sopt
