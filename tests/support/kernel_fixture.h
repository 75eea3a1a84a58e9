// KernelRows with their kernel and solver, and the same segment solved in its inputs by DenseRows.
// For tests.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "opt/qp/active_set_qp.h"
#include "opt/qp/dense_rows.h"
#include "opt/qp/kernel_rows.h"
#include "tests/support/condensed_segment.h"
#include "tests/support/test_problem.h"

namespace sopt::oracle {

inline constexpr int kMaxWindow = 32;

template <class Rows>
class KernelSolver {
 public:
  using Scalar = typename Rows::Scalar;

  KernelSolver(int order, const IntegratorWeights& weights, int max_table = kMaxWindow,
               const KernelCapacity& capacity = {kMaxWindow, 256, 256})
      : kernel_(order, weights, capacity.max_window, max_table),
        rows_(*kernel_, capacity),
        solver_(capacity.max_active) {}

  QpResult<Scalar> solve(const LinearSegment& segment, const Deadline& deadline = Deadline()) {
    is_filled_ = fill(segment, *rows_);
    return solve_again(deadline);
  }
  // Without giving the rows again.
  QpResult<Scalar> solve_again(const Deadline& deadline = Deadline()) {
    return solver_->solve(*rows_, options_, deadline);
  }
  // Whether all rows fitted.
  [[nodiscard]] bool is_filled() const { return is_filled_; }
  [[nodiscard]] Rows& rows() { return *rows_; }
  [[nodiscard]] ActiveSetQp<Scalar>& solver() { return *solver_; }
  [[nodiscard]] QpOptions<Scalar>& options() { return options_; }

  [[nodiscard]] std::vector<int> active() {
    return {solver_->active_rows().begin(), solver_->active_rows().end()};
  }
  // Every quantity, time and joint in turn.
  [[nodiscard]] std::vector<Scalar> values(const LinearSegment& segment) {
    std::vector<Scalar> result;
    for (int q = 0; q <= segment.order; ++q) {
      for (int t = 0; t < segment.num_steps + (q == segment.order ? 0 : 1); ++t) {
        const Scalar* const value = rows_->value(static_cast<Quantity>(q), t);
        result.insert(result.end(), value, value + segment.num_joints());
      }
    }
    return result;
  }

 private:
  InArena<IntegratorKernel<Scalar>> kernel_;
  InArena<Rows> rows_;
  InArena<ActiveSetQp<Scalar>> solver_;
  QpOptions<Scalar> options_;
  bool is_filled_ = false;
};

template <class A, class B>
[[nodiscard]] double largest_difference(const std::vector<A>& a, const std::vector<B>& b) {
  if (a.size() != b.size()) return INFINITY;
  double worst = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double difference = std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i]));
    if (!(difference <= worst)) worst = difference;
  }
  return worst;
}

struct DenseAnswer {
  QpStatus status = QpStatus::kNotSolved;
  Eigen::VectorXd x;
};
[[nodiscard]] inline DenseAnswer solve_dense(const DenseQp& qp) {
  const int n = qp.num_variables();
  InArena<DenseRows<double>> rows(DenseCapacity{n, qp.num_rows(), n});
  InArena<ActiveSetQp<double>> solver(n);
  if (!fill(qp, *rows)) return {};
  const QpStatus status = solver->solve(*rows, {}, Deadline()).status;
  return {status, Eigen::Map<const Eigen::VectorXd>(rows->primal().data(), n)};
}

// As KernelSolver::values, from the inputs.
[[nodiscard]] inline std::vector<double> values_from(const LinearSegment& segment,
                                                     const Eigen::VectorXd& inputs) {
  std::vector<double> result;
  for (int q = 0; q <= segment.order; ++q) {
    for (int t = 0; t < segment.num_steps + (q == segment.order ? 0 : 1); ++t) {
      const Eigen::VectorXd value = quantity_at(segment, inputs, static_cast<Quantity>(q), t);
      result.insert(result.end(), value.begin(), value.end());
    }
  }
  return result;
}

inline constexpr int kPlainSteps = 12;
inline constexpr int kPlainJoints = 3;

// Segments of three joints with acceleration input and a solver for them.
class KernelFixture : public ::testing::Test {
 protected:
  using Solver = KernelSolver<KernelRows<double, 4>>;

  // Nothing but both ends at rest, 1 apart.
  [[nodiscard]] static LinearSegment plain_segment(int num_steps = kPlainSteps,
                                                   int num_joints = kPlainJoints) {
    LinearSegment segment;
    segment.num_steps = num_steps;
    segment.weights = {0.0, 1.0, 2.0};
    segment.first_position = segment.first_velocity = segment.last_velocity = segment.attractor =
        Eigen::VectorXd::Zero(num_joints);
    segment.last_position = segment.factors = Eigen::VectorXd::Ones(num_joints);
    return segment;
  }
  // Of several steps, with the default weights.
  [[nodiscard]] static LinearSegment long_segment() {
    Random random(5);
    LinearSegment segment = random_segment(random, 2, 20, kPlainJoints, 30, true);
    segment.weights = plain_segment().weights;
    return segment;
  }
  static void add_row(Quantity quantity, int t, const Eigen::VectorXd& direction, double bound,
                      LinearSegment& segment) {
    segment.rows.push_back({quantity, t, direction, bound});
  }
  static void add_bound(Quantity quantity, int t, double lower, double upper,
                        LinearSegment& segment) {
    const auto size = segment.first_position.size();
    segment.bounds.push_back({quantity, t, Eigen::VectorXd::Constant(size, lower),
                              Eigen::VectorXd::Constant(size, upper)});
  }
  void expect_bad(const LinearSegment& segment, const std::string& what) {
    EXPECT_EQ(solver_.solve(segment).status, QpStatus::kBadInput) << what;
    EXPECT_TRUE(solver_.active().empty()) << what;
  }
  [[nodiscard]] bool is_bound(int id, Quantity quantity, int t, int joint) {
    return id == solver_.rows().bound_id(quantity, t, joint, false) ||
           id == solver_.rows().bound_id(quantity, t, joint, true);
  }

  Solver solver_{2, plain_segment().weights};
};

}  // namespace sopt::oracle
