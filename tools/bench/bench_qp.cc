#include "tools/bench/bench_qp.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tools/bench/allocation_counter.h"
#include "tools/bench/bench_qp_solvers.h"
#include "tools/io/input_error.h"
#include "tools/qp/qp_solution.h"

namespace sopt {
namespace {

// Of one solver, cold or warm.
struct Samples {
  std::vector<std::vector<double>> times_us;  // of every problem
  std::vector<BenchQpOutcome> outcomes;       // of every problem, the last time
  std::int64_t num_allocations = 0;
  double max_difference = 0.0;

  explicit Samples(std::size_t num_problems) : times_us(num_problems), outcomes(num_problems) {}
};

void solve_once(BenchQpSolver& solver, const BenchQpProblem& problem, std::size_t i, bool is_warm,
                const Clock& clock, Samples& samples) {
  solver.prepare(problem);
  const std::int64_t allocations = num_allocations();
  const std::int64_t begin_ns = clock.now_ns();
  samples.outcomes[i] = solver.solve(problem, is_warm);
  const std::int64_t end_ns = clock.now_ns();
  samples.num_allocations += num_allocations() - allocations;
  samples.times_us[i].push_back(1e-3 * static_cast<double>(end_ns - begin_ns));
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

// A solver's two halves, side by side.
struct Measured {
  Samples cold, warm;

  explicit Measured(std::size_t num_problems) : cold(num_problems), warm(num_problems) {}
};

// The first solver's inputs are what the others are compared with.
struct Reference {
  std::vector<double> cold, warm;
};

void run_pair(BenchQpSolver& solver, const BenchQpPair& pair, std::size_t i, const Clock& clock,
              Measured& measured, Reference& reference) {
  const auto compare = [&](std::vector<double>& expected, Samples& samples) {
    if (expected.empty()) expected = solver.inputs();
    samples.max_difference =
        std::max(samples.max_difference, largest_difference(solver.inputs(), expected));
  };
  solve_once(solver, pair.cold, i, false, clock, measured.cold);
  compare(reference.cold, measured.cold);
  solver.remember(pair.warm_row_of);
  solve_once(solver, pair.warm, i, true, clock, measured.warm);
  compare(reference.warm, measured.warm);
}

BenchQpResult to_result(const std::string& solver, bool is_warm,
                        const std::vector<BenchQpPair>& pairs, const Samples& samples) {
  BenchQpResult result;
  result.solver = solver;
  result.is_warm = is_warm;
  result.num_allocations = samples.num_allocations;
  result.max_difference = samples.max_difference;
  std::vector<double> times_us;
  std::vector<double> steps;
  double timed_steps = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::vector<double>& own = samples.times_us[i];
    const BenchQpOutcome& outcome = samples.outcomes[i];
    times_us.insert(times_us.end(), own.begin(), own.end());
    result.slowest_us = std::max(result.slowest_us, summarize(own).median);
    steps.push_back(outcome.num_steps);
    result.total_steps += outcome.num_steps;
    timed_steps += outcome.num_steps * static_cast<double>(own.size());
    if (outcome.status != QpStatus::kOptimal) {
      result.failed.push_back(pairs[i].name + ": " + to_string(outcome.status));
    }
  }
  result.time_us = summarize(std::move(times_us));
  result.steps = summarize(std::move(steps));
  if (timed_steps > 0.0) {
    result.ns_per_step = 1e3 * result.time_us.mean * result.time_us.count / timed_steps;
  }
  return result;
}

// Sizes, and how many rows are active according to `samples`.
BenchQpFamily describe_problems(const QpFamily& family, const std::vector<BenchQpPair>& pairs,
                                const Samples& samples) {
  BenchQpFamily result;
  result.name = family.name;
  result.description = family.description;
  result.num_pairs = static_cast<int>(pairs.size());
  std::vector<double> rows;
  std::vector<double> active;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const QpProblem& problem = pairs[i].cold.condensed;
    result.num_variables = std::max(result.num_variables, problem.num_variables);
    rows.push_back(problem.num_rows);
    active.push_back(samples.outcomes[i].num_active);
  }
  result.min_rows = static_cast<int>(*std::min_element(rows.begin(), rows.end()));
  result.min_active = static_cast<int>(*std::min_element(active.begin(), active.end()));
  result.rows = summarize(std::move(rows));
  result.active = summarize(std::move(active));
  return result;
}

void forget_times(Samples& samples) {
  for (std::vector<double>& times_us : samples.times_us) times_us.clear();
}

}  // namespace

BenchQpFamily run_bench_qp(const QpFamily& family, int num_repeats, Clock clock) {
  std::vector<BenchQpPair> pairs;
  for (const QpPair& pair : family.pairs) pairs.push_back(make_bench_pair(pair));
  if (pairs.empty()) throw InputError("family " + family.name + " has no problems");
  const std::vector<std::unique_ptr<BenchQpSolver>> solvers = make_bench_solvers(pairs);
  std::vector<Measured> measured(solvers.size(), Measured(pairs.size()));
  std::vector<Reference> references(pairs.size());
  for (int repeat = 0; repeat <= num_repeats; ++repeat) {
    for (std::size_t s = 0; s < solvers.size(); ++s) {
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        run_pair(*solvers[s], pairs[i], i, clock, measured[s], references[i]);
      }
      if (repeat > 0) continue;
      forget_times(measured[s].cold);
      forget_times(measured[s].warm);
    }
  }
  BenchQpFamily result = describe_problems(family, pairs, measured.front().cold);
  for (std::size_t s = 0; s < solvers.size(); ++s) {
    result.results.push_back(to_result(solvers[s]->name(), false, pairs, measured[s].cold));
    result.results.push_back(to_result(solvers[s]->name(), true, pairs, measured[s].warm));
  }
  return result;
}

int num_failures(const std::vector<BenchQpFamily>& families) {
  int count = 0;
  for (const BenchQpFamily& family : families) {
    for (const BenchQpResult& result : family.results) {
      count += static_cast<int>(result.failed.size());
    }
  }
  return count;
}

}  // namespace sopt
