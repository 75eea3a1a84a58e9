// `sopt bench plan`: success, stage times and their tails, lengths, cost over scenes and seeds, as
// a table for people and as JSON.
#pragma once

#include <CLI/CLI.hpp>

namespace sopt {

// The exit code is stored when the command has run; errors are thrown (tools/input_error.h).
void add_bench_command(CLI::App& app, int& exit_code);

}  // namespace sopt
