#include "tools/io/json_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace sopt {
namespace {

using Json = nlohmann::ordered_json;

TEST(JsonText, NumbersComeBackBitByBit) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> mantissa(-1.0, 1.0);
  std::uniform_int_distribution<int> exponent(-300, 300);
  for (int i = 0; i < 10000; ++i) {
    const double number = std::ldexp(mantissa(random), exponent(random));
    ASSERT_EQ(Json::parse(to_text(Json(number))).get<double>(), number);
  }
}

TEST(JsonText, WritesSeventeenDigits) {
  EXPECT_EQ(to_text(Json(0.1)), "0.10000000000000001\n");
  EXPECT_EQ(to_text(Json(1.0 / 3.0)), "0.33333333333333331\n");
}

TEST(JsonText, WhatIsNotFiniteIsNull) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(to_text(Json{{"a", infinity}, {"b", -infinity}, {"c", std::nan("")}}),
            "{\n  \"a\": null,\n  \"b\": null,\n  \"c\": null\n}\n");
}

TEST(JsonText, FieldsAndRowsStandOnLinesOfTheirOwn) {
  const Json document = {{"n", 3},
                         {"rows", {{1, 2}, {3, 4}}},
                         {"flat", {1, 2}},
                         {"none", Json::array()},
                         {"inner", {{"x", "\"q\""}, {"y", nullptr}}}};
  EXPECT_EQ(to_text(document),
            "{\n"
            "  \"n\": 3,\n"
            "  \"rows\": [\n    [1, 2],\n    [3, 4]\n  ],\n"
            "  \"flat\": [1, 2],\n"
            "  \"none\": [],\n"
            "  \"inner\": {\"x\": \"\\\"q\\\"\", \"y\": null}\n"
            "}\n");
}

}  // namespace
}  // namespace sopt
