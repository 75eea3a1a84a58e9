#include "tools/bench/bench_scaling_command.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "tests/tools/temporary_folder.h"
#include "tools/io/input_error.h"

namespace sopt {
namespace {

class BenchScalingCommandTest : public TemporaryFolderTest {
 protected:
  // The exit code; -1: the arguments were refused.
  static int run(const std::string& arguments) {
    CLI::App app;
    int exit_code = -1;
    add_bench_scaling_command(app, exit_code);
    testing::internal::CaptureStdout();
    try {
      app.parse("scaling " + arguments);
    } catch (const CLI::ParseError&) {
      exit_code = -1;
    } catch (const InputError&) {
      exit_code = 2;
    }
    output() = testing::internal::GetCapturedStdout();
    return exit_code;
  }
  static std::string& output() {
    static std::string text;
    return text;
  }
};

TEST_F(BenchScalingCommandTest, WritesFiguresAndAChartOfEachFamily) {
  const std::string json = (folder() / "scaling.json").string();
  EXPECT_EQ(run("--families maze,field --max-size 50 --seeds 2 --repeat 1 --json " + json +
                " --svg-dir " + folder().string()),
            0);
  EXPECT_EQ(files(),
            (std::set<std::string>{"scaling.json", "scaling_maze.svg", "scaling_field.svg"}));
  const auto document = nlohmann::json::parse(read_file(json));
  EXPECT_EQ(document["cases_failed"], 0);
  ASSERT_EQ(document["families"].size(), 2U);
  EXPECT_EQ(document["families"][0]["family"], "maze");
  EXPECT_EQ(document["families"][0]["cases"].size(), 2U);
  EXPECT_EQ(document["families"][1]["cases"].size(), 4U);
  EXPECT_NE(output().find("field: growth with the number of obstacles"), std::string::npos);
  EXPECT_EQ(output().find("corridor"), std::string::npos);
}

TEST_F(BenchScalingCommandTest, AnswersOneWhenThereIsNoPlan) {
  EXPECT_EQ(run("--families corridor --max-size 100 --seeds 1 --samples 1"), 1);
  EXPECT_NE(output().find("first path over steps: no plans\n"), std::string::npos);
}

TEST_F(BenchScalingCommandTest, RefusesWhatItDoesNotKnow) {
  EXPECT_EQ(run("--families corridor,forest"), -1);
  EXPECT_EQ(run("--clock sundial"), -1);
  EXPECT_EQ(run("--seeds 0"), -1);
  EXPECT_EQ(run("--max-size 49"), -1);
  EXPECT_EQ(run("--svg-dir " + (folder() / "missing").string()), 2);
}

}  // namespace
}  // namespace sopt
