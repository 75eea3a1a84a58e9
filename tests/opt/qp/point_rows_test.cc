#include "opt/qp/point_rows.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
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
  EXPECT_EQ(rows->num_ids(), 0);
  EXPECT_EQ(rows->most_violated(0.0), -1);
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
    std::vector<double> gram(index.size());
    for (std::size_t i = 0; i < index.size(); ++i) {
      rows->gram(index, index[i], gram.data());
      for (std::size_t k = 0; k < index.size(); ++k) {
        EXPECT_NEAR(gram[k], expected(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)),
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

// Of waypoint t, by which violations are priced: 1 / sqrt(G(t,t)).
double price(int t, int num_steps) {
  return std::sqrt(num_steps / (static_cast<double>(t) * (num_steps - t)));
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
    const double tolerance = random.chance(0.5) ? 0.0 : 0.1;
    std::vector<double> priced;
    for (std::size_t i = 0; i < index.size(); ++i) {
      const double excess = rows->violation(index[i]) - tolerance;
      priced.push_back(excess * price(qp.rows[i].t, qp.num_steps));
    }
    const double worst = *std::max_element(priced.begin(), priced.end());
    const int found = rows->most_violated(tolerance);
    if (worst < -1e-12) {
      EXPECT_EQ(found, -1);
    }
    if (worst > 1e-12) {
      const auto at = std::find(index.begin(), index.end(), found) - index.begin();
      ASSERT_LT(at, static_cast<std::ptrdiff_t>(index.size())) << "padding, or nothing";
      EXPECT_NEAR(priced[static_cast<std::size_t>(at)], worst, 1e-12);
    }
    EXPECT_EQ(rows->num_ids() % kLanesDouble, 0);
    for (int i = 0; i < rows->num_ids(); ++i) {
      if (std::find(index.begin(), index.end(), i) == index.end()) {
        EXPECT_LT(rows->violation(i), 0.0) << "padding";
      }
    }
  }
}

TEST(PointRows, PrefersTheLowestIdAmongEquals) {
  InArena<PointRows> rows(10, 64);
  rows->reset(10, Vec2::Zero(), {10.0, 0.0});
  for (int i = 0; i < 6; ++i) ASSERT_TRUE(rows->try_add(5, Vec2::UnitY(), 1.0));
  EXPECT_EQ(rows->most_violated(0.0), 0);
}

TEST(PointRows, DoesNotPriceRowsThatAreEntered) {
  InArena<PointRows> rows(10, 64);
  rows->reset(10, Vec2::Zero(), {10.0, 0.0});
  ASSERT_TRUE(rows->try_add(5, Vec2::UnitY(), 1.0));
  ASSERT_TRUE(rows->try_add(5, Vec2::UnitY(), 2.0));
  EXPECT_EQ(rows->most_violated(0.0), 1);
  rows->enter(1);
  EXPECT_EQ(rows->most_violated(0.0), 0);
  EXPECT_NEAR(rows->violation(1), 2.0, 1e-15);
  rows->enter(0);
  EXPECT_EQ(rows->most_violated(0.0), -1);
  rows->leave(1);
  EXPECT_EQ(rows->most_violated(0.0), 1);
  EXPECT_EQ(rows->most_violated(2.0), -1);
}

TEST(PointRows, AddsAStepAlongRows) {
  Random random(4);
  InArena<PointRows> rows(60, 512);
  for (int round = 0; round < 50; ++round) {
    const int num_steps = 2 + random.index(59);
    const SegmentQp qp = oracle::random_feasible_qp(random, num_steps, 1 + random.index(20));
    ASSERT_TRUE(oracle::fill(qp, *rows));
    const std::vector<int> index = oracle::row_indices(qp);
    std::vector<double> weights;
    Eigen::VectorXd lambda(static_cast<Eigen::Index>(index.size()));
    for (Eigen::Index i = 0; i < lambda.size(); ++i) {
      weights.push_back(lambda[i] = random.uniform(-0.1, 0.1));
    }
    rows->update_primal({}, {});
    rows->update_step(index, weights);
    const Eigen::VectorXd step_values = qp.gram() * lambda;
    for (std::size_t i = 0; i < index.size(); ++i) {
      EXPECT_NEAR(rows->step_value(index[i]), step_values[static_cast<Eigen::Index>(i)],
                  1e-12 * num_steps);
    }
    rows->add_step();
    const Eigen::VectorXd expected = qp.primal(lambda);
    for (int t = 1; t < num_steps; ++t) {
      EXPECT_LE((rows->position(t) - expected.segment<2>(2 * (t - 1))).norm(), 1e-12 * num_steps);
    }
  }
}

TEST(PointRows, SaysWhenANumberIsNotFinite) {
  constexpr double kBad[] = {std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity()};
  InArena<PointRows> rows(10, 16);
  for (const double bad : kBad) {
    rows->reset(4, {bad, 0.0}, {1.0, 0.0});
    EXPECT_FALSE(rows->is_valid());
    rows->reset(4, Vec2::Zero(), {1.0, -bad});
    EXPECT_FALSE(rows->is_valid());
    rows->reset(4, Vec2::Zero(), {1.0, 0.0});
    EXPECT_TRUE(rows->is_valid());
    ASSERT_TRUE(rows->try_add(1, {0.0, bad}, 0.0));
    EXPECT_FALSE(rows->is_valid());
    rows->reset(4, Vec2::Zero(), {1.0, 0.0});
    ASSERT_TRUE(rows->try_add(1, Vec2::UnitX(), -bad));
    EXPECT_FALSE(rows->is_valid());
  }
}

TEST(PointRows, RefusesRowsBeyondItsCapacity) {
  InArena<PointRows> rows(10, 16);
  rows->reset(10, Vec2::Zero(), {1.0, 0.0});
  int num_added = 0;
  while (num_added < 1000 && rows->try_add(5, Vec2::UnitY(), 0.1 * num_added)) ++num_added;
  EXPECT_GE(num_added, 16);
  EXPECT_LT(num_added, 1000);
  const int num_ids = rows->num_ids();
  EXPECT_FALSE(rows->try_add(9, Vec2::UnitX(), 100.0));
  EXPECT_EQ(rows->num_ids(), num_ids);
  rows->update_primal({}, {});
  EXPECT_NEAR(rows->violation(rows->most_violated(0.0)), 0.1 * (num_added - 1), 1e-12);
}

TEST(PointRows, ForgetsRowsAtReset) {
  InArena<PointRows> rows(10, 16);
  rows->reset(10, Vec2::Zero(), {1.0, 0.0});
  ASSERT_TRUE(rows->try_add(1, Vec2::UnitY(), 1.0));
  ASSERT_TRUE(rows->try_add(1, Vec2::UnitX(), 1.0));
  rows->reset(6, Vec2::Zero(), {1.0, 0.0});
  EXPECT_EQ(rows->num_ids(), 0);
  ASSERT_TRUE(rows->try_add(1, Vec2::UnitY(), 2.0));
  rows->update_primal({}, {});
  EXPECT_EQ(rows->num_ids(), kLanesDouble);
  EXPECT_EQ(rows->most_violated(0.0), 0);
  EXPECT_NEAR(rows->violation(0), 2.0, 1e-15);
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

TEST(PointRows, ShiftsBoundsByWhatTheWaypointsMove) {
  Random random(5);
  InArena<PointRows> rows(60, 512);
  InArena<PointRows> expected(60, 512);
  InArena<ActiveSetQp<double>> solver(120);
  for (int round = 0; round < 100; ++round) {
    SegmentQp qp = oracle::random_feasible_qp(random, 2 + random.index(59), 1 + random.index(60));
    ASSERT_TRUE(oracle::fill(qp, *rows));
    std::vector<Vec2> offsets;
    for (int t = 0; t <= qp.num_steps; ++t) {
      offsets.emplace_back(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
    }
    rows->shift_bounds(offsets.data());
    for (auto& row : qp.rows) {
      row.bound += row.normal.dot(offsets[static_cast<std::size_t>(row.t)]);
    }
    ASSERT_TRUE(oracle::fill(qp, *expected));
    ASSERT_EQ(rows->num_ids(), expected->num_ids());
    for (int id = 0; id < rows->num_ids(); ++id) {
      ASSERT_EQ(rows->is_free(id), expected->is_free(id)) << "padding";
      if (rows->is_free(id)) {
        EXPECT_NEAR(rows->row(id).bound, expected->row(id).bound, 1e-12);
      }
    }
    // What is priced has moved too; shifted rows may contradict each other.
    const auto shifted = solver->solve(*rows, {}, Deadline());
    const auto direct = solver->solve(*expected, {}, Deadline());
    ASSERT_EQ(shifted.status, direct.status);
    if (direct.status != QpStatus::kOptimal) continue;
    for (int t = 0; t <= qp.num_steps; ++t) {
      EXPECT_LE((rows->position(t) - expected->position(t)).norm(), 1e-9);
    }
  }
}

TEST(PointRows, StandsWhereItIsPut) {
  InArena<PointRows> rows(10, 16);
  rows->reset(3, Vec2::Zero(), {3.0, 0.0});
  ASSERT_TRUE(rows->try_add(1, Vec2::UnitY(), 1.5));
  ASSERT_TRUE(rows->try_add(2, Vec2::UnitX(), 1.0));
  const Vec2 points[] = {{9.0, 9.0}, {1.0, 1.0}, {2.0, -1.0}, {9.0, 9.0}};
  rows->set_positions(points);
  EXPECT_EQ(rows->position(1), points[1]);
  EXPECT_EQ(rows->position(2), points[2]);
  // The ends are fixed.
  EXPECT_EQ(rows->position(0), Vec2(0.0, 0.0));
  EXPECT_EQ(rows->position(3), Vec2(3.0, 0.0));
  const int found = rows->most_violated(0.0);
  EXPECT_EQ(found, 0);
  EXPECT_NEAR(rows->violation(found), 0.5, 1e-15);
  EXPECT_EQ(rows->most_violated(0.5), -1);
}

}  // namespace
}  // namespace sopt
