#include "tools/qp_command.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include "tools/cli/option_checks.h"
#include "tools/io/input_error.h"
#include "tools/io/json_fields.h"
#include "tools/io/plan_report.h"
#include "tools/io/qp_file.h"
#include "tools/qp/qp_solution.h"

namespace sopt {
namespace {

struct QpArguments {
  std::string file;
  std::optional<int> max_steps;
  std::optional<double> tolerance;
};

// From the optimum in the file; empty when it has none.
std::string describe_difference(const QpProblem& problem, const QpSolution& solution,
                                double objective) {
  std::string text;
  if (problem.optimum) text += format("%.2g from fstar", objective - *problem.optimum);
  if (!problem.optimum_point.empty()) {
    double largest = 0.0;
    for (std::size_t j = 0; j < solution.x.size(); ++j) {
      largest = std::max(largest, std::abs(solution.x[j] - problem.optimum_point[j]));
    }
    text += format("%sat most %.2g from xstar", text.empty() ? "" : ", ", largest);
  }
  return text.empty() ? "" : "  difference    " + text + '\n';
}

// Why there is no optimum.
std::string describe_failure(const QpSolution& solution) {
  switch (solution.result.status) {
    case QpStatus::kInfeasible:
      return solution.blocking + " cannot hold together with the others";
    case QpStatus::kStepLimit:
      return "the working-set changes allowed were not enough";
    case QpStatus::kCapacity:
      return "too many equalities follow from others";
    case QpStatus::kInaccurate:
      return "rounding: constraints hold to the violation below only";
    case QpStatus::kOptimal:
    case QpStatus::kNotSolved:
    case QpStatus::kDeadline:
    case QpStatus::kBadInput:
      break;
  }
  return to_string(solution.result.status);
}

std::string describe_work(const QpResult<double>& result) {
  std::string text =
      format("  working set   %d changes, %d active", result.num_steps, result.num_active);
  if (result.num_refactored > 0) text += format(", begun again %dx", result.num_refactored);
  return text + '\n';
}

std::string describe(const QpProblem& problem, const QpSolution& solution) {
  const QpResult<double>& result = solution.result;
  const bool is_optimal = result.status == QpStatus::kOptimal;
  const QpResiduals residuals = compute_residuals(problem, solution.x, solution.multipliers);
  std::string text = format("%s  %s: %d variables, %d rows, %d of them equalities\n",
                            to_string(result.status), printable(problem.name).c_str(),
                            problem.num_variables, problem.num_rows, problem.num_equalities);
  if (is_optimal) {
    text += format("objective: %.17g\n", residuals.objective);
    text += describe_difference(problem, solution, residuals.objective);
  } else {
    text += "  reason        " + describe_failure(solution) + '\n';
  }
  if (result.status != QpStatus::kInfeasible) {
    text += format(
        "  residuals     violation %.2g, stationarity %.2g, multiplier signs %.2g, "
        "complementarity %.2g\n",
        residuals.violation, residuals.stationarity, residuals.sign, residuals.complementarity);
  }
  return text + describe_work(result);
}

int run_qp(const QpArguments& arguments) {
  const QpProblem problem = load_qp(arguments.file);
  QpOptions<double> options;
  options.max_steps = arguments.max_steps.value_or(default_max_steps(problem));
  options.violation_tolerance = arguments.tolerance.value_or(options.violation_tolerance);
  const QpSolution solution = solve_qp(problem, options);
  if (solution.result.status == QpStatus::kBadInput) {
    throw InputError(printable(arguments.file, 400) +
                     ": H is not positive definite; it must be, by more than rounding");
  }
  (void)std::fputs(describe(problem, solution).c_str(), stdout);
  return solution.result.status == QpStatus::kOptimal ? 0 : 1;
}

}  // namespace

void add_qp_command(CLI::App& app, int& exit_code) {
  constexpr NumberRule kTolerance{1e-15, 1e-3, "a number from 1e-15 to 1e-3"};
  const auto arguments = std::make_shared<QpArguments>();
  CLI::App* const command =
      app.add_subcommand("qp", "Solve a strictly convex QP: objective, residuals, work");
  command->add_option("FILE", arguments->file, "Problem in the QP1 format")
      ->required()
      ->type_name("QP1");
  command
      ->add_option("--max-steps", arguments->max_steps,
                   "Working-set changes allowed [1000 + 10 for each constraint]")
      ->type_name("N")
      ->check(integer_check(0, 1000000000));
  command
      ->add_option("--tolerance", arguments->tolerance,
                   "Constraints may be violated by this, scaled to unit length [1e-11]")
      ->type_name("T")
      ->check(number_check(kTolerance));
  command->callback([arguments, &exit_code] { exit_code = run_qp(*arguments); });
}

}  // namespace sopt
