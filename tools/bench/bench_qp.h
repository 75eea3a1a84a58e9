// The measurement behind `sopt bench qp`: every problem of a family cold, and its partner from the
// active rows of the first, by every solver. Timed is what happens when tables are known and rows
// are new: the row space is reset and filled, and solved. Problems alternate, so that no solve
// finds the caches and branch predictions of the one before.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "rt/clock.h"
#include "tools/bench/bench_statistics.h"
#include "tools/qp/qp_families.h"

namespace sopt {

// A solver on all cold problems, or on all warm ones.
struct BenchQpResult {
  std::string solver;
  bool is_warm = false;
  Distribution time_us;      // of all timed solves
  double slowest_us = 0.0;   // of the problem with the largest median
  double ns_per_step = 0.0;  // all time over all steps
  Distribution steps;        // working-set changes, one number per problem
  std::int64_t total_steps = 0;
  std::int64_t num_allocations = 0;
  std::vector<std::string> failed;  // "b17: infeasible"
  // Largest difference of an input from DenseRows on the condensed problem.
  double max_difference = 0.0;
};

struct BenchQpFamily {
  std::string name;
  std::string description;
  int num_pairs = 0;
  int num_variables = 0;  // the largest; condensed
  Distribution rows;      // condensed, equalities included, input bounds not
  int min_rows = 0;
  Distribution active;  // at the optimum, equalities included
  int min_active = 0;
  std::vector<BenchQpResult> results;
};

// One untimed pass over all problems, then `num_repeats` timed ones. Throws InputError when
// the family is empty, HostError when there is no memory.
[[nodiscard]] BenchQpFamily run_bench_qp(const QpFamily& family, int num_repeats, Clock clock);

// Solves that did not end optimal.
[[nodiscard]] int num_failures(const std::vector<BenchQpFamily>& families);

}  // namespace sopt
