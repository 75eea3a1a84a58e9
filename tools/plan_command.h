// `sopt plan SCENE`: plan, verify, report, and write plan, picture and table.
#pragma once

#include <CLI/CLI.hpp>

namespace sopt {

// The exit code is stored when the command has run; errors are thrown (tools/input_error.h).
void add_plan_command(CLI::App& app, int& exit_code);

}  // namespace sopt
