// The solvers that `sopt bench qp` compares, behind one interface: the structured row spaces in
// double and single precision, PointRows where it applies, and DenseRows on the condensed problem.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "opt/qp/qp_result.h"
#include "tools/qp/qp_families.h"

namespace sopt {

// A problem in every form a solver takes.
struct BenchQpProblem {
  SegmentQp structured;
  KernelPart<float> single;
  QpProblem condensed;
};

struct BenchQpPair {
  std::string name;
  BenchQpProblem cold, warm;
  std::vector<int> warm_row_of;  // see QpPair
};

[[nodiscard]] BenchQpPair make_bench_pair(const QpPair& pair);

struct BenchQpOutcome {
  QpStatus status = QpStatus::kNotSolved;
  int num_steps = 0;
  int num_active = 0;  // with equalities and fixed ends
};

class BenchQpSolver {
 public:
  explicit BenchQpSolver(std::string name) : name_(std::move(name)) {}
  BenchQpSolver(const BenchQpSolver&) = delete;
  BenchQpSolver& operator=(const BenchQpSolver&) = delete;
  virtual ~BenchQpSolver() = default;

  [[nodiscard]] const std::string& name() const { return name_; }

  // What is known before a problem arrives.
  virtual void prepare(const BenchQpProblem& problem) = 0;
  // From the problem's data to its solution, without heap. Starts from what was remembered, when
  // something was and `is_warm`.
  virtual BenchQpOutcome solve(const BenchQpProblem& problem, bool is_warm) = 0;
  // The active rows of the last solve, for a problem in which they have other indices as QpPair
  // says; or the same ids.
  virtual void remember(const std::vector<int>& warm_row_of) = 0;
  void remember() { remember({}); }
  // Of the last solve, in the order of the condensed problem's variables.
  [[nodiscard]] virtual std::vector<double> inputs() const = 0;

 private:
  std::string name_;
};

// All solvers that apply, DenseRows first. The pairs are of one family, and outlive them.
// Throws HostError when there is no memory.
[[nodiscard]] std::vector<std::unique_ptr<BenchQpSolver>> make_bench_solvers(
    const std::vector<BenchQpPair>& pairs);

// DenseRows for one condensed problem, its Hessian factorised in every solve. Throws HostError.
[[nodiscard]] std::unique_ptr<BenchQpSolver> make_dense_solver(const QpProblem& problem);

}  // namespace sopt
