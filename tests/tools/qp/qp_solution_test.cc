#include "tools/qp/qp_solution.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace sopt {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// (x0 - 1)^2 + (x1 - 2.5)^2 without its constant, x >= 0 and three rows; at the optimum only row 0
// is active. [Nocedal, Wright 2006, example 16.4]
QpProblem textbook_problem() {
  QpProblem problem;
  problem.name = "textbook";
  problem.num_variables = 2;
  problem.num_rows = 3;
  problem.hessian = {2, 0, 0, 2};
  problem.gradient = {-2, -5};
  problem.rows = {1, -2, 1, 2, -1, 2};
  problem.row_lower = {-2, -kInfinity, -2};
  problem.row_upper = {kInfinity, 6, kInfinity};
  problem.lower = {0, 0};
  problem.upper = {kInfinity, kInfinity};
  return problem;
}
const std::vector<double> kX = {1.4, 1.7};
const std::vector<double> kMultipliers = {0.8, 0, 0, 0, 0};

// One variable with the cost x^2 / 2 and the bounds of rows x.
QpProblem line_problem(const std::vector<double>& row_lower, const std::vector<double>& row_upper) {
  QpProblem problem;
  problem.num_variables = 1;
  problem.num_rows = static_cast<int>(row_lower.size());
  problem.hessian = {1};
  problem.gradient = {0};
  problem.rows.assign(row_lower.size(), 1.0);
  problem.row_lower = row_lower;
  problem.row_upper = row_upper;
  problem.lower = {-kInfinity};
  problem.upper = {kInfinity};
  return problem;
}

QpSolution solve(const QpProblem& problem) {
  QpOptions<double> options;
  options.max_steps = default_max_steps(problem);
  return solve_qp(problem, options);
}

TEST(QpResiduals, VanishAtTheOptimum) {
  const QpResiduals residuals = compute_residuals(textbook_problem(), kX, kMultipliers);
  EXPECT_NEAR(residuals.objective, -6.45, 1e-14);
  EXPECT_LT(residuals.largest(), 1e-15);
}

TEST(QpResiduals, AnotherPointIsNotStationary) {
  const std::vector<double> x = {1.4, 1.6};
  const QpResiduals residuals = compute_residuals(textbook_problem(), x, kMultipliers);
  EXPECT_EQ(residuals.violation, 0.0);
  EXPECT_NEAR(residuals.stationarity, 0.2 / (3.2 + 5 + 1.6), 1e-15);
  EXPECT_NEAR(residuals.complementarity, 0.8 * 0.2 / 6.28, 1e-14);
}

TEST(QpResiduals, ViolationIsInTheLengthOfRowOrBound) {
  QpProblem problem = textbook_problem();
  const std::vector<double> none(5);
  const std::vector<double> x = {0, 2};
  EXPECT_NEAR(compute_residuals(problem, x, none).violation, 2.0 / std::sqrt(5.0), 1e-15);
  problem.row_lower[0] = 96;
  EXPECT_NEAR(compute_residuals(problem, x, none).violation, 100.0 / 96.0, 1e-15);
  problem.rows = {0, 0, 1, 2, -1, 2};
  problem.row_lower[0] = 0.25;
  EXPECT_EQ(compute_residuals(problem, x, none).violation, 0.25);
  problem.row_lower[0] = -kInfinity;
  EXPECT_EQ(compute_residuals(problem, x, none).violation, 0.0);
  problem.upper[1] = 0.5;
  EXPECT_EQ(compute_residuals(problem, x, none).violation, 1.5);
}

TEST(QpResiduals, MultiplierNeedsItsBound) {
  const std::vector<double> wrong_side = {-0.8, 0, 0, 0, 0};
  const QpResiduals residuals = compute_residuals(textbook_problem(), kX, wrong_side);
  EXPECT_GT(residuals.sign, 0.1);
  EXPECT_GT(residuals.stationarity, 0.1);
  const std::vector<double> not_active = {0.8, 0, 0, 0.1, 0};
  EXPECT_NEAR(compute_residuals(textbook_problem(), kX, not_active).complementarity,
              0.1 * 1.4 / 6.45, 1e-15);
}

TEST(QpResiduals, WhatIsNotFiniteIsInfinitelyWrong) {
  for (const double poison : {std::nan(""), kInfinity}) {
    std::vector<double> x = kX;
    x[1] = poison;
    EXPECT_EQ(compute_residuals(textbook_problem(), x, kMultipliers).largest(), kInfinity);
    std::vector<double> multipliers = kMultipliers;
    multipliers[3] = poison;
    EXPECT_EQ(compute_residuals(textbook_problem(), kX, multipliers).largest(), kInfinity);
  }
}

TEST(QpSolution, FindsTheTextbookOptimum) {
  const QpSolution solution = solve(textbook_problem());
  ASSERT_EQ(solution.result.status, QpStatus::kOptimal);
  EXPECT_EQ(solution.result.num_active, 1);
  EXPECT_EQ(solution.blocking, "");
  for (std::size_t j = 0; j < kX.size(); ++j) EXPECT_NEAR(solution.x[j], kX[j], 1e-15);
  for (std::size_t c = 0; c < kMultipliers.size(); ++c) {
    EXPECT_NEAR(solution.multipliers[c], kMultipliers[c], 1e-15);
  }
}

TEST(QpSolution, UpperBoundsHaveNegativeMultipliers) {
  QpProblem problem = textbook_problem();
  problem.upper = {0.5, 1.0};
  const QpSolution solution = solve(problem);
  ASSERT_EQ(solution.result.status, QpStatus::kOptimal);
  EXPECT_NEAR(solution.x[0], 0.5, 1e-15);
  EXPECT_NEAR(solution.x[1], 1.0, 1e-15);
  EXPECT_NEAR(solution.multipliers[3], -1.0, 1e-15);
  EXPECT_NEAR(solution.multipliers[4], -3.0, 1e-15);
  EXPECT_LT(compute_residuals(problem, solution.x, solution.multipliers).largest(), 1e-15);
}

TEST(QpSolution, NamesWhatCannotHold) {
  EXPECT_EQ(solve(line_problem({-kInfinity, 2}, {1, kInfinity})).blocking, "row 0 (upper)");
  EXPECT_EQ(solve(line_problem({-2, -kInfinity}, {kInfinity, -3})).blocking, "row 0 (lower)");
  EXPECT_EQ(solve(line_problem({2, 3}, {2, 3})).blocking, "row 1 (equality)");
  QpProblem problem = line_problem({1}, {1});
  problem.upper = {0.5};
  const QpSolution solution = solve(problem);
  EXPECT_EQ(solution.result.status, QpStatus::kInfeasible);
  EXPECT_EQ(solution.blocking, "bound of variable 0 (upper)");
  problem.lower = {0.5};
  EXPECT_EQ(solve(problem).blocking, "bound of variable 0 (equality)");
}

TEST(QpSolution, CrossedBoundsAreInfeasible) {
  EXPECT_EQ(solve(line_problem({2}, {1})).result.status, QpStatus::kInfeasible);
  QpProblem problem = line_problem({}, {});
  problem.lower = {2};
  problem.upper = {1};
  EXPECT_EQ(solve(problem).result.status, QpStatus::kInfeasible);
}

TEST(QpSolution, EqualitiesMayRepeat) {
  const std::vector<double> many(20, 2.0);
  const QpSolution solution = solve(line_problem(many, many));
  ASSERT_EQ(solution.result.status, QpStatus::kOptimal);
  EXPECT_EQ(solution.x[0], 2.0);
}

TEST(QpSolution, NoVariables) {
  QpProblem problem;
  EXPECT_EQ(solve(problem).result.status, QpStatus::kOptimal);
  problem.num_rows = 1;
  problem.row_lower = {-1};
  problem.row_upper = {1};
  EXPECT_EQ(solve(problem).result.status, QpStatus::kOptimal);
  problem.row_lower = {0.5};
  EXPECT_EQ(solve(problem).blocking, "row 0 (lower)");
}

TEST(QpSolution, IndefiniteHessianIsBadInput) {
  QpProblem problem = textbook_problem();
  for (const double h : {2.0, 3.0}) {
    problem.hessian = {2, h, h, 2};
    EXPECT_EQ(solve(problem).result.status, QpStatus::kBadInput);
  }
}

TEST(QpSolution, StepsAreCapped) {
  QpOptions<double> options;
  options.max_steps = 0;
  const QpSolution solution = solve_qp(textbook_problem(), options);
  EXPECT_EQ(solution.result.status, QpStatus::kStepLimit);
  EXPECT_NEAR(solution.x[0], 1.0, 1e-15);
  EXPECT_NEAR(solution.x[1], 2.5, 1e-15);
  EXPECT_GT(compute_residuals(textbook_problem(), solution.x, solution.multipliers).violation, 0.1);
}

TEST(QpSolution, EveryStatusHasAName) {
  EXPECT_STREQ(to_string(QpStatus::kOptimal), "optimal");
  EXPECT_STREQ(to_string(QpStatus::kNotSolved), "not_solved");
  EXPECT_STREQ(to_string(QpStatus::kInfeasible), "infeasible");
  EXPECT_STREQ(to_string(QpStatus::kStepLimit), "step_limit");
  EXPECT_STREQ(to_string(QpStatus::kDeadline), "deadline");
  EXPECT_STREQ(to_string(QpStatus::kCapacity), "capacity");
  EXPECT_STREQ(to_string(QpStatus::kInaccurate), "inaccurate");
  EXPECT_STREQ(to_string(QpStatus::kBadInput), "bad_input");
}

}  // namespace
}  // namespace sopt
