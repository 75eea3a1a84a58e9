#include "tools/tables/table_summary.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sopt {
namespace {

TableCase good_case(double length, double optimize_us = 10.0) {
  TableCase c;
  c.has_plan = true;
  c.length = length;
  c.optimize = {optimize_us, 0.5 * optimize_us};
  c.iterations = 3;
  c.segments_initial = 7;
  c.segments_final = 5;
  return c;
}

TableCase refused_case(double length) {
  TableCase c = good_case(length);
  c.fell_back = true;
  return c;
}

TableRun run_of(const std::vector<TableCase>& cases) {
  TableRun run;
  run.cases = cases;
  return run;
}

TEST(TableSummaryTest, MeanDeviationAndMedianAreThoseOfASample) {
  const Spread spread = spread_of({2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0});
  EXPECT_EQ(spread.count, 8);
  EXPECT_DOUBLE_EQ(spread.mean, 5.0);
  EXPECT_DOUBLE_EQ(spread.deviation, std::sqrt(32.0 / 7.0));
  EXPECT_DOUBLE_EQ(spread.median, 4.0);
}

TEST(TableSummaryTest, OneValueHasNoDeviationAndNoValueIsZero) {
  EXPECT_DOUBLE_EQ(spread_of({3.0}).deviation, 0.0);
  EXPECT_DOUBLE_EQ(spread_of({3.0}).mean, 3.0);
  EXPECT_EQ(spread_of({}).count, 0);
  EXPECT_DOUBLE_EQ(spread_of({}).mean, 0.0);
}

TEST(TableSummaryTest, LengthsAreOfSuccessesAndTimesOfAllCases) {
  const TableRun run = run_of({good_case(30.0, 10.0), refused_case(90.0), good_case(32.0, 40.0)});
  const RunSummary summary = summarize(run, {true, false, false});
  EXPECT_EQ(summary.num_cases, 3);
  EXPECT_NEAR(summary.success_percent(), 200.0 / 3.0, 1e-12);
  EXPECT_NEAR(summary.fell_back_percent(), 100.0 / 3.0, 1e-12);
  EXPECT_DOUBLE_EQ(summary.length.mean, 31.0);
  EXPECT_DOUBLE_EQ(summary.common_length.mean, 30.0);
  EXPECT_EQ(summary.optimize.serial_us.count, 3);
  EXPECT_DOUBLE_EQ(summary.optimize.serial_us.mean, 20.0);
  EXPECT_DOUBLE_EQ(summary.optimize.critical_us.mean, 10.0);
  EXPECT_DOUBLE_EQ(summary.iterations.mean, 3.0);
  EXPECT_DOUBLE_EQ(summary.segments_initial.mean, 7.0);
  EXPECT_DOUBLE_EQ(summary.segments_final.mean, 5.0);
}

TEST(TableSummaryTest, ACaseWithoutAPlanIsNoSuccessAndNoFallBack) {
  const RunSummary summary = summarize(run_of({TableCase{}}), {false});
  EXPECT_DOUBLE_EQ(summary.success_percent(), 0.0);
  EXPECT_EQ(summary.num_fell_back, 0);
  EXPECT_EQ(summary.length.count, 0);
}

TEST(TableSummaryTest, CommonCasesAreThoseThatEveryColumnSolved) {
  TableMode mode;
  mode.columns.resize(7);
  for (TableRun& column : mode.columns) {
    column.cases = {good_case(30.0), good_case(40.0), good_case(50.0)};
  }
  mode.columns[2].cases[0] = refused_case(99.0);
  mode.columns[5].cases[2] = TableCase{};
  const ModeSummary summary =
      summarize(mode, run_of({good_case(60.0), good_case(70.0), good_case(80.0)}));
  EXPECT_EQ(summary.num_common, 1);
  EXPECT_DOUBLE_EQ(summary.rrt_star.common_length.mean, 70.0);
  EXPECT_DOUBLE_EQ(summary.rrt_star.length.mean, 70.0);
  EXPECT_DOUBLE_EQ(summary.columns[0].common_length.mean, 40.0);
  EXPECT_DOUBLE_EQ(summary.columns[2].length.mean, 45.0);
}

}  // namespace
}  // namespace sopt
