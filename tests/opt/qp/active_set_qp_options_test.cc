// Soft rows, warm starts and single precision.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "opt/qp/active_set_qp.h"
#include "tests/support/planted_qp.h"
#include "tests/support/qp_fixture.h"

namespace sopt {
namespace {

using oracle::DenseQp;
using oracle::InArena;
using oracle::kMaxActive;
using oracle::kMaxRows;
using oracle::kMaxVariables;
using oracle::nearest_to;
using oracle::PlantedQp;
using oracle::Random;

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class ActiveSetQpOptionsTest : public oracle::QpFixture {};

// --- soft rows

// The same with a slack variable of weight 1 / softness for every soft side.
DenseQp with_slack_variables(const DenseQp& qp, const std::vector<int>& soft, double softness) {
  const int n = qp.num_variables();
  const int num_soft = static_cast<int>(soft.size());
  const int size = n + num_soft;
  Eigen::MatrixXd h = Eigen::MatrixXd::Identity(size, size) / softness;
  h.topLeftCorner(n, n) = qp.h;
  Eigen::VectorXd f = Eigen::VectorXd::Zero(size);
  f.head(n) = qp.f;
  DenseQp result = DenseQp::unconstrained(h, f);
  for (int c = 0; c < qp.num_constraints(); ++c) {
    Eigen::VectorXd normal = Eigen::VectorXd::Zero(size);
    normal.head(n) = qp.normal(c);
    const auto at = std::find(soft.begin(), soft.end(), c) - soft.begin();
    if (at < num_soft) normal[n + at] = 1.0;
    if (std::isinf(qp.lower_of(c)) && std::isinf(qp.upper_of(c))) continue;
    result.add_row(normal, qp.lower_of(c), qp.upper_of(c));
  }
  return result;
}

TEST_F(ActiveSetQpOptionsTest, SoftRowsAnswerAsSlackVariablesDo) {
  Random random(9);
  for (int round = 0; round < 200; ++round) {
    const PlantedQp planted =
        oracle::random_planted_qp(random, {.max_variables = 10, .max_condition = 1e3});
    DenseQp qp = planted.qp;
    // Bounds are moved, so that rows would have to give way much.
    for (int i = 0; i < qp.num_rows(); ++i) {
      const double shift =
          random.chance(0.3) ? random.uniform(-0.3, 0.3) * qp.a.row(i).norm() : 0.0;
      qp.lower[i] += shift;
      qp.upper[i] += shift;
    }
    std::vector<int> soft;
    for (int c = 0; c < qp.num_constraints(); ++c) {
      if (static_cast<int>(soft.size()) < kMaxVariables - 10) soft.push_back(c);
    }
    if (static_cast<int>(soft.size()) < qp.num_constraints()) continue;
    const double softness = std::pow(10.0, random.uniform(-2.0, 1.0));
    const DenseQp augmented = with_slack_variables(qp, soft, softness);
    expect_solution(augmented, solve(augmented));
    const Eigen::VectorXd expected = x().head(qp.num_variables());
    ASSERT_TRUE(oracle::fill(qp, *rows_));
    for (const int c : soft) rows_->set_softness(c, softness);
    const QpResult<double> result = solver_->solve(*rows_, options_, Deadline());
    ASSERT_EQ(result.status, QpStatus::kOptimal);
    EXPECT_LE((x() - expected).norm(), 1e-9 * (1.0 + expected.norm()));
  }
}

TEST_F(ActiveSetQpOptionsTest, SoftAndHardRowsStandTogether) {
  DenseQp qp = nearest_to(Eigen::Vector2d(0.0, 0.0));
  qp.add_row(Eigen::Vector2d(1.0, 0.0), 2.0, kInf);  // soft
  qp.add_row(Eigen::Vector2d(1.0, 1.0), -kInf, 0.5);
  const DenseQp augmented = with_slack_variables(qp, {0}, 0.5);
  expect_solution(augmented, solve(augmented));
  const Eigen::VectorXd expected = x().head(2);
  ASSERT_TRUE(oracle::fill(qp, *rows_));
  rows_->set_softness(0, 0.5);
  ASSERT_EQ(solver_->solve(*rows_, options_, Deadline()).status, QpStatus::kOptimal);
  EXPECT_LE((x() - expected).norm(), 1e-12);
  EXPECT_LE(x().sum(), 0.5 + 1e-11);
}

TEST_F(ActiveSetQpOptionsTest, SoftDuplicatesShareAndSoftContradictionsMeet) {
  // k copies of x >= 1 with softness s: x = k / (k + s).
  DenseQp copies = nearest_to(Eigen::VectorXd::Zero(1));
  for (int k = 0; k < 3; ++k) copies.add_row(Eigen::VectorXd::Ones(1), 1.0, kInf);
  ASSERT_TRUE(oracle::fill(copies, *rows_));
  for (int k = 0; k < 3; ++k) rows_->set_softness(k, 0.5);
  ASSERT_EQ(solver_->solve(*rows_, options_, Deadline()).status, QpStatus::kOptimal);
  EXPECT_NEAR(x()[0], 3.0 / 3.5, 1e-12);
  EXPECT_EQ(solver_->active_rows().size(), 3u);
  // x >= 1 and x <= -1: x = 0 by symmetry; one of them softer gives more.
  DenseQp against = nearest_to(Eigen::VectorXd::Zero(1));
  against.add_row(Eigen::VectorXd::Ones(1), 1.0, kInf);
  against.add_row(Eigen::VectorXd::Ones(1), -kInf, -1.0);
  ASSERT_TRUE(oracle::fill(against, *rows_));
  rows_->set_softness(0, 0.1);
  rows_->set_softness(1, 0.2);
  ASSERT_EQ(solver_->solve(*rows_, options_, Deadline()).status, QpStatus::kOptimal);
  // 1/2 x^2 + (1 - x)^2 / 0.2 + (1 + x)^2 / 0.4
  EXPECT_NEAR(x()[0], 5.0 / 16.0, 1e-12);
}

TEST_F(ActiveSetQpOptionsTest, SoftZeroRowsDisturbNothing) {
  DenseQp qp = nearest_to(Eigen::Vector2d(2.0, 0.0));
  qp.add_row(Eigen::Vector2d::Zero(), 1.0, kInf);
  qp.add_row(Eigen::Vector2d::UnitX(), -kInf, 1.0);
  ASSERT_TRUE(oracle::fill(qp, *rows_));
  rows_->set_softness(0, 0.5);
  ASSERT_EQ(solver_->solve(*rows_, options_, Deadline()).status, QpStatus::kOptimal);
  EXPECT_LE((x() - Eigen::Vector2d(1.0, 0.0)).norm(), 1e-12);
}

TEST_F(ActiveSetQpOptionsTest, SoftEqualitiesPullFromBothSides) {
  for (const double target : {-2.0, 2.0}) {
    DenseQp qp = nearest_to(Eigen::VectorXd::Zero(1));
    qp.add_row(Eigen::VectorXd::Ones(1), target, target);
    ASSERT_TRUE(oracle::fill(qp, *rows_));
    rows_->set_softness(0, 1.0);
    ASSERT_EQ(solver_->solve(*rows_, options_, Deadline()).status, QpStatus::kOptimal);
    EXPECT_NEAR(x()[0], target / 2.0, 1e-13);
  }
}

// --- warm start

TEST_F(ActiveSetQpOptionsTest, StartsWarmWithoutMoreStepsThanRows) {
  Random random(10);
  int num_fewer = 0;
  for (int round = 0; round < 100; ++round) {
    const PlantedQp planted = oracle::random_planted_qp(random, {.max_condition = 1e3});
    options_.warm = {};
    const QpResult<double> cold = solve(planted.qp);
    expect_solution(planted.qp, cold);
    const std::vector<int> active(solver_->active_rows().begin(), solver_->active_rows().end());
    options_.warm.rows = active;
    const QpResult<double> warm = solve(planted.qp);
    expect_solution(planted.qp, warm);
    EXPECT_LE(warm.num_steps, cold.num_steps);
    num_fewer += warm.num_steps < cold.num_steps ? 1 : 0;
  }
  EXPECT_GT(num_fewer, 20);
}

TEST_F(ActiveSetQpOptionsTest, PassesOverWarmRowsOfMultipliersThatAreNotPositive) {
  const DenseQp qp = long_problem();
  const QpResult<double> cold = solve(qp);
  const std::vector<int> active(solver_->active_rows().begin(), solver_->active_rows().end());
  const std::vector<double> bad(active.size(), kNan);
  options_.warm = {active, bad};
  const QpResult<double> result = solve(qp);
  expect_solution(qp, result);
  EXPECT_EQ(result.num_steps, cold.num_steps);
}

TEST_F(ActiveSetQpOptionsTest, PassesOverWarmRowsThatDoNotExistOrRepeat) {
  const DenseQp qp = long_problem();
  const QpResult<double> cold = solve(qp);
  const int num_ids = rows_->num_ids();
  const std::vector<int> wrong = {-1, num_ids, std::numeric_limits<int>::max(),
                                  std::numeric_limits<int>::min()};
  options_.warm.rows = wrong;
  EXPECT_EQ(solve(qp).num_steps, cold.num_steps);
  const std::vector<int> repeated(100, rows_->lower_id(6));
  options_.warm.rows = repeated;
  expect_solution(qp, solve(qp));
}

TEST_F(ActiveSetQpOptionsTest, PassesOverWarmRowsWithoutABound) {
  DenseQp qp = nearest_to(Eigen::Vector2d(3.0, 4.0));
  qp.add_row(Eigen::Vector2d(1.0, 1.0), -kInf, 1.0);
  ASSERT_TRUE(oracle::fill(qp, *rows_));
  const std::vector<int> without = {rows_->lower_id(0), rows_->lower_id(1), rows_->lower_id(2) + 1};
  options_.warm.rows = without;
  expect_solution_at(Eigen::Vector2d(0.0, 1.0), qp);
}

// Ids of the sides of an equality exist as well.
TEST_F(ActiveSetQpOptionsTest, PassesOverWarmRowsOfAnEqualitysSides) {
  DenseQp qp = nearest_to(Eigen::Vector2d(3.0, 4.0));
  qp.add_row(Eigen::Vector2d(1.0, 1.0), 1.0, 1.0);
  qp.set_bounds(1, 0.5, kInf);
  ASSERT_TRUE(oracle::fill(qp, *rows_));
  const std::vector<int> sides = {rows_->lower_id(0), rows_->lower_id(0) + 1, 0};
  for (int round = 0; round < 200; ++round) {
    options_.warm.rows = sides;
    expect_solution_at(Eigen::Vector2d(0.5, 0.5), qp);
    options_.warm.rows = {};
    expect_solution_at(Eigen::Vector2d(0.5, 0.5), qp);
    if (HasFailure()) return;
  }
}

TEST_F(ActiveSetQpOptionsTest, CorrectsAWarmStartFromTheWrongSide) {
  DenseQp qp = nearest_to(Eigen::Vector2d(3.0, 4.0));
  qp.add_row(Eigen::Vector2d(1.0, 1.0), -1.0, 1.0);
  ASSERT_TRUE(oracle::fill(qp, *rows_));
  const std::vector<int> lower_side = {rows_->lower_id(0)};
  options_.warm.rows = lower_side;
  expect_solution_at(Eigen::Vector2d(0.0, 1.0), qp);
}

TEST_F(ActiveSetQpOptionsTest, FindsContradictionsFromAWarmStartToo) {
  DenseQp qp = nearest_to(Eigen::Vector2d(0.0, 0.0));
  qp.add_row(Eigen::Vector2d(1.0, 1.0), 1.0, kInf);
  qp.add_row(Eigen::Vector2d(-1.0, -1.0), 1.0, kInf);
  const std::vector<int> both = {0, 2};
  options_.warm.rows = both;
  expect_infeasible(qp, {0, 1});
}

// --- single precision

class FloatQpTest : public ::testing::Test {
 protected:
  QpResult<float> solve(const DenseQp& qp) {
    EXPECT_TRUE(oracle::fill(qp, *rows_));
    return solver_->solve(*rows_, {}, Deadline());
  }
  void expect_solution(const DenseQp& qp, const QpResult<float>& result) {
    ASSERT_EQ(result.status, QpStatus::kOptimal) << oracle::to_text(qp);
    Eigen::VectorXf multipliers(qp.num_constraints());
    rows_->write_multipliers(solver_->active_rows(), solver_->multipliers(), multipliers.data());
    const Eigen::VectorXf x = Eigen::Map<const Eigen::VectorXf>(
        rows_->primal().data(), static_cast<Eigen::Index>(qp.num_variables()));
    EXPECT_LE(oracle::scaled_kkt(qp, x.cast<double>(), multipliers.cast<double>()).worst(), 1e-4)
        << oracle::to_text(qp);
  }

  InArena<DenseRows<float>> rows_{DenseCapacity{kMaxVariables, kMaxRows, kMaxActive}};
  InArena<ActiveSetQp<float>> solver_{kMaxActive};
};

TEST_F(FloatQpTest, FindsPlantedSolutions) {
  Random random(1);
  for (int round = 0; round < 300; ++round) {
    const PlantedQp planted = oracle::random_planted_qp(
        random, {.max_condition = 1e3, .min_slack = 1e-3, .has_exact_duplicates = true});
    const DenseQp qp = oracle::rounded_to_float(planted.qp);
    expect_solution(qp, solve(qp));
  }
}

// Tolerances made for double precision misbehave here.
TEST_F(FloatQpTest, TellsContradictionsFromRounding) {
  for (const double gap : {0.01, 1.0}) {
    DenseQp qp = nearest_to(Eigen::Vector2d(0.1, 0.2));
    qp.add_row(Eigen::Vector2d(0.6, 0.8), 1.0, kInf);
    qp.add_row(Eigen::Vector2d(0.3, 0.4), -kInf, 0.5 - gap);
    EXPECT_EQ(solve(qp).status, QpStatus::kInfeasible);
  }
  DenseQp touching = nearest_to(Eigen::Vector2d(0.1, 0.2));
  touching.add_row(Eigen::Vector2d(0.6, 0.8), 1.0, kInf);
  touching.add_row(Eigen::Vector2d(0.18, 0.24), -kInf, 0.3);
  expect_solution(touching, solve(touching));
}

TEST_F(FloatQpTest, CopesWithDuplicateAndNearlyParallelRows) {
  for (const double angle : {0.0, 1e-3, 1e-5, 1e-7}) {
    DenseQp qp = nearest_to(Eigen::Vector2d(0.3, 0.0));
    for (const double a : {0.0, angle, -angle}) {
      qp.add_row(Eigen::Vector2d(std::sin(a), std::cos(a)), 1.0, kInf);
    }
    expect_solution(oracle::rounded_to_float(qp), solve(qp));
  }
}

TEST_F(FloatQpTest, RefusesBadInputAndSingularHessians) {
  DenseQp qp = nearest_to(Eigen::Vector2d(3.0, 4.0));
  qp.f[1] = kNan;
  EXPECT_EQ(solve(qp).status, QpStatus::kBadInput);
  const float singular[] = {1.0F, 1.0F, 1.0F, 1.0F};
  EXPECT_FALSE(rows_->factorize(2, singular));
}

}  // namespace
}  // namespace sopt
