#include "opt/point_rows.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <vector>

#include "tests/support/dense_qp.h"
#include "tests/support/test_problem.h"

namespace sopt {
namespace {

using oracle::InArena;
using oracle::Random;
using oracle::SegmentQp;

TEST(PointRows, StandsOnTheLineBetweenTheEndsWithoutMultipliers) {
  InArena<PointRows> rows(60, 64);
  rows->reset(4, {0.0, 8.0}, {4.0, 0.0});
  rows->update_primal({}, {});
  EXPECT_EQ(rows->num_steps(), 4);
  EXPECT_EQ(rows->num_rows(), 0);
  EXPECT_EQ(rows->most_violated(), -1);
  for (int t = 0; t <= 4; ++t) {
    EXPECT_NEAR(rows->position(t).x(), t, 1e-15);
    EXPECT_NEAR(rows->position(t).y(), 8.0 - 2.0 * t, 1e-15);
  }
}

TEST(PointRows, HasTheGramOfTheInverseSecondDifference) {
  Random random(1);
  InArena<PointRows> rows(60, 512);
  for (int num_steps = 2; num_steps <= 60; num_steps += 1 + num_steps / 8) {
    const SegmentQp qp = oracle::random_feasible_qp(random, num_steps, 40);
    ASSERT_TRUE(oracle::fill(qp, *rows));
    const Eigen::MatrixXd expected = qp.gram();
    const std::vector<int> index = oracle::row_indices(qp);
    for (std::size_t i = 0; i < index.size(); ++i) {
      for (std::size_t k = 0; k < index.size(); ++k) {
        EXPECT_NEAR(rows->gram(index[i], index[k]),
                    expected(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)),
                    1e-12 * num_steps);
      }
    }
  }
}

TEST(PointRows, MovesThePrimalAsTheGreensFunctionSays) {
  Random random(2);
  InArena<PointRows> rows(60, 512);
  for (int round = 0; round < 50; ++round) {
    const int num_steps = 2 + random.index(59);
    const SegmentQp qp = oracle::random_feasible_qp(random, num_steps, 1 + random.index(60));
    ASSERT_TRUE(oracle::fill(qp, *rows));
    const std::vector<int> index = oracle::row_indices(qp);
    Eigen::VectorXd lambda = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(qp.rows.size()));
    std::vector<int> active;
    std::vector<double> multipliers;
    for (std::size_t i = 0; i < index.size(); ++i) {
      if (!random.chance(0.4)) continue;
      active.insert(active.begin() + random.index(static_cast<int>(active.size()) + 1), index[i]);
      lambda[static_cast<Eigen::Index>(i)] = random.uniform(0.0, 0.1);
    }
    for (const int row : active) {
      const auto at = std::find(index.begin(), index.end(), row) - index.begin();
      multipliers.push_back(lambda[at]);
    }
    rows->update_primal(active, multipliers);
    const Eigen::VectorXd expected = qp.primal(lambda);
    EXPECT_EQ(rows->position(0), qp.first);
    EXPECT_EQ(rows->position(num_steps), qp.last);
    for (int t = 1; t < num_steps; ++t) {
      EXPECT_NEAR(rows->position(t).x(), expected[2 * (t - 1)], 1e-12 * num_steps);
      EXPECT_NEAR(rows->position(t).y(), expected[2 * (t - 1) + 1], 1e-12 * num_steps);
    }
    for (std::size_t i = 0; i < index.size(); ++i) {
      EXPECT_NEAR(rows->violation(index[i]), qp.violation(i, expected), 1e-12 * num_steps);
    }
  }
}

TEST(PointRows, FindsTheMostViolatedRowAndNeverPadding) {
  Random random(3);
  InArena<PointRows> rows(60, 512);
  for (int round = 0; round < 300; ++round) {
    SegmentQp qp = oracle::random_feasible_qp(random, 2 + random.index(59), 1 + random.index(80));
    // All satisfied by far, or equal violations, or as drawn.
    const double shift = random.chance(0.3) ? -1e6 : 0.0;
    for (auto& row : qp.rows) row.bound += shift;
    if (random.chance(0.3)) {
      for (auto& row : qp.rows) row = {row.t, Vec2(1.0, 0.0), qp.first.x() + 1.0};
      qp.last = qp.first;
    }
    ASSERT_TRUE(oracle::fill(qp, *rows));
    rows->update_primal({}, {});
    const std::vector<int> index = oracle::row_indices(qp);
    int expected = index.front();
    for (const int i : index) {
      if (rows->violation(i) > rows->violation(expected)) expected = i;
    }
    EXPECT_EQ(rows->most_violated(), expected);
    EXPECT_EQ(rows->num_rows() % kLanesDouble, 0);
    for (int i = 0; i < rows->num_rows(); ++i) {
      if (std::find(index.begin(), index.end(), i) == index.end()) {
        EXPECT_LT(rows->violation(i), rows->violation(expected)) << "padding";
      }
    }
  }
}

TEST(PointRows, RefusesRowsBeyondItsCapacity) {
  InArena<PointRows> rows(10, 16);
  rows->reset(10, Vec2::Zero(), {1.0, 0.0});
  int num_added = 0;
  while (num_added < 1000 && rows->try_add(5, Vec2::UnitY(), 0.1 * num_added)) ++num_added;
  EXPECT_GE(num_added, 16);
  EXPECT_LT(num_added, 1000);
  const int num_rows = rows->num_rows();
  EXPECT_FALSE(rows->try_add(9, Vec2::UnitX(), 100.0));
  EXPECT_EQ(rows->num_rows(), num_rows);
  rows->update_primal({}, {});
  EXPECT_NEAR(rows->violation(rows->most_violated()), 0.1 * (num_added - 1), 1e-12);
}

TEST(PointRows, ForgetsRowsAtReset) {
  InArena<PointRows> rows(10, 16);
  rows->reset(10, Vec2::Zero(), {1.0, 0.0});
  ASSERT_TRUE(rows->try_add(1, Vec2::UnitY(), 1.0));
  ASSERT_TRUE(rows->try_add(1, Vec2::UnitX(), 1.0));
  rows->reset(6, Vec2::Zero(), {1.0, 0.0});
  EXPECT_EQ(rows->num_rows(), 0);
  ASSERT_TRUE(rows->try_add(1, Vec2::UnitY(), -1.0));
  rows->update_primal({}, {});
  EXPECT_EQ(rows->num_rows(), kLanesDouble);
  EXPECT_EQ(rows->most_violated(), 0);
  EXPECT_NEAR(rows->violation(0), -1.0, 1e-15);
}

TEST(PointRows, ShortensAStepTowardsTheReference) {
  InArena<PointRows> rows(10, 16);
  rows->reset(2, Vec2::Zero(), {2.0, 0.0});
  ASSERT_TRUE(rows->try_add(1, Vec2::UnitY(), 0.0));
  const int active[] = {0};
  const double lambda[] = {2.0};  // G(1,1) = 1/2
  rows->update_primal(active, lambda);
  EXPECT_NEAR(rows->position(1).y(), 1.0, 1e-15);
  const Vec2 reference[] = {{0.0, 0.0}, {1.0, 3.0}, {2.0, 0.0}};
  rows->shorten_step(reference, 0.25);
  EXPECT_NEAR(rows->position(1).y(), 2.5, 1e-15);
  EXPECT_NEAR(rows->violation(0), -2.5, 1e-15);
  rows->shorten_step(reference, 0.0);
  EXPECT_EQ(rows->position(1), reference[1]);
}

}  // namespace
}  // namespace sopt
