// A solver over DenseRows and what tests expect of its answers: KKT conditions by separate code,
// known solutions, contradictions that name the right constraint. For tests.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <limits>
#include <vector>

#include "opt/qp/active_set_qp.h"
#include "tests/support/kkt.h"
#include "tests/support/test_problem.h"

namespace sopt::oracle {

inline constexpr int kMaxVariables = 40;
inline constexpr int kMaxRows = 160;
inline constexpr int kMaxActive = 64;

// min 1/2 |x - target|^2
inline DenseQp nearest_to(const Eigen::VectorXd& target) {
  const auto n = target.size();
  return DenseQp::unconstrained(Eigen::MatrixXd::Identity(n, n), -target);
}

class QpFixture : public ::testing::Test {
 protected:
  QpResult<double> solve(const DenseQp& qp, const Deadline& deadline = Deadline()) {
    EXPECT_TRUE(fill(qp, *rows_));
    return solver_->solve(*rows_, options_, deadline);
  }
  [[nodiscard]] Eigen::VectorXd x() const {
    const auto primal = rows_view_->primal();
    return Eigen::Map<const Eigen::VectorXd>(primal.data(),
                                             static_cast<Eigen::Index>(primal.size()));
  }
  [[nodiscard]] Eigen::VectorXd multipliers() {
    Eigen::VectorXd out(rows_->num_rows() + rows_->num_variables());
    rows_->write_multipliers(solver_->active_rows(), solver_->multipliers(), out.data());
    return out;
  }
  void expect_solution(const DenseQp& qp, const QpResult<double>& result) {
    ASSERT_EQ(result.status, QpStatus::kOptimal) << to_text(qp);
    const ScaledKkt kkt = scaled_kkt(qp, x(), multipliers());
    EXPECT_LE(kkt.stationarity, 1e-11) << to_text(qp);
    EXPECT_LE(kkt.violation, 1e-11) << to_text(qp);
    EXPECT_LE(kkt.sign, 0.0) << to_text(qp);
    EXPECT_LE(kkt.complementarity, 1e-11) << to_text(qp);
    EXPECT_EQ(result.num_active, static_cast<int>(solver_->active_rows().size()));
    for (std::size_t k = 0; k < solver_->active_rows().size(); ++k) {
      if (solver_->active_rows()[k] < rows_->num_equalities()) continue;
      EXPECT_GE(solver_->multipliers()[k], 0.0);
    }
  }
  void expect_solution_at(const Eigen::VectorXd& expected, const DenseQp& qp) {
    expect_solution(qp, solve(qp));
    EXPECT_LE((x() - expected).norm(), 1e-10 * (1.0 + expected.norm())) << x().transpose();
  }
  // What names a constraint of an infeasible problem.
  [[nodiscard]] int blocking_constraint(const QpResult<double>& result) const {
    const bool is_id = result.blocking_row >= 0 && result.blocking_row < rows_view_->num_ids();
    return is_id ? rows_view_->constraint(result.blocking_row) : -1;
  }
  void expect_infeasible(const DenseQp& qp, const std::vector<int>& suspects) {
    const QpResult<double> result = solve(qp);
    ASSERT_EQ(result.status, QpStatus::kInfeasible) << to_text(qp);
    EXPECT_EQ(std::count(suspects.begin(), suspects.end(), blocking_constraint(result)), 1)
        << blocking_constraint(result);
  }
  // Of about n steps.
  [[nodiscard]] static DenseQp long_problem() {
    Random random(12);
    DenseQp qp = nearest_to(Eigen::VectorXd::Zero(10));
    for (int j = 0; j < 10; ++j) {
      qp.set_bounds(j, random.uniform(1.0, 2.0), std::numeric_limits<double>::infinity());
    }
    for (int i = 0; i < 6; ++i) {
      qp.add_row(Eigen::VectorXd::Unit(10, i) - Eigen::VectorXd::Unit(10, i + 1), -0.1, 0.1);
    }
    return qp;
  }

  InArena<DenseRows<double>> rows_{DenseCapacity{kMaxVariables, kMaxRows, kMaxActive}};
  InArena<ActiveSetQp<double>> solver_{kMaxActive};
  const DenseRows<double>* rows_view_ = &*rows_;
  QpOptions<double> options_;
};

}  // namespace sopt::oracle
