#include "tools/bench/bench_qp_files.h"

#include <filesystem>
#include <string>
#include <vector>

#include "tests/tools/temporary_folder.h"
#include "tools/io/qp_file.h"

namespace sopt {
namespace {

// min x'x + ..., x0 + x1 = 1: the optimum is (1/2, 1/2).
constexpr const char* kTiny =
    "QP1 tiny\n2 1 1\nH 2\n0 0 2\n1 1 2\nf 0 0\nA 2\n0 0 1\n0 1 1\nlA 1\nuA 1\nlb -1e20 -1e20\n"
    "ub 1e20 1e20\nfstar 0.5\n";
constexpr const char* kNoRows = "QP1 no rows\n1 0 0\nH 1\n0 0 2\nf -4\nA 0\nlA\nuA\nlb 0\nub 1\n";
constexpr const char* kContradiction =
    "QP1 contradiction\n1 2 0\nH 1\n0 0 2\nf 0\nA 2\n0 0 1\n1 0 1\nlA 2 -1e20\nuA 1e20 1\n"
    "lb -1e20\nub 1e20\n";

using BenchQpFilesTest = TemporaryFolderTest;

TEST_F(BenchQpFilesTest, ComparesWithTheYardstick) {
  const QpProblem problem = load_qp(write("tiny.qp", kTiny));
  ManualClock ticking(1000);
  const BenchQpFile file = bench_qp_file(problem, 3, ticking.clock());
  EXPECT_EQ(file.name, "tiny");
  EXPECT_EQ(file.num_variables, 2);
  EXPECT_EQ(file.num_rows, 1);
  EXPECT_EQ(file.num_steps, 1);
  EXPECT_EQ(file.status, QpStatus::kOptimal);
  EXPECT_DOUBLE_EQ(file.time_us, 0.01);  // of 100 solves between two readings
  EXPECT_DOUBLE_EQ(file.yardstick_us, 0.01);
  EXPECT_DOUBLE_EQ(file.ratio, 1.0);
  ASSERT_TRUE(file.objective_error);
  EXPECT_LE(*file.objective_error, 1e-14);
  EXPECT_LE(file.violation, 1e-14);
  const std::string text = describe({file});
  EXPECT_NE(text.find("1 files, 0 failed; ratio median 1.00, worst 1.00"), std::string::npos)
      << text;
  EXPECT_EQ(to_json({file})["files"][0]["ratio"], 1.0);
}

TEST_F(BenchQpFilesTest, TakesProblemsWithoutRowsOrOptimum) {
  const QpProblem problem = load_qp(write("no_rows.qp", kNoRows));
  const BenchQpFile file = bench_qp_file(problem, 2, thread_cpu_clock());
  EXPECT_EQ(file.status, QpStatus::kOptimal);
  EXPECT_FALSE(file.objective_error);
  EXPECT_GT(file.ratio, 0.0);
  EXPECT_FALSE(to_json({file})["files"][0].contains("objective_error"));
}

TEST_F(BenchQpFilesTest, SaysWhatFailed) {
  const QpProblem problem = load_qp(write("contradiction.qp", kContradiction));
  const BenchQpFile file = bench_qp_file(problem, 1, thread_cpu_clock());
  EXPECT_EQ(file.status, QpStatus::kInfeasible);
  EXPECT_EQ(num_failures(std::vector<BenchQpFile>{file}), 1);
  EXPECT_NE(describe({file}).find("failed: infeasible"), std::string::npos);
}

}  // namespace
}  // namespace sopt
