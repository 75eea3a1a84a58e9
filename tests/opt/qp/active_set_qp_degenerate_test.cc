// Dependent, duplicate and contradicting rows: what makes active-set methods loop or lie.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "opt/qp/active_set_qp.h"
#include "tests/support/planted_qp.h"
#include "tests/support/qp_fixture.h"

namespace sopt {
namespace {

using oracle::DenseQp;
using oracle::kMaxRows;
using oracle::nearest_to;
using oracle::PlantedQp;
using oracle::Random;

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class ActiveSetQpDegenerateTest : public oracle::QpFixture {};

// --- degenerate rows

TEST_F(ActiveSetQpDegenerateTest, PassesOverZeroRowsThatHold) {
  DenseQp qp = nearest_to(Eigen::Vector2d(2.0, 0.0));
  qp.add_row(Eigen::Vector2d::Zero(), -1.0, 1.0);
  qp.add_row(Eigen::Vector2d::Zero(), 0.0, kInf);
  qp.add_row(Eigen::Vector2d::Zero(), 0.0, 0.0);
  qp.add_row(Eigen::Vector2d::UnitX(), -kInf, 1.0);
  expect_solution_at(Eigen::Vector2d(1.0, 0.0), qp);
}

// A solver of others called such data optimal.
TEST_F(ActiveSetQpDegenerateTest, RefusesZeroRowsThatContradictThemselves) {
  for (const double bound : {1e-5, 1.0, 1e6}) {
    for (const int side : {0, 1, 2}) {
      DenseQp qp = nearest_to(Eigen::Vector2d(2.0, 0.0));
      qp.add_row(Eigen::Vector2d::UnitX(), -kInf, 1.0);
      qp.add_row(Eigen::Vector2d::Zero(), side == 1 ? -kInf : bound,
                 side == 0 ? kInf : (side == 1 ? -bound : bound));
      expect_infeasible(qp, {1});
    }
  }
}

TEST_F(ActiveSetQpDegenerateTest, CopesWithDuplicateRows) {
  Random random(3);
  for (int round = 0; round < 100; ++round) {
    const PlantedQp planted =
        oracle::random_planted_qp(random, {.max_variables = 20, .max_condition = 1e3});
    DenseQp qp = planted.qp;
    const int num_once = qp.num_rows();
    for (int copy = 0; copy < 2; ++copy) {
      for (int i = 0; i < num_once && qp.num_rows() < kMaxRows; ++i) {
        qp.add_row(qp.a.row(i).transpose(), qp.lower[i], qp.upper[i]);
      }
    }
    expect_solution(qp, solve(qp));
  }
}

TEST_F(ActiveSetQpDegenerateTest, HoldsDependentRowsThatLeaveOnlyOnePoint) {
  DenseQp qp = nearest_to(Eigen::Vector2d(0.0, 0.0));
  const Eigen::Vector2d point(5.0, 2.0);
  for (const double angle : {0.3, 1.4, 2.5, 4.4, 5.5}) {
    const Eigen::Vector2d normal(std::cos(angle), std::sin(angle));
    qp.add_row(normal, normal.dot(point), kInf);
  }
  expect_solution(qp, solve(qp));
  EXPECT_LE((x() - point).norm(), 1e-9);
}

TEST_F(ActiveSetQpDegenerateTest, HoldsACorridorWithoutWidth) {
  DenseQp qp = nearest_to(Eigen::Vector2d(0.0, 3.0));
  qp.add_row(Eigen::Vector2d(0.0, 1.0), 1.0, kInf);
  qp.add_row(Eigen::Vector2d(0.0, 1.0), -kInf, 1.0);
  expect_solution_at(Eigen::Vector2d(0.0, 1.0), qp);
}

// --- equalities

TEST_F(ActiveSetQpDegenerateTest, HoldsEqualitiesWithMultipliersOfEitherSign) {
  DenseQp qp = nearest_to(Eigen::Vector3d(0.0, 0.0, 7.0));
  qp.add_row(Eigen::Vector3d(1.0, 1.0, 0.0), 2.0, 2.0);
  qp.set_bounds(1 + 2, 3.0, 3.0);
  expect_solution_at(Eigen::Vector3d(1.0, 1.0, 3.0), qp);
  EXPECT_EQ(rows_->num_equalities(), 2);
  EXPECT_NEAR(multipliers()[0], 1.0, 1e-13);
  EXPECT_NEAR(multipliers()[3], -4.0, 1e-13);
}

TEST_F(ActiveSetQpDegenerateTest, TakesEqualBoundsAsAnEquality) {
  DenseQp qp = nearest_to(Eigen::Vector2d(9.0, 9.0));
  qp.set_bounds(0, 1.5, 1.5);
  qp.set_bounds(1, 0.0, 0.0);
  expect_solution_at(Eigen::Vector2d(1.5, 0.0), qp);
}

TEST_F(ActiveSetQpDegenerateTest, PassesOverDependentEqualitiesThatAgree) {
  DenseQp qp = nearest_to(Eigen::Vector3d(4.0, 0.0, 0.0));
  qp.add_row(Eigen::Vector3d(1.0, 1.0, 0.0), 1.0, 1.0);
  qp.add_row(Eigen::Vector3d(0.0, 1.0, 1.0), 2.0, 2.0);
  qp.add_row(Eigen::Vector3d(1.0, 2.0, 1.0), 3.0, 3.0);
  qp.add_row(Eigen::Vector3d(-2.0, -2.0, 0.0), -2.0, -2.0);
  qp.add_row(Eigen::Vector3d(1.0, 0.0, -1.0), -1.0, -1.0);
  expect_solution(qp, solve(qp));
}

TEST_F(ActiveSetQpDegenerateTest, HoldsMoreEqualitiesThanVariables) {
  Random random(4);
  for (const double size : {1.0, 1e3}) {
    Eigen::VectorXd point(5);
    for (int j = 0; j < 5; ++j) point[j] = size * random.uniform(-1.0, 1.0);
    DenseQp qp = nearest_to(Eigen::VectorXd::Zero(5));
    for (int i = 0; i < 17; ++i) {
      const Eigen::VectorXd normal =
          Eigen::VectorXd::NullaryExpr(5, [&](Eigen::Index) { return random.uniform(-1.0, 1.0); });
      qp.add_row(normal, normal.dot(point), normal.dot(point));
    }
    expect_solution(qp, solve(qp));
    EXPECT_LE((x() - point).norm(), 1e-9 * size);
  }
}

TEST_F(ActiveSetQpDegenerateTest, NamesAnEqualityThatContradictsOthers) {
  DenseQp qp = nearest_to(Eigen::Vector3d(4.0, 0.0, 0.0));
  qp.add_row(Eigen::Vector3d(1.0, 1.0, 0.0), 1.0, 1.0);
  qp.add_row(Eigen::Vector3d(0.0, 1.0, 1.0), 2.0, 2.0);
  qp.add_row(Eigen::Vector3d(0.0, 0.0, 1.0), 2.0, 2.0);
  qp.add_row(Eigen::Vector3d(1.0, 2.0, 1.0), 3.5, 3.5);
  expect_infeasible(qp, {0, 1, 3});
}

TEST_F(ActiveSetQpDegenerateTest, NamesARowThatContradictsAnEquality) {
  for (const double gap : {1e-4, 1.0, 1e4}) {
    DenseQp qp = nearest_to(Eigen::Vector2d(0.0, 0.0));
    qp.add_row(Eigen::Vector2d(1.0, 1.0), 1.0, 1.0);
    qp.add_row(Eigen::Vector2d(0.0, 1.0), -5.0, kInf);
    qp.add_row(Eigen::Vector2d(2.0, 2.0), 2.0 + gap, kInf);
    expect_infeasible(qp, {0, 2});
  }
}

// --- contradictions

TEST_F(ActiveSetQpDegenerateTest, RefusesLowerBoundsAboveUpperOnes) {
  for (const double gap : {1e-5, 1.0, 1e5}) {
    DenseQp row = nearest_to(Eigen::Vector2d(0.0, 0.0));
    row.add_row(Eigen::Vector2d(1.0, 2.0), gap, 0.0);
    expect_infeasible(row, {0});
    DenseQp bound = nearest_to(Eigen::Vector2d(0.0, 0.0));
    bound.set_bounds(1, 3.0 + gap, 3.0);
    expect_infeasible(bound, {1});
  }
}

TEST_F(ActiveSetQpDegenerateTest, SolvesAFeasibleProblemAfterAnInfeasibleOne) {
  Random random(6);
  for (int round = 0; round < 100; ++round) {
    PlantedQp planted = oracle::random_planted_qp(random, {.max_condition = 1e3});
    DenseQp broken = planted.qp;
    oracle::add_contradiction(random, 0.1, broken);
    EXPECT_EQ(solve(broken).status, QpStatus::kInfeasible) << oracle::to_text(broken);
    expect_solution(planted.qp, solve(planted.qp));
  }
}

// Others fail when called in a loop: "unable to perform homotopy as previous QP is not solved".
TEST_F(ActiveSetQpDegenerateTest, GivesTheSameBytesTwiceWhateverCameBetween) {
  Random random(7);
  const PlantedQp planted = oracle::random_planted_qp(random, {.max_condition = 1e3});
  const DenseQp& qp = planted.qp;
  const QpResult<double> first = solve(qp);
  expect_solution(qp, first);
  const Eigen::VectorXd x_first = x();
  const std::vector<double> lambda(solver_->multipliers().begin(), solver_->multipliers().end());
  const auto expect_same = [&](const QpResult<double>& again) {
    EXPECT_EQ(std::memcmp(x_first.data(), x().data(), sizeof(double) * rows_->primal().size()), 0);
    EXPECT_TRUE(std::equal(lambda.begin(), lambda.end(), solver_->multipliers().begin(),
                           solver_->multipliers().end()));
    EXPECT_EQ(first.num_steps, again.num_steps);
    EXPECT_EQ(first.gap, again.gap);
    EXPECT_EQ(first.primal_residual, again.primal_residual);
  };
  expect_same(solve(qp));
  // Without giving the rows again.
  expect_same(solver_->solve(*rows_, options_, Deadline()));
  DenseQp broken = qp;
  oracle::add_contradiction(random, 1.0, broken);
  EXPECT_EQ(solve(broken).status, QpStatus::kInfeasible);
  expect_same(solve(qp));
  options_.max_steps = 1;
  EXPECT_EQ(solve(long_problem()).status, QpStatus::kStepLimit);
  options_.max_steps = 1000;
  expect_same(solve(qp));
  DenseQp poisoned = qp;
  poisoned.f[0] = kNan;
  EXPECT_EQ(solve(poisoned).status, QpStatus::kBadInput);
  expect_same(solve(qp));
}

TEST_F(ActiveSetQpDegenerateTest, EndsInALoopOfWarmStartedSolves) {
  Random random(8);
  PlantedQp planted = oracle::random_planted_qp(random, {.max_condition = 1e3});
  std::vector<int> warm;
  for (int round = 0; round < 200; ++round) {
    options_.warm.rows = warm;
    const DenseQp qp = oracle::perturbed_partner(random, planted, 0.03);
    expect_solution(qp, solve(qp));
    warm.assign(solver_->active_rows().begin(), solver_->active_rows().end());
  }
}

// Random small-integer data make ties, zero steps and cycles likely; others loop there forever.
TEST_F(ActiveSetQpDegenerateTest, EndsOnDegenerateIntegerData) {
  Random random(14);
  int num_optimal = 0;
  for (int round = 0; round < 2000; ++round) {
    const int n = 1 + random.index(6);
    DenseQp qp = nearest_to(Eigen::VectorXd::Zero(n));
    for (int j = 0; j < n; ++j) qp.f[j] = random.index(5) - 2;
    const int num_rows = random.index(25);
    for (int i = 0; i < num_rows; ++i) {
      Eigen::VectorXd normal(n);
      for (int j = 0; j < n; ++j) normal[j] = random.index(3) - 1;
      const double lower = random.index(3) - 2;
      qp.add_row(normal, lower, random.chance(0.5) ? kInf : lower + random.index(3));
    }
    const QpResult<double> result = solve(qp);
    if (result.status == QpStatus::kOptimal) {
      expect_solution(qp, result);
      ++num_optimal;
    } else {
      EXPECT_EQ(result.status, QpStatus::kInfeasible) << oracle::to_text(qp);
    }
  }
  EXPECT_GT(num_optimal, 200);
}

}  // namespace
}  // namespace sopt
