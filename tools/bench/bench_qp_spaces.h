// What the solvers of `sopt bench qp` solve over: each space owns row spaces, which load() fills
// from a problem and rows() gives to ActiveSetQp; false when they do not fit. inputs() are those of
// the last solve, by time. Spaces differ in what else they offer:
//     prepare(problem)    what is known before a problem arrives
//     row_id(i)           of arm row i, where pairs may have rows at other indices
#pragma once

#include <span>
#include <type_traits>
#include <vector>

#include "alloc/arena.h"
#include "opt/qp/point_rows.h"
#include "tools/bench/bench_qp_solvers.h"

namespace sopt {

class DenseSpace {
 public:
  using Scalar = double;
  struct Settings {
    DenseCapacity capacity;
    bool is_factor_known;
  };

  DenseSpace(Arena& arena, const Settings& settings)
      : is_factor_known_(settings.is_factor_known), rows_(arena, settings.capacity) {}

  void prepare(const BenchQpProblem& problem) {
    if (is_factor_known_) (void)factorize(problem.condensed);
  }

  bool load(const BenchQpProblem& problem) {
    const QpProblem& qp = problem.condensed;
    if (!is_factor_known_ && !factorize(qp)) return false;
    rows_.reset(qp.gradient.data());
    first_row_ = qp.num_rows - static_cast<int>(problem.structured.arm.rows.size());
    const double* row = qp.rows.data();
    for (std::size_t i = 0; i < qp.row_lower.size(); ++i, row += qp.num_variables) {
      if (!rows_.try_add(row, qp.row_lower[i], qp.row_upper[i])) return false;
    }
    for (std::size_t j = 0; j < qp.lower.size(); ++j) {
      rows_.set_bounds(static_cast<int>(j), qp.lower[j], qp.upper[j]);
    }
    return true;
  }

  DenseRows<double>& rows() { return rows_; }
  // Without coupled rows, those of the arm are last.
  [[nodiscard]] int row_id(int i) const { return rows_.lower_id(first_row_ + i); }
  [[nodiscard]] std::vector<double> inputs() const {
    return {rows_.primal().begin(), rows_.primal().end()};
  }

 private:
  bool factorize(const QpProblem& qp) {
    return rows_.factorize(qp.num_variables, qp.hessian.data());
  }

  bool is_factor_known_;
  int first_row_ = 0;
  DenseRows<double> rows_;
};

struct KernelSettings {
  static constexpr int kMaxTable = 60;  // steps; longer segments sweep

  int order;
  IntegratorWeights weights;
  KernelCapacity capacity;
  DenseCapacity base;
};

// Inputs by time, after those of the base.
template <class Rows>
std::vector<double> collect_inputs(const Rows& rows, const SegmentQp& problem,
                                   std::span<const double> base) {
  std::vector<double> inputs;
  const auto per_step = static_cast<std::size_t>(problem.base.num_inputs);
  for (int t = 0; t < problem.arm.num_steps; ++t) {
    const std::span<const double> own =
        base.subspan(static_cast<std::size_t>(t) * per_step, per_step);
    inputs.insert(inputs.end(), own.begin(), own.end());
    const auto* const value = rows.value(problem.arm.input(), t);
    for (int j = 0; j < problem.arm.num_joints; ++j) {
      inputs.push_back(static_cast<double>(value[j]));
    }
  }
  return inputs;
}

template <class ScalarType, int kLanes>
class KernelSpace {
 public:
  using Scalar = ScalarType;
  using Settings = KernelSettings;

  KernelSpace(Arena& arena, const Settings& settings)
      : kernel_(arena, settings.order, settings.weights, settings.capacity.max_window,
                Settings::kMaxTable),
        rows_(arena, kernel_, settings.capacity) {}

  bool load(const BenchQpProblem& problem) {
    problem_ = &problem.structured;
    if constexpr (std::is_same_v<Scalar, float>) {
      return fill(problem.single, rows_);
    } else {
      return fill(problem.structured.arm, rows_);
    }
  }

  KernelRows<Scalar, kLanes>& rows() { return rows_; }
  [[nodiscard]] int row_id(int i) const { return rows_.row_id(i); }
  [[nodiscard]] std::vector<double> inputs() const { return collect_inputs(rows_, *problem_, {}); }

 private:
  const SegmentQp* problem_ = nullptr;
  IntegratorKernel<Scalar> kernel_;
  KernelRows<Scalar, kLanes> rows_;
};

template <int kLanes>
class SumSpace {
 public:
  using Scalar = double;
  using Settings = KernelSettings;

  SumSpace(Arena& arena, const Settings& settings)
      : kernel_(arena, settings.order, settings.weights, settings.capacity.max_window,
                Settings::kMaxTable),
        base_(arena, settings.base),
        arm_(arena, kernel_, settings.capacity),
        rows_(arena, base_, arm_, {settings.capacity.max_rows, settings.capacity.max_active}) {}

  bool load(const BenchQpProblem& problem) {
    problem_ = &problem.structured;
    return fill(problem.structured, base_, arm_, rows_);
  }

  SumRows<DenseRows<double>, KernelRows<double, kLanes>>& rows() { return rows_; }
  [[nodiscard]] std::vector<double> inputs() const {
    return collect_inputs(arm_, *problem_, base_.primal());
  }

 private:
  const SegmentQp* problem_ = nullptr;
  IntegratorKernel<double> kernel_;
  DenseRows<double> base_;
  KernelRows<double, kLanes> arm_;
  SumRows<DenseRows<double>, KernelRows<double, kLanes>> rows_;
};

class PointSpace {
 public:
  using Scalar = double;
  using Settings = KernelSettings;

  PointSpace(Arena& arena, const Settings& settings)
      : rows_(arena, settings.capacity.max_window, settings.capacity.max_rows),
        ids_(arena, settings.capacity.max_rows) {}

  bool load(const BenchQpProblem& problem) {
    const KernelPart<double>& part = problem.structured.arm;
    rows_.reset(part.num_steps, Vec2(part.first_position.data()), Vec2(part.last_position.data()));
    ids_.clear();
    int id = -1;
    for (const KernelRow<double>& row : part.rows) {
      const int first_new = rows_.num_ids();
      if (!rows_.try_add(row.t, Vec2(row.direction.data()), row.bound)) return false;
      id = rows_.num_ids() > first_new ? first_new : id + 1;  // a group of its own, or the last
      (void)ids_.try_push_back(id);
    }
    return true;
  }

  PointRows& rows() { return rows_; }
  [[nodiscard]] int row_id(int i) const { return ids_[i]; }
  [[nodiscard]] std::vector<double> inputs() const {
    std::vector<double> inputs;
    for (int t = 0; t < rows_.num_steps(); ++t) {
      const Vec2 step = rows_.position(t + 1) - rows_.position(t);
      inputs.insert(inputs.end(), step.begin(), step.end());
    }
    return inputs;
  }

 private:
  PointRows rows_;
  FixedVector<int> ids_;  // of the arm's rows
};

}  // namespace sopt
