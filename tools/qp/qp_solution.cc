#include "tools/qp/qp_solution.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "alloc/arena.h"
#include "alloc/memory_block.h"
#include "opt/qp/active_set_qp.h"
#include "opt/qp/dense_rows.h"
#include "rt/deadline.h"
#include "tools/io/input_error.h"

namespace sopt {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::size_t to_size(int count) { return static_cast<std::size_t>(count); }

std::span<const double> row_of(const std::vector<double>& matrix, std::size_t i, std::size_t n) {
  return std::span(matrix).subspan(i * n, n);
}

double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0.0;
  for (std::size_t j = 0; j < a.size(); ++j) sum += a[j] * b[j];
  return sum;
}

bool are_finite(std::span<const double> numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double v) { return std::isfinite(v); });
}

// H x + f - A'l, and the sums of the magnitudes of its terms.
struct Gradient {
  std::vector<double> sum;
  std::vector<double> magnitude;

  explicit Gradient(std::size_t n) : sum(n), magnitude(n) {}
  void add(std::size_t j, double term) {
    sum[j] += term;
    magnitude[j] += std::abs(term);
  }
  [[nodiscard]] double scale() const {
    double largest = 1.0;
    for (const double m : magnitude) largest = std::max(largest, m);
    return largest;
  }
  [[nodiscard]] double largest() const {
    double largest = 0.0;
    for (const double s : sum) largest = std::max(largest, std::abs(s));
    return largest;
  }
};

Gradient lagrangian_gradient(const QpProblem& problem, std::span<const double> x,
                             std::span<const double> multipliers) {
  const std::size_t n = x.size();
  const std::size_t m = to_size(problem.num_rows);
  Gradient gradient(n);
  for (std::size_t j = 0; j < n; ++j) {
    const std::span<const double> h = row_of(problem.hessian, j, n);
    for (std::size_t k = 0; k < n; ++k) gradient.add(j, h[k] * x[k]);
    gradient.add(j, problem.gradient[j]);
    gradient.add(j, -multipliers[m + j]);
  }
  for (std::size_t i = 0; i < m; ++i) {
    if (multipliers[i] == 0.0) continue;
    const std::span<const double> a = row_of(problem.rows, i, n);
    for (std::size_t j = 0; j < n; ++j) gradient.add(j, -multipliers[i] * a[j]);
  }
  return gradient;
}

// One constraint lower <= a . x <= upper at x.
struct Constraint {
  double value = 0.0;
  double length = 0.0;  // |a|
  double lower = 0.0;
  double upper = 0.0;

  [[nodiscard]] double violation() const {
    return std::max({0.0, scaled(lower - value, lower), scaled(value - upper, upper)});
  }
  // Of the bound that a multiplier of this sign belongs to.
  [[nodiscard]] double bound(double multiplier) const { return multiplier > 0.0 ? lower : upper; }

 private:
  [[nodiscard]] double scaled(double excess, double bound) const {
    if (std::isinf(bound)) return 0.0;
    return excess / std::max(length > 0.0 ? length : 1.0, std::abs(bound));
  }
};

Constraint constraint_at(const QpProblem& problem, std::span<const double> x, std::size_t c) {
  const std::size_t m = to_size(problem.num_rows);
  if (c >= m) return {x[c - m], 1.0, problem.lower[c - m], problem.upper[c - m]};
  const std::span<const double> a = row_of(problem.rows, c, x.size());
  return {dot(a, x), std::sqrt(dot(a, a)), problem.row_lower[c], problem.row_upper[c]};
}

double objective_at(const QpProblem& problem, std::span<const double> x) {
  double objective = dot(problem.gradient, x);
  for (std::size_t j = 0; j < x.size(); ++j) {
    objective += 0.5 * x[j] * dot(row_of(problem.hessian, j, x.size()), x);
  }
  return objective;
}

// At most n rows are active; equalities that follow from others are kept beside them.
DenseCapacity capacity_for(const QpProblem& problem) {
  constexpr int kMaxBeside = 2000;  // 0.1 GB in as many variables
  const int n = problem.num_variables;
  int num_equalities = 0;
  for (std::size_t i = 0; i < problem.row_lower.size(); ++i) {
    num_equalities += problem.row_lower[i] == problem.row_upper[i] ? 1 : 0;
  }
  for (std::size_t j = 0; j < problem.lower.size(); ++j) {
    num_equalities += problem.lower[j] == problem.upper[j] ? 1 : 0;
  }
  return {n, problem.num_rows, n + std::min(num_equalities, kMaxBeside)};
}

struct Workspace {
  DenseRows<double> rows;
  ActiveSetQp<double> solver;

  Workspace(Arena& arena, const DenseCapacity& capacity)
      : rows(arena, capacity), solver(arena, capacity.max_active) {}

  [[nodiscard]] static std::size_t required_bytes(const DenseCapacity& capacity) {
    Arena arena = Arena::measuring();
    const Workspace measured(arena, capacity);
    return arena.used_B();
  }
};

void load(const QpProblem& problem, DenseRows<double>& rows) {
  if (!rows.factorize(problem.num_variables, problem.hessian.data())) return;
  rows.reset(problem.gradient.data());
  const std::size_t n = to_size(problem.num_variables);
  for (std::size_t i = 0; i < to_size(problem.num_rows); ++i) {
    (void)rows.try_add(problem.rows.data() + i * n, problem.row_lower[i], problem.row_upper[i]);
  }
  for (int j = 0; j < problem.num_variables; ++j) {
    rows.set_bounds(j, problem.lower[to_size(j)], problem.upper[to_size(j)]);
  }
}

std::string name_of(const DenseRows<double>& rows, int id) {
  const int c = rows.constraint(id);
  const bool is_row = c < rows.num_rows();
  std::string name = is_row ? "row " + std::to_string(c)
                            : "bound of variable " + std::to_string(c - rows.num_rows());
  if (id < rows.num_equalities()) return name + " (equality)";
  return name + (rows.is_upper(id) ? " (upper)" : " (lower)");
}

}  // namespace

double QpResiduals::largest() const {
  return std::max({violation, stationarity, sign, complementarity});
}

QpResiduals compute_residuals(const QpProblem& problem, std::span<const double> x,
                              std::span<const double> multipliers) {
  if (!are_finite(x) || !are_finite(multipliers)) {
    return {kInfinity, kInfinity, kInfinity, kInfinity, kInfinity};
  }
  QpResiduals residuals;
  residuals.objective = objective_at(problem, x);
  const Gradient gradient = lagrangian_gradient(problem, x, multipliers);
  residuals.stationarity = gradient.largest() / gradient.scale();
  double gap = 0.0;
  for (std::size_t c = 0; c < multipliers.size(); ++c) {
    const Constraint constraint = constraint_at(problem, x, c);
    residuals.violation = std::max(residuals.violation, constraint.violation());
    if (multipliers[c] == 0.0) continue;
    const double bound = constraint.bound(multipliers[c]);
    if (std::isinf(bound)) {
      const double push = std::abs(multipliers[c]) * constraint.length / gradient.scale();
      residuals.sign = std::max(residuals.sign, push);
    } else {
      gap += std::abs(multipliers[c] * (constraint.value - bound));
    }
  }
  residuals.complementarity = gap / std::max(1.0, std::abs(residuals.objective));
  return residuals;
}

QpSolution solve_qp(const QpProblem& problem, const QpOptions<double>& options) {
  const DenseCapacity capacity = capacity_for(problem);
  const MemoryBlock block(Workspace::required_bytes(capacity));
  Arena arena(block);
  Workspace workspace(arena, capacity);
  if (arena.exhausted()) throw HostError("no memory for the QP");
  DenseRows<double>& rows = workspace.rows;
  load(problem, rows);

  QpSolution solution;
  solution.result = workspace.solver.solve(rows, options, Deadline());
  solution.x.resize(to_size(problem.num_variables));
  solution.multipliers.resize(to_size(problem.num_constraints()));
  if (solution.result.status == QpStatus::kBadInput) return solution;
  std::copy(rows.primal().begin(), rows.primal().end(), solution.x.begin());
  rows.write_multipliers(workspace.solver.active_rows(), workspace.solver.multipliers(),
                         solution.multipliers.data());
  if (solution.result.blocking_row >= 0) {
    solution.blocking = name_of(rows, solution.result.blocking_row);
  }
  return solution;
}

int default_max_steps(const QpProblem& problem) { return 1000 + 10 * problem.num_constraints(); }

const char* to_string(QpStatus status) {
  switch (status) {
    case QpStatus::kOptimal:
      return "optimal";
    case QpStatus::kNotSolved:
      return "not_solved";
    case QpStatus::kInfeasible:
      return "infeasible";
    case QpStatus::kStepLimit:
      return "step_limit";
    case QpStatus::kDeadline:
      return "deadline";
    case QpStatus::kCapacity:
      return "capacity";
    case QpStatus::kInaccurate:
      return "inaccurate";
    case QpStatus::kBadInput:
      return "bad_input";
  }
  return "not_solved";
}

}  // namespace sopt
