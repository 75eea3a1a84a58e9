// `sopt bench qp`: time, working-set changes and agreement of the QP solvers on seeded families of
// segment QPs and on the QPs of plans in the plane (a family of its own, p); or, with --files, of
// DenseRows on QP files against the Cholesky factor of the Hessian and a triangular solve.
#pragma once

#include <CLI/CLI.hpp>

namespace sopt {

// Below `bench`. The exit code is stored when the command has run; errors are thrown
// (tools/input_error.h).
void add_bench_qp_command(CLI::App& bench, int& exit_code);

}  // namespace sopt
