#include "tools/bench/bench_command.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tools/io/input_error.h"

namespace sopt {
namespace {

const std::filesystem::path kFolder(SOPT_SOURCE_DIR);
const std::string kPlane = (kFolder / "tests/data/three_obstacles.json").string();
const std::string kArm = (kFolder / "tools/scenes/arm/arm_2_01.json").string();

struct BenchCommandRun {
  std::string out;
  std::string error;  // what was refused
};

BenchCommandRun run(const std::string& arguments) {
  CLI::App app;
  int exit_code = 0;
  add_bench_command(app, exit_code);
  BenchCommandRun result;
  testing::internal::CaptureStdout();
  try {
    app.parse("bench " + arguments);
  } catch (const InputError& error) {
    result.error = error.what();
  }
  result.out = testing::internal::GetCapturedStdout();
  return result;
}

TEST(BenchCommandTest, RefusesScenesBeforeItPrintsAnything) {
  for (const std::string command :
       {"plan --seeds 1 ", "plan --by-segments --seeds 1 ", "improve --budgets-ms 0 --seeds 1 "}) {
    const BenchCommandRun mixed = run(command + kPlane + ' ' + kArm);
    EXPECT_NE(mixed.error.find("must be measured apart"), std::string::npos) << mixed.error;
    EXPECT_EQ(mixed.out, "") << command;
    const BenchCommandRun good = run(command + kPlane);
    EXPECT_EQ(good.error, "");
    EXPECT_NE(good.out.find("\n1 scenes x 1 seeds"), std::string::npos) << good.out;
  }
}

}  // namespace
}  // namespace sopt
