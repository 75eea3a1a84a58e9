// What ids of KernelRows mean; warm starts from any of them, limits and capacities.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "opt/qp/kernel_rows.h"
#include "rt/clock.h"
#include "tests/support/kernel_fixture.h"
#include "tests/support/rt_guard.h"

namespace sopt {
namespace {

using oracle::KernelSolver;
using oracle::kPlainJoints;
using oracle::LinearSegment;
using oracle::Random;
using oracle::SegmentBound;

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class KernelRowsLimitsTest : public oracle::KernelFixture {};

// --- ids

TEST_F(KernelRowsLimitsTest, IdsSayWhatTheyMean) {
  const LinearSegment segment = long_segment();
  ASSERT_EQ(solver_.solve(segment).status, QpStatus::kOptimal);
  KernelRows<double, 4>& rows = solver_.rows();
  ASSERT_EQ(rows.num_rows(), static_cast<int>(segment.rows.size()));
  std::vector<int> seen;
  for (int i = 0; i < rows.num_rows(); ++i) {
    const oracle::LinearRow& row = segment.rows[static_cast<std::size_t>(i)];
    const Eigen::Map<const Eigen::VectorXd> value(rows.value(row.quantity, row.t), kPlainJoints);
    const int id = rows.row_id(i);
    seen.push_back(id);
    EXPECT_NEAR(rows.row_value(id), row.direction.dot(value), 1e-14);
    EXPECT_EQ(rows.violation(id), row.bound - rows.row_value(id));
  }
  for (const SegmentBound& bound : segment.bounds) {
    for (int j = 0; j < kPlainJoints; ++j) {
      const double value = rows.value(bound.quantity, bound.t)[j];
      const int lower = rows.bound_id(bound.quantity, bound.t, j, false);
      const int upper = rows.bound_id(bound.quantity, bound.t, j, true);
      seen.push_back(lower);
      seen.push_back(upper);
      if (std::isfinite(bound.lower[j])) {
        EXPECT_EQ(rows.violation(lower), bound.lower[j] - value);
      }
      if (std::isfinite(bound.upper[j])) {
        EXPECT_EQ(rows.violation(upper), value - bound.upper[j]);
      }
      const std::vector<int> active = solver_.active();
      for (const int id : {lower, upper}) {
        const double side = id == lower ? bound.lower[j] : bound.upper[j];
        const bool is_active = std::count(active.begin(), active.end(), id) > 0;
        EXPECT_TRUE(!is_active || std::isfinite(side));
      }
    }
  }
  // All different, in range; no other id has a bound to keep.
  std::sort(seen.begin(), seen.end());
  EXPECT_EQ(std::adjacent_find(seen.begin(), seen.end()), seen.end());
  EXPECT_GE(seen.front(), 0);
  EXPECT_LT(seen.back(), rows.num_ids());
  for (int id = 0; id < rows.num_ids(); ++id) {
    if (std::binary_search(seen.begin(), seen.end(), id)) continue;
    EXPECT_FALSE(rows.is_free(id)) << id;
  }
}

TEST_F(KernelRowsLimitsTest, NeverPricesRowsWithoutABound) {
  LinearSegment segment = plain_segment();
  add_row(Quantity::kPosition, 5, Eigen::Vector3d::Ones(), -kInf, segment);
  const auto result = solver_.solve(segment);
  EXPECT_EQ(result.status, QpStatus::kOptimal);
  EXPECT_EQ(result.num_steps, 0);
  const int id = solver_.rows().row_id(0);
  EXPECT_FALSE(solver_.rows().is_free(id));
  EXPECT_NEAR(solver_.rows().row_value(id),
              Eigen::Map<const Eigen::Vector3d>(solver_.rows().value(Quantity::kPosition, 5)).sum(),
              1e-14);
}

TEST_F(KernelRowsLimitsTest, TheLastBoundsOfATimeCount) {
  LinearSegment segment = plain_segment();
  add_bound(Quantity::kPosition, 5, 5.0, 6.0, segment);
  add_bound(Quantity::kPosition, 5, -kInf, kInf, segment);
  const auto result = solver_.solve(segment);
  EXPECT_EQ(result.status, QpStatus::kOptimal);
  EXPECT_EQ(result.num_active, 0);
}

// --- warm start

TEST_F(KernelRowsLimitsTest, StartsFromItsOwnSolution) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    LinearSegment segment = oracle::random_segment(random, 2, 20, kPlainJoints, 30, true);
    segment.weights = plain_segment().weights;
    solver_.options().warm = {};
    const auto cold = solver_.solve(segment);
    ASSERT_EQ(cold.status, QpStatus::kOptimal) << seed;
    const std::vector<double> values = solver_.values(segment);
    const std::vector<int> active = solver_.active();
    const std::vector<double> multipliers(solver_.solver().multipliers().begin(),
                                          solver_.solver().multipliers().end());
    solver_.options().warm = {active, multipliers};
    const auto warm = solver_.solve(segment);
    ASSERT_EQ(warm.status, QpStatus::kOptimal) << seed;
    EXPECT_EQ(warm.num_steps, cold.num_active) << seed;
    EXPECT_LE(oracle::largest_difference(solver_.values(segment), values), 1e-11) << seed;
  }
}

TEST_F(KernelRowsLimitsTest, StartsFromWrongRowsAndPoisonedMultipliers) {
  const LinearSegment segment = long_segment();
  const auto cold = solver_.solve(segment);
  ASSERT_EQ(cold.status, QpStatus::kOptimal);
  const std::vector<double> values = solver_.values(segment);
  Random random(3);
  for (int round = 0; round < 200; ++round) {
    std::vector<int> ids = {-1, std::numeric_limits<int>::max(), std::numeric_limits<int>::min(),
                            solver_.rows().num_ids()};
    std::vector<double> multipliers = {1.0, 1.0, 1.0, 1.0};
    for (int i = 0; i < random.index(40); ++i) {
      ids.push_back(random.index(solver_.rows().num_ids()));
      multipliers.push_back(random.chance(0.2) ? kNan : random.uniform(-0.3, 1.0));
    }
    solver_.options().warm = {ids, {}};
    if (round % 2 == 1) solver_.options().warm.multipliers = multipliers;
    ASSERT_EQ(solver_.solve(segment).status, QpStatus::kOptimal) << round;
    EXPECT_LE(oracle::largest_difference(solver_.values(segment), values), 1e-10) << round;
  }
}

// --- limits

TEST_F(KernelRowsLimitsTest, StopsAtStepLimitsAndDeadlines) {
  const LinearSegment segment = long_segment();
  const auto whole = solver_.solve(segment);
  ASSERT_EQ(whole.status, QpStatus::kOptimal);
  ASSERT_GT(whole.num_steps, 5);
  for (int i = 0; i < whole.num_steps; ++i) {
    solver_.options().max_steps = i;
    auto result = solver_.solve(segment);
    EXPECT_EQ(result.status, QpStatus::kStepLimit) << i;
    EXPECT_EQ(result.num_steps, i);
    EXPECT_GT(result.primal_residual, 1e-9);
    solver_.options().max_steps = 1000;
    ManualClock clock(1000);
    result = solver_.solve(segment, Deadline(clock.clock(), 0, 1e-6 * i));
    EXPECT_EQ(result.status, QpStatus::kDeadline) << i;
    EXPECT_LE(result.num_steps, i);
  }
  EXPECT_EQ(solver_.solve(segment).status, QpStatus::kOptimal);
}

TEST_F(KernelRowsLimitsTest, SaysWhenMoreRowsAreActiveThanItHolds) {
  const LinearSegment segment = long_segment();
  const int num_active = solver_.solve(segment).num_active;
  ASSERT_GT(num_active, 3);
  for (int max_active = 0; max_active < num_active; ++max_active) {
    Solver small(2, segment.weights, oracle::kMaxWindow, {oracle::kMaxWindow, 64, max_active});
    EXPECT_EQ(small.solve(segment).status, QpStatus::kCapacity) << max_active;
    EXPECT_EQ(small.solve_again().status, QpStatus::kCapacity) << max_active;
  }
}

TEST_F(KernelRowsLimitsTest, TouchesNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "this build cannot count allocations";
  const LinearSegment segment = long_segment();
  const Eigen::VectorXd lower = Eigen::VectorXd::Constant(kPlainJoints, -1.0);
  const Eigen::VectorXd upper = Eigen::VectorXd::Constant(kPlainJoints, 1.0);
  for (const int max_table : {0, oracle::kMaxWindow}) {
    Solver solver(2, segment.weights, max_table);
    ASSERT_TRUE(oracle::fill(segment, solver.rows()));
    RtGuard guard;
    const auto result = solver.solve_again();
    const int num_ids = solver.rows().num_ids();
    solver.rows().reset({.num_steps = 30, .num_joints = kPlainJoints});
    const bool has_room =
        solver.rows().try_add(Quantity::kPosition, 1, segment.rows[0].direction.data(), 0.5);
    solver.rows().set_bounds(Quantity::kVelocity, 1, 29, lower.data(), upper.data());
    const auto second = solver.solve_again();
    guard.stop();
    EXPECT_EQ(guard.num_allocations() + guard.num_releases() + guard.num_locks(), 0);
    EXPECT_EQ(result.status, QpStatus::kOptimal);
    EXPECT_EQ(second.status, QpStatus::kOptimal);
    EXPECT_TRUE(has_room && num_ids > 0);
  }
}

// Longest window, all lanes, all rows, bounds on everything.
TEST_F(KernelRowsLimitsTest, HoldsItsLargestProblem) {
  constexpr int kMaxRows = 512;
  for (const int max_table : {0, 60}) {
    Random random(31);
    LinearSegment segment = oracle::random_segment(random, 2, 60, 8, kMaxRows, true);
    std::sort(segment.rows.begin(), segment.rows.end(),
              [](const oracle::LinearRow& a, const oracle::LinearRow& b) {
                return std::pair(a.quantity, a.t) < std::pair(b.quantity, b.t);
              });
    KernelSolver<KernelRows<double, 8>> solver(2, segment.weights, max_table, {60, kMaxRows, 480});
    const auto result = solver.solve(segment);
    ASSERT_TRUE(solver.is_filled());
    ASSERT_EQ(result.status, QpStatus::kOptimal);
    EXPECT_GT(result.num_active, 10);
    EXPECT_EQ(solver.rows().num_rows(), kMaxRows);
    for (int i = 0; i < kMaxRows; ++i) {
      EXPECT_LE(solver.rows().violation(solver.rows().row_id(i)), 1e-11);
    }
    for (const SegmentBound& bound : segment.bounds) {
      for (int j = 0; j < 8; ++j) {
        const double value = solver.rows().value(bound.quantity, bound.t)[j];
        EXPECT_GE(value, bound.lower[j] - 1e-11);
        EXPECT_LE(value, bound.upper[j] + 1e-11);
      }
    }
    const double up[8] = {1.0};
    EXPECT_FALSE(solver.rows().try_add(Quantity::kPosition, 59, up, 0.0));
  }
}

}  // namespace
}  // namespace sopt
