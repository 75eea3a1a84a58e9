// `sopt robot FILE.urdf -o ROBOT.json`: converts a robot description.
#pragma once

#include <CLI/CLI.hpp>

namespace sopt {

// The exit code is stored when the command has run; errors are thrown (tools/input_error.h).
void add_robot_command(CLI::App& app, int& exit_code);

}  // namespace sopt
