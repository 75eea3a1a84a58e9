// What KernelRows refuses, and contradictions it names.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "opt/qp/kernel_rows.h"
#include "tests/support/kernel_fixture.h"

namespace sopt {
namespace {

using oracle::kPlainJoints;
using oracle::kPlainSteps;
using oracle::LinearSegment;

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class KernelRowsInputTest : public oracle::KernelFixture {};

// --- what is refused

TEST_F(KernelRowsInputTest, RefusesSegmentsThatAreTooLongOrTooShort) {
  for (const int num_steps : {1, 0, -1, std::numeric_limits<int>::min(), oracle::kMaxWindow + 1}) {
    LinearSegment segment = plain_segment();
    segment.num_steps = num_steps;
    expect_bad(segment, std::to_string(num_steps) + " steps");
  }
  EXPECT_EQ(solver_.solve(plain_segment(2)).status, QpStatus::kOptimal);
  EXPECT_EQ(solver_.solve(plain_segment(oracle::kMaxWindow)).status, QpStatus::kOptimal);
}

TEST_F(KernelRowsInputTest, RefusesMoreJointsThanLanesAndNone) {
  LinearSegment none = plain_segment(kPlainSteps, 0);
  expect_bad(none, "no joints");
  for (const int num_joints : {5, 8, 60}) {
    expect_bad(plain_segment(kPlainSteps, num_joints), std::to_string(num_joints) + " joints");
  }
  EXPECT_EQ(solver_.solve(plain_segment(kPlainSteps, 4)).status, QpStatus::kOptimal);
}

// As when a caller fills in a problem without looking in between.
TEST_F(KernelRowsInputTest, RefusesThemWithRowsAndBoundsToo) {
  for (const int num_joints : {5, 60}) {
    LinearSegment segment = plain_segment(kPlainSteps, num_joints);
    for (int t = 1; t < kPlainSteps; ++t) {
      add_row(Quantity::kVelocity, t, Eigen::VectorXd::Ones(num_joints), -1.0, segment);
      add_bound(Quantity::kAcceleration, t, -1.0, 1.0, segment);
    }
    expect_bad(segment, std::to_string(num_joints) + " joints");
  }
  for (const int num_steps : {oracle::kMaxWindow + 1, 10000}) {
    LinearSegment segment = plain_segment();
    segment.num_steps = num_steps;
    for (int q = 0; q <= 2; ++q) {
      add_row(static_cast<Quantity>(q), num_steps - 1, Eigen::VectorXd::Ones(kPlainJoints), -1.0,
              segment);
      add_bound(static_cast<Quantity>(q), num_steps - 1, -1.0, 1.0, segment);
    }
    expect_bad(segment, std::to_string(num_steps) + " steps");
  }
  EXPECT_EQ(solver_.solve(plain_segment()).status, QpStatus::kOptimal);
}

TEST_F(KernelRowsInputTest, RefusesNumbersThatAreNone) {
  LinearSegment good = long_segment();
  for (const double bad : {kNan, kInf, -kInf}) {
    const std::string name = std::to_string(bad);
    for (int j = 0; j < kPlainJoints; ++j) {
      const auto expect_bad_in = [&](Eigen::VectorXd LinearSegment::*member, const char* what) {
        LinearSegment segment = good;
        (segment.*member)[j] = bad;
        expect_bad(segment, what + name);
      };
      expect_bad_in(&LinearSegment::first_position, "first position ");
      expect_bad_in(&LinearSegment::last_position, "last position ");
      expect_bad_in(&LinearSegment::first_velocity, "first velocity ");
      expect_bad_in(&LinearSegment::last_velocity, "last velocity ");
      expect_bad_in(&LinearSegment::attractor, "attractor ");
      expect_bad_in(&LinearSegment::factors, "factors ");
      LinearSegment segment = good;
      segment.rows[7].direction[j] = bad;
      expect_bad(segment, "direction " + name);
      segment = good;
      if (bad != -kInf) {
        segment.bounds[3].lower[j] = bad;
        expect_bad(segment, "lower " + name);
      }
      segment = good;
      if (bad != kInf) {
        segment.bounds[3].upper[j] = bad;
        expect_bad(segment, "upper " + name);
      }
    }
    if (bad == -kInf) continue;
    LinearSegment segment = good;
    segment.rows[7].bound = bad;
    expect_bad(segment, "bound " + name);
  }
  EXPECT_EQ(solver_.solve(good).status, QpStatus::kOptimal);
}

TEST_F(KernelRowsInputTest, RefusesFactorsThatAreNotPositive) {
  for (const double bad : {0.0, -0.0, -1.0}) {
    LinearSegment segment = plain_segment();
    segment.factors[1] = bad;
    expect_bad(segment, std::to_string(bad));
  }
}

TEST_F(KernelRowsInputTest, TakesArraysThatAreLeftOut) {
  const LinearSegment segment = plain_segment();
  ASSERT_EQ(solver_.solve(segment).status, QpStatus::kOptimal);
  const std::vector<double> values = solver_.values(segment);
  solver_.rows().reset({.num_steps = kPlainSteps,
                        .num_joints = kPlainJoints,
                        .last_position = segment.last_position.data()});
  ASSERT_EQ(solver_.solve_again().status, QpStatus::kOptimal);
  EXPECT_EQ(solver_.values(segment), values);
}

TEST_F(KernelRowsInputTest, RefusesRowsWhenFull) {
  for (const int max_rows : {0, 1, 5, 64}) {
    Solver small(2, plain_segment().weights, oracle::kMaxWindow,
                 {oracle::kMaxWindow, max_rows, 16});
    for (int round = 0; round < 2; ++round) {
      ASSERT_TRUE(oracle::fill(plain_segment(), small.rows()));
      const double up[] = {0.0, 1.0, 0.0};
      for (int i = 0; i < max_rows; ++i) {
        EXPECT_TRUE(small.rows().try_add(Quantity::kPosition, 1 + i % 11 * (i / 32), up, -9.0));
      }
      EXPECT_FALSE(small.rows().try_add(Quantity::kPosition, 11, up, 9.0));
      EXPECT_EQ(small.rows().num_rows(), max_rows);
      EXPECT_EQ(small.solve_again().status, QpStatus::kOptimal);
    }
  }
}

// --- contradictions

TEST_F(KernelRowsInputTest, NamesALowerBoundAboveTheUpperOne) {
  for (const double gap : {1e-5, 1.0, 1e5}) {
    for (int q = 0; q <= 2; ++q) {
      LinearSegment segment = plain_segment();
      const auto quantity = static_cast<Quantity>(q);
      add_bound(quantity, 5, -kInf, kInf, segment);
      segment.bounds[0].lower[1] = 0.1 + gap;
      segment.bounds[0].upper[1] = 0.1;
      const auto result = solver_.solve(segment);
      ASSERT_EQ(result.status, QpStatus::kInfeasible) << q << " " << gap;
      EXPECT_TRUE(is_bound(result.blocking_row, quantity, 5, 1)) << result.blocking_row;
    }
  }
}

TEST_F(KernelRowsInputTest, NamesARowThatContradictsABound) {
  LinearSegment segment = plain_segment();
  add_row(Quantity::kPosition, 5, Eigen::Vector3d(0.0, 2.0, 0.0), 1.0, segment);
  add_bound(Quantity::kPosition, 5, -1.0, 0.4, segment);
  const auto result = solver_.solve(segment);
  ASSERT_EQ(result.status, QpStatus::kInfeasible);
  EXPECT_TRUE(result.blocking_row == solver_.rows().row_id(0) ||
              is_bound(result.blocking_row, Quantity::kPosition, 5, 1));
}

TEST_F(KernelRowsInputTest, RowsAtFixedEndsHoldOrContradict) {
  const Eigen::VectorXd up = Eigen::Vector3d(0.0, 1.0, 0.0);
  for (const Quantity quantity : {Quantity::kPosition, Quantity::kVelocity}) {
    for (const int t : {0, kPlainSteps}) {
      const double at = quantity == Quantity::kPosition && t > 0 ? 1.0 : 0.0;
      for (const double slack : {0.0, 1e-3, 1.0}) {
        LinearSegment segment = plain_segment();
        add_row(quantity, t, up, at - slack, segment);
        add_bound(quantity, t, at - slack, at + slack, segment);
        const auto result = solver_.solve(segment);
        EXPECT_EQ(result.status, QpStatus::kOptimal) << t << " " << slack;
        EXPECT_EQ(result.num_active, 0);
      }
      for (const double gap : {1e-5, 1.0}) {
        LinearSegment row = plain_segment();
        add_row(quantity, t, up, at + gap, row);
        auto result = solver_.solve(row);
        EXPECT_EQ(result.status, QpStatus::kInfeasible) << t << " " << gap;
        EXPECT_EQ(result.blocking_row, solver_.rows().row_id(0));
        LinearSegment bound = plain_segment();
        add_bound(quantity, t, -kInf, kInf, bound);
        bound.bounds[0].upper[1] = at - gap;
        result = solver_.solve(bound);
        EXPECT_EQ(result.status, QpStatus::kInfeasible) << t << " " << gap;
        EXPECT_EQ(result.blocking_row, solver_.rows().bound_id(quantity, t, 1, true));
      }
    }
  }
}

TEST_F(KernelRowsInputTest, RowsWithoutFreedomHoldOrContradict) {
  // Two steps of an acceleration input: both ends leave nothing to choose.
  LinearSegment segment = plain_segment(2);
  add_row(Quantity::kPosition, 1, Eigen::Vector3d::Ones(), 1.4, segment);
  ASSERT_EQ(solver_.solve(segment).status, QpStatus::kOptimal);
  EXPECT_NEAR(solver_.rows().value(Quantity::kPosition, 1)[0], 0.5, 1e-13);
  segment.rows[0].bound = 1.6;
  EXPECT_EQ(solver_.solve(segment).status, QpStatus::kInfeasible);
}

TEST_F(KernelRowsInputTest, ZeroRowsHoldOrContradict) {
  LinearSegment segment = plain_segment();
  add_row(Quantity::kPosition, 5, Eigen::Vector3d::Zero(), -1.0, segment);
  EXPECT_EQ(solver_.solve(segment).status, QpStatus::kOptimal);
  segment.rows[0].bound = 1e-3;
  const auto result = solver_.solve(segment);
  EXPECT_EQ(result.status, QpStatus::kInfeasible);
  EXPECT_EQ(result.blocking_row, solver_.rows().row_id(0));
}

TEST_F(KernelRowsInputTest, SolvesAFeasibleSegmentAfterAnInfeasibleOne) {
  const LinearSegment good = long_segment();
  const auto first = solver_.solve(good);
  ASSERT_EQ(first.status, QpStatus::kOptimal);
  const std::vector<double> values = solver_.values(good);
  const std::vector<int> active = solver_.active();
  const auto expect_same = [&](const QpResult<double>& again) {
    EXPECT_EQ(again.status, QpStatus::kOptimal);
    EXPECT_EQ(again.num_steps, first.num_steps);
    EXPECT_EQ(again.gap, first.gap);
    EXPECT_EQ(solver_.active(), active);
    const std::vector<double> now = solver_.values(good);
    ASSERT_EQ(now.size(), values.size());
    EXPECT_EQ(std::memcmp(now.data(), values.data(), sizeof(double) * now.size()), 0);
  };
  expect_same(solver_.solve(good));
  expect_same(solver_.solve_again());
  LinearSegment broken = good;
  broken.bounds[9].lower[0] = 1.0;
  broken.bounds[9].upper[0] = 0.0;
  EXPECT_EQ(solver_.solve(broken).status, QpStatus::kInfeasible);
  expect_same(solver_.solve(good));
  solver_.options().max_steps = 2;
  EXPECT_EQ(solver_.solve(good).status, QpStatus::kStepLimit);
  solver_.options().max_steps = 1000;
  expect_same(solver_.solve(good));
  LinearSegment poisoned = good;
  poisoned.rows[0].bound = kNan;
  EXPECT_EQ(solver_.solve(poisoned).status, QpStatus::kBadInput);
  expect_same(solver_.solve(good));
  EXPECT_EQ(solver_.solve(plain_segment(30)).status, QpStatus::kOptimal);
  expect_same(solver_.solve(good));
}

}  // namespace
}  // namespace sopt
