#include "tools/bench/bench_qp_solvers.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "alloc/arena.h"
#include "alloc/memory_block.h"
#include "opt/qp/active_set_qp.h"
#include "tools/bench/bench_qp_spaces.h"
#include "tools/io/input_error.h"

namespace sopt {
namespace {

constexpr int kMaxSteps = 10000;

// Largest of every size.
struct Sizes {
  int num_steps = 0;
  int num_joints = 0;
  int num_rows = 0;  // of the structured form, coupled ones included
  DenseCapacity base;
  DenseCapacity condensed;
};

Sizes sizes_of(const std::vector<BenchQpPair>& pairs) {
  Sizes sizes;
  for (const BenchQpPair& pair : pairs) {
    for (const BenchQpProblem* problem : {&pair.cold, &pair.warm}) {
      const SegmentQp& qp = problem->structured;
      const auto num_coupled = static_cast<int>(qp.coupled.size());
      const auto num_own = static_cast<int>(qp.arm.rows.size());
      const auto num_equalities = static_cast<int>(qp.base.equality_rows.size());
      const auto num_base = static_cast<int>(qp.base.gradient.size());
      const auto grow = [](int& size, int to) { size = std::max(size, to); };
      grow(sizes.num_steps, qp.arm.num_steps);
      grow(sizes.num_joints, qp.arm.num_joints);
      grow(sizes.num_rows, num_own + num_coupled);
      grow(sizes.base.max_variables, num_base);
      grow(sizes.base.max_rows, num_equalities + num_coupled);
      grow(sizes.condensed.max_variables, problem->condensed.num_variables);
      grow(sizes.condensed.max_rows, problem->condensed.num_rows);
    }
  }
  sizes.condensed.max_active = sizes.condensed.max_variables;
  sizes.base.max_active = sizes.condensed.max_variables;
  return sizes;
}

// Memory for whatever `Space` takes.
template <class Space, class Settings>
std::size_t required_bytes(const Settings& settings) {
  Arena arena = Arena::measuring();
  const Space measured(arena, settings);
  return arena.used_B();
}

template <class Space>
class SpaceSolver : public BenchQpSolver {
 public:
  using Scalar = typename Space::Scalar;

  SpaceSolver(std::string name, const typename Space::Settings& settings, int max_active)
      : BenchQpSolver(std::move(name)),
        memory_(required_bytes<Parts>(PartSettings{settings, max_active})),
        arena_(memory_),
        parts_(arena_, {settings, max_active}) {
    if (arena_.exhausted()) throw HostError("no memory for the QPs");
  }

  void prepare(const BenchQpProblem& problem) override {
    if constexpr (requires { parts_.space.prepare(problem); }) parts_.space.prepare(problem);
  }

  BenchQpOutcome solve(const BenchQpProblem& problem, bool is_warm) override {
    if (!parts_.space.load(problem)) return {QpStatus::kCapacity};
    QpOptions<Scalar> options;
    options.max_steps = kMaxSteps;
    if (is_warm) {
      set_ids();
      options.warm = {active_, multipliers_};
    }
    const QpResult<Scalar> result = parts_.solver.solve(parts_.space.rows(), options, Deadline());
    return {result.status, result.num_steps, result.num_active};
  }

  void remember(const std::vector<int>& warm_row_of) override {
    const auto ids = parts_.solver.active_rows();
    const auto multipliers = parts_.solver.multipliers();
    has_rows_ = false;
    active_rows_.clear();
    active_.assign(ids.begin(), ids.end());
    multipliers_.assign(multipliers.begin(), multipliers.end());
    if constexpr (kHasRowIds) {
      if (!warm_row_of.empty()) remember_rows(warm_row_of);
    }
  }

  [[nodiscard]] std::vector<double> inputs() const override { return parts_.space.inputs(); }

 private:
  static constexpr bool kHasRowIds = requires(const Space& space) { space.row_id(0); };

  // Of what was remembered, the rows that are in the partner too, by their index there.
  void remember_rows(const std::vector<int>& warm_row_of) {
    const Space& space = parts_.space;
    std::vector<Scalar> multipliers;
    for (int i = 0; i < static_cast<int>(warm_row_of.size()); ++i) {
      const auto position = std::find(active_.begin(), active_.end(), space.row_id(i));
      const int row = warm_row_of[static_cast<std::size_t>(i)];
      if (row < 0 || position == active_.end()) continue;
      active_rows_.push_back(row);
      multipliers.push_back(multipliers_[static_cast<std::size_t>(position - active_.begin())]);
    }
    active_.resize(active_rows_.size());
    multipliers_ = std::move(multipliers);
    has_rows_ = true;
  }

  // Ids of the remembered rows are known once the problem is loaded.
  void set_ids() {
    if constexpr (kHasRowIds) {
      if (!has_rows_) return;
      std::transform(active_rows_.begin(), active_rows_.end(), active_.begin(),
                     [&](int row) { return parts_.space.row_id(row); });
    }
  }

  struct PartSettings {
    typename Space::Settings space;
    int max_active;
  };
  struct Parts {
    Space space;
    ActiveSetQp<Scalar> solver;

    Parts(Arena& arena, const PartSettings& settings)
        : space(arena, settings.space), solver(arena, settings.max_active) {}
  };

  MemoryBlock memory_;
  Arena arena_;
  Parts parts_;
  bool has_rows_ = false;
  std::vector<int> active_rows_;  // of arm rows, when has_rows_
  std::vector<int> active_;       // ids
  std::vector<Scalar> multipliers_;
};

KernelSettings kernel_settings(const Sizes& sizes, const KernelPart<double>& part) {
  return {part.order,
          part.weights,
          {sizes.num_steps, sizes.num_rows, sizes.condensed.max_variables},
          sizes.base};
}

// What PointRows is the closed form of.
bool is_point(const KernelPart<double>& part) {
  return part.order == 1 && part.num_joints == 2 && part.weights.position == 0.0 &&
         part.weights.velocity == 1.0 && part.factors.empty() && part.bounds.empty();
}

}  // namespace

BenchQpPair make_bench_pair(const QpPair& pair) {
  const auto make = [&](const SegmentQp& problem) {
    return BenchQpProblem{problem, to_float(problem.arm), condense(problem, pair.name)};
  };
  return {pair.name, make(pair.cold), make(pair.warm), pair.warm_row_of};
}

std::vector<std::unique_ptr<BenchQpSolver>> make_bench_solvers(
    const std::vector<BenchQpPair>& pairs) {
  std::vector<std::unique_ptr<BenchQpSolver>> solvers;
  if (pairs.empty()) return solvers;
  const Sizes sizes = sizes_of(pairs);
  const int max_active = sizes.condensed.max_active;
  const auto add = [&]<class Space>(const char* name, const typename Space::Settings& settings) {
    solvers.push_back(std::make_unique<SpaceSolver<Space>>(name, settings, max_active));
  };
  add.operator()<DenseSpace>("dense", {sizes.condensed, false});
  add.operator()<DenseSpace>("dense, H known", {sizes.condensed, true});
  const KernelSettings settings = kernel_settings(sizes, pairs.front().cold.structured.arm);
  const bool is_narrow = sizes.num_joints <= 4;
  if (sizes.base.max_variables > 0) {
    is_narrow ? add.operator()<SumSpace<4>>("kernel", settings)
              : add.operator()<SumSpace<8>>("kernel", settings);
    return solvers;
  }
  is_narrow ? add.operator()<KernelSpace<double, 4>>("kernel", settings)
            : add.operator()<KernelSpace<double, 8>>("kernel", settings);
  add.operator()<KernelSpace<float, 8>>("kernel, float", settings);
  const bool are_points = std::all_of(pairs.begin(), pairs.end(), [](const BenchQpPair& pair) {
    return is_point(pair.cold.structured.arm) && is_point(pair.warm.structured.arm);
  });
  if (are_points) add.operator()<PointSpace>("point", settings);
  return solvers;
}

std::unique_ptr<BenchQpSolver> make_dense_solver(const QpProblem& problem) {
  // Equalities that follow from others, and fixed variables, are kept beside n independent rows.
  const int max_active = 2 * problem.num_variables + problem.num_equalities;
  const DenseCapacity capacity = {problem.num_variables, problem.num_rows, max_active};
  return std::make_unique<SpaceSolver<DenseSpace>>("dense", DenseSpace::Settings{capacity, false},
                                                   max_active);
}

}  // namespace sopt
