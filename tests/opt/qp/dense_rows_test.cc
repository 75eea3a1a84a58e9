#include "opt/qp/dense_rows.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/planted_qp.h"
#include "tests/support/rt_guard.h"
#include "tests/support/test_problem.h"

namespace sopt {
namespace {

using oracle::DenseQp;
using oracle::InArena;
using oracle::Random;

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class DenseRowsTest : public ::testing::Test {
 protected:
  static constexpr int kMaxVariables = 12;
  static constexpr int kMaxRows = 18;
  static constexpr int kMaxActive = 24;

  // Gives `rows_` random rows and bounds, with equalities among them, and keeps them in `qp_`.
  void fill_random(Random& random) {
    qp_ = oracle::random_planted_qp(random, {.max_variables = 8, .max_condition = 1e2}).qp;
    while (qp_.num_rows() > kMaxRows || qp_.num_variables() == 0) {
      qp_ = oracle::random_planted_qp(random, {.max_variables = 8, .max_condition = 1e2}).qp;
    }
    ASSERT_TRUE(oracle::fill(qp_, *rows_));
  }
  // The row of an id: sign a / max(|a|, |bound|).
  [[nodiscard]] Eigen::VectorXd scaled_row(int id) const {
    const int c = rows_ids_->constraint(id);
    const bool is_upper = rows_ids_->is_upper(id);
    const double bound = is_upper ? qp_.upper_of(c) : qp_.lower_of(c);
    const double length = qp_.normal(c).norm();
    return (is_upper ? -1.0 : 1.0) / std::max(length, std::abs(bound)) * qp_.normal(c);
  }
  // What rows are compared by: violation^2 / sum a_j^2 / H_jj.
  [[nodiscard]] double price(int id) const {
    const double violation = std::max(0.0, rows_ids_->violation(id));
    const Eigen::VectorXd a = scaled_row(id);
    return violation * violation / a.cwiseAbs2().cwiseQuotient(qp_.h.diagonal()).sum();
  }
  // Ids with a bound, not of equalities' sides.
  [[nodiscard]] std::vector<int> bounded_ids() const {
    std::vector<int> ids;
    for (int id = 0; id < rows_ids_->num_ids(); ++id) {
      const int c = rows_ids_->constraint(id);
      const double bound = rows_ids_->is_upper(id) ? qp_.upper_of(c) : qp_.lower_of(c);
      const bool is_side = id >= rows_ids_->num_equalities() && qp_.lower_of(c) == qp_.upper_of(c);
      if (std::isfinite(bound) && !is_side) ids.push_back(id);
    }
    return ids;
  }
  // Of at most 8 rows of a new random problem, weights up to 2.
  struct Combination {
    std::vector<int> ids;
    std::vector<double> weights;
    Eigen::VectorXd sum;
  };
  [[nodiscard]] Combination random_combination(Random& random, double lowest_weight) {
    fill_random(random);
    std::vector<int> ids = bounded_ids();
    ids.resize(std::min<std::size_t>(ids.size(), 8));
    Combination combination = {ids, {}, Eigen::VectorXd::Zero(qp_.num_variables())};
    for (const int id : ids) {
      combination.weights.push_back(random.uniform(lowest_weight, 2.0));
      combination.sum += combination.weights.back() * scaled_row(id);
    }
    return combination;
  }
  void reset(int n, const std::vector<double>& gradient) {
    const Eigen::MatrixXd h = Eigen::MatrixXd::Identity(n, n);
    ASSERT_TRUE(rows_->factorize(n, h.data()));
    rows_->reset(gradient.data());
  }
  [[nodiscard]] bool factorizes(const Eigen::MatrixXd& h) {
    const bool is_accepted = rows_->factorize(static_cast<int>(h.rows()), h.data());
    const Eigen::VectorXd f = Eigen::VectorXd::Zero(h.rows());
    if (is_accepted) rows_->reset(f.data());
    EXPECT_EQ(rows_->is_valid(), is_accepted);
    return is_accepted;
  }

  DenseQp qp_;
  InArena<DenseRows<double>> rows_{DenseCapacity{kMaxVariables, kMaxRows, kMaxActive}};
  const DenseRows<double>* rows_ids_ = &*rows_;
};

TEST_F(DenseRowsTest, StandsAtTheUnconstrainedOptimum) {
  Random random(1);
  for (int round = 0; round < 50; ++round) {
    fill_random(random);
    const Eigen::VectorXd expected = qp_.h.llt().solve(-qp_.f);
    ASSERT_EQ(rows_->num_variables(), qp_.num_variables());
    rows_->update_primal({}, {});
    for (int j = 0; j < qp_.num_variables(); ++j) {
      EXPECT_NEAR(rows_->primal()[static_cast<std::size_t>(j)], expected[j],
                  1e-11 * (1.0 + expected.norm()));
    }
  }
}

TEST_F(DenseRowsTest, NumbersEqualitiesFirstThenBothSidesOfEveryConstraint) {
  reset(2, {0.0, 0.0});
  const double a[] = {1.0, 2.0};
  ASSERT_TRUE(rows_->try_add(a, -1.0, 1.0));
  ASSERT_TRUE(rows_->try_add(a, 3.0, 3.0));
  rows_->set_bounds(1, 0.5, 0.5);
  EXPECT_EQ(rows_->num_rows(), 2);
  ASSERT_EQ(rows_->num_equalities(), 2);
  EXPECT_EQ(rows_->num_ids(), 2 + 2 * 4);
  EXPECT_EQ(rows_->constraint(0), 1);
  EXPECT_EQ(rows_->constraint(1), 3);
  for (int c = 0; c < 4; ++c) {
    EXPECT_EQ(rows_->lower_id(c), 2 + 2 * c);
    EXPECT_EQ(rows_->constraint(rows_->lower_id(c)), c);
    EXPECT_FALSE(rows_->is_upper(rows_->lower_id(c)));
    EXPECT_EQ(rows_->constraint(rows_->lower_id(c) + 1), c);
    EXPECT_TRUE(rows_->is_upper(rows_->lower_id(c) + 1));
  }
}

TEST_F(DenseRowsTest, HasTheGramOfTheInverseHessian) {
  Random random(2);
  for (int round = 0; round < 50; ++round) {
    fill_random(random);
    std::vector<int> ids = bounded_ids();
    ids.resize(std::min<std::size_t>(ids.size(), kMaxActive));
    for (const int id : ids) rows_->enter(id);
    std::vector<double> gram(ids.size());
    for (const int id : ids) {
      rows_->gram(ids, id, gram.data());
      const Eigen::VectorXd a = scaled_row(id);
      const Eigen::VectorXd response = qp_.h.llt().solve(a);
      for (std::size_t k = 0; k < ids.size(); ++k) {
        const Eigen::VectorXd b = scaled_row(ids[k]);
        const double size = std::sqrt(a.dot(response) * b.dot(qp_.h.llt().solve(b)));
        EXPECT_NEAR(gram[k], b.dot(response), 1e-12 * size);
      }
    }
    for (const int id : ids) rows_->leave(id);
  }
}

TEST_F(DenseRowsTest, MovesThePrimalAlongRows) {
  Random random(3);
  for (int round = 0; round < 50; ++round) {
    const auto [ids, weights, force] = random_combination(random, -2.0);
    for (const int id : ids) rows_->enter(id);
    const Eigen::VectorXd step = qp_.h.llt().solve(force);
    const Eigen::VectorXd x = qp_.h.llt().solve(force - qp_.f);
    const double tol = 1e-11 * (1.0 + x.norm() + step.norm());
    rows_->update_step(ids, weights);
    for (const int id : ids) EXPECT_NEAR(rows_->step_value(id), scaled_row(id).dot(step), tol);
    const auto expect_at = [&](const Eigen::VectorXd& expected) {
      for (int c = 0; c < qp_.num_constraints(); ++c) {
        const double value = qp_.normal(c).dot(expected);
        EXPECT_NEAR(rows_->value(c), value, tol * (1.0 + qp_.normal(c).norm()));
      }
    };
    rows_->update_primal(ids, weights);
    expect_at(x);
    rows_->add_step();
    expect_at(x + step);
    for (const int id : ids) rows_->leave(id);
  }
}

TEST_F(DenseRowsTest, ScalesViolationsByTheLongerOfRowAndBound) {
  reset(2, {-1.0, 0.0});  // x = (1, 0)
  const double a[] = {3.0, 4.0};
  const double small[] = {0.003, 0.004};
  const double zero[] = {0.0, 0.0};
  ASSERT_TRUE(rows_->try_add(a, 4.0, kInf));
  ASSERT_TRUE(rows_->try_add(a, 300.0, kInf));
  ASSERT_TRUE(rows_->try_add(small, -kInf, 0.001));
  ASSERT_TRUE(rows_->try_add(zero, 0.5, kInf));
  rows_->set_bounds(0, 3.0, kInf);
  rows_->update_primal({}, {});
  EXPECT_NEAR(rows_->violation(rows_->lower_id(0)), 1.0 / 5.0, 1e-14);
  EXPECT_NEAR(rows_->violation(rows_->lower_id(1)), 297.0 / 300.0, 1e-14);
  EXPECT_NEAR(rows_->violation(rows_->lower_id(2) + 1), 0.002 / 0.005, 1e-13);
  EXPECT_NEAR(rows_->violation(rows_->lower_id(3)), 0.5, 1e-14);
  EXPECT_NEAR(rows_->violation(rows_->lower_id(4)), 2.0 / 3.0, 1e-14);
}

TEST_F(DenseRowsTest, FindsTheMostViolatedOfRowsNotEntered) {
  Random random(4);
  for (int round = 0; round < 200; ++round) {
    fill_random(random);
    std::vector<int> ids = bounded_ids();
    std::vector<int> entered;
    for (const int id : ids) {
      if (random.chance(0.2) && entered.size() < kMaxActive) entered.push_back(id);
    }
    for (const int id : entered) rows_->enter(id);
    rows_->update_primal({}, {});
    double worst = 0.0;
    double worst_price = 0.0;
    for (const int id : ids) {
      const bool is_priced = id >= rows_->num_equalities() &&
                             std::find(entered.begin(), entered.end(), id) == entered.end();
      if (!is_priced) continue;
      worst = std::max(worst, rows_->violation(id));
      worst_price = std::max(worst_price, price(id));
    }
    const int found = rows_->most_violated(0.0);
    // Pricing may add up in another order than violation() does.
    const double tol = 1e-12 * (1.0 + worst);
    if (found >= 0) {
      EXPECT_GT(rows_->violation(found), 0.0);
      EXPECT_NEAR(price(found), worst_price, 1e-10 * (1.0 + worst_price));
    } else {
      EXPECT_LE(worst, tol);
    }
    EXPECT_EQ(rows_->most_violated(worst + tol), -1);
    for (const int id : entered) rows_->leave(id);
  }
}

TEST_F(DenseRowsTest, PricesARowAgainAfterItLeft) {
  reset(1, {0.0});
  rows_->set_bounds(0, 1.0, kInf);
  rows_->update_primal({}, {});
  const int id = rows_->lower_id(0);
  EXPECT_EQ(rows_->most_violated(0.0), id);
  rows_->enter(id);
  EXPECT_EQ(rows_->most_violated(0.0), -1);
  rows_->leave(id);
  EXPECT_EQ(rows_->most_violated(0.0), id);
}

TEST_F(DenseRowsTest, NeverPricesEqualities) {
  reset(1, {0.0});
  rows_->set_bounds(0, 1.0, 1.0);
  rows_->update_primal({}, {});
  EXPECT_EQ(rows_->most_violated(0.0), -1);
  rows_->enter(0);
  rows_->leave(0);
  EXPECT_EQ(rows_->most_violated(0.0), -1);
  EXPECT_EQ(rows_->violation(0), 1.0);
}

TEST_F(DenseRowsTest, TakesTheLastBoundsOfAVariable) {
  reset(2, {0.0, 0.0});
  rows_->set_bounds(0, 1.0, 1.0);
  rows_->set_bounds(0, 2.0, 3.0);
  rows_->update_primal({}, {});
  EXPECT_EQ(rows_->num_equalities(), 0);
  EXPECT_EQ(rows_->most_violated(0.0), rows_->lower_id(0));
  reset(2, {0.0, 0.0});
  rows_->set_bounds(1, 1.0, 1.0);
  rows_->set_bounds(1, 1.0, 1.0);
  EXPECT_EQ(rows_->num_equalities(), 1);
}

TEST_F(DenseRowsTest, ForgetsRowsBoundsAndEqualitiesAtReset) {
  reset(2, {0.0, 0.0});
  const double a[] = {1.0, 0.0};
  ASSERT_TRUE(rows_->try_add(a, 1.0, 1.0));
  rows_->set_bounds(1, 2.0, kInf);
  const double gradient[] = {-3.0, 0.0};
  rows_->reset(gradient);
  rows_->update_primal({}, {});
  EXPECT_EQ(rows_->num_rows(), 0);
  EXPECT_EQ(rows_->num_equalities(), 0);
  EXPECT_EQ(rows_->most_violated(0.0), -1);
  EXPECT_EQ(rows_->primal()[0], 3.0);
  EXPECT_TRUE(rows_->is_valid());
}

TEST_F(DenseRowsTest, WritesMultipliersInTheUnitsOfTheProblem) {
  Random random(5);
  for (int round = 0; round < 50; ++round) {
    const auto [ids, weights, force] = random_combination(random, 0.0);
    Eigen::VectorXd out = Eigen::VectorXd::Constant(qp_.num_constraints(), 7.0);
    rows_->write_multipliers(ids, weights, out.data());
    const Eigen::VectorXd sum =
        qp_.a.transpose() * out.head(qp_.num_rows()) + out.tail(qp_.num_variables());
    EXPECT_LE((sum - force).norm(), 1e-13 * (1.0 + force.norm()));
  }
}

TEST_F(DenseRowsTest, ScalesSoftnessWithTheRow) {
  reset(2, {0.0, 0.0});
  const double a[] = {3.0, 4.0};
  ASSERT_TRUE(rows_->try_add(a, 1.0, 10.0));
  rows_->set_softness(0, 0.5);
  EXPECT_NEAR(rows_->softness(rows_->lower_id(0)), 0.5 / 25.0, 1e-16);
  EXPECT_NEAR(rows_->softness(rows_->lower_id(0) + 1), 0.5 / 100.0, 1e-16);
  EXPECT_EQ(rows_->softness(rows_->lower_id(1)), 0.0);
}

TEST_F(DenseRowsTest, RefusesHessiansThatAreNotPositiveDefinite) {
  Random random(6);
  const Eigen::MatrixXd h = oracle::random_hessian(random, 6, 1e3, 1e-2);
  EXPECT_TRUE(factorizes(h));
  EXPECT_FALSE(factorizes(-h));
  EXPECT_FALSE(factorizes(Eigen::MatrixXd::Zero(3, 3)));
  EXPECT_FALSE(factorizes(Eigen::MatrixXd::Ones(3, 3)));
  Eigen::Vector3d eigenvalues(1.0, 0.0, 1.0);
  EXPECT_FALSE(factorizes(eigenvalues.asDiagonal()));
  eigenvalues[1] = -1e-3;
  EXPECT_FALSE(factorizes(eigenvalues.asDiagonal()));
  const Eigen::VectorXd v = Eigen::VectorXd::LinSpaced(5, 0.3, 2.0);
  EXPECT_FALSE(factorizes(v * v.transpose()));
  EXPECT_TRUE(factorizes(h));
}

TEST_F(DenseRowsTest, RefusesHessiansThatAreNotFinite) {
  Random random(7);
  const Eigen::MatrixXd h = oracle::random_hessian(random, 5, 1e3, 1e-2);
  for (const double bad : {kNan, kInf, -kInf}) {
    for (int i = 0; i < 5; ++i) {
      for (int j = 0; j <= i; ++j) {
        Eigen::MatrixXd wrong = h;
        wrong(i, j) = wrong(j, i) = bad;
        EXPECT_FALSE(factorizes(wrong)) << i << " " << j << " " << bad;
      }
    }
  }
}

TEST_F(DenseRowsTest, IsNotValidBeforeAHessianIsGiven) { EXPECT_FALSE(rows_->is_valid()); }

TEST_F(DenseRowsTest, AcceptsHessiansOfTinyAndHugeNumbers) {
  Random random(8);
  const Eigen::MatrixXd h = oracle::random_hessian(random, 6, 1e3, 1.0);
  EXPECT_TRUE(factorizes(1e-30 * h));
  EXPECT_TRUE(factorizes(1e30 * h));
}

TEST_F(DenseRowsTest, ReadsTheLowerTriangleOnly) {
  const double h[] = {2.0, kNan, 1.0, 3.0};  // row after row
  ASSERT_TRUE(rows_->factorize(2, h));
  const double gradient[] = {-4.0, -7.0};
  rows_->reset(gradient);
  rows_->update_primal({}, {});
  EXPECT_NEAR(rows_->primal()[0], 1.0, 1e-14);
  EXPECT_NEAR(rows_->primal()[1], 2.0, 1e-14);
}

TEST_F(DenseRowsTest, SaysWhenDataAreNotNumbers) {
  const double ones[] = {1.0, 1.0};
  for (const double bad : {kNan, kInf, -kInf}) {
    for (const int i : {0, 1}) {
      double wrong[] = {1.0, 1.0};
      wrong[i] = bad;
      reset(2, {wrong[0], wrong[1]});
      EXPECT_FALSE(rows_->is_valid());
      reset(2, {0.0, 0.0});
      EXPECT_TRUE(rows_->is_valid());
      ASSERT_TRUE(rows_->try_add(wrong, -1.0, 1.0));
      EXPECT_FALSE(rows_->is_valid());
    }
  }
  constexpr double kBadBounds[][2] = {{kNan, 1.0},  {0.0, kNan}, {kNan, kNan},   {kInf, kInf},
                                      {0.0, -kInf}, {kInf, 1.0}, {-kInf, -kInf}, {kInf, -kInf}};
  for (const auto& bounds : kBadBounds) {
    reset(2, {0.0, 0.0});
    ASSERT_TRUE(rows_->try_add(ones, bounds[0], bounds[1]));
    EXPECT_FALSE(rows_->is_valid()) << bounds[0] << " " << bounds[1];
    reset(2, {0.0, 0.0});
    rows_->set_bounds(1, bounds[0], bounds[1]);
    EXPECT_FALSE(rows_->is_valid()) << bounds[0] << " " << bounds[1];
  }
  reset(2, {0.0, 0.0});
  ASSERT_TRUE(rows_->try_add(ones, -kInf, kInf));
  rows_->set_bounds(0, -kInf, 1.0);
  rows_->set_bounds(1, 1.0, kInf);
  EXPECT_TRUE(rows_->is_valid());
}

TEST_F(DenseRowsTest, HoldsItsCapacityExactly) {
  const Eigen::MatrixXd h = Eigen::MatrixXd::Identity(kMaxVariables + 1, kMaxVariables + 1);
  EXPECT_FALSE(rows_->factorize(kMaxVariables + 1, h.data()));
  EXPECT_FALSE(rows_->is_valid());
  EXPECT_FALSE(rows_->factorize(-1, h.data()));
  const std::vector<double> zeros(kMaxVariables, 0.0);
  reset(kMaxVariables, zeros);
  const std::vector<double> ones(kMaxVariables, 1.0);
  for (int i = 0; i < kMaxRows; ++i) ASSERT_TRUE(rows_->try_add(ones.data(), 1.0 + i, kInf));
  int num_more = 0;
  while (num_more < 100 && rows_->try_add(ones.data(), 1000.0, kInf)) ++num_more;
  EXPECT_LT(num_more, 100);
  EXPECT_EQ(rows_->num_rows(), kMaxRows + num_more);
  for (int j = 0; j < kMaxVariables; ++j) rows_->set_bounds(j, -1.0, 1.0);
  EXPECT_TRUE(rows_->is_valid());
  EXPECT_FALSE(rows_.exhausted());
}

TEST_F(DenseRowsTest, HoldsAnEqualityForEveryConstraint) {
  const std::vector<double> zeros(kMaxVariables, 0.0);
  const std::vector<double> ones(kMaxVariables, 1.0);
  reset(kMaxVariables, zeros);
  while (rows_->num_rows() < 100 && rows_->try_add(ones.data(), 1.0, 1.0)) continue;
  EXPECT_GE(rows_->num_rows(), kMaxRows);
  for (int j = 0; j < kMaxVariables; ++j) rows_->set_bounds(j, 1.0, 1.0);
  EXPECT_EQ(rows_->num_equalities(), rows_->num_rows() + kMaxVariables);
}

TEST_F(DenseRowsTest, ManagesWithoutVariables) {
  ASSERT_TRUE(rows_->factorize(0, nullptr));
  rows_->reset(nullptr);
  EXPECT_TRUE(rows_->is_valid());
  EXPECT_EQ(rows_->num_ids(), 0);
  ASSERT_TRUE(rows_->try_add(nullptr, 1.0, kInf));
  rows_->update_primal({}, {});
  EXPECT_EQ(rows_->most_violated(0.0), rows_->lower_id(0));
}

TEST_F(DenseRowsTest, TouchesNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "this build cannot count allocations";
  const double h[] = {2.0, 1.0, 1.0, 3.0};
  const double a[] = {1.0, 1.0};
  RtGuard guard;
  const bool is_convex = rows_->factorize(2, h);
  rows_->reset(a);
  const bool has_room = rows_->try_add(a, 1.0, 2.0);
  rows_->set_bounds(0, 0.0, 1.0);
  rows_->enter(rows_->lower_id(0));
  rows_->leave(rows_->lower_id(0));
  guard.stop();
  EXPECT_TRUE(is_convex && has_room);
  EXPECT_EQ(guard.num_allocations() + guard.num_releases() + guard.num_locks(), 0);
}

}  // namespace
}  // namespace sopt
