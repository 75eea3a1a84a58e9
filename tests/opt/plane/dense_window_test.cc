#include "opt/plane/dense_window.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "rt/clock.h"
#include "tests/support/dense_qp.h"
#include "tests/support/rt_guard.h"
#include "tests/support/test_problem.h"

namespace sopt {
namespace {

using oracle::InArena;
using oracle::Random;
using oracle::SegmentQp;

constexpr int kMaxWindow = 60;
constexpr int kMaxRows = 256;
constexpr double kTol_m = 1e-9;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class DenseWindowTest : public ::testing::Test {
 protected:
  QpResult<double> solve_dense(const SegmentQp& qp, const Deadline& deadline = Deadline()) {
    EXPECT_TRUE(oracle::fill(qp, *rows_));
    return dense_->solve(*rows_, options_, deadline);
  }
  QpResult<double> solve_closed_form(const SegmentQp& qp) {
    EXPECT_TRUE(oracle::fill(qp, *expected_));
    return closed_form_->solve(*expected_, options_, Deadline());
  }
  void expect_same_points(const SegmentQp& qp) {
    ASSERT_EQ(rows_->num_steps(), qp.num_steps);
    EXPECT_EQ(rows_->position(0), qp.first);
    EXPECT_EQ(rows_->position(qp.num_steps), qp.last);
    for (int t = 1; t < qp.num_steps; ++t) {
      ASSERT_LE((rows_->position(t) - expected_->position(t)).norm(), kTol_m)
          << t << oracle::to_text(qp);
    }
  }

  InArena<PointRows> rows_{kMaxWindow, kMaxRows};
  InArena<PointRows> expected_{kMaxWindow, kMaxRows};
  InArena<DenseWindow> dense_{kMaxWindow, kMaxRows};
  InArena<ActiveSetQp<double>> closed_form_{2 * kMaxWindow};
  QpOptions<double> options_;
};

TEST_F(DenseWindowTest, StandsOnTheLineWithoutRows) {
  for (const int num_steps : {1, 2, 3, 60}) {
    const SegmentQp qp = {num_steps, {1.0, 2.0}, {4.0, -2.0}, {}};
    EXPECT_EQ(solve_dense(qp).status, QpStatus::kOptimal);
    for (int t = 0; t <= num_steps; ++t) {
      const Vec2 on_line = qp.first + (qp.last - qp.first) * t / num_steps;
      EXPECT_LE((rows_->position(t) - on_line).norm(), 1e-12);
    }
  }
}

TEST_F(DenseWindowTest, AgreesWithTheClosedForm) {
  Random random(1);
  int num_active = 0;
  for (int round = 0; round < 400; ++round) {
    const int num_steps = random.chance(0.2) ? 2 : 2 + random.index(kMaxWindow - 1);
    const SegmentQp qp = oracle::random_feasible_qp(random, num_steps, 1 + random.index(60));
    const QpResult<double> expected = solve_closed_form(qp);
    const QpResult<double> result = solve_dense(qp);
    ASSERT_EQ(expected.status, QpStatus::kOptimal) << oracle::to_text(qp);
    ASSERT_EQ(result.status, QpStatus::kOptimal) << oracle::to_text(qp);
    expect_same_points(qp);
    num_active += expected.num_active;
  }
  EXPECT_GT(num_active, 400);
}

TEST_F(DenseWindowTest, AgreesWithTheClosedFormFarFromTheOrigin) {
  Random random(2);
  for (int round = 0; round < 100; ++round) {
    SegmentQp qp = oracle::random_feasible_qp(random, 2 + random.index(59), 1 + random.index(40));
    const Vec2 offset(500.0, -300.0);
    qp.first += offset;
    qp.last += offset;
    for (auto& row : qp.rows) row.bound += row.normal.dot(offset);
    ASSERT_EQ(solve_closed_form(qp).status, QpStatus::kOptimal);
    ASSERT_EQ(solve_dense(qp).status, QpStatus::kOptimal) << oracle::to_text(qp);
    expect_same_points(qp);
  }
}

TEST_F(DenseWindowTest, SaysWhenThereIsNoSolutionAndLeavesThePoints) {
  Random random(3);
  for (int round = 0; round < 100; ++round) {
    const int num_steps = random.chance(0.2) ? 2 : 2 + random.index(kMaxWindow - 1);
    SegmentQp qp = oracle::random_feasible_qp(random, num_steps, 1 + random.index(40));
    const oracle::SegmentRow row = qp.rows[0];
    qp.rows.push_back({row.t, -row.normal, -row.bound + random.uniform(1e-3, 1.0)});
    oracle::sort_rows(qp);
    ASSERT_TRUE(oracle::fill(qp, *rows_));
    const std::vector<Vec2> marks(static_cast<std::size_t>(num_steps) + 1, Vec2(7.0, -7.0));
    rows_->set_positions(marks.data());
    EXPECT_EQ(dense_->solve(*rows_, options_, Deadline()).status, QpStatus::kInfeasible)
        << oracle::to_text(qp);
    for (int t = 1; t < num_steps; ++t) EXPECT_EQ(rows_->position(t), marks[0]);
    EXPECT_EQ(solve_closed_form(qp).status, QpStatus::kInfeasible);
  }
}

TEST_F(DenseWindowTest, RefusesNumbersThatAreNotFinite) {
  const SegmentQp good = {4, {0.0, 0.0}, {4.0, 0.0}, {{1, Vec2::UnitY(), 1.0}}};
  for (const double bad : {kNan, std::numeric_limits<double>::infinity()}) {
    SegmentQp first = good;
    first.first.x() = bad;
    SegmentQp last = good;
    last.last.y() = bad;
    SegmentQp normal = good;
    normal.rows[0].normal.x() = bad;
    SegmentQp bound = good;
    bound.rows[0].bound = bad;
    for (const SegmentQp& qp : {first, last, normal, bound}) {
      EXPECT_EQ(solve_dense(qp).status, QpStatus::kBadInput);
    }
    // And recovers.
    EXPECT_EQ(solve_dense(good).status, QpStatus::kOptimal);
    EXPECT_NEAR(rows_->position(1).y(), 1.0, 1e-12);
  }
}

TEST_F(DenseWindowTest, SaysWhenThereAreMoreRowsThanItHolds) {
  InArena<DenseWindow> small(kMaxWindow, 0);
  SegmentQp qp = {30, {0.0, 0.0}, {4.0, 0.0}, {}};
  for (int i = 0; i < 400; ++i) qp.rows.push_back({1 + i % 29, Vec2::UnitY(), 1e-3 * i});
  oracle::sort_rows(qp);
  ASSERT_TRUE(oracle::fill(qp, *rows_));
  EXPECT_EQ(small->solve(*rows_, options_, Deadline()).status, QpStatus::kCapacity);
}

// Rows fill groups of four, so PointRows holds up to 4 max_window more than max_rows.
TEST_F(DenseWindowTest, HoldsAsManyRowsAsPointRowsOfItsSize) {
  InArena<PointRows> rows(10, 8);
  InArena<DenseWindow> dense(10, 8);
  rows->reset(10, {0.0, 0.0}, {1.0, 0.0});
  int num_added = 0;
  while (rows->try_add(1 + num_added / 6, Vec2::UnitY(), -1.0 - num_added)) ++num_added;
  ASSERT_GT(num_added, 8);
  EXPECT_EQ(dense->solve(*rows, options_, Deadline()).status, QpStatus::kOptimal) << num_added;
}

TEST_F(DenseWindowTest, RefusesAWindowThatIsTooLongForIt) {
  InArena<DenseWindow> small(10, kMaxRows);
  rows_->reset(kMaxWindow, {0.0, 0.0}, {1.0, 0.0});
  ASSERT_TRUE(rows_->try_add(30, Vec2::UnitY(), 1.0));
  EXPECT_EQ(small->solve(*rows_, options_, Deadline()).status, QpStatus::kCapacity);
}

TEST_F(DenseWindowTest, WithoutMemoryRefusesEveryWindow) {
  DenseWindow none;
  rows_->reset(4, {0.0, 0.0}, {1.0, 0.0});
  EXPECT_EQ(none.solve(*rows_, options_, Deadline()).status, QpStatus::kCapacity);
}

TEST_F(DenseWindowTest, StopsAtItsDeadline) {
  Random random(4);
  const SegmentQp qp = oracle::random_feasible_qp(random, 60, 60);
  ManualClock clock;
  EXPECT_EQ(solve_dense(qp, Deadline(clock.clock(), 0, 0.0)).status, QpStatus::kDeadline);
}

TEST_F(DenseWindowTest, TouchesNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "this build cannot count allocations";
  Random random(5);
  const SegmentQp qp = oracle::random_feasible_qp(random, 60, 60);
  ASSERT_TRUE(oracle::fill(qp, *rows_));
  RtGuard guard;
  const QpStatus status = dense_->solve(*rows_, options_, Deadline()).status;
  guard.stop();
  EXPECT_EQ(status, QpStatus::kOptimal);
  EXPECT_EQ(guard.num_allocations() + guard.num_releases() + guard.num_locks(), 0);
}

}  // namespace
}  // namespace sopt
