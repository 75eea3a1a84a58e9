#include "tools/bench/bench_qp_files.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>

#include "tools/bench/bench_qp_solvers.h"
#include "tools/bench/bench_statistics.h"
#include "tools/io/input_error.h"
#include "tools/io/json_fields.h"
#include "tools/io/plan_report.h"
#include "tools/qp/qp_solution.h"

namespace sopt {
namespace {

using Matrix = Eigen::MatrixXd;

class Yardstick {
 public:
  explicit Yardstick(const QpProblem& problem)
      : hessian_(Eigen::Map<const Matrix>(problem.hessian.data(), problem.num_variables,
                                          problem.num_variables)),
        transposed_rows_(
            Eigen::Map<const Matrix>(problem.rows.data(), problem.num_variables, problem.num_rows)),
        factor_(problem.num_variables) {}

  // Mean of `batch` runs, each on rows of its own.
  [[nodiscard]] double run_us(int batch, const Clock& clock) {
    solved_.assign(static_cast<std::size_t>(batch), transposed_rows_);
    const std::int64_t begin_ns = clock.now_ns();
    for (Matrix& solved : solved_) {
      factor_.compute(hessian_);
      if (solved.cols() > 0) factor_.matrixL().solveInPlace(solved);
    }
    return 1e-3 * static_cast<double>(clock.now_ns() - begin_ns) / batch;
  }

 private:
  Matrix hessian_;
  Matrix transposed_rows_;  // n x m
  std::vector<Matrix> solved_;
  Eigen::LLT<Matrix> factor_;
};

// Both methods on one problem.
class Comparison {
 public:
  Comparison(const QpProblem& problem, const Clock& clock)
      : input_{{}, {}, problem},
        solver_(make_dense_solver(problem)),
        yardstick_(problem),
        clock_(clock) {
    choose_batch();
  }

  [[nodiscard]] double solve_us() { return solve_us(batch_); }
  [[nodiscard]] double yardstick_us() { return yardstick_.run_us(batch_, clock_); }
  [[nodiscard]] const BenchQpOutcome& outcome() const { return outcome_; }
  [[nodiscard]] std::vector<double> point() const { return solver_->inputs(); }

 private:
  // Small problems take about as long as a reading of the clock: many of them to a reading.
  void choose_batch() {
    constexpr double kReading_us = 100.0;
    constexpr int kMaxBatch = 200;
    double least_us = kReading_us;
    for (int i = 0; i < 3; ++i) {
      least_us = std::min({least_us, solve_us(1), yardstick_.run_us(1, clock_)});
    }
    batch_ = static_cast<int>(kReading_us / std::max(least_us, kReading_us / kMaxBatch));
  }

  double solve_us(int batch) {
    const std::int64_t begin_ns = clock_.now_ns();
    for (int i = 0; i < batch; ++i) outcome_ = solver_->solve(input_, false);
    return 1e-3 * static_cast<double>(clock_.now_ns() - begin_ns) / batch;
  }

  BenchQpProblem input_;
  std::unique_ptr<BenchQpSolver> solver_;
  Yardstick yardstick_;
  Clock clock_;
  int batch_ = 1;
  BenchQpOutcome outcome_;
};

void judge(const QpProblem& problem, const std::vector<double>& x, BenchQpFile& file) {
  const std::vector<double> no_multipliers(static_cast<std::size_t>(problem.num_constraints()));
  const QpResiduals residuals = compute_residuals(problem, x, no_multipliers);
  file.violation = residuals.violation;
  if (!problem.optimum) return;
  file.objective_error =
      std::abs(residuals.objective - *problem.optimum) / std::max(1.0, std::abs(*problem.optimum));
}

nlohmann::ordered_json file_json(const BenchQpFile& file) {
  nlohmann::ordered_json document = {{"name", file.name},
                                     {"variables", file.num_variables},
                                     {"rows", file.num_rows},
                                     {"steps", file.num_steps},
                                     {"status", to_string(file.status)},
                                     {"median_us", file.time_us},
                                     {"yardstick_us", file.yardstick_us},
                                     {"ratio", file.ratio},
                                     {"violation", file.violation}};
  if (file.objective_error) document["objective_error"] = *file.objective_error;
  return document;
}

// Over all files.
struct Summary {
  Distribution ratio;
  double objective_error = 0.0;  // largest
  double violation = 0.0;        // largest
};

Summary summary_of(const std::vector<BenchQpFile>& files) {
  Summary summary;
  std::vector<double> ratios;
  for (const BenchQpFile& file : files) {
    ratios.push_back(file.ratio);
    summary.objective_error = std::max(summary.objective_error, file.objective_error.value_or(0.0));
    summary.violation = std::max(summary.violation, file.violation);
  }
  summary.ratio = summarize(std::move(ratios));
  return summary;
}

}  // namespace

BenchQpFile bench_qp_file(const QpProblem& problem, int num_repeats, const Clock& clock) {
  BenchQpFile file;
  file.name = problem.name;
  file.num_variables = problem.num_variables;
  file.num_rows = problem.num_rows;
  Comparison comparison(problem, clock);
  std::vector<double> times_us;
  std::vector<double> yardsticks_us;
  for (int repeat = 0; repeat < num_repeats; ++repeat) {
    times_us.push_back(comparison.solve_us());
    yardsticks_us.push_back(comparison.yardstick_us());
  }
  file.status = comparison.outcome().status;
  file.num_steps = comparison.outcome().num_steps;
  file.time_us = summarize(std::move(times_us)).median;
  file.yardstick_us = summarize(std::move(yardsticks_us)).median;
  if (file.yardstick_us > 0.0) file.ratio = file.time_us / file.yardstick_us;
  judge(problem, comparison.point(), file);
  return file;
}

int num_failures(const std::vector<BenchQpFile>& files) {
  return static_cast<int>(std::count_if(files.begin(), files.end(), [](const BenchQpFile& file) {
    return file.status != QpStatus::kOptimal;
  }));
}

std::string describe(const std::vector<BenchQpFile>& files) {
  std::string text = format("%-28s %5s %6s %6s %10s %10s %6s %9s %9s\n", "file", "n", "m", "steps",
                            "[us]", "yardstick", "ratio", "|f-f*|", "violation");
  for (const BenchQpFile& file : files) {
    const std::string error =
        file.objective_error ? format("%9.1e", *file.objective_error) : "        -";
    text += format("%-28s %5d %6d %6d %10.1f %10.1f %6.2f %s %9.1e%s%s\n",
                   printable(file.name).c_str(), file.num_variables, file.num_rows, file.num_steps,
                   file.time_us, file.yardstick_us, file.ratio, error.c_str(), file.violation,
                   file.status == QpStatus::kOptimal ? "" : "  failed: ",
                   file.status == QpStatus::kOptimal ? "" : to_string(file.status));
  }
  const Summary all = summary_of(files);
  text += format(
      "%zu files, %d failed; ratio median %.2f, worst %.2f; worst |f-f*| %.1e relative, "
      "violation %.1e\n",
      files.size(), num_failures(files), all.ratio.median, all.ratio.max, all.objective_error,
      all.violation);
  return text;
}

nlohmann::ordered_json to_json(const std::vector<BenchQpFile>& files) {
  const Summary all = summary_of(files);
  nlohmann::ordered_json document = {{"ratio_median", all.ratio.median},
                                     {"ratio_worst", all.ratio.max},
                                     {"objective_error_worst", all.objective_error},
                                     {"violation_worst", all.violation}};
  for (const BenchQpFile& file : files) document["files"].push_back(file_json(file));
  return document;
}

}  // namespace sopt
