// `sopt tables plane|arm`: the paper's tables and figures made again (tools/tables).
#pragma once

#include <CLI/CLI.hpp>

namespace sopt {

// Registers the subcommand; when it was run, `exit_code` says how that ended: 1 when a case had no
// plan.
void add_tables_command(CLI::App& app, int& exit_code);

}  // namespace sopt
