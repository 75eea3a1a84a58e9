// A linear time-invariant robot's segment QP written out in its inputs, apart from the kernel: maps
// from the inputs of one joint to every quantity by rolling out unit inputs, cost and rows from
// them, fixed ends as equalities. For tests.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "opt/qp/active_set_qp.h"
#include "opt/qp/integrator_kernel.h"
#include "opt/qp/kernel_rows.h"
#include "tests/support/kkt.h"
#include "tests/support/oracle2.h"

namespace sopt::oracle {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct LinearRow {
  Quantity quantity = Quantity::kPosition;
  int t = 1;
  Eigen::VectorXd direction;  // per joint
  double bound = 0.0;
};

struct SegmentBound {
  Quantity quantity = Quantity::kPosition;
  int t = 1;
  Eigen::VectorXd lower, upper;  // per joint
};

struct LinearSegment {
  int order = 2;
  int num_steps = 10;
  IntegratorWeights weights;
  Eigen::VectorXd first_position, first_velocity, last_position, last_velocity;
  Eigen::VectorXd factors, attractor;
  std::vector<LinearRow> rows;
  std::vector<SegmentBound> bounds;

  [[nodiscard]] int num_joints() const { return static_cast<int>(first_position.size()); }
  // Of one joint: quantity(t) = constant + map . inputs.
  [[nodiscard]] Eigen::RowVectorXd map(Quantity quantity, int t) const;
  [[nodiscard]] double constant(int joint, Quantity quantity, int t) const;
};

// min 1/2 x'Hx + f'x with x = inputs, joint after joint; rows: ends (equalities), rows, bounds.
struct CondensedQp {
  RowMatrix hessian;
  Eigen::VectorXd gradient;
  RowMatrix rows;
  Eigen::VectorXd lower, upper;

  [[nodiscard]] DenseQp dense() const;
  // Of the Hessian.
  [[nodiscard]] double condition() const;
};
[[nodiscard]] CondensedQp condense(const LinearSegment& segment);

[[nodiscard]] LinearSegment random_segment(Random& random, int order, int num_steps, int num_joints,
                                           int num_rows, bool has_bounds);

// Quantity at t of all joints from the inputs.
[[nodiscard]] Eigen::VectorXd quantity_at(const LinearSegment& segment,
                                          const Eigen::VectorXd& inputs, Quantity quantity, int t);

// Inputs at the end of a solve.
template <class Rows>
[[nodiscard]] Eigen::VectorXd inputs_of(const LinearSegment& segment, const Rows& rows) {
  const int n = segment.num_steps;
  Eigen::VectorXd inputs(n * segment.num_joints());
  for (int j = 0; j < segment.num_joints(); ++j) {
    for (int t = 0; t < n; ++t) {
      inputs[j * n + t] =
          static_cast<double>(rows.value(static_cast<Quantity>(segment.order), t)[j]);
    }
  }
  return inputs;
}

// Multipliers of the condensed problem's constraints; those of the ends, which the kernel does not
// know, are what leaves the least of the gradient at `inputs`.
template <class Rows>
[[nodiscard]] Eigen::VectorXd condensed_multipliers(
    const LinearSegment& segment, const CondensedQp& qp, const Eigen::VectorXd& inputs,
    const Rows& rows, const ActiveSetQp<typename Rows::Scalar>& solver) {
  std::vector<double> of_id(static_cast<std::size_t>(rows.num_ids()), 0.0);
  for (std::size_t k = 0; k < solver.active_rows().size(); ++k) {
    of_id[static_cast<std::size_t>(solver.active_rows()[k])] =
        static_cast<double>(solver.multipliers()[k]);
  }
  const auto at = [&](int id) { return of_id[static_cast<std::size_t>(id)]; };
  const int num_ends = segment.order * segment.num_joints();
  Eigen::VectorXd result = Eigen::VectorXd::Zero(qp.rows.rows() + inputs.size());
  int c = num_ends;
  for (int i = 0; i < rows.num_rows(); ++i) result[c++] = at(rows.row_id(i));
  for (const SegmentBound& bound : segment.bounds) {
    for (int j = 0; j < segment.num_joints(); ++j) {
      result[c++] = at(rows.bound_id(bound.quantity, bound.t, j, false)) -
                    at(rows.bound_id(bound.quantity, bound.t, j, true));
    }
  }
  const Eigen::VectorXd left =
      qp.hessian * inputs + qp.gradient - qp.rows.transpose() * result.head(qp.rows.rows());
  result.head(num_ends) = qp.rows.topRows(num_ends).transpose().householderQr().solve(left);
  return result;
}

// False when it does not fit.
template <class Rows>
[[nodiscard]] bool fill(const LinearSegment& segment, Rows& rows) {
  using Scalar = typename Rows::Scalar;
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
  const Vector first_position = segment.first_position.cast<Scalar>();
  const Vector last_position = segment.last_position.cast<Scalar>();
  const Vector first_velocity = segment.first_velocity.cast<Scalar>();
  const Vector last_velocity = segment.last_velocity.cast<Scalar>();
  const Vector factors = segment.factors.cast<Scalar>();
  const Vector attractor = segment.attractor.cast<Scalar>();
  rows.reset({segment.num_steps, segment.num_joints(), first_position.data(), last_position.data(),
              first_velocity.data(), last_velocity.data(), factors.data(), attractor.data()});
  for (const LinearRow& row : segment.rows) {
    const Vector direction = row.direction.cast<Scalar>();
    if (!rows.try_add(row.quantity, row.t, direction.data(), static_cast<Scalar>(row.bound))) {
      return false;
    }
  }
  for (const SegmentBound& bound : segment.bounds) {
    const Vector lower = bound.lower.cast<Scalar>();
    const Vector upper = bound.upper.cast<Scalar>();
    rows.set_bounds(bound.quantity, bound.t, bound.t, lower.data(), upper.data());
  }
  return true;
}

}  // namespace sopt::oracle
