// Every rule for input has a case in tests/data/bad_*.json: what is wrong, and the one line that
// `sopt` answers. Exit code 2, nothing on stdout, no file written.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "tests/system/program.h"

namespace sopt {
namespace {

using nlohmann::json;

// A case by its place in its file, so that the names of tests are known before any file is read.
struct BadCase {
  std::string name;
  std::size_t index = 0;
};
std::ostream& operator<<(std::ostream& out, const BadCase& bad) { return out << bad.name; }

json read_table(const char* file) {
  std::ifstream in(std::filesystem::path(SOPT_SOURCE_DIR) / "tests/data" / file);
  return json::parse(in);
}

std::vector<BadCase> read_cases(const char* file) {
  const json cases = read_table(file);
  std::vector<BadCase> names;
  for (std::size_t i = 0; i < cases.size(); ++i) names.push_back({cases[i]["case"], i});
  return names;
}

std::string name_of(const ::testing::TestParamInfo<BadCase>& info) { return info.param.name; }

class BadInputTest : public ProgramTest, public ::testing::WithParamInterface<BadCase> {
 protected:
  [[nodiscard]] static json parameters(const char* file) {
    return read_table(file).at(GetParam().index);
  }

  void expect_refused(const std::string& arguments, const std::string& line) {
    const std::set<std::string> before = files();
    const ProgramRun result = run(arguments);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.err, "sopt: " + line + "\n");
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(files(), before);
  }
};

class BadSceneTest : public BadInputTest {};
class BadPlanTest : public BadInputTest {};
class BadUsageTest : public BadInputTest {};

TEST_P(BadSceneTest, IsNamedInOneLine) {
  const json bad = parameters("bad_scenes.json");
  write("scene.json", json::parse(good_scene()).patch(bad["patch"]).dump());
  expect_refused("plan scene.json -o plan.json --svg plan.svg --csv plan.csv",
                 "scene.json: " + bad["line"].get<std::string>());
}

TEST_P(BadPlanTest, IsNamedInOneLine) {
  const json bad = parameters("bad_plans.json");
  const json good = json::parse(read_file(data_file("three_obstacles_plan.json")));
  write("scene.json", good_scene());
  write("plan.json", good.patch(bad["patch"]).dump());
  expect_refused("verify scene.json plan.json --json answer.json",
                 "plan.json: " + bad["line"].get<std::string>());
}

TEST_P(BadUsageTest, IsNamedInOneLine) {
  const json bad = parameters("bad_usage.json");
  write("scene.json", good_scene());
  write("plan.json", read_file(data_file("three_obstacles_plan.json")));
  expect_refused(bad["arguments"], bad["line"]);
}

INSTANTIATE_TEST_SUITE_P(Rules, BadSceneTest, ::testing::ValuesIn(read_cases("bad_scenes.json")),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Rules, BadPlanTest, ::testing::ValuesIn(read_cases("bad_plans.json")),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Rules, BadUsageTest, ::testing::ValuesIn(read_cases("bad_usage.json")),
                         name_of);

// --- what no patch can say

class BadTextTest : public ProgramTest {
 protected:
  void expect_refused(const std::string& text, const std::string& problem) {
    write("scene.json", text);
    const ProgramRun result = run("plan scene.json -o plan.json --svg plan.svg --csv plan.csv");
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.err, "sopt: scene.json: " + problem + "\n");
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(files(), std::set<std::string>{"scene.json"});
  }
  static std::string repeated(const char* text, std::size_t count) {
    std::string result;
    for (std::size_t i = 0; i < count; ++i) result += text;
    return result;
  }
};

TEST_F(BadTextTest, EmptyFile) { expect_refused("", "is empty; it must be a JSON object"); }

TEST_F(BadTextTest, TruncatedFile) {
  expect_refused(R"({"name": "cut", "robot": "poi)",
                 "not valid JSON: line 1, column 30: syntax error while parsing value - invalid "
                 "string: missing closing quote; last read: '\"poi'");
}

TEST_F(BadTextTest, EveryTruncationIsRefusedWithoutACrash) {
  const std::string whole = nlohmann::json::parse(good_scene()).dump();
  for (std::size_t length = 1; length < whole.size(); length += 17) {
    write("scene.json", whole.substr(0, length));
    const ProgramRun result = run("plan scene.json -o plan.json");
    ASSERT_EQ(result.exit_code, 2) << length;
    ASSERT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    ASSERT_EQ(files(), std::set<std::string>{"scene.json"});
  }
}

TEST_F(BadTextTest, TwoDocuments) {
  expect_refused("{} {}",
                 "not valid JSON: line 1, column 4: syntax error while parsing value - "
                 "unexpected '{'; expected end of input");
}

TEST_F(BadTextTest, NotAnObject) {
  expect_refused("[1, 2]", "the file is [1,2]; it must be an object");
}

TEST_F(BadTextTest, NanIsNotJson) {
  expect_refused(R"({"radius": NaN})",
                 "not valid JSON: line 1, column 12: syntax error while parsing value - invalid "
                 "literal; last read: '\"radius\": N'");
}

TEST_F(BadTextTest, NumberThatOverflows) {
  expect_refused(R"({"obstacles": [{}, {"radius": -1e999}]})",
                 "obstacles[1].radius is -1e999; it must be a finite number");
}

TEST_F(BadTextTest, FieldTwice) {
  expect_refused(R"({"obstacles": [[], {"a": {}, "radius": 1, "radius": 2}]})",
                 "obstacles[1].radius appears twice; it must be unique");
}

TEST_F(BadTextTest, NotUtf8) {
  expect_refused("{\"name\": \"\xff\"}",
                 "not valid JSON: line 1, column 11: syntax error while parsing value - invalid "
                 "string: ill-formed UTF-8 byte; last read: '\"\xff'");
}

TEST_F(BadTextTest, DeepArrays) {
  expect_refused(repeated("[", 1000000), "is nested deeper than 32 levels, the limit");
}

TEST_F(BadTextTest, DeepObjectsInAnIgnoredField) {
  expect_refused(R"({"x_deep": )" + repeated(R"({"a": )", 200000),
                 "is nested deeper than 32 levels, the limit");
}

TEST_F(BadTextTest, TooManyValues) {
  expect_refused('[' + repeated("0,", std::size_t{1} << 22U) + "0]",
                 "holds more than 4194304 values, the limit");
}

TEST_F(BadTextTest, TooManyObstacles) {
  nlohmann::json scene = nlohmann::json::parse(good_scene());
  scene["obstacles"] = std::vector<nlohmann::json>(8193, scene["obstacles"][0]);
  expect_refused(scene.dump(),
                 "obstacles has 8193 elements; it must be an array of at most 8192 obstacles");
}

TEST_F(BadTextTest, TooManyVertices) {
  nlohmann::json scene = nlohmann::json::parse(good_scene());
  nlohmann::json polygon = {{"type", "polygon"}, {"vertices", nlohmann::json::array()}};
  for (int i = 0; i < 16; ++i) {
    polygon["vertices"].push_back({std::cos(0.39 * i), std::sin(0.39 * i)});
  }
  scene["obstacles"] = std::vector<nlohmann::json>(4097, polygon);
  expect_refused(scene.dump(),
                 "obstacles[4096].vertices is one too many; it must be among at most "
                 "65536 vertices, every obstacle's rounded up to a multiple of 4");
}

TEST_F(BadTextTest, HugeFileIsRefused) {
  write("scene.json", "{");
  std::filesystem::resize_file(folder() / "scene.json", std::uintmax_t{100} << 20U);  // sparse
  const ProgramRun result = run("plan scene.json -o plan.json");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.err, "sopt: scene.json: is 100 MiB; it must be at most 64 MiB\n");
  EXPECT_EQ(files(), std::set<std::string>{"scene.json"});
}

TEST_F(BadTextTest, EndlessPipeIsRefused) {
  const ProgramRun result = run("plan <(yes) -o plan.json");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find(": is larger than allowed; it must be at most 64 MiB\n"),
            std::string::npos)
      << result.err;
  EXPECT_EQ(files(), std::set<std::string>{});
}

}  // namespace
}  // namespace sopt
