#include "tests/support/planted_qp.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace sopt::oracle {
namespace {

using Index = Eigen::Index;

constexpr double kInf = std::numeric_limits<double>::infinity();

double log_uniform(Random& random, double low, double high) {
  return std::pow(10.0, random.uniform(std::log10(low), std::log10(high)));
}

Eigen::VectorXd random_direction(Random& random, int n) {
  Eigen::VectorXd v(n);
  // Dense, or a few entries.
  const double share = random.chance(0.7) ? 1.0 : random.uniform(0.05, 0.5);
  for (int j = 0; j < n; ++j) v[j] = random.chance(share) ? random.uniform(-1.0, 1.0) : 0.0;
  if (n > 0 && v.norm() < 1e-3) v[random.index(n)] = 1.0;
  return n > 0 ? Eigen::VectorXd(v.normalized()) : v;
}

double random_multiplier(Random& random) {
  if (random.chance(0.1)) return 0.0;
  if (random.chance(0.1)) return log_uniform(random, 1e-12, 1e-4);
  return log_uniform(random, 1e-3, 1e1);
}

// What the bounds of a constraint through, or at a distance from, value are to be.
struct Sides {
  double lower = -kInf;
  double upper = kInf;
  double multiplier = 0.0;  // times the length of the row
};

Sides active_sides(Random& random, double value, double length) {
  Sides sides;
  sides.multiplier = random_multiplier(random);
  if (random.chance(0.12)) {
    if (random.chance(0.5)) sides.multiplier = -sides.multiplier;
    sides.lower = sides.upper = value;
    return sides;
  }
  // The other side of the row: none, far, or next to nothing.
  double width = kInf;
  if (random.chance(0.3)) width = length * log_uniform(random, 1e-3, 1e2);
  if (random.chance(0.03)) width = length * log_uniform(random, 1e-12, 1e-3);
  if (random.chance(0.5)) {
    sides.lower = value;
    sides.upper = value + width;
  } else {
    sides.upper = value;
    sides.lower = value - width;
    sides.multiplier = -sides.multiplier;
  }
  return sides;
}

Sides inactive_sides(Random& random, double value, double length, double min_slack) {
  Sides sides;
  if (random.chance(0.7)) sides.lower = value - length * log_uniform(random, min_slack, 1e2);
  if (random.chance(0.5)) sides.upper = value + length * log_uniform(random, min_slack, 1e2);
  return sides;
}

// Adds rows that follow from active ones: multiples of them, or sums of two.
void add_dependent_rows(Random& random, const std::vector<int>& active, bool has_exact_duplicates,
                        PlantedQp& planted, std::vector<double>& multipliers) {
  if (active.empty()) return;
  const int num_added = 1 + random.index(4);
  DenseQp& qp = planted.qp;
  const auto any = [&] {
    return active[static_cast<std::size_t>(random.index(static_cast<int>(active.size())))];
  };
  for (int k = 0; k < num_added; ++k) {
    const int i = any();
    const int other = any();
    if (has_exact_duplicates || random.chance(0.5)) {
      const double sign = random.chance(0.5) ? -1.0 : 1.0;
      const bool is_exact = has_exact_duplicates || random.chance(0.5);
      const double factor =
          sign * (is_exact ? std::exp2(random.index(7) - 3) : log_uniform(random, 0.1, 10.0));
      const double low = factor * (factor > 0 ? qp.lower[i] : qp.upper[i]);
      const double high = factor * (factor > 0 ? qp.upper[i] : qp.lower[i]);
      qp.add_row(factor * qp.a.row(i).transpose(), low, high);
    } else {
      qp.add_row((qp.a.row(i) + qp.a.row(other)).transpose(), qp.lower[i] + qp.lower[other],
                 qp.upper[i] + qp.upper[other]);
    }
    multipliers.push_back(0.0);
  }
}

Eigen::VectorXd random_point(Random& random, int n) {
  const double size = log_uniform(random, 0.1, 10.0);
  Eigen::VectorXd x(n);
  for (int j = 0; j < n; ++j) x[j] = random.chance(0.1) ? 0.0 : random.uniform(-size, size);
  return x;
}

// Rows in a random order.
void shuffle_rows(Random& random, DenseQp& qp, std::vector<double>& multipliers) {
  for (int i = qp.num_rows() - 1; i > 0; --i) {
    const int k = random.index(i + 1);
    if (k == i) continue;
    qp.a.row(i).swap(qp.a.row(k));
    std::swap(qp.lower[i], qp.lower[k]);
    std::swap(qp.upper[i], qp.upper[k]);
    std::swap(multipliers[static_cast<std::size_t>(i)], multipliers[static_cast<std::size_t>(k)]);
  }
}

// Rows and multipliers of rows; the active ones first.
std::vector<double> add_rows(Random& random, const PlantedLimits& limits, int num_active,
                             PlantedQp& planted) {
  DenseQp& qp = planted.qp;
  const int n = qp.num_variables();
  const int num_inactive = random.chance(0.2) ? 0 : random.index(2 * n + 6);
  std::vector<double> multipliers;
  std::vector<int> active;
  for (int i = 0; i < num_active + num_inactive; ++i) {
    const double length = log_uniform(random, 1.0 / limits.max_norm_ratio, limits.max_norm_ratio);
    const Eigen::VectorXd normal = length * random_direction(random, n);
    const double value = normal.dot(planted.x);
    const bool is_active = i < num_active;
    const Sides sides = is_active ? active_sides(random, value, length)
                                  : inactive_sides(random, value, length, limits.min_slack);
    qp.add_row(normal, sides.lower, sides.upper);
    multipliers.push_back(sides.multiplier / length);
    if (is_active) active.push_back(i);
  }
  if (random.chance(0.3)) {
    add_dependent_rows(random, active, limits.has_exact_duplicates, planted, multipliers);
  }
  shuffle_rows(random, qp, multipliers);
  return multipliers;
}

// Bounds of every variable; the first `num_active` of a random order are active.
std::vector<double> add_bounds(Random& random, const PlantedLimits& limits, int num_active,
                               PlantedQp& planted) {
  DenseQp& qp = planted.qp;
  const int n = qp.num_variables();
  std::vector<int> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  for (int i = n - 1; i > 0; --i) {
    std::swap(order[static_cast<std::size_t>(i)],
              order[static_cast<std::size_t>(random.index(i + 1))]);
  }
  std::vector<double> multipliers(static_cast<std::size_t>(n), 0.0);
  const double share = random.chance(0.5) ? 0.0 : random.uniform(0.0, 1.0);
  for (int k = 0; k < n; ++k) {
    const int j = order[static_cast<std::size_t>(k)];
    const bool is_active = k < num_active;
    if (!is_active && !random.chance(share)) continue;
    const Sides sides = is_active ? active_sides(random, planted.x[j], 1.0)
                                  : inactive_sides(random, planted.x[j], 1.0, limits.min_slack);
    qp.lower_x[j] = sides.lower;
    qp.upper_x[j] = sides.upper;
    multipliers[static_cast<std::size_t>(j)] = sides.multiplier;
  }
  return multipliers;
}

}  // namespace

Eigen::MatrixXd random_hessian(Random& random, int n, double condition, double lowest) {
  Eigen::VectorXd eigenvalues(n);
  for (int i = 0; i < n; ++i) {
    eigenvalues[i] = lowest * std::pow(condition, n > 1 ? static_cast<double>(i) / (n - 1) : 0.0);
  }
  if (random.chance(0.1)) return eigenvalues.asDiagonal();
  Eigen::MatrixXd any(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) any(i, j) = random.uniform(-1.0, 1.0);
  }
  if (n == 0) return any;
  const Eigen::MatrixXd q = any.householderQr().householderQ();
  const Eigen::MatrixXd h = q * eigenvalues.asDiagonal() * q.transpose();
  return 0.5 * (h + h.transpose());
}

double gram_condition(const DenseQp& qp, const std::vector<int>& constraints) {
  Eigen::MatrixXd normals(qp.num_variables(), static_cast<Eigen::Index>(constraints.size()));
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    normals.col(static_cast<Eigen::Index>(i)) = qp.normal(constraints[i]);
  }
  if (normals.size() == 0) return 1.0;
  const Eigen::MatrixXd gram = normals.transpose() * qp.h.llt().solve(normals);
  const Eigen::VectorXd unit = gram.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(unit.asDiagonal() * gram * unit.asDiagonal(),
                                                     Eigen::EigenvaluesOnly)
          .eigenvalues();
  return eigenvalues.maxCoeff() / std::max(eigenvalues.minCoeff(), 1e-16);
}

PlantedQp random_planted_qp(Random& random, const PlantedLimits& limits) {
  PlantedQp planted;
  const int n = random.index(random.chance(0.4) ? std::min(6, limits.max_variables + 1)
                                                : limits.max_variables + 1);
  planted.condition = log_uniform(random, 1.0, limits.max_condition);
  const double lowest = std::pow(planted.condition, -random.uniform(0.0, 1.0));
  planted.qp = DenseQp::unconstrained(random_hessian(random, n, planted.condition, lowest),
                                      Eigen::VectorXd::Zero(n));
  planted.x = random_point(random, n);
  const int kind = random.index(10);
  const double share = kind == 0 ? 0.0 : kind == 1 ? 1.0 : random.uniform(0.0, 1.0);
  const int num_active = static_cast<int>(std::lround(share * n));
  const int num_bounds = random.chance(0.5) ? 0 : random.index(num_active + 1);
  std::vector<double> multipliers = add_rows(random, limits, num_active - num_bounds, planted);
  const std::vector<double> of_bounds = add_bounds(random, limits, num_bounds, planted);
  multipliers.insert(multipliers.end(), of_bounds.begin(), of_bounds.end());
  planted.multipliers =
      Eigen::Map<Eigen::VectorXd>(multipliers.data(), static_cast<Index>(multipliers.size()));
  DenseQp& qp = planted.qp;
  qp.f = qp.a.transpose() * planted.multipliers.head(qp.num_rows()) + planted.multipliers.tail(n) -
         qp.h * planted.x;
  std::vector<int> active;
  for (int c = 0; c < qp.num_constraints(); ++c) {
    if (planted.multipliers[c] != 0.0) active.push_back(c);
  }
  planted.gram_condition = gram_condition(qp, active);
  return planted;
}

DenseQp perturbed_partner(Random& random, const PlantedQp& planted, double share) {
  DenseQp qp = planted.qp;
  const int n = qp.num_variables();
  for (int i = 0; i < qp.num_rows(); ++i) {
    Eigen::VectorXd change(n);
    for (int j = 0; j < n; ++j) change[j] = random.uniform(-1.0, 1.0);
    if (n > 0) change *= share * qp.a.row(i).norm() / std::max(change.norm(), 1e-3);
    const bool is_equality = qp.lower[i] == qp.upper[i];
    qp.a.row(i) += change.transpose();
    qp.lower[i] += change.dot(planted.x);
    qp.upper[i] = is_equality ? qp.lower[i] : qp.upper[i] + change.dot(planted.x);
  }
  return qp;
}

void add_contradiction(Random& random, double gap, DenseQp& qp) {
  const int n = qp.num_variables();
  const int kind = random.index(4);
  if (kind == 0) {  // 0 . x >= gap
    qp.add_row(Eigen::VectorXd::Zero(n), gap, kInf);
    return;
  }
  if (kind == 1) {  // lower > upper
    const double low = random.uniform(-1.0, 1.0);
    qp.add_row(random_direction(random, n), low + gap, low);
    return;
  }
  // Minus a nonnegative combination of lower sides, old and new.
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(n);
  double bound = 0.0;
  const int num_parts = 1 + random.index(3);
  for (int k = 0; k < num_parts; ++k) {
    const double weight = log_uniform(random, 0.1, 10.0);
    int row = qp.num_rows() > 0 ? random.index(qp.num_rows()) : -1;
    if (row < 0 || std::isinf(qp.lower[row])) {
      row = qp.num_rows();
      qp.add_row(random_direction(random, n), random.uniform(-1.0, 1.0), kInf);
    }
    sum += weight * qp.a.row(row).transpose();
    bound += weight * qp.lower[row];
  }
  qp.add_row(-sum, gap * std::max(sum.norm(), 1.0) - bound, kInf);
}

}  // namespace sopt::oracle
