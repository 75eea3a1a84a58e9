#include "tools/io/json_fields.h"

#include <string>

#include "tests/tools/temporary_folder.h"
#include "tools/io/input_error.h"
#include "tools/io/input_text.h"

namespace sopt {
namespace {

class JsonFieldsTest : public TemporaryFolderTest {
 protected:
  // What load_json says, without the folder; "" when it loads.
  [[nodiscard]] std::string refusal(const std::string& name) const {
    try {
      (void)load_json(folder() / name);
      return "";
    } catch (const InputError& error) {
      const std::string line = error.what();
      const std::string prefix = folder().string() + '/';
      return line.rfind(prefix, 0) == 0 ? line.substr(prefix.size()) : line;
    }
  }
};

TEST_F(JsonFieldsTest, LoadsWhatItShould) {
  const nlohmann::json json = load_json(write(
      "good", R"({"a": [1, -2, 2.5, 1e300, true, null, "\u00e9"], "b": {"c": {}, "d": []}})"));
  EXPECT_EQ(json, nlohmann::json::parse(
                      R"({"a": [1, -2, 2.5, 1e300, true, null, "é"], "b": {"c": {}, "d": []}})"));
  EXPECT_EQ(load_json(write("scalar", " 7 ")), 7);
}

TEST_F(JsonFieldsTest, DepthHasALimitAndTheLimitIsAllowed) {
  const auto nested = [](int depth) {
    const auto n = static_cast<std::size_t>(depth);
    return std::string(n, '[') + std::string(n, ']');
  };
  write("at", nested(kMaxJsonDepth));
  write("above", nested(kMaxJsonDepth + 1));
  EXPECT_EQ(refusal("at"), "");
  EXPECT_EQ(refusal("above"), "above: is nested deeper than 32 levels, the limit");
}

TEST_F(JsonFieldsTest, SizeHasALimit) {
  write("big", "");
  std::filesystem::resize_file(folder() / "big", kMaxInputSize_B + (std::size_t{1} << 20U));
  EXPECT_EQ(refusal("big"), "big: is 65 MiB; it must be at most 64 MiB");
}

TEST_F(JsonFieldsTest, SpacesUpToTheLimitAreAllowed) {
  write("wide", '1' + std::string(kMaxInputSize_B - 1, ' '));
  EXPECT_EQ(refusal("wide"), "");
}

TEST_F(JsonFieldsTest, WhatCannotBeReadIsNamed) {
  EXPECT_EQ(refusal("absent"), "absent: cannot be read: No such file or directory");
  std::filesystem::create_directory(folder() / "folder");
  EXPECT_EQ(refusal("folder"), "folder: is a directory; it must be a JSON file");
}

TEST_F(JsonFieldsTest, ErrorsSayWhereInTheDocument) {
  write("overflow", R"({"a": [0, {"b c": [1, 1e400]}]})");
  EXPECT_EQ(refusal("overflow"), "overflow: a[1].\"b c\"[1] is 1e400; it must be a finite number");
  write("twice", R"({"a": {"b": 1}, "c": {"b": 1, "d": {"e": 1, "e": 2}}})");
  EXPECT_EQ(refusal("twice"), "twice: c.d.e appears twice; it must be unique");
  write("same", R"([{"a": 1}, {"a": 1}])");
  EXPECT_EQ(refusal("same"), "");
}

TEST_F(JsonFieldsTest, ErrorsStayShortAndOnOneLine) {
  write("long", '"' + std::string(100000, 'x'));
  EXPECT_LT(refusal("long").size(), 300U);
  write("odd\nname", "[");
  EXPECT_EQ(refusal("odd\nname").find('\n'), std::string::npos);
}

TEST_F(JsonFieldsTest, PrintableEscapesAndCuts) {
  EXPECT_EQ(printable("a\nb\x1b[31m\x7f"), "a\\x0ab\\x1b[31m\\x7f");
  EXPECT_EQ(printable("abcdef", 3), "abc...");
  EXPECT_EQ(printable("\xc3\xa9\xc3\xa9", 3), "\xc3\xa9\xc3\xa9");  // cut between characters only
  EXPECT_EQ(printable("\xc3\xa9\xc3\xa9", 2), "\xc3\xa9...");
}

TEST_F(JsonFieldsTest, FieldNamesAreQuotedWhereNeeded) {
  EXPECT_EQ(field_name("v_max"), "v_max");
  EXPECT_EQ(field_name(""), "\"\"");
  EXPECT_EQ(field_name("a.b"), "\"a.b\"");
}

}  // namespace
}  // namespace sopt
