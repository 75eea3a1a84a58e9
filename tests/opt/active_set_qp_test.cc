#include "opt/active_set_qp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "rt/clock.h"
#include "tests/support/dense_qp.h"
#include "tests/support/rt_guard.h"
#include "tests/support/test_problem.h"

namespace sopt {
namespace {

using oracle::InArena;
using oracle::KktResidual;
using oracle::Random;
using oracle::SegmentQp;
using oracle::SegmentRow;

constexpr double kTol = 1e-9;

class ActiveSetQpTest : public ::testing::Test {
 protected:
  QpResult solve(const SegmentQp& qp, const Deadline& deadline = Deadline()) {
    EXPECT_TRUE(oracle::fill(qp, *rows_));
    return qp_->solve(*rows_, options_, deadline);
  }
  void expect_solution(const SegmentQp& qp, const QpResult& result) {
    ASSERT_EQ(result.status, QpStatus::kOptimal) << oracle::to_text(qp);
    const KktResidual residual = oracle::kkt_residual(qp, *rows_, *qp_);
    EXPECT_LE(residual.stationarity, 1e-9) << oracle::to_text(qp);
    EXPECT_LE(residual.violation, kTol) << oracle::to_text(qp);
    EXPECT_LE(residual.negativity, 0.0) << oracle::to_text(qp);
    EXPECT_LE(residual.complementarity, kTol * 10) << oracle::to_text(qp);
    EXPECT_FALSE(residual.has_padding);
    EXPECT_EQ(result.num_active, static_cast<int>(qp_->active_rows().size()));
  }
  // y >= bound at waypoint 5 and y <= -bound at the same: contradict each other when bound > 0.
  static SegmentQp corridor(double bound) {
    SegmentQp qp;
    qp.num_steps = 10;
    qp.last = {10.0, 0.0};
    qp.rows = {{3, Vec2::UnitY(), 0.5}, {5, Vec2::UnitY(), bound}, {5, -Vec2::UnitY(), bound}};
    return qp;
  }

  InArena<PointRows> rows_{60, 512};
  InArena<ActiveSetQp> qp_{128};
  QpOptions options_;
};

TEST_F(ActiveSetQpTest, KeepsTheLineWithoutRows) {
  SegmentQp qp;
  qp.num_steps = 5;
  qp.last = {5.0, 0.0};
  const QpResult result = solve(qp);
  expect_solution(qp, result);
  EXPECT_EQ(result.num_steps, 0);
  EXPECT_EQ(result.num_active, 0);
  EXPECT_NEAR(rows_->position(2).x(), 2.0, 1e-15);
}

TEST_F(ActiveSetQpTest, KeepsTheLineWhenNoRowIsViolated) {
  SegmentQp qp;
  qp.num_steps = 5;
  qp.last = {5.0, 0.0};
  qp.rows = {{2, Vec2::UnitY(), -1.0}, {3, Vec2::UnitX(), 3.0}};
  expect_solution(qp, solve(qp));
  EXPECT_TRUE(qp_->active_rows().empty());
}

// One row lifts the line to a tent: z_y(5) = 1, multiplier = 1 / G(5,5) = 10 / 25.
TEST_F(ActiveSetQpTest, LiftsTheLineToATent) {
  SegmentQp qp;
  qp.num_steps = 10;
  qp.last = {10.0, 0.0};
  qp.rows = {{5, Vec2::UnitY(), 1.0}};
  expect_solution(qp, solve(qp));
  ASSERT_EQ(qp_->active_rows().size(), 1u);
  EXPECT_NEAR(qp_->multipliers()[0], 0.4, 1e-14);
  for (int t = 0; t <= 10; ++t) {
    EXPECT_NEAR(rows_->position(t).y(), t <= 5 ? 0.2 * t : 2.0 - 0.2 * t, 1e-14);
  }
}

TEST_F(ActiveSetQpTest, LetsGoOfARowThatALaterOneMakesSlack) {
  // Waypoint 5 is violated most at first; holding it and waypoint 2 leaves waypoint 3 slack.
  SegmentQp qp;
  qp.num_steps = 10;
  qp.last = {10.0, 0.0};
  qp.rows = {{3, Vec2::UnitY(), 0.9}, {4, Vec2::UnitY(), 0.99}, {5, Vec2::UnitY(), 2.0}};
  expect_solution(qp, solve(qp));
  ASSERT_EQ(qp_->active_rows().size(), 1u);
}

// Rows and multipliers are chosen, the data follow; the solver must find both again.
TEST_F(ActiveSetQpTest, FindsPlantedSolutions) {
  Random random(1);
  for (int round = 0; round < 300; ++round) {
    SegmentQp qp = oracle::random_feasible_qp(random, 2 + random.index(59), random.index(150));
    std::vector<int> used(static_cast<std::size_t>(qp.num_steps), 0);
    std::vector<bool> is_active(qp.rows.size(), false);
    Eigen::VectorXd lambda = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(qp.rows.size()));
    for (std::size_t i = 0; i < qp.rows.size(); ++i) {
      // At most one row per waypoint is active: independent, so multipliers are unique.
      if (used[static_cast<std::size_t>(qp.rows[i].t)]++ != 0 || random.chance(0.5)) continue;
      is_active[i] = true;
      lambda[static_cast<Eigen::Index>(i)] = random.uniform(0.01, 1.0);
    }
    const Eigen::VectorXd x = qp.primal(lambda);
    for (std::size_t i = 0; i < qp.rows.size(); ++i) {
      qp.rows[i].bound += qp.violation(i, x) * -1.0;
      if (!is_active[i]) qp.rows[i].bound -= random.uniform(0.001, 1.0);
    }
    expect_solution(qp, solve(qp));
    for (int t = 1; t < qp.num_steps; ++t) {
      EXPECT_LE((rows_->position(t) - x.segment<2>(2 * (t - 1))).norm(), 1e-9);
    }
    const std::vector<int> indices = oracle::row_indices(qp);
    ASSERT_EQ(qp_->active_rows().size(),
              static_cast<std::size_t>(std::count(is_active.begin(), is_active.end(), true)));
    for (std::size_t k = 0; k < qp_->active_rows().size(); ++k) {
      const auto i = std::find(indices.begin(), indices.end(), qp_->active_rows()[k]);
      EXPECT_NEAR(qp_->multipliers()[k], lambda[i - indices.begin()], 1e-8);
    }
  }
}

TEST_F(ActiveSetQpTest, SolvesRandomFeasibleProblems) {
  Random random(2);
  for (int round = 0; round < 300; ++round) {
    const SegmentQp qp =
        oracle::random_feasible_qp(random, 2 + random.index(59), random.index(200), 1e-6);
    expect_solution(qp, solve(qp));
  }
}

TEST_F(ActiveSetQpTest, CopesWithDuplicateRows) {
  Random random(3);
  for (int round = 0; round < 100; ++round) {
    SegmentQp qp = oracle::random_feasible_qp(random, 2 + random.index(59), 1 + random.index(40));
    const std::vector<SegmentRow> once = qp.rows;
    qp.rows.insert(qp.rows.end(), once.begin(), once.end());
    qp.rows.insert(qp.rows.end(), once.begin(), once.end());
    oracle::sort_rows(qp);
    expect_solution(qp, solve(qp));
  }
}

TEST_F(ActiveSetQpTest, CopesWithNearlyParallelRows) {
  Random random(4);
  for (const double angle : {1e-3, 1e-6, 1e-8, 1e-10, 1e-13}) {
    for (int round = 0; round < 50; ++round) {
      SegmentQp qp =
          oracle::random_feasible_qp(random, 2 + random.index(59), 1 + random.index(40), 1e-3);
      const std::vector<SegmentRow> once = qp.rows;
      for (SegmentRow row : once) {
        row.normal = Eigen::Rotation2Dd(angle * random.uniform(-1.0, 1.0)) * row.normal;
        // Far enough to stay feasible: |z| < 100.
        row.bound -= 100.0 * angle;
        qp.rows.push_back(row);
      }
      oracle::sort_rows(qp);
      expect_solution(qp, solve(qp));
    }
  }
}

TEST_F(ActiveSetQpTest, HoldsRowsThatLeaveOnlyOnePoint) {
  // Three rows pin waypoint 5 to (5, 2); any two of them are independent.
  SegmentQp qp;
  qp.num_steps = 10;
  qp.last = {10.0, 0.0};
  for (const double angle : {0.3, 2.5, 4.4}) {
    const Vec2 normal = {std::cos(angle), std::sin(angle)};
    qp.rows.push_back({5, normal, normal.dot(Vec2(5.0, 2.0))});
  }
  expect_solution(qp, solve(qp));
  EXPECT_LE((rows_->position(5) - Vec2(5.0, 2.0)).norm(), 1e-8);
}

TEST_F(ActiveSetQpTest, HoldsACorridorWithoutWidth) {
  const SegmentQp qp = corridor(0.0);
  expect_solution(qp, solve(qp));
  EXPECT_NEAR(rows_->position(5).y(), 0.0, kTol);
}

TEST_F(ActiveSetQpTest, NamesTheRowThatContradictsOthers) {
  const SegmentQp qp = corridor(0.25);
  const QpResult result = solve(qp);
  EXPECT_EQ(result.status, QpStatus::kInfeasible);
  // Waypoint 5's rows are 4 and 5: a group of four per waypoint.
  EXPECT_TRUE(result.blocking_row == 4 || result.blocking_row == 5) << result.blocking_row;
}

TEST_F(ActiveSetQpTest, FindsContradictionsAmongManyRows) {
  Random random(5);
  for (int round = 0; round < 200; ++round) {
    SegmentQp qp = oracle::random_feasible_qp(random, 2 + random.index(59), random.index(60));
    const int t = 1 + random.index(qp.num_steps - 1);
    const double turn = random.uniform(0.0, 6.28);
    const Vec2 z = random.point({Vec2::Constant(-5.0), Vec2::Constant(5.0)});
    // Two opposite rows, or three that leave nothing in their midst.
    const int num_sides = 2 + random.index(2);
    for (int k = 0; k < num_sides; ++k) {
      const double angle = turn + 2.0 * 3.14159265358979 * k / num_sides;
      const Vec2 normal = {std::cos(angle), std::sin(angle)};
      qp.rows.push_back({t, normal, normal.dot(z) + random.uniform(1e-3, 1.0)});
    }
    oracle::sort_rows(qp);
    const QpResult result = solve(qp);
    ASSERT_EQ(result.status, QpStatus::kInfeasible) << oracle::to_text(qp);
    const std::vector<int> indices = oracle::row_indices(qp);
    const auto position = [&](int row) {
      return static_cast<int>(std::find(indices.begin(), indices.end(), row) - indices.begin());
    };
    const int blocking = position(result.blocking_row);
    ASSERT_LT(blocking, static_cast<int>(qp.rows.size()));
    std::vector<int> others;
    for (const int row : qp_->active_rows()) {
      if (position(row) != blocking) others.push_back(position(row));
    }
    const auto certificate = oracle::infeasibility_certificate(qp, blocking, others);
    EXPECT_LE(certificate.residual, 1e-6);
    EXPECT_GT(certificate.gap, 0.0);
  }
}

TEST_F(ActiveSetQpTest, SolvesAFeasibleProblemAfterAnInfeasibleOne) {
  Random random(6);
  for (int round = 0; round < 50; ++round) {
    EXPECT_EQ(solve(corridor(0.25)).status, QpStatus::kInfeasible);
    const SegmentQp qp =
        oracle::random_feasible_qp(random, 2 + random.index(59), random.index(100), 1e-6);
    expect_solution(qp, solve(qp));
  }
}

TEST_F(ActiveSetQpTest, GivesTheSameBytesTwice) {
  Random random(7);
  const SegmentQp qp = oracle::random_feasible_qp(random, 40, 150);
  const QpResult first = solve(qp);
  std::vector<Vec2> z;
  for (int t = 0; t <= 40; ++t) z.push_back(rows_->position(t));
  const std::vector<double> lambda(qp_->multipliers().begin(), qp_->multipliers().end());
  const QpResult second = solve(qp);
  EXPECT_EQ(first.num_steps, second.num_steps);
  for (int t = 0; t <= 40; ++t) EXPECT_EQ(z[static_cast<std::size_t>(t)], rows_->position(t));
  EXPECT_TRUE(std::equal(lambda.begin(), lambda.end(), qp_->multipliers().begin(),
                         qp_->multipliers().end()));
}

TEST_F(ActiveSetQpTest, StopsAtItsStepLimit) {
  SegmentQp qp = corridor(-1.0);
  qp.rows.push_back({8, -Vec2::UnitY(), 0.5});
  for (int max_steps = 0; max_steps < 2; ++max_steps) {
    options_.max_steps = max_steps;
    const QpResult result = solve(qp);
    EXPECT_EQ(result.status, QpStatus::kStepLimit);
    EXPECT_EQ(result.num_steps, max_steps);
  }
  options_.max_steps = 100;
  const QpResult free = solve(qp);
  expect_solution(qp, free);
  options_.max_steps = free.num_steps;
  expect_solution(qp, solve(qp));
}

TEST_F(ActiveSetQpTest, NeedsNoStepWhenNothingIsViolated) {
  options_.max_steps = 0;
  SegmentQp qp;
  qp.num_steps = 5;
  qp.last = {5.0, 0.0};
  qp.rows = {{2, Vec2::UnitY(), -1.0}};
  EXPECT_EQ(solve(qp).status, QpStatus::kOptimal);
}

TEST_F(ActiveSetQpTest, StopsAtItsDeadline) {
  Random random(8);
  const SegmentQp qp = oracle::random_feasible_qp(random, 50, 150);
  const int num_steps = solve(qp).num_steps;
  ASSERT_GT(num_steps, 5);
  for (int polls = 0; polls < 5; ++polls) {
    ManualClock clock(1000);
    const QpResult result = solve(qp, Deadline(clock.clock(), 0, 1e-6 * polls));
    EXPECT_EQ(result.status, QpStatus::kDeadline);
    EXPECT_LE(result.num_steps, polls);
  }
}

TEST_F(ActiveSetQpTest, RefusesMoreActiveRowsThanItHolds) {
  SegmentQp qp = corridor(-1.0);
  qp.rows.push_back({8, -Vec2::UnitY(), 0.5});
  ASSERT_TRUE(oracle::fill(qp, *rows_));
  InArena<ActiveSetQp> small(1);
  EXPECT_EQ(small->solve(*rows_, options_, Deadline()).status, QpStatus::kCapacity);
  ASSERT_TRUE(oracle::fill(qp, *rows_));
  InArena<ActiveSetQp> exact(2);
  EXPECT_EQ(exact->solve(*rows_, options_, Deadline()).status, QpStatus::kOptimal);
}

TEST_F(ActiveSetQpTest, TouchesNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "this build cannot count allocations";
  Random random(9);
  const SegmentQp qp = oracle::random_feasible_qp(random, 50, 150);
  ASSERT_TRUE(oracle::fill(qp, *rows_));
  RtGuard guard;
  const QpResult result = qp_->solve(*rows_, options_, Deadline());
  guard.stop();
  EXPECT_EQ(result.status, QpStatus::kOptimal);
  EXPECT_EQ(guard.num_allocations() + guard.num_releases() + guard.num_locks(), 0);
}

}  // namespace
}  // namespace sopt
