// The `sopt` program. Exit codes: 0 done; 1 valid input but no usable plan, or a check that failed;
// 2 input unreadable or invalid, or wrong usage; 3 host problem. Errors are one line on stderr.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <new>
#include <string>

#include "tools/bench/bench_command.h"
#include "tools/io/input_error.h"
#include "tools/io/json_fields.h"
#include "tools/plan_command.h"
#include "tools/qp_command.h"
#include "tools/robot_command.h"
#include "tools/tables_command.h"
#include "tools/verify_command.h"

namespace {

int report(const std::string& line, int exit_code) {
  (void)std::fprintf(stderr, "sopt: %s\n", line.c_str());
  return exit_code;
}

// The innermost command that was given has the help that helps.
std::string help_hint(const CLI::App& app) {
  std::string names;
  for (auto commands = app.get_subcommands(); !commands.empty();
       commands = commands.front()->get_subcommands()) {
    names += commands.front()->get_name() + ' ';
  }
  return " (see sopt " + names + "--help)";
}

int run(int argc, char** argv) {
  CLI::App app("RRT*-sOpt: real-time long-horizon motion planning", "sopt");
  int exit_code = 0;
  sopt::add_plan_command(app, exit_code);
  sopt::add_verify_command(app, exit_code);
  sopt::add_bench_command(app, exit_code);
  sopt::add_qp_command(app, exit_code);
  sopt::add_tables_command(app, exit_code);
  sopt::add_robot_command(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    return report(sopt::printable(error.what(), 400) + help_hint(app), 2);
  }
  if (app.get_subcommands().empty()) {
    std::string names;
    for (const CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
      names += (names.empty() ? "" : ", ") + command->get_name();
    }
    return report("a command is required, one of " + names + help_hint(app), 2);
  }
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const int exit_code = run(argc, argv);
    return std::fflush(stdout) == 0 ? exit_code : report("stdout cannot be written", 3);
  } catch (const sopt::InputError& error) {
    return report(error.what(), 2);
  } catch (const sopt::HostError& error) {
    return report(error.what(), 3);
  } catch (const std::bad_alloc&) {
    return report("the host has no memory left", 3);
  } catch (const std::exception& error) {
    return report(error.what(), 3);
  }
}
