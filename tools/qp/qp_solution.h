// Solves a QpProblem with DenseRows and ActiveSetQp, and judges an answer from the problem's data
// alone, by the KKT conditions
//     H x + f = A' l + l_bounds,   l_c > 0 only at a lower bound, l_c < 0 only at an upper one.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "opt/qp/qp_result.h"
#include "tools/io/qp_problem.h"

namespace sopt {

// Without unit; all are infinite when a number of the answer is not finite.
struct QpResiduals {
  double objective = 0.0;  // 1/2 x'Hx + f'x, no residual
  // Largest violation of a constraint over max(|a|, |bound|); |a| is 1 for a row of zeros.
  double violation = 0.0;
  // |H x + f - A'l|_inf / max(1, | |H||x| + |f| + |A'||l| |_inf)
  double stationarity = 0.0;
  // Largest multiplier that pushes from a bound that does not exist, times |a|, over the same.
  double sign = 0.0;
  // sum |l_c x distance to the bound it belongs to| / max(1, |objective|): the duality gap of a
  // stationary point that violates nothing.
  double complementarity = 0.0;

  [[nodiscard]] double largest() const;
};

// `multipliers` by constraint, m + n.
[[nodiscard]] QpResiduals compute_residuals(const QpProblem& problem, std::span<const double> x,
                                            std::span<const double> multipliers);

struct QpSolution {
  QpResult<double> result;
  std::vector<double> x;
  std::vector<double> multipliers;  // by constraint, m + n
  std::string blocking;             // what cannot hold, as in "row 12 (upper)"; "" when all can
};

// Throws HostError when there is no memory. kBadInput: the Hessian is not positive definite.
[[nodiscard]] QpSolution solve_qp(const QpProblem& problem, const QpOptions<double>& options);

// Working-set changes that a sound problem stays far below.
[[nodiscard]] int default_max_steps(const QpProblem& problem);

[[nodiscard]] const char* to_string(QpStatus status);

}  // namespace sopt
