#include "opt/qp/active_set_qp.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "rt/clock.h"
#include "tests/support/planted_qp.h"
#include "tests/support/qp_fixture.h"
#include "tests/support/rt_guard.h"

namespace sopt {
namespace {

using oracle::DenseQp;
using oracle::InArena;
using oracle::nearest_to;
using oracle::PlantedQp;
using oracle::Random;

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class ActiveSetQpTest : public oracle::QpFixture {};

// --- plain answers

TEST_F(ActiveSetQpTest, AnswersFailureByDefault) {
  const QpResult<double> result;
  EXPECT_EQ(result.status, QpStatus::kNotSolved);
  EXPECT_EQ(result.blocking_row, -1);
}

TEST_F(ActiveSetQpTest, StaysAtTheUnconstrainedOptimumWhenAllRowsHold) {
  DenseQp qp = nearest_to(Eigen::Vector2d(1.0, 2.0));
  qp.add_row(Eigen::Vector2d(1.0, 1.0), 2.0, 4.0);
  const QpResult<double> result = solve(qp);
  expect_solution(qp, result);
  EXPECT_EQ(result.num_steps, 0);
  EXPECT_EQ(result.num_active, 0);
  EXPECT_EQ(result.primal_residual, 0.0);
  EXPECT_EQ(result.gap, 0.0);
  EXPECT_EQ(x()[0], 1.0);
  EXPECT_EQ(x()[1], 2.0);
}

TEST_F(ActiveSetQpTest, ProjectsOntoEitherSideOfARow) {
  DenseQp qp = nearest_to(Eigen::Vector2d(3.0, 4.0));
  qp.add_row(Eigen::Vector2d(1.0, 1.0), -1.0, 1.0);
  expect_solution_at(Eigen::Vector2d(0.0, 1.0), qp);
  EXPECT_NEAR(multipliers()[0], -3.0, 1e-13);
  qp.f << 3.0, 4.0;
  expect_solution_at(Eigen::Vector2d(0.0, -1.0), qp);
  EXPECT_NEAR(multipliers()[0], 3.0, 1e-13);
}

TEST_F(ActiveSetQpTest, LetsGoOfARowThatALaterOneMakesSlack) {
  DenseQp qp = nearest_to(Eigen::Vector2d(0.0, 0.0));
  qp.add_row(Eigen::Vector2d(1.0, 0.0), 1.0, kInf);
  qp.add_row(Eigen::Vector2d(1.0, 1.0) / std::sqrt(2.0), 0.9, kInf);
  qp.add_row(Eigen::Vector2d(1.0, 0.2), 2.0, kInf);
  const QpResult<double> result = solve(qp);
  expect_solution(qp, result);
  EXPECT_EQ(result.num_active, 1);
}

TEST_F(ActiveSetQpTest, FindsPlantedSolutions) {
  Random random(1);
  for (int round = 0; round < 300; ++round) {
    const PlantedQp planted = oracle::random_planted_qp(random, {.max_condition = 1e3});
    expect_solution(planted.qp, solve(planted.qp));
    if (planted.gram_condition < 1e3) {
      EXPECT_LE((x() - planted.x).norm(), 1e-9 * (1.0 + planted.x.norm()));
    }
  }
}

// --- limits

TEST_F(ActiveSetQpTest, StopsAtEveryStepLimitBelowTheNeed) {
  const DenseQp qp = long_problem();
  const QpResult<double> whole = solve(qp);
  expect_solution(qp, whole);
  ASSERT_GT(whole.num_steps, 8);
  for (int max_steps = 0; max_steps < whole.num_steps; ++max_steps) {
    options_.max_steps = max_steps;
    const QpResult<double> result = solve(qp);
    EXPECT_EQ(result.status, QpStatus::kStepLimit) << max_steps;
    EXPECT_EQ(result.num_steps, max_steps);
    EXPECT_GT(result.primal_residual, 1e-9);
  }
  options_.max_steps = whole.num_steps;
  expect_solution(qp, solve(qp));
}

TEST_F(ActiveSetQpTest, NeedsNoStepWhenNothingIsViolated) {
  options_.max_steps = 0;
  DenseQp qp = nearest_to(Eigen::Vector2d(0.0, 0.0));
  qp.add_row(Eigen::Vector2d(1.0, 0.0), -1.0, 1.0);
  EXPECT_EQ(solve(qp).status, QpStatus::kOptimal);
}

TEST_F(ActiveSetQpTest, StopsAtADeadlineAtEveryPoll) {
  const DenseQp qp = long_problem();
  const QpResult<double> whole = solve(qp);
  ASSERT_GT(whole.num_steps, 8);
  for (int polls = 0; polls < whole.num_steps; ++polls) {
    ManualClock clock(1000);
    const QpResult<double> result = solve(qp, Deadline(clock.clock(), 0, 1e-6 * polls));
    EXPECT_EQ(result.status, QpStatus::kDeadline) << polls;
    EXPECT_LE(result.num_steps, polls);
    EXPECT_GE(clock.num_reads(), polls);
  }
  ManualClock clock(1000);
  EXPECT_EQ(solve(qp, Deadline(clock.clock(), 0, 1.0)).status, QpStatus::kOptimal);
}

TEST_F(ActiveSetQpTest, RecoversAfterAStepLimitAndADeadline) {
  const DenseQp qp = long_problem();
  options_.max_steps = 5;
  EXPECT_EQ(solve(qp).status, QpStatus::kStepLimit);
  options_.max_steps = 1000;
  // The same rows, not filled again.
  expect_solution(qp, solver_->solve(*rows_, options_, Deadline()));
  ManualClock clock(1000);
  EXPECT_EQ(solve(qp, Deadline(clock.clock(), 0, 4e-6)).status, QpStatus::kDeadline);
  expect_solution(qp, solver_->solve(*rows_, options_, Deadline()));
}

TEST_F(ActiveSetQpTest, RefusesMoreActiveRowsThanItHolds) {
  const DenseQp qp = long_problem();
  const int num_active = solve(qp).num_active;
  ASSERT_GT(num_active, 3);
  for (int max_active = 0; max_active <= num_active; ++max_active) {
    InArena<ActiveSetQp<double>> small(max_active);
    ASSERT_TRUE(oracle::fill(qp, *rows_));
    const QpResult<double> result = small->solve(*rows_, options_, Deadline());
    if (max_active < num_active) {
      EXPECT_EQ(result.status, QpStatus::kCapacity) << max_active;
    } else {
      EXPECT_EQ(result.status, QpStatus::kOptimal) << max_active;
    }
  }
}

TEST_F(ActiveSetQpTest, HoldsItsLargestProblem) {
  InArena<DenseRows<double>> rows(DenseCapacity{6, 12, 6});
  InArena<ActiveSetQp<double>> solver(6);
  DenseQp qp = nearest_to(Eigen::VectorXd::Zero(6));
  for (int j = 0; j < 6; ++j) qp.set_bounds(j, 1.0 + j, kInf);
  for (int i = 0; i < 12; ++i) qp.add_row(Eigen::VectorXd::Unit(6, i % 6), 0.5, 20.0);
  ASSERT_TRUE(oracle::fill(qp, *rows));
  EXPECT_EQ(solver->solve(*rows, {}, Deadline()).status, QpStatus::kOptimal);
  EXPECT_EQ(solver->active_rows().size(), 6u);
  for (int j = 0; j < 6; ++j) {
    EXPECT_NEAR(rows->primal()[static_cast<std::size_t>(j)], 1.0 + j, 1e-12);
  }
}

TEST_F(ActiveSetQpTest, ManagesWithoutVariablesAndWithoutRows) {
  DenseQp nothing = nearest_to(Eigen::VectorXd(0));
  EXPECT_EQ(solve(nothing).status, QpStatus::kOptimal);
  nothing.add_row(Eigen::VectorXd(0), -1.0, 1.0);
  EXPECT_EQ(solve(nothing).status, QpStatus::kOptimal);
  nothing.add_row(Eigen::VectorXd(0), 1.0, 1.0);
  EXPECT_EQ(solve(nothing).status, QpStatus::kInfeasible);
  expect_solution_at(Eigen::Vector2d(1.0, -1.0), nearest_to(Eigen::Vector2d(1.0, -1.0)));
}

// --- bad input

TEST_F(ActiveSetQpTest, RefusesNumbersThatAreNone) {
  DenseQp good = nearest_to(Eigen::Vector2d(3.0, 4.0));
  good.add_row(Eigen::Vector2d(1.0, 1.0), -1.0, 1.0);
  good.set_bounds(1, -2.0, 2.0);
  const auto expect_bad = [&](const DenseQp& qp, const std::string& what) {
    const bool has_hessian = oracle::fill(qp, *rows_);
    if (!has_hessian) rows_->reset(qp.f.data());
    const QpResult<double> result = solver_->solve(*rows_, options_, Deadline());
    EXPECT_EQ(result.status, QpStatus::kBadInput) << what;
    EXPECT_TRUE(solver_->active_rows().empty());
  };
  for (const double bad : {kNan, kInf, -kInf}) {
    const std::string name = std::to_string(bad);
    for (const int i : {0, 1}) {
      DenseQp qp = good;
      qp.f[i] = bad;
      expect_bad(qp, "f " + name);
      qp = good;
      qp.a(0, i) = bad;
      expect_bad(qp, "A " + name);
      for (const int j : {0, 1}) {
        qp = good;
        qp.h(i, j) = qp.h(j, i) = bad;
        expect_bad(qp, "H " + name);
      }
    }
    for (const int c : {0, 2}) {
      if (bad != -kInf) {
        DenseQp qp = good;
        qp.set_bounds(c, bad, 1.0);
        expect_bad(qp, "lower " + name);
        qp.set_bounds(c, bad, kInf);
        expect_bad(qp, "lower without upper " + name);
      }
      if (bad != kInf) {
        DenseQp qp = good;
        qp.set_bounds(c, -1.0, bad);
        expect_bad(qp, "upper " + name);
        qp.set_bounds(c, -kInf, bad);
        expect_bad(qp, "upper without lower " + name);
      }
    }
  }
  expect_solution(good, solve(good));
}

TEST_F(ActiveSetQpTest, TakesInfiniteBoundsAsNone) {
  DenseQp qp = nearest_to(Eigen::Vector2d(3.0, 4.0));
  qp.add_row(Eigen::Vector2d(1.0, 1.0), -kInf, kInf);
  qp.set_bounds(2, -kInf, 1.0);
  qp.set_bounds(1, -kInf, kInf);
  expect_solution_at(Eigen::Vector2d(3.0, 1.0), qp);
}

TEST_F(ActiveSetQpTest, RefusesHessiansThatAreNotPositiveDefinite) {
  const Eigen::Vector2d f(1.0, 1.0);
  for (const double lowest : {-1.0, -1e-9, 0.0}) {
    Eigen::Matrix2d h;
    h << 1.0, 1.0, 1.0, 1.0 + lowest;
    EXPECT_FALSE(rows_->factorize(2, h.data()));
    rows_->reset(f.data());
    EXPECT_EQ(solver_->solve(*rows_, options_, Deadline()).status, QpStatus::kBadInput);
  }
}

TEST_F(ActiveSetQpTest, RefusesStepLimitsAndTolerancesThatMakeNoSense) {
  const DenseQp qp = long_problem();
  options_.max_steps = -1;
  EXPECT_EQ(solve(qp).status, QpStatus::kStepLimit);
  options_.max_steps = 1000;
  // Too fine a tolerance costs steps or says that it was not met; it never calls the problem
  // infeasible.
  for (const double tolerance : {1e-14, 1e-16, 0.0}) {
    options_.violation_tolerance = tolerance;
    const QpResult<double> result = solve(qp);
    EXPECT_TRUE(result.status == QpStatus::kOptimal || result.status == QpStatus::kInaccurate);
    EXPECT_LE(oracle::scaled_violation(qp, x()), 1e-11);
  }
}

// --- what the result says

TEST_F(ActiveSetQpTest, ReportsResidualsThatExplainWhatIsViolated) {
  Random random(11);
  for (int round = 0; round < 100; ++round) {
    const PlantedQp planted = oracle::random_planted_qp(random);
    const QpResult<double> result = solve(planted.qp);
    expect_solution(planted.qp, result);
    const double violation = oracle::scaled_violation(planted.qp, x());
    // Rows that hold within the tolerance are not in it.
    EXPECT_GE(std::max(result.primal_residual, options_.violation_tolerance), 0.999 * violation);
    EXPECT_LE(result.primal_residual, 1e-10);
    EXPECT_GE(result.dual_residual, 0.0);
    EXPECT_LE(result.dual_residual, 1e-11);
    EXPECT_GE(result.gap, 0.0);
    EXPECT_LE(result.num_refactored, 1);
    EXPECT_LE(result.num_active, planted.qp.num_variables());
    EXPECT_EQ(result.blocking_row, -1);
  }
}

TEST_F(ActiveSetQpTest, SaysHowFarAnUnfinishedPointIsFromFeasible) {
  const DenseQp qp = long_problem();
  options_.max_steps = 4;
  const QpResult<double> result = solve(qp);
  EXPECT_EQ(result.status, QpStatus::kStepLimit);
  EXPECT_NEAR(result.primal_residual, oracle::scaled_violation(qp, x()), 1e-10);
}

TEST_F(ActiveSetQpTest, TouchesNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "this build cannot count allocations";
  Random random(13);
  const PlantedQp planted = oracle::random_planted_qp(random);
  DenseQp broken = planted.qp;
  oracle::add_contradiction(random, 1.0, broken);
  for (const DenseQp* qp : {&planted.qp, static_cast<const DenseQp*>(&broken)}) {
    ASSERT_TRUE(oracle::fill(*qp, *rows_));
    RtGuard guard;
    const QpResult<double> result = solver_->solve(*rows_, options_, Deadline());
    guard.stop();
    EXPECT_NE(result.status, QpStatus::kNotSolved);
    EXPECT_EQ(guard.num_allocations() + guard.num_releases() + guard.num_locks(), 0);
  }
}

}  // namespace
}  // namespace sopt
