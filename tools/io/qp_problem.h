// A strictly convex QP as data,
//     min 1/2 x'Hx + f'x   s.t.  row_lower <= A x <= row_upper,  lower <= x <= upper,
// dense, with infinite bounds where there are none. Constraint c in [0, m) is a row of A, m + j the
// bounds of variable j.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace sopt {

struct QpProblem {
  std::string name;
  int num_variables = 0;                     // n
  int num_rows = 0;                          // m
  int num_equalities = 0;                    // leading rows with row_lower == row_upper
  std::vector<double> hessian;               // n x n, symmetric
  std::vector<double> gradient;              // n
  std::vector<double> rows;                  // m x n, row after row
  std::vector<double> row_lower, row_upper;  // m
  std::vector<double> lower, upper;          // n
  // Of the optimum, when it is known.
  std::optional<double> optimum;
  std::vector<double> optimum_point;  // n or empty

  [[nodiscard]] int num_constraints() const { return num_rows + num_variables; }
};

}  // namespace sopt
