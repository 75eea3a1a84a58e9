#include "tools/tables/paper_table.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace sopt {
namespace {

const std::filesystem::path kPaperText = SOPT_SOURCE_DIR "/../shared/paper/rrtstar-sopt.tex";

// The numbers in a table cell: "$7 \rightarrow 3.9$" has two, "$\mathbf{21.42}$" one.
std::vector<double> numbers_of(const std::string& cell) {
  std::vector<double> numbers;
  for (std::size_t i = 0; i < cell.size();) {
    if (cell[i] < '0' || cell[i] > '9') {
      ++i;
      continue;
    }
    std::size_t used = 0;
    numbers.push_back(std::stod(cell.substr(i), &used));
    i += used;
  }
  return numbers;
}

// Last numbers of the cells of a line behind its first cell; -1 for a cell without one.
std::vector<double> row_of(const std::string& line) {
  std::vector<double> row;
  std::istringstream cells(line.substr(line.find('&') + 1));
  for (std::string cell; std::getline(cells, cell, '&');) {
    const std::vector<double> numbers = numbers_of(cell.substr(0, cell.find("\\\\")));
    row.push_back(numbers.empty() ? -1.0 : numbers.back());
  }
  return row;
}

class PaperTableTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ifstream file(kPaperText);
    if (!file) GTEST_SKIP() << "there is no " << kPaperText;
    for (std::string line; std::getline(file, line);) lines_.push_back(line);
  }

  // The i-th line with `label` behind `caption`.
  [[nodiscard]] std::vector<double> find_row(const char* caption, const char* label, int i) const {
    bool is_behind = false;
    for (const std::string& line : lines_) {
      if (is_behind && line.find(label) != std::string::npos && i-- == 0) return row_of(line);
      is_behind = is_behind || line.find(caption) != std::string::npos;
    }
    ADD_FAILURE() << label;
    return {};
  }

  void expect_same(const PaperTable& table, const char* caption, int i) const {
    const auto expect = [&](const char* label, auto figure, double of_rrt_star) {
      const std::vector<double> row = find_row(caption, label, i);
      ASSERT_EQ(row.size(), table.columns.size() + 1) << label;
      EXPECT_DOUBLE_EQ(row[0], of_rrt_star) << label;
      for (std::size_t k = 0; k < table.columns.size(); ++k) {
        EXPECT_DOUBLE_EQ(row[k + 1], table.columns[k].*figure) << label << ' ' << k;
      }
    };
    expect("\\textbf{\\# Segments}", &PaperColumn::segments_final, -1.0);
    expect("Computation time average", &PaperColumn::time_s, table.rrt_star.time_s);
    expect("Computation time standard deviation [s]", &PaperColumn::deviation_s, -1.0);
    expect("\\textbf{Cost}", &PaperColumn::cost, table.rrt_star.cost);
    expect("\\textbf{\\# iterations}", &PaperColumn::iterations, -1.0);
    expect("Success rate", &PaperColumn::success_percent, table.rrt_star.success_percent);
  }

  std::vector<std::string> lines_;
};

TEST_F(PaperTableTest, FiguresAreThoseOfThePapersText) {
  expect_same(kPlaneTable, "\\label{table:2D}", 0);
  expect_same(kArmFewTable, "\\label{table:5D}", 0);
  expect_same(kArmManyTable, "\\label{table:5D}", 1);
}

TEST(PaperTableColumns, FixedOnesComeFirstAndEachMergingOneHasItsFixedOne) {
  for (const PaperTable* const table : {&kPlaneTable, &kArmFewTable, &kArmManyTable}) {
    EXPECT_EQ(table->columns.front().num_segments, 1);
    ASSERT_EQ(table->num_fixed(), 5U);
    for (std::size_t i = 0; i < table->columns.size(); ++i) {
      EXPECT_EQ(table->columns[i].merges, i >= table->num_fixed());
      const PaperColumn& fixed = table->columns[table->i_fixed(table->columns[i].num_segments)];
      EXPECT_FALSE(fixed.merges);
      EXPECT_EQ(fixed.num_segments, table->columns[i].num_segments);
    }
  }
  EXPECT_NEAR(kArmFewTable.optimize_s(kArmFewTable.columns[0]), 97.38, 1e-9);
}

}  // namespace
}  // namespace sopt
