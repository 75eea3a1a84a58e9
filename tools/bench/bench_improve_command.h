// `sopt bench improve`: the length of plans over the budget for improving them (--improve-ms), by
// scene, as tables, as JSON and as charts.
#pragma once

#include <CLI/CLI.hpp>

namespace sopt {

// Below `bench`. The exit code is stored when the command has run; errors are thrown
// (tools/input_error.h).
void add_bench_improve_command(CLI::App& bench, int& exit_code);

}  // namespace sopt
