// Strict reading of QP files: words and numbers apart by blanks or line ends, in this order,
//     QP1 NAME                   the rest of the first line
//     n m neq                    variables, rows, how many of the first rows are equalities
//     H count, then "i j v"      lower triangle of the Hessian, each entry once
//     f                          n numbers
//     A count, then "i j v"      entries of the rows, each once
//     lA uA lb ub                m, m, n, n numbers after each word; |v| >= 1e20 is no bound
//     fstar, xstar               optional: the optimum's value, and its n variables
// Indices count from 0. What is not given of H and A is 0. A lower bound above the upper one is a
// problem without a solution, not a malformed file.
#pragma once

#include <filesystem>

#include "tools/io/qp_problem.h"

namespace sopt {

inline constexpr int kMaxQpVariables = 2000;
inline constexpr int kMaxQpRows = 20000;
inline constexpr double kQpInfinity = 1e20;

// Throws InputError, one line: file, line, field, value, what is allowed.
[[nodiscard]] QpProblem load_qp(const std::filesystem::path& file);

}  // namespace sopt
