// `sopt qp` from outside: what it prints and answers for sound, unsolvable and malformed problems.
#include <cmath>
#include <cstdlib>
#include <string>

#include "tests/system/program.h"

namespace sopt {
namespace {

// (x0 - 1)^2 + (x1 - 2.5)^2 without its constant, x >= 0 and three rows.
// [Nocedal, Wright 2006, example 16.4]
constexpr const char* kTextbook =
    "QP1 textbook\n"
    "2 3 0\n"
    "H 2\n0 0 2\n1 1 2\n"
    "f -2 -5\n"
    "A 6\n0 0 1\n0 1 -2\n1 0 1\n1 1 2\n2 0 -1\n2 1 2\n"
    "lA -2 -1e20 -2\n"
    "uA 1e20 6 1e20\n"
    "lb 0 0\n"
    "ub 1e20 1e20\n";

class QpCliTest : public ProgramTest {
 protected:
  void SetUp() override {
    ProgramTest::SetUp();
    write("good.qp", kTextbook);
  }

  // Writes the textbook problem as bad.qp with `from` replaced, and runs it.
  ProgramRun run_with(const std::string& from, const std::string& to) {
    std::string text = kTextbook;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    write("bad.qp", text.replace(at, from.size(), to));
    return run("qp bad.qp");
  }
  void expect_refused(const ProgramRun& result, const std::string& line) {
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.err, "sopt: " + line + "\n");
    EXPECT_EQ(result.out, "");
  }
};

double number_behind(const std::string& label, const std::string& text) {
  const std::size_t at = text.find(label);
  EXPECT_NE(at, std::string::npos) << text;
  return at == std::string::npos ? std::nan("")
                                 : std::strtod(text.c_str() + at + label.size(), nullptr);
}

TEST_F(QpCliTest, PrintsObjectiveResidualsAndWork) {
  const ProgramRun result = run("qp good.qp");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(result.out.rfind("optimal  textbook: 2 variables, 3 rows, 0 of them equalities\n", 0),
            0U)
      << result.out;
  EXPECT_NEAR(number_behind("\nobjective: ", result.out), -6.45, 1e-13);
  EXPECT_LT(number_behind("\n  residuals     violation ", result.out), 1e-14);
  EXPECT_LT(number_behind("stationarity ", result.out), 1e-14);
  EXPECT_NE(result.out.find("\n  working set   1 changes, 1 active\n"), std::string::npos)
      << result.out;
  EXPECT_EQ(result.out.find("difference"), std::string::npos) << result.out;
  EXPECT_EQ(files(), std::set<std::string>{"good.qp"});
}

TEST_F(QpCliTest, ComparesWithTheOptimumInTheFile) {
  const ProgramRun result = run_with("ub 1e20 1e20\n", "ub 1e20 1e20\nfstar -6.4\nxstar 1.4 1.2\n");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.out.find("\n  difference    -0.05 from fstar, at most 0.5 from xstar\n"),
            std::string::npos)
      << result.out;
}

TEST_F(QpCliTest, NamesTheRowThatCannotHold) {
  const ProgramRun result = run_with("uA 1e20", "uA -3");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(result.out,
            "infeasible  textbook: 2 variables, 3 rows, 0 of them equalities\n"
            "  reason        row 0 (upper) cannot hold together with the others\n"
            "  working set   2 changes, 1 active\n");
}

TEST_F(QpCliTest, NamesTheBoundThatCannotHold) {
  const ProgramRun result = run_with("ub 1e20 1e20", "ub 1e20 -3");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.out.find("bound of variable 1 (lower) cannot hold"), std::string::npos)
      << result.out;
}

TEST_F(QpCliTest, TooFewStepsAreAnAnswer) {
  const ProgramRun result = run("qp good.qp --max-steps 0");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.out.rfind("step_limit  textbook: ", 0), 0U) << result.out;
  EXPECT_EQ(result.out.find("objective: "), std::string::npos) << result.out;
  EXPECT_GT(number_behind("violation ", result.out), 0.1);
}

TEST_F(QpCliTest, ToleranceReachesTheSolver) {
  write("loose.qp", "QP1 loose\n1 0 0\nH 1\n0 0 1\nf 0\nA 0\nlA\nuA\nlb 1e-4\nub 1\n");
  EXPECT_NE(run("qp loose.qp").out.find(" 1 active"), std::string::npos);
  EXPECT_NE(run("qp loose.qp --tolerance 1e-3").out.find(" 0 active"), std::string::npos);
}

TEST_F(QpCliTest, MalformedFileIsNamedInOneLine) {
  expect_refused(run_with("1 1 2\nf", "0 1 2\nf"),
                 "bad.qp: line 5: H[1].column is \"1\"; it must be an integer from 0 to 0, its "
                 "row: only the lower triangle is given");
  expect_refused(run_with("1 1 2\nf", "1 1 -2\nf"),
                 "bad.qp: H is not positive definite; it must be, by more than rounding");
  expect_refused(run("qp absent.qp"), "absent.qp: cannot be read: No such file or directory");
  expect_refused(run("qp ."), ".: is a directory; it must be a QP1 file");
  expect_refused(run("qp /dev/null"),
                 "/dev/null: line 1: the format is missing; it must be \"QP1\"");
}

TEST_F(QpCliTest, WrongUsageIsNamedInOneLine) {
  expect_refused(run("qp"), "FILE is required (see sopt qp --help)");
  expect_refused(run("qp good.qp --max-steps -1"),
                 "--max-steps: \"-1\" is not allowed; it must be an integer from 0 to 1000000000 "
                 "(see sopt qp --help)");
  expect_refused(run("qp good.qp --tolerance 0"),
                 "--tolerance: \"0\" is not allowed; it must be a number from 1e-15 to 1e-3 (see "
                 "sopt qp --help)");
}

TEST_F(QpCliTest, EndlessPipeIsRefused) {
  const ProgramRun result = run("qp <(yes)");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find(": is larger than allowed; it must be at most 64 MiB\n"),
            std::string::npos)
      << result.err;
}

TEST_F(QpCliTest, HelpIsThere) {
  const ProgramRun result = run("qp --help");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.out.find("Usage: sopt qp"), std::string::npos) << result.out;
}

}  // namespace
}  // namespace sopt
