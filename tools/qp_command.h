// `sopt qp FILE.qp`: solves a strictly convex QP and prints its objective, residuals and work.
#pragma once

#include <CLI/CLI.hpp>

namespace sopt {

// The exit code is stored when the command has run; errors are thrown (tools/input_error.h).
void add_qp_command(CLI::App& app, int& exit_code);

}  // namespace sopt
