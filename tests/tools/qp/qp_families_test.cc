#include "tools/qp/qp_families.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "tools/bench/bench_qp_solvers.h"
#include "tools/qp/qp_solution.h"

namespace sopt {
namespace {

constexpr double kTolerance = 0.15;  // relative

double condition(const QpProblem& problem) {
  const Eigen::Map<const Eigen::MatrixXd> hessian(problem.hessian.data(), problem.num_variables,
                                                  problem.num_variables);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(hessian, Eigen::EigenvaluesOnly);
  return solver.eigenvalues().maxCoeff() / solver.eigenvalues().minCoeff();
}

struct Extent {
  double min = 0.0, median = 0.0, max = 0.0;
};

Extent extent_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return {values.front(), 0.5 * (values[(n - 1) / 2] + values[n / 2]), values.back()};
}

void expect_near(const Extent& value, const Extent& expected) {
  EXPECT_NEAR(value.min, expected.min, kTolerance * expected.min);
  EXPECT_NEAR(value.median, expected.median, kTolerance * expected.median);
  EXPECT_NEAR(value.max, expected.max, kTolerance * expected.max);
}

struct Expected {
  char name;
  int num_variables;
  int num_equalities;
  double min_rows, max_rows;
  double condition;
  Extent active;
};

class QpFamilyTest : public ::testing::TestWithParam<Expected> {};

TEST_P(QpFamilyTest, HasTheSizesConditioningAndActiveCountsItIsNamedFor) {
  const Expected expected = GetParam();
  std::vector<double> rows;
  std::vector<double> conditions;
  std::vector<double> active;
  for (const QpPair& pair : make_qp_family(expected.name, 40, 1).pairs) {
    const QpProblem problem = condense(pair.cold, pair.name);
    EXPECT_EQ(problem.num_variables, expected.num_variables);
    EXPECT_EQ(problem.num_equalities, expected.num_equalities);
    const QpSolution solution = solve_qp(problem, {});
    ASSERT_EQ(solution.result.status, QpStatus::kOptimal) << pair.name;
    EXPECT_LE(compute_residuals(problem, solution.x, solution.multipliers).largest(), 1e-11)
        << pair.name;
    rows.push_back(problem.num_rows);
    conditions.push_back(condition(problem));
    active.push_back(solution.result.num_active);
  }
  EXPECT_EQ(extent_of(rows).min, expected.min_rows);
  EXPECT_EQ(extent_of(rows).max, expected.max_rows);
  expect_near(extent_of(conditions), {expected.condition, expected.condition, expected.condition});
  expect_near(extent_of(active), expected.active);
}

INSTANTIATE_TEST_SUITE_P(All, QpFamilyTest,
                         ::testing::Values(Expected{'a', 60, 2, 32, 92, 37.8, {17, 29, 38}},
                                           Expected{'b', 150, 10, 215, 335, 717, {19, 32, 55}},
                                           Expected{'c', 100, 10, 145, 225, 156, {11, 18, 26}},
                                           Expected{'d', 180, 11, 187, 277, 764, {70, 98, 132}}),
                         [](const auto& test) { return std::string(1, test.param.name); });

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

TEST(QpFamiliesTest, EverySolverFindsTheSameInputs) {
  for (const char name : std::string(kQpFamilies)) {
    std::vector<BenchQpPair> pairs;
    for (const QpPair& pair : make_qp_family(name, 10, 2).pairs) {
      pairs.push_back(make_bench_pair(pair));
    }
    const auto solvers = make_bench_solvers(pairs);
    for (const BenchQpPair& pair : pairs) {
      for (const BenchQpProblem* problem : {&pair.cold, &pair.warm}) {
        const QpSolution expected = solve_qp(problem->condensed, {});
        for (const auto& solver : solvers) {
          const bool is_warm = problem == &pair.warm;
          solver->prepare(*problem);
          EXPECT_EQ(solver->solve(*problem, is_warm).status, QpStatus::kOptimal);
          const double tolerance = solver->name() == "kernel, float" ? 1e-4 : 1e-8;
          EXPECT_LE(largest_difference(solver->inputs(), expected.x), tolerance)
              << pair.name << ' ' << solver->name();
          if (!is_warm) solver->remember();
        }
      }
    }
  }
}

TEST(QpFamiliesTest, DependOnTheSeedAlone) {
  const QpProblem first = condense(make_qp_family('b', 3, 5).pairs[2].cold, "");
  const QpProblem same = condense(make_qp_family('b', 9, 5).pairs[2].cold, "");
  const QpProblem other = condense(make_qp_family('b', 3, 6).pairs[2].cold, "");
  EXPECT_EQ(first.rows, same.rows);
  EXPECT_EQ(first.row_lower, same.row_lower);
  EXPECT_EQ(first.gradient, same.gradient);
  EXPECT_NE(first.gradient, other.gradient);
}

TEST(QpFamiliesTest, PartnersHaveTheSameRowsTurnedByThreePercent) {
  for (const char name : {'a', 'b', 'c'}) {
    for (const QpPair& pair : make_qp_family(name, 5, 1).pairs) {
      ASSERT_EQ(pair.cold.arm.rows.size(), pair.warm.arm.rows.size());
      double largest = 0.0;
      for (std::size_t i = 0; i < pair.cold.arm.rows.size(); ++i) {
        const KernelRow<double>& cold = pair.cold.arm.rows[i];
        const KernelRow<double>& warm = pair.warm.arm.rows[i];
        EXPECT_EQ(cold.t, warm.t);
        double square = 0.0;
        double length2 = 0.0;
        for (std::size_t j = 0; j < cold.direction.size(); ++j) {
          square += std::pow(cold.direction[j] - warm.direction[j], 2);
          length2 += warm.direction[j] * warm.direction[j];
        }
        EXPECT_NEAR(length2, 1.0, 1e-12);
        largest = std::max(largest, std::sqrt(square));
      }
      EXPECT_LE(largest, 0.031);
      EXPECT_GE(largest, 0.02);
      EXPECT_EQ(condense(pair.cold, "").hessian, condense(pair.warm, "").hessian);
    }
  }
}

TEST(QpFamiliesTest, PartnersOfMobileProblemsHaveAnotherHessian) {
  for (const QpPair& pair : make_qp_family('d', 3, 1).pairs) {
    ASSERT_EQ(pair.cold.coupled.size(), pair.warm.coupled.size());
    const double difference = largest_difference(pair.cold.base.hessian, pair.warm.base.hessian);
    EXPECT_GT(difference, 0.0);
    EXPECT_LT(difference, 0.1 * *std::max_element(pair.cold.base.hessian.begin(),
                                                  pair.cold.base.hessian.end()));
  }
}

}  // namespace
}  // namespace sopt
