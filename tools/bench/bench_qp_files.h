// The measurement behind `sopt bench qp --files`: DenseRows on a QP file, cold and from the
// Hessian's factorisation on, against what any method on a dense Hessian has to begin with: the
// Cholesky factor H = LL' and, when there are rows, L^-1 A'. Both alternate in one run.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "opt/qp/qp_result.h"
#include "rt/clock.h"
#include "tools/io/qp_problem.h"

namespace sopt {

struct BenchQpFile {
  std::string name;
  int num_variables = 0;
  int num_rows = 0;
  int num_steps = 0;
  QpStatus status = QpStatus::kNotSolved;
  double time_us = 0.0;                   // medians
  double yardstick_us = 0.0;              // factor and solve alone
  double ratio = 0.0;                     // of the two
  std::optional<double> objective_error;  // |f - f*| / max(1, |f*|), when f* is known
  double violation = 0.0;                 // QpResiduals
};

// Both untimed first, then `num_repeats` >= 1 times; of small problems each time is the mean of as
// many solves in a row as make a reading of the clock small against them. Throws HostError when
// there is no memory.
[[nodiscard]] BenchQpFile bench_qp_file(const QpProblem& problem, int num_repeats,
                                        const Clock& clock);

// Those that did not end optimal.
[[nodiscard]] int num_failures(const std::vector<BenchQpFile>& files);

// A line for each file, and one for all; there is at least one.
[[nodiscard]] std::string describe(const std::vector<BenchQpFile>& files);
[[nodiscard]] nlohmann::ordered_json to_json(const std::vector<BenchQpFile>& files);

}  // namespace sopt
