#include "tests/support/condensed_segment.h"

#include <cmath>
#include <limits>

namespace sopt::oracle {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct State {
  double q = 0.0;
  double v = 0.0;
};

State advance(int order, const State& x, double u) {
  return order == 1 ? State{x.q + u, 0.0} : State{x.q + x.v + 0.5 * u, x.v + u};
}

bool is_input(int order, Quantity quantity) { return static_cast<int>(quantity) == order; }

State roll_out(int order, State x, const Eigen::VectorXd& inputs, int t) {
  for (int s = 0; s < t; ++s) x = advance(order, x, inputs[s]);
  return x;
}

}  // namespace

Eigen::RowVectorXd LinearSegment::map(Quantity quantity, int t) const {
  Eigen::RowVectorXd result = Eigen::RowVectorXd::Zero(num_steps);
  for (int s = 0; s < num_steps; ++s) {
    if (is_input(order, quantity)) {
      result[s] = s == t ? 1.0 : 0.0;
      continue;
    }
    const State x = roll_out(order, {}, Eigen::VectorXd::Unit(num_steps, s), t);
    result[s] = quantity == Quantity::kPosition ? x.q : x.v;
  }
  return result;
}

double LinearSegment::constant(int joint, Quantity quantity, int t) const {
  if (is_input(order, quantity)) return 0.0;
  const State x = roll_out(order, {first_position[joint], first_velocity[joint]},
                           Eigen::VectorXd::Zero(num_steps), t);
  return quantity == Quantity::kPosition ? x.q : x.v;
}

DenseQp CondensedQp::dense() const {
  DenseQp qp = DenseQp::unconstrained(hessian, gradient);
  qp.a = rows;
  qp.lower = lower;
  qp.upper = upper;
  return qp;
}

double CondensedQp::condition() const {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(hessian, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues().maxCoeff() / eigen.eigenvalues().minCoeff();
}

CondensedQp condense(const LinearSegment& segment) {
  const int n = segment.num_steps;
  const int joints = segment.num_joints();
  CondensedQp qp;
  qp.hessian = RowMatrix::Zero(n * joints, n * joints);
  qp.gradient = Eigen::VectorXd::Zero(n * joints);
  const auto add_cost = [&](Quantity quantity, int t, double weight, bool has_attractor) {
    const Eigen::RowVectorXd map = segment.map(quantity, t);
    for (int j = 0; j < joints; ++j) {
      const double target = has_attractor ? segment.attractor[j] : 0.0;
      const double w = weight * segment.factors[j];
      qp.hessian.block(j * n, j * n, n, n) += w * map.transpose() * map;
      qp.gradient.segment(j * n, n) +=
          w * (segment.constant(j, quantity, t) - target) * map.transpose();
    }
  };
  for (int t = 0; t < n; ++t) {
    add_cost(Quantity::kPosition, t, segment.weights.position, true);
    add_cost(Quantity::kVelocity, t, segment.weights.velocity, false);
    if (segment.order == 2)
      add_cost(Quantity::kAcceleration, t, segment.weights.acceleration, false);
  }
  const int num_bounds = static_cast<int>(segment.bounds.size()) * joints;
  const int num_ends = segment.order * joints;
  const int m = num_ends + static_cast<int>(segment.rows.size()) + num_bounds;
  qp.rows = RowMatrix::Zero(m, n * joints);
  qp.lower = Eigen::VectorXd::Constant(m, -kInfinity);
  qp.upper = Eigen::VectorXd::Constant(m, kInfinity);
  int i = 0;
  for (int j = 0; j < joints; ++j) {
    for (int k = 0; k < segment.order; ++k, ++i) {
      const auto quantity = static_cast<Quantity>(k);
      const double last = k == 0 ? segment.last_position[j] : segment.last_velocity[j];
      qp.rows.block(i, j * n, 1, n) = segment.map(quantity, n);
      qp.lower[i] = qp.upper[i] = last - segment.constant(j, quantity, n);
    }
  }
  for (const LinearRow& row : segment.rows) {
    qp.lower[i] = row.bound;
    for (int j = 0; j < joints; ++j) {
      qp.rows.block(i, j * n, 1, n) = row.direction[j] * segment.map(row.quantity, row.t);
      qp.lower[i] -= row.direction[j] * segment.constant(j, row.quantity, row.t);
    }
    ++i;
  }
  for (const SegmentBound& bound : segment.bounds) {
    for (int j = 0; j < joints; ++j, ++i) {
      const double constant = segment.constant(j, bound.quantity, bound.t);
      qp.rows.block(i, j * n, 1, n) = segment.map(bound.quantity, bound.t);
      qp.lower[i] = bound.lower[j] - constant;
      qp.upper[i] = bound.upper[j] - constant;
    }
  }
  return qp;
}

Eigen::VectorXd quantity_at(const LinearSegment& segment, const Eigen::VectorXd& inputs,
                            Quantity quantity, int t) {
  Eigen::VectorXd result(segment.num_joints());
  const Eigen::RowVectorXd map = segment.map(quantity, t);
  for (int j = 0; j < segment.num_joints(); ++j) {
    result[j] = segment.constant(j, quantity, t) +
                map.dot(inputs.segment(j * segment.num_steps, segment.num_steps));
  }
  return result;
}

// Rows and bounds hold at a random motion that meets both ends.
LinearSegment random_segment(Random& random, int order, int num_steps, int num_joints, int num_rows,
                             bool has_bounds) {
  LinearSegment segment;
  segment.order = order;
  segment.num_steps = num_steps;
  segment.weights = {random.chance(0.5) ? 0.0 : random.uniform(0.0, 0.1),
                     order == 1 ? random.uniform(0.5, 2.0) : random.uniform(0.0, 2.0),
                     random.uniform(0.5, 4.0)};
  const auto draw = [&](double size) {
    Eigen::VectorXd v(num_joints);
    for (double& x : v) x = random.uniform(-size, size);
    return v;
  };
  segment.first_position = draw(1.0);
  segment.first_velocity = draw(order == 1 ? 0.0 : 0.05);
  segment.attractor = draw(1.0);
  segment.factors = draw(1.0).array().exp();
  Eigen::VectorXd inputs(num_steps * num_joints);
  for (double& u : inputs) u = random.uniform(-0.1, 0.1) / (order == 1 ? 1.0 : num_steps);
  segment.last_position = segment.last_velocity = Eigen::VectorXd::Zero(num_joints);
  segment.last_position = quantity_at(segment, inputs, Quantity::kPosition, num_steps);
  if (order == 2) {
    segment.last_velocity = quantity_at(segment, inputs, Quantity::kVelocity, num_steps);
  }
  const auto size_of = [&](Quantity quantity) {
    return is_input(order, quantity) || quantity == Quantity::kVelocity ? 0.05 : 0.3;
  };
  for (int i = 0; i < num_rows; ++i) {
    LinearRow row;
    row.quantity = static_cast<Quantity>(random.chance(0.6) ? 0 : random.index(order + 1));
    row.t = (is_input(order, row.quantity) ? 0 : 1) + random.index(num_steps - 1);
    row.direction = draw(1.0).normalized();
    row.bound = row.direction.dot(quantity_at(segment, inputs, row.quantity, row.t)) -
                size_of(row.quantity) * random.uniform(0.0, 0.5) * (random.chance(0.3) ? 0.0 : 1.0);
    segment.rows.push_back(row);
  }
  for (int q = 0; has_bounds && q <= order; ++q) {
    const auto quantity = static_cast<Quantity>(q);
    for (int t = q == order ? 0 : 1; t < num_steps; ++t) {
      const Eigen::VectorXd z = quantity_at(segment, inputs, quantity, t);
      SegmentBound bound{quantity, t, z, z};
      for (int j = 0; j < num_joints; ++j) {
        bound.lower[j] -=
            random.chance(0.2) ? kInfinity : size_of(quantity) * random.uniform(0.0, 1.0);
        bound.upper[j] +=
            random.chance(0.2) ? kInfinity : size_of(quantity) * random.uniform(0.0, 1.0);
      }
      segment.bounds.push_back(bound);
    }
  }
  return segment;
}

}  // namespace sopt::oracle
