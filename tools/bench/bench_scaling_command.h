// `sopt bench scaling`: time and exact counts of planning against the horizon (corridors, mazes)
// and against the number of obstacles (fields), first solution and optimisation apart, with the
// fitted exponents; as tables, as JSON and as charts.
#pragma once

#include <CLI/CLI.hpp>

namespace sopt {

// Below `bench`. The exit code is stored when the command has run; errors are thrown
// (tools/input_error.h).
void add_bench_scaling_command(CLI::App& bench, int& exit_code);

}  // namespace sopt
