// Answers of KernelRows against the same problem in its inputs, and against PointRows.
#include "opt/qp/kernel_rows.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "opt/qp/point_rows.h"
#include "tests/support/dense_qp.h"
#include "tests/support/kernel_fixture.h"

namespace sopt {
namespace {

using oracle::CondensedQp;
using oracle::DenseQp;
using oracle::InArena;
using oracle::KernelSolver;
using oracle::LinearSegment;
using oracle::Random;

constexpr double kInf = std::numeric_limits<double>::infinity();

LinearSegment draw_segment(Random& random, int order, int num_joints) {
  const int num_steps = order + random.index(30);
  const int num_rows = num_steps < 2 ? 0 : random.index(40);
  return oracle::random_segment(random, order, num_steps, num_joints, num_rows, random.chance(0.5));
}

// The condensed problem is worse conditioned the longer the segment; where its answer is no
// better than that, nor is the agreement.
template <class Rows>
void expect_agreement(int order, int num_joints, int max_table, double tolerance,
                      std::uint64_t seed, int count) {
  int num_well_conditioned = 0;
  for (int i = 0; i < count; ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed + static_cast<std::uint64_t>(i)));
    Random random(seed + static_cast<std::uint64_t>(i));
    const LinearSegment segment = draw_segment(random, order, num_joints);
    KernelSolver<Rows> solver(order, segment.weights, max_table);
    ASSERT_EQ(solver.solve(segment).status, QpStatus::kOptimal);
    ASSERT_TRUE(solver.is_filled());
    const CondensedQp condensed = oracle::condense(segment);
    const oracle::DenseAnswer dense = oracle::solve_dense(condensed.dense());
    ASSERT_EQ(dense.status, QpStatus::kOptimal);
    const double condition = condensed.condition();
    num_well_conditioned += condition <= 1e4 ? 1 : 0;
    EXPECT_LE(
        oracle::largest_difference(solver.values(segment), oracle::values_from(segment, dense.x)),
        tolerance * std::max(1.0, condition / 1e4))
        << "condition " << condition;
  }
  EXPECT_GE(num_well_conditioned, count / 2);
}

TEST(KernelRows, AgreesWithTheCondensedProblemForAccelerationInput) {
  expect_agreement<KernelRows<double, 8>>(2, 5, 32, 1e-10, 100, 40);
}

TEST(KernelRows, AgreesWithTheCondensedProblemForVelocityInput) {
  expect_agreement<KernelRows<double, 4>>(1, 2, 32, 1e-10, 200, 60);
}

TEST(KernelRows, AgreesWithTheCondensedProblemForFourJoints) {
  expect_agreement<KernelRows<double, 4>>(2, 4, 32, 1e-10, 300, 30);
}

TEST(KernelRows, AgreesWithTheCondensedProblemBeyondTheTables) {
  expect_agreement<KernelRows<double, 8>>(2, 6, 0, 1e-10, 400, 20);
  expect_agreement<KernelRows<double, 4>>(1, 3, 8, 1e-10, 500, 30);
}

TEST(KernelRows, AgreesInSinglePrecision) {
  expect_agreement<KernelRows<float, 8>>(2, 5, 32, 1e-4, 600, 40);
}

// --- optimality by separate code

template <class Rows>
void expect_kkt(int order, int num_joints, double tolerance, std::uint64_t seed, int count) {
  int num_active = 0;
  for (int i = 0; i < count; ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed + static_cast<std::uint64_t>(i)));
    Random random(seed + static_cast<std::uint64_t>(i));
    const LinearSegment segment = draw_segment(random, order, num_joints);
    KernelSolver<Rows> solver(order, segment.weights);
    const auto result = solver.solve(segment);
    ASSERT_EQ(result.status, QpStatus::kOptimal);
    const CondensedQp qp = oracle::condense(segment);
    const Eigen::VectorXd inputs = oracle::inputs_of(segment, solver.rows());
    const oracle::ScaledKkt kkt = oracle::scaled_kkt(
        qp.dense(), inputs,
        oracle::condensed_multipliers(segment, qp, inputs, solver.rows(), solver.solver()));
    EXPECT_LE(kkt.stationarity, tolerance);
    EXPECT_LE(kkt.violation, tolerance);
    EXPECT_LE(kkt.sign, 0.0);
    EXPECT_LE(kkt.complementarity, tolerance);
    num_active += result.num_active;
  }
  EXPECT_GT(num_active, 2 * count);
}

TEST(KernelRows, MeetsTheOptimalityConditionsOfTheCondensedProblem) {
  expect_kkt<KernelRows<double, 4>>(1, 2, 1e-11, 700, 80);
  expect_kkt<KernelRows<double, 8>>(2, 5, 1e-11, 800, 40);
}

TEST(KernelRows, MeetsThemInSinglePrecision) {
  expect_kkt<KernelRows<float, 8>>(2, 5, 1e-4, 900, 40);
}

// --- bounds

TEST(KernelRows, TakesEqualBoundsOnEveryQuantity) {
  for (int order = 1; order <= 2; ++order) {
    for (int q = 0; q <= order; ++q) {
      Random random(static_cast<std::uint64_t>(10 * order + q));
      LinearSegment segment = oracle::random_segment(random, order, 12, 3, 6, false);
      const oracle::DenseAnswer free = oracle::solve_dense(oracle::condense(segment).dense());
      const auto quantity = static_cast<Quantity>(q);
      const Eigen::VectorXd z =
          oracle::quantity_at(segment, free.x, quantity, 6) + Eigen::VectorXd::Constant(3, 0.02);
      segment.rows.clear();
      segment.bounds.push_back({quantity, 6, z, z});
      KernelSolver<KernelRows<double, 4>> solver(order, segment.weights);
      ASSERT_EQ(solver.solve(segment).status, QpStatus::kOptimal);
      for (int j = 0; j < 3; ++j) EXPECT_NEAR(solver.rows().value(quantity, 6)[j], z[j], 1e-12);
      const oracle::DenseAnswer dense = oracle::solve_dense(oracle::condense(segment).dense());
      EXPECT_LE(
          oracle::largest_difference(solver.values(segment), oracle::values_from(segment, dense.x)),
          1e-10);
    }
  }
}

TEST(KernelRows, HoldsBoundsThatLeaveNoFreedom) {
  Random random(20);
  LinearSegment segment = oracle::random_segment(random, 1, 20, 8, 0, false);
  segment.bounds.clear();
  for (int t = 1; t < 20; ++t) {
    Eigen::VectorXd z(8);
    for (double& x : z) x = random.uniform(-1.0, 1.0);
    segment.bounds.push_back({Quantity::kPosition, t, z, z});
  }
  KernelSolver<KernelRows<double, 8>> solver(1, segment.weights);
  const auto result = solver.solve(segment);
  ASSERT_EQ(result.status, QpStatus::kOptimal);
  EXPECT_EQ(result.num_active, 19 * 8);
  for (const oracle::SegmentBound& bound : segment.bounds) {
    for (int j = 0; j < 8; ++j) {
      EXPECT_NEAR(solver.rows().value(Quantity::kPosition, bound.t)[j], bound.lower[j], 1e-11);
    }
  }
}

TEST(KernelRows, BoundsAllTimesOfARangeAtOnce) {
  Random random(21);
  LinearSegment segment = oracle::random_segment(random, 2, 15, 3, 0, false);
  KernelSolver<KernelRows<double, 4>> at_once(2, segment.weights);
  KernelSolver<KernelRows<double, 4>> one_by_one(2, segment.weights);
  ASSERT_EQ(at_once.solve(segment).status, QpStatus::kOptimal);
  const Eigen::VectorXd upper =
      Eigen::Map<const Eigen::VectorXd>(at_once.rows().value(Quantity::kAcceleration, 6), 3)
          .array() -
      1e-3;
  const Eigen::VectorXd lower = Eigen::VectorXd::Constant(3, -kInf);
  for (int t = 4; t <= 9; ++t) {
    segment.bounds.push_back({Quantity::kAcceleration, t, lower, upper});
  }
  ASSERT_EQ(one_by_one.solve(segment).status, QpStatus::kOptimal);
  segment.bounds.clear();
  ASSERT_TRUE(oracle::fill(segment, at_once.rows()));
  at_once.rows().set_bounds(Quantity::kAcceleration, 4, 9, lower.data(), upper.data());
  ASSERT_EQ(at_once.solve_again().status, QpStatus::kOptimal);
  EXPECT_GT(one_by_one.active().size(), 0u);
  EXPECT_EQ(at_once.values(segment), one_by_one.values(segment));
}

TEST(KernelRows, PricesInfiniteBoundsNotAtAll) {
  Random random(22);
  LinearSegment segment = oracle::random_segment(random, 2, 15, 3, 20, false);
  KernelSolver<KernelRows<double, 4>> solver(2, segment.weights);
  const auto without = solver.solve(segment);
  const std::vector<double> values = solver.values(segment);
  const Eigen::VectorXd far = Eigen::VectorXd::Constant(3, kInf);
  for (int q = 0; q <= 2; ++q) {
    for (int t = 1; t < 15; ++t) {
      segment.bounds.push_back({static_cast<Quantity>(q), t, -far, far});
    }
  }
  const auto with = solver.solve(segment);
  EXPECT_EQ(with.status, QpStatus::kOptimal);
  EXPECT_EQ(with.num_steps, without.num_steps);
  EXPECT_EQ(solver.values(segment), values);
  for (int id = solver.rows().bound_id(Quantity::kPosition, 0, 0, false);
       id < solver.rows().num_ids(); ++id) {
    EXPECT_FALSE(solver.rows().is_free(id)) << id;
  }
}

// --- soft rows

// The same with a slack variable for every row, not for ends and bounds.
DenseQp with_slack_variables(const LinearSegment& segment, double softness) {
  const DenseQp hard = oracle::condense(segment).dense();
  const int n = hard.num_variables();
  const auto num_soft = static_cast<int>(segment.rows.size());
  Eigen::MatrixXd h = Eigen::MatrixXd::Identity(n + num_soft, n + num_soft) / softness;
  h.topLeftCorner(n, n) = hard.h;
  Eigen::VectorXd f = Eigen::VectorXd::Zero(n + num_soft);
  f.head(n) = hard.f;
  DenseQp qp = DenseQp::unconstrained(h, f);
  const int num_ends = segment.order * segment.num_joints();
  for (int i = 0; i < hard.num_rows(); ++i) {
    Eigen::VectorXd normal = Eigen::VectorXd::Zero(n + num_soft);
    normal.head(n) = hard.a.row(i);
    if (i >= num_ends && i < num_ends + num_soft) normal[n + i - num_ends] = 1.0;
    qp.add_row(normal, hard.lower[i], hard.upper[i]);
  }
  return qp;
}

TEST(KernelRows, SoftRowsAnswerAsSlackVariablesDo) {
  for (std::uint64_t seed = 1000; seed < 1040; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const int order = 1 + random.index(2);
    LinearSegment segment =
        oracle::random_segment(random, order, 3 + random.index(15), 3, 12, random.chance(0.5));
    // Some cannot hold, and lengths are any.
    for (oracle::LinearRow& row : segment.rows) {
      const double scale = std::exp(random.uniform(-1.0, 1.0));
      row.bound = scale * (row.bound + random.uniform(0.0, 0.2));
      row.direction *= scale;
    }
    const double softness = std::pow(10.0, random.uniform(-2.0, 1.0));
    KernelSolver<KernelRows<double, 4>> solver(order, segment.weights);
    ASSERT_TRUE(oracle::fill(segment, solver.rows()));
    solver.rows().set_softness(softness);
    ASSERT_EQ(solver.solve_again().status, QpStatus::kOptimal);
    const oracle::DenseAnswer dense = oracle::solve_dense(with_slack_variables(segment, softness));
    ASSERT_EQ(dense.status, QpStatus::kOptimal);
    EXPECT_LE(
        oracle::largest_difference(solver.values(segment), oracle::values_from(segment, dense.x)),
        1e-9);
  }
}

// --- tables and closed forms change nothing

TEST(KernelRows, AnswersBeyondTheTablesAsWithin) {
  const KernelCapacity capacity{60, 256, 256};
  for (int order = 1; order <= 2; ++order) {
    const IntegratorWeights weights{order == 1 ? 0.01 : 0.0, 1.0, 2.0};
    KernelSolver<KernelRows<double, 8>> within(order, weights, 60, capacity);
    KernelSolver<KernelRows<double, 8>> beyond(order, weights, 0, capacity);
    for (std::uint64_t seed = 1100; seed < 1130; ++seed) {
      Random random(seed);
      LinearSegment segment =
          oracle::random_segment(random, order, 2 + random.index(59), 6, 40, random.chance(0.5));
      segment.weights = weights;
      ASSERT_EQ(within.solve(segment).status, QpStatus::kOptimal) << seed;
      ASSERT_EQ(beyond.solve(segment).status, QpStatus::kOptimal) << seed;
      EXPECT_LE(oracle::largest_difference(within.values(segment), beyond.values(segment)), 1e-10)
          << seed;
    }
  }
}

TEST(KernelRows, AnswersAsPointRowsDoForAPointInThePlane) {
  constexpr int kWindow = 60;
  KernelSolver<KernelRows<double, 4>> solver(1, {0.0, 1.0, 0.0}, kWindow, {kWindow, 256, 256});
  InArena<PointRows> point(kWindow, 256);
  InArena<ActiveSetQp<double>> point_solver(256);
  for (std::uint64_t seed = 1200; seed < 1400; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const int num_steps = 2 + random.index(kWindow - 1);
    const oracle::SegmentQp qp =
        oracle::random_feasible_qp(random, num_steps, random.index(100), 1e-3);
    ASSERT_TRUE(oracle::fill(qp, *point));
    solver.rows().reset({.num_steps = num_steps,
                         .num_joints = 2,
                         .first_position = qp.first.data(),
                         .last_position = qp.last.data()});
    for (const oracle::SegmentRow& row : qp.rows) {
      ASSERT_TRUE(solver.rows().try_add(Quantity::kPosition, row.t, row.normal.data(), row.bound));
    }
    ASSERT_EQ(point_solver->solve(*point, {}, Deadline()).status, QpStatus::kOptimal);
    ASSERT_EQ(solver.solve_again().status, QpStatus::kOptimal);
    for (int t = 0; t <= num_steps; ++t) {
      const double* const z = solver.rows().value(Quantity::kPosition, t);
      EXPECT_LE((point->position(t) - Vec2(z[0], z[1])).norm(), 1e-11) << t;
    }
  }
}

}  // namespace
}  // namespace sopt
