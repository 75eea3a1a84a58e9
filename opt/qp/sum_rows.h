// The row space of a robot whose cost is the sum of two parts that share rows, as a mobile base
// (DenseRows) and the arm on it (KernelRows):
//     gram(i,k) = gram_base(i,k) + gram_arm(i,k),   violation = b - a_base . x_base - a_arm . x_arm
// Rows and bounds of one part alone stay in that part; a coupled row names a row without bound in
// each (docs/qp.md, 6). Ids: [base] [arm] [coupled].
#pragma once

#include <span>

#include "alloc/fixed_vector.h"
#include "opt/qp/dense_rows.h"
#include "opt/qp/kernel_rows.h"
#include "rt/annotations.h"

namespace sopt {

struct SumCapacity {
  int max_coupled = 0;
  int max_active = 0;  // of the solver it is used with
};

template <class Base, class Arm>
class SumRows {
 public:
  using Scalar = typename Base::Scalar;

  SumRows() noexcept = default;
  // Both parts belong to this from now on, and outlive it.
  SumRows(Arena& arena, Base& base, Arm& arm, const SumCapacity& capacity) noexcept;

  // Call after both parts were reset and filled: forgets coupled rows.
  void reset() SOPT_RT;
  // base row base_constraint + arm row arm_id >= bound. Both are without bounds and named once.
  // False when full.
  [[nodiscard]] bool try_add(int base_constraint, int arm_id, Scalar bound) SOPT_RT;
  // Of coupled rows: violated at a cost of violation^2 / (2 softness).
  void set_softness(Scalar softness) SOPT_RT { softness_ = softness; }

  // --- what the active-set core asks of a row space (active_set_qp.h)
  [[nodiscard]] bool is_valid() const SOPT_RT;
  [[nodiscard]] int num_equalities() const SOPT_RT { return base_->num_equalities(); }
  [[nodiscard]] int num_ids() const SOPT_RT { return first_coupled_ + coupled_.size(); }
  [[nodiscard]] bool is_free(int id) const SOPT_RT;
  void enter(int id) SOPT_RT;
  void leave(int id) SOPT_RT;
  void gram(std::span<const int> ids, int id, Scalar* out) SOPT_RT;
  [[nodiscard]] Scalar softness(int id) const SOPT_RT;
  void update_primal(std::span<const int> ids, std::span<const Scalar> weights) SOPT_RT;
  void update_step(std::span<const int> ids, std::span<const Scalar> weights) SOPT_RT;
  [[nodiscard]] Scalar step_value(int id) const SOPT_RT;
  [[nodiscard]] Scalar step_energy() const SOPT_RT {
    return base_->step_energy() + arm_->step_energy();
  }
  void add_step() SOPT_RT;
  [[nodiscard]] Scalar violation(int id) const SOPT_RT;
  [[nodiscard]] Scalar size_of_terms(int id) const SOPT_RT;
  [[nodiscard]] int most_violated(Scalar tolerance) const SOPT_RT;

  [[nodiscard]] int coupled_id(int i) const SOPT_RT { return first_coupled_ + i; }

 private:
  struct Coupled {
    int base_constraint = 0;
    int base_id = 0;
    int arm_id = 0;
    Scalar bound = 0;
    Scalar priced_bound = 0;
  };
  // Ids of a row in both parts; -1: it has none there.
  struct Parts {
    int base = -1;
    int arm = -1;
  };

  [[nodiscard]] Parts parts(int id) const SOPT_RT;
  void split(std::span<const int> ids) SOPT_RT;
  void split(std::span<const int> ids, std::span<const Scalar> weights) SOPT_RT;

  Base* base_ = nullptr;
  Arm* arm_ = nullptr;
  int first_arm_ = 0;
  int first_coupled_ = 0;
  Scalar softness_ = 0;
  Scalar not_finite_ = 0;
  FixedVector<Coupled> coupled_;
  // Of the ids at hand that have such a part: their ids in it, where they stand, a number each.
  struct Share {
    FixedVector<int> ids, positions;
    FixedVector<Scalar> numbers;
  };
  Share base_share_, arm_share_;
};

extern template class SumRows<DenseRows<double>, KernelRows<double, 4>>;
extern template class SumRows<DenseRows<double>, KernelRows<double, 8>>;

}  // namespace sopt
