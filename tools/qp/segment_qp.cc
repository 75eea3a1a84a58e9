#include "tools/qp/segment_qp.h"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace sopt {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::size_t at(int i) { return static_cast<std::size_t>(i); }

template <class To, class From>
std::vector<To> convert(const std::vector<From>& from) {
  std::vector<To> to(from.size());
  std::transform(from.begin(), from.end(), to.begin(),
                 [](From value) { return static_cast<To>(value); });
  return to;
}

// quantity(t) of one joint = free_value + sum_s gain(s) input(s)
double gain(int order, Quantity quantity, int t, int s) {
  if (static_cast<int>(quantity) == order) return s == t ? 1.0 : 0.0;
  if (s >= t) return 0.0;
  return order == 2 && quantity == Quantity::kPosition ? t - s - 0.5 : 1.0;
}

double free_value(const KernelPart<double>& part, Quantity quantity, int t, int joint) {
  if (quantity == part.input()) return 0.0;
  const double velocity = part.order == 2 ? part.first_velocity[at(joint)] : 0.0;
  if (quantity == Quantity::kVelocity) return velocity;
  return part.first_position[at(joint)] + t * velocity;
}

// Writes a SegmentQp as a QpProblem, row by row.
class Condenser {
 public:
  Condenser(const SegmentQp& from, QpProblem& to)
      : from_(from), arm_(from.arm), to_(to), per_step_(from.base.num_inputs + arm_.num_joints) {
    const int n = arm_.num_steps * per_step_;
    to_.num_variables = n;
    to_.hessian.assign(at(n * n), 0.0);
    to_.gradient.assign(at(n), 0.0);
    to_.lower.assign(at(n), -kInfinity);
    to_.upper.assign(at(n), kInfinity);
  }

  void write() {
    write_base();
    for (int j = 0; j < arm_.num_joints; ++j) write_cost(j);
    for (int j = 0; j < arm_.num_joints; ++j) write_ends(j);
    to_.num_equalities = to_.num_rows;
    for (const KernelBounds<double>& bounds : arm_.bounds) write_bounds(bounds);
    for (const KernelRow<double>& row : arm_.rows) {
      double free = 0.0;
      add_row();
      add_direction(row.quantity, row.t, row.direction, free);
      bound_row(row.bound - free, kInfinity);
    }
    for (const CoupledRow& row : from_.coupled) {
      double free = 0.0;
      add_row();
      add_base(row.base);
      add_direction(Quantity::kPosition, row.t, row.arm, free);
      bound_row(row.bound - free, kInfinity);
    }
  }

 private:
  int base_variable(int i) const {
    return i / from_.base.num_inputs * per_step_ + i % from_.base.num_inputs;
  }
  int arm_variable(int joint, int s) const { return s * per_step_ + from_.base.num_inputs + joint; }
  double& row_entry(int variable) {
    return to_.rows[at((to_.num_rows - 1) * to_.num_variables + variable)];
  }

  void add_row() {
    ++to_.num_rows;
    to_.rows.resize(at(to_.num_rows * to_.num_variables), 0.0);
  }
  void bound_row(double lower, double upper) {
    to_.row_lower.push_back(lower);
    to_.row_upper.push_back(upper);
  }
  void add_base(const std::vector<double>& row) {
    for (int i = 0; i < static_cast<int>(row.size()); ++i) {
      row_entry(base_variable(i)) = row[at(i)];
    }
  }
  void add_direction(Quantity quantity, int t, const std::vector<double>& direction, double& free) {
    for (int j = 0; j < arm_.num_joints; ++j) {
      free += direction[at(j)] * free_value(arm_, quantity, t, j);
      for (int s = 0; s < arm_.num_steps; ++s) {
        row_entry(arm_variable(j, s)) += direction[at(j)] * gain(arm_.order, quantity, t, s);
      }
    }
  }

  void write_base() {
    const BasePart& base = from_.base;
    const int n = static_cast<int>(base.gradient.size());
    for (int i = 0; i < n; ++i) {
      const int row = base_variable(i);
      for (int k = 0; k < n; ++k) {
        to_.hessian[at(row * to_.num_variables + base_variable(k))] = base.hessian[at(i * n + k)];
      }
      to_.gradient[at(row)] = base.gradient[at(i)];
      to_.lower[at(row)] = base.lower[at(i)];
      to_.upper[at(row)] = base.upper[at(i)];
    }
    for (std::size_t i = 0; i < base.equality_rows.size(); ++i) {
      add_row();
      add_base(base.equality_rows[i]);
      bound_row(base.equality_values[i], base.equality_values[i]);
    }
  }

  // Weights of quantities at times 1 .. n, of the input at 0 .. n - 1.
  void write_cost(int j) {
    const double weights[] = {arm_.weights.position, arm_.weights.velocity,
                              arm_.weights.acceleration};
    const double factor = arm_.factors.empty() ? 1.0 : arm_.factors[at(j)];
    int q = 0;
    for (const double weight : weights) {
      const int first = q == arm_.order ? 0 : 1;
      for (int t = first; t < first + arm_.num_steps; ++t) {
        add_square(static_cast<Quantity>(q), t, j, factor * weight);
      }
      if (q++ == arm_.order) return;
    }
  }

  // 1/2 weight (quantity(t) - target)^2 of joint j, where positions have the attractor as target.
  void add_square(Quantity quantity, int t, int j, double weight) {
    const bool is_attracted = quantity == Quantity::kPosition && !arm_.attractor.empty();
    const double target = is_attracted ? arm_.attractor[at(j)] : 0.0;
    const double residual = free_value(arm_, quantity, t, j) - target;
    for (int s = 0; s < arm_.num_steps; ++s) {
      const double weighted = weight * gain(arm_.order, quantity, t, s);
      const int row = arm_variable(j, s);
      to_.gradient[at(row)] += weighted * residual;
      for (int k = 0; k < arm_.num_steps; ++k) {
        to_.hessian[at(row * to_.num_variables + arm_variable(j, k))] +=
            weighted * gain(arm_.order, quantity, t, k);
      }
    }
  }

  void write_ends(int j) {
    std::vector<double> direction(at(arm_.num_joints), 0.0);
    direction[at(j)] = 1.0;
    for (int q = 0; q < arm_.order; ++q) {
      const double last = q == 0 ? arm_.last_position[at(j)] : arm_.last_velocity[at(j)];
      double free = 0.0;
      add_row();
      add_direction(static_cast<Quantity>(q), arm_.num_steps, direction, free);
      bound_row(last - free, last - free);
    }
  }

  void write_bounds(const KernelBounds<double>& bounds) {
    for (int t = bounds.first_t; t <= bounds.last_t; ++t) {
      for (int j = 0; j < arm_.num_joints; ++j) {
        if (bounds.quantity == arm_.input()) {
          to_.lower[at(arm_variable(j, t))] = bounds.lower[at(j)];
          to_.upper[at(arm_variable(j, t))] = bounds.upper[at(j)];
          continue;
        }
        std::vector<double> direction(at(arm_.num_joints), 0.0);
        direction[at(j)] = 1.0;
        double free = 0.0;
        add_row();
        add_direction(bounds.quantity, t, direction, free);
        bound_row(bounds.lower[at(j)] - free, bounds.upper[at(j)] - free);
      }
    }
  }

  const SegmentQp& from_;
  const KernelPart<double>& arm_;
  QpProblem& to_;
  int per_step_;
};

template <class Scalar>
const Scalar* data_or_null(const std::vector<Scalar>& values) {
  return values.empty() ? nullptr : values.data();
}

}  // namespace

KernelPart<float> to_float(const KernelPart<double>& part) {
  KernelPart<float> result;
  result.order = part.order;
  result.weights = part.weights;
  result.num_steps = part.num_steps;
  result.num_joints = part.num_joints;
  result.first_position = convert<float>(part.first_position);
  result.last_position = convert<float>(part.last_position);
  result.first_velocity = convert<float>(part.first_velocity);
  result.last_velocity = convert<float>(part.last_velocity);
  result.attractor = convert<float>(part.attractor);
  result.factors = convert<float>(part.factors);
  for (const KernelRow<double>& row : part.rows) {
    result.rows.push_back(
        {row.quantity, row.t, convert<float>(row.direction), static_cast<float>(row.bound)});
  }
  for (const KernelBounds<double>& bounds : part.bounds) {
    result.bounds.push_back({bounds.quantity, bounds.first_t, bounds.last_t,
                             convert<float>(bounds.lower), convert<float>(bounds.upper)});
  }
  return result;
}

QpProblem condense(const SegmentQp& problem, const std::string& name) {
  QpProblem condensed;
  condensed.name = name;
  Condenser(problem, condensed).write();
  return condensed;
}

template <class Scalar, int kLanes>
bool fill(const KernelPart<Scalar>& part, KernelRows<Scalar, kLanes>& rows) {
  KernelSegment<Scalar> segment;
  segment.num_steps = part.num_steps;
  segment.num_joints = part.num_joints;
  segment.first_position = part.first_position.data();
  segment.last_position = part.last_position.data();
  segment.first_velocity = data_or_null(part.first_velocity);
  segment.last_velocity = data_or_null(part.last_velocity);
  segment.factors = data_or_null(part.factors);
  segment.attractor = data_or_null(part.attractor);
  rows.reset(segment);
  for (const KernelBounds<Scalar>& bounds : part.bounds) {
    rows.set_bounds(bounds.quantity, bounds.first_t, bounds.last_t, bounds.lower.data(),
                    bounds.upper.data());
  }
  for (const KernelRow<Scalar>& row : part.rows) {
    if (!rows.try_add(row.quantity, row.t, row.direction.data(), row.bound)) return false;
  }
  return true;
}

template <int kLanes>
bool fill(const SegmentQp& problem, DenseRows<double>& base, KernelRows<double, kLanes>& arm,
          SumRows<DenseRows<double>, KernelRows<double, kLanes>>& sum) {
  const BasePart& part = problem.base;
  const int num_base = static_cast<int>(part.gradient.size());
  if (!base.factorize(num_base, part.hessian.data())) return false;
  base.reset(part.gradient.data());
  bool ok = fill(problem.arm, arm);
  for (std::size_t i = 0; i < part.equality_rows.size(); ++i) {
    const double value = part.equality_values[i];
    ok = base.try_add(part.equality_rows[i].data(), value, value) && ok;
  }
  const int first_base = base.num_rows();
  const int first_arm = arm.num_rows();
  for (const CoupledRow& row : problem.coupled) {
    ok = base.try_add(row.base.data(), -kInfinity, kInfinity) &&
         arm.try_add(Quantity::kPosition, row.t, row.arm.data(), -kInfinity) && ok;
  }
  for (int i = 0; i < num_base; ++i) base.set_bounds(i, part.lower[at(i)], part.upper[at(i)]);
  sum.reset();
  for (int i = 0; ok && i < static_cast<int>(problem.coupled.size()); ++i) {
    ok = sum.try_add(first_base + i, arm.row_id(first_arm + i), problem.coupled[at(i)].bound);
  }
  return ok;
}

template bool fill(const KernelPart<double>&, KernelRows<double, 4>&);
template bool fill(const KernelPart<double>&, KernelRows<double, 8>&);
template bool fill(const KernelPart<float>&, KernelRows<float, 8>&);
template bool fill(const SegmentQp&, DenseRows<double>&, KernelRows<double, 4>&,
                   SumRows<DenseRows<double>, KernelRows<double, 4>>&);
template bool fill(const SegmentQp&, DenseRows<double>&, KernelRows<double, 8>&,
                   SumRows<DenseRows<double>, KernelRows<double, 8>>&);

}  // namespace sopt
