#include "tools/cli/option_checks.h"

#include <gtest/gtest.h>

namespace sopt {
namespace {

TEST(OptionChecks, NumbersAreReadWholeAndInRange) {
  const OptionCheck check = number_check(kPositive);
  for (const char* text : {"1", "0.5", "1e-9", "1e6"}) EXPECT_EQ(check(text), "") << text;
  for (const char* text : {"", " ", "0", "-1", "1x", " 1", "nan", "inf", "1e7", "1e999", "0x10"}) {
    EXPECT_NE(check(text), "") << text;
  }
  EXPECT_EQ(check("0"), "\"0\" is not allowed; it must be a number > 0, from 1e-9 to 1e6");
}

TEST(OptionChecks, IntegersAreReadWholeAndInRange) {
  const OptionCheck check = integer_check(1, 16);
  EXPECT_EQ(check("1"), "");
  EXPECT_EQ(check("16"), "");
  for (const char* text : {"", "0", "17", "-1", "1.0", "1e1", "99999999999999999999"}) {
    EXPECT_NE(check(text), "") << text;
  }
  EXPECT_EQ(check("17"), "\"17\" is not allowed; it must be an integer from 1 to 16");
}

TEST(OptionChecks, AWordCanStandForANumber) {
  const OptionCheck check = integer_or_word_check(1, 9, "auto");
  EXPECT_EQ(check("auto"), "");
  EXPECT_EQ(check("9"), "");
  EXPECT_EQ(check("Auto"),
            "\"Auto\" is not allowed; it must be an integer from 1 to 9 or \"auto\"");
}

TEST(OptionChecks, WordsAreListed) {
  const OptionCheck check = word_check({"scale", "off"});
  EXPECT_EQ(check("off"), "");
  EXPECT_EQ(check("on"), "\"on\" is not allowed; it must be one of \"scale\", \"off\"");
}

TEST(OptionChecks, FilesHaveAName) {
  EXPECT_EQ(file_check()("a"), "");
  EXPECT_EQ(file_check()(""), "\"\" is not allowed; it must be a file name");
}

}  // namespace
}  // namespace sopt
