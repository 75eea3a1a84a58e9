#include "tools/io/qp_file.h"

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "tests/tools/temporary_folder.h"
#include "tools/io/input_error.h"

namespace sopt {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr const char* kGood =
    "QP1 two rows\n"    // line 1
    "2 2 1\n"           // 2
    "H 3\n"             // 3
    "0 0 2\n"           // 4
    "1 0 0.5\n"         // 5
    "1 1 4\n"           // 6
    "f -1 1e-3\n"       // 7
    "A 3\n"             // 8
    "0 0 1\n"           // 9
    "0 1 1.5\n"         // 10
    "1 1 -2\n"          // 11
    "lA 1 -1e20\n"      // 12
    "uA 1 3\n"          // 13
    "lb 0 -inf\n"       // 14
    "ub 1e+20 7.5\n"    // 15
    "fstar -0.25\n"     // 16
    "xstar 1 0.125\n";  // 17

class QpFileTest : public TemporaryFolderTest {
 protected:
  // The good file with `from`, which it contains, replaced.
  [[nodiscard]] static std::string with(const std::string& from, const std::string& to) {
    std::string text = kGood;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  }
  [[nodiscard]] QpProblem load(const std::string& text) const {
    return load_qp(write("a.qp", text));
  }
  // What is said about a file of this text, without its folder; "" when it loads.
  [[nodiscard]] std::string refusal(const std::string& text) const {
    return refusal_of(write("a.qp", text));
  }
  [[nodiscard]] std::string refusal_of(const std::filesystem::path& file) const {
    try {
      (void)load_qp(file);
      return "";
    } catch (const InputError& error) {
      const std::string line = error.what();
      const std::string prefix = folder().string() + '/';
      return line.rfind(prefix, 0) == 0 ? line.substr(prefix.size()) : line;
    }
  }
};

using Numbers = std::vector<double>;

TEST_F(QpFileTest, ReadsEverySection) {
  const QpProblem problem = load(kGood);
  EXPECT_EQ(problem.name, "two rows");
  EXPECT_EQ(problem.num_variables, 2);
  EXPECT_EQ(problem.num_rows, 2);
  EXPECT_EQ(problem.num_equalities, 1);
  EXPECT_EQ(problem.hessian, (Numbers{2, 0.5, 0.5, 4}));
  EXPECT_EQ(problem.gradient, (Numbers{-1, 1e-3}));
  EXPECT_EQ(problem.rows, (Numbers{1, 1.5, 0, -2}));
  EXPECT_EQ(problem.row_lower, (Numbers{1, -kInfinity}));
  EXPECT_EQ(problem.row_upper, (Numbers{1, 3}));
  EXPECT_EQ(problem.lower, (Numbers{0, -kInfinity}));
  EXPECT_EQ(problem.upper, (Numbers{kInfinity, 7.5}));
  EXPECT_EQ(problem.optimum, -0.25);
  EXPECT_EQ(problem.optimum_point, (Numbers{1, 0.125}));
}

TEST_F(QpFileTest, OptimumIsOptional) {
  EXPECT_FALSE(load(with("fstar -0.25\nxstar 1 0.125\n", "")).optimum);
  EXPECT_TRUE(load(with("xstar 1 0.125\n", "")).optimum_point.empty());
  const QpProblem problem = load(with("fstar -0.25\n", ""));
  EXPECT_FALSE(problem.optimum);
  EXPECT_EQ(problem.optimum_point.size(), 2U);
}

TEST_F(QpFileTest, BlanksAndLineEndsAreOne) {
  std::string text = kGood;
  for (std::size_t at = text.find('\n') + 1; at < text.size(); ++at) {
    if (text[at] == ' ') text.replace(at, 1, "\r\n\t");
  }
  EXPECT_EQ(load(text).rows, load(kGood).rows);
}

TEST_F(QpFileTest, SectionsCanBeEmpty) {
  const QpProblem problem = load("QP1 empty\n0 0 0\nH 0\nf\nA 0\nlA\nuA\nlb\nub\nfstar 0\nxstar\n");
  EXPECT_EQ(problem.num_constraints(), 0);
  EXPECT_TRUE(problem.hessian.empty());
}

TEST_F(QpFileTest, CrossedBoundsAreNoFaultOfTheFile) {
  const QpProblem problem = load(with("lb 0 -inf", "lb 0 8"));
  EXPECT_EQ(problem.lower[1], 8.0);
  EXPECT_EQ(problem.upper[1], 7.5);
  EXPECT_EQ(refusal(with("ub 1e+20", "ub -5")), "");
  EXPECT_EQ(refusal(with("lA 1 -1e20", "lA 1 4")), "");
}

TEST_F(QpFileTest, FileMustBeReadable) {
  EXPECT_EQ(refusal_of(folder() / "absent.qp"),
            "absent.qp: cannot be read: No such file or directory");
  std::filesystem::create_directory(folder() / "sub");
  EXPECT_EQ(refusal_of(folder() / "sub"), "sub: is a directory; it must be a QP1 file");
  std::filesystem::resize_file(write("big.qp", ""), std::uintmax_t{65} << 20U);
  EXPECT_EQ(refusal_of(folder() / "big.qp"), "big.qp: is 65 MiB; it must be at most 64 MiB");
}

TEST_F(QpFileTest, FormatAndNameComeFirst) {
  EXPECT_EQ(refusal(""), "a.qp: line 1: the format is missing; it must be \"QP1\"");
  EXPECT_EQ(refusal("\n\n"), "a.qp: line 3: the format is missing; it must be \"QP1\"");
  EXPECT_EQ(refusal("QP2 x\n"), "a.qp: line 1: the format is \"QP2\"; it must be \"QP1\"");
  EXPECT_EQ(refusal("\x7f"
                    "ELF \x01"),
            "a.qp: line 1: the format is \"\\x7fELF\"; it must be \"QP1\"");
  EXPECT_EQ(refusal(with("QP1 two rows", "QP1 ")),
            "a.qp: line 1: the name is missing; it must be behind \"QP1\" on its line");
}

TEST_F(QpFileTest, CountsHaveLimits) {
  const auto counts = [this](const std::string& text) { return refusal(with("2 2 1", text)); };
  EXPECT_EQ(counts("-1 2 1"), "a.qp: line 2: n is \"-1\"; it must be an integer from 0 to 2000");
  EXPECT_EQ(counts("2001 2 1"),
            "a.qp: line 2: n is \"2001\"; it must be an integer from 0 to 2000");
  EXPECT_EQ(counts("2.0 2 1"), "a.qp: line 2: n is \"2.0\"; it must be an integer from 0 to 2000");
  EXPECT_EQ(counts("2 99999999999999999999 1"),
            "a.qp: line 2: m is \"99999999999999999999\"; it must be an integer from 0 to 20000");
  EXPECT_EQ(counts("2 2 3"),
            "a.qp: line 2: neq is \"3\"; it must be an integer from 0 to 2, the number of rows");
  EXPECT_EQ(refusal(with("H 3", "H 4")),
            "a.qp: line 3: H.count is \"4\"; it must be an integer from 0 to 3");
  EXPECT_EQ(refusal(with("A 3", "A 5")),
            "a.qp: line 8: A.count is \"5\"; it must be an integer from 0 to 4");
}

TEST_F(QpFileTest, CountsMustAgreeWithWhatFollows) {
  EXPECT_EQ(refusal(with("H 3", "H 2")),
            "a.qp: line 6: the next section is \"1\"; it must be \"f\"");
  EXPECT_EQ(refusal(with("A 3", "A 4")),
            "a.qp: line 12: A[3].row is \"lA\"; it must be an integer from 0 to 1");
  EXPECT_EQ(refusal(with("f -1 1e-3", "f -1 1e-3 0")),
            "a.qp: line 7: the next section is \"0\"; it must be \"A\"");
  EXPECT_EQ(refusal(with("uA 1 3", "uA 1")),
            "a.qp: line 14: uA[1] is \"lb\"; it must be a number above -1e20");
}

TEST_F(QpFileTest, EntriesLieInsideAndOnce) {
  EXPECT_EQ(refusal(with("1 0 0.5", "2 0 0.5")),
            "a.qp: line 5: H[1].row is \"2\"; it must be an integer from 0 to 1");
  EXPECT_EQ(refusal(with("1 0 0.5", "0 1 0.5")),
            "a.qp: line 5: H[1].column is \"1\"; it must be an integer from 0 to 0, its row: only "
            "the lower triangle is given");
  EXPECT_EQ(refusal(with("1 0 0.5", "0 0 0.5")),
            "a.qp: line 5: H[1] is at row 0, column 0 again; it must be at a place of its own");
  EXPECT_EQ(refusal(with("1 1 -2", "-1 1 -2")),
            "a.qp: line 11: A[2].row is \"-1\"; it must be an integer from 0 to 1");
  EXPECT_EQ(refusal(with("1 1 -2", "1 2 -2")),
            "a.qp: line 11: A[2].column is \"2\"; it must be an integer from 0 to 1");
  EXPECT_EQ(refusal(with("1 1 -2", "0 1 0")),
            "a.qp: line 11: A[2] is at row 0, column 1 again; it must be at a place of its own");
}

TEST_F(QpFileTest, NumbersAreFinite) {
  constexpr const char* kAllowed = "it must be a number between -1e20 and 1e20";
  for (const std::string word :
       {"nan", "-nan", "inf", "1e20", "-1e20", "1e999", "2x", "0x2", "--1"}) {
    const std::string problem = " is \"" + word + "\"; " + kAllowed;
    EXPECT_EQ(refusal(with("1 0 0.5", "1 0 " + word)), "a.qp: line 5: H[1].value" + problem);
    EXPECT_EQ(refusal(with("f -1", "f " + word)), "a.qp: line 7: f[0]" + problem);
    EXPECT_EQ(refusal(with("1 1 -2", "1 1 " + word)), "a.qp: line 11: A[2].value" + problem);
    EXPECT_EQ(refusal(with("-0.25", word)), "a.qp: line 16: fstar" + problem);
    EXPECT_EQ(refusal(with("0.125", word)), "a.qp: line 17: xstar[1]" + problem);
  }
}

TEST_F(QpFileTest, BoundsAreInfiniteOnTheirOwnSideOnly) {
  for (const std::string word : {"nan", "1e20", "inf", "1e+30", "none"}) {
    const std::string problem = " is \"" + word + "\"; it must be a number below 1e20";
    EXPECT_EQ(refusal(with("lA 1 -1e20", "lA 1 " + word)), "a.qp: line 12: lA[1]" + problem);
    EXPECT_EQ(refusal(with("lb 0", "lb " + word)), "a.qp: line 14: lb[0]" + problem);
  }
  for (const std::string word : {"nan", "-1e20", "-inf", "-1e+30", "none"}) {
    const std::string problem = " is \"" + word + "\"; it must be a number above -1e20";
    EXPECT_EQ(refusal(with("uA 1 3", "uA 1 " + word)), "a.qp: line 13: uA[1]" + problem);
    EXPECT_EQ(refusal(with("7.5", word)), "a.qp: line 15: ub[1]" + problem);
  }
}

TEST_F(QpFileTest, EqualitiesHaveOneFiniteBound) {
  EXPECT_EQ(refusal(with("uA 1 3", "uA 1.5 3")),
            "a.qp: line 13: uA[0] is \"1.5\"; it must be lA[0]: row 0 is an equality");
  EXPECT_EQ(refusal(with("lA 1", "lA -1e20")),
            "a.qp: line 12: lA[0] is \"-1e20\"; it must be above -1e20: row 0 is an equality");
}

TEST_F(QpFileTest, NothingFollowsTheEnd) {
  constexpr const char* kAllowed =
      "it must be \"fstar\", \"xstar\", each once and in this order, or the end of the file";
  const std::string good = kGood;
  EXPECT_EQ(refusal(good + "\n \n"), "");
  EXPECT_EQ(refusal(good + "more"),
            "a.qp: line 18: the next section is \"more\"; " + std::string(kAllowed));
  EXPECT_EQ(refusal(good + "fstar 1"),
            "a.qp: line 18: the next section is \"fstar\"; " + std::string(kAllowed));
  EXPECT_EQ(refusal(with("fstar", "fopt")),
            "a.qp: line 16: the next section is \"fopt\"; " + std::string(kAllowed));
}

TEST_F(QpFileTest, EveryTruncationIsRefused) {
  const std::string good = kGood;
  const std::size_t end_of_ub = good.find("fstar");
  for (std::size_t length = 0; length < end_of_ub; ++length) {
    if (length + 3 >= end_of_ub) continue;  // "7.5" cut short is a number, too
    EXPECT_NE(refusal(good.substr(0, length)), "") << length;
  }
  EXPECT_EQ(refusal(good.substr(0, good.find(" 3\nlb"))),
            "a.qp: line 13: uA[1] is missing; it must be a number above -1e20");
  EXPECT_EQ(refusal(good.substr(0, good.find("lb"))),
            "a.qp: line 14: the next section is missing; it must be \"lb\"");
}

TEST_F(QpFileTest, LongWordsAreCut) {
  const std::string line = refusal(with("1e-3", std::string(100000, '7')));
  EXPECT_LT(line.size(), 200U) << line;
}

}  // namespace
}  // namespace sopt
