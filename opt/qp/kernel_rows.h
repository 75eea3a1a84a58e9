// The row space of a linear time-invariant robot's segment over IntegratorKernel: rows
//     a . quantity(t) >= b,   quantity in {position, velocity, acceleration},
// with directions a over the joints, and bounds on every quantity, time and joint, which cost
// nothing but their share of a pricing pass while inactive. With joint factors r_j (the cost of
// joint j is r_j times the kernel's):
//     gram(i,k) = G_n((q_i,t_i),(q_k,t_k)) sum_j a_ij a_kj / r_j
//     quantities(lambda) = one O(n) sweep under the forces lambda_i a_i / r
// Rows and bounds are priced by violation / sqrt(gram). docs/qp.md, 4.
//
// Ids: rows in the order of try_add, padded to groups (row_id says which), then the bounds.
// kLanes joints are computed at a time: 4 or 8.
#pragma once

#include <cstdint>
#include <span>

#include "alloc/fixed_vector.h"
#include "opt/qp/integrator_kernel.h"
#include "opt/qp/vector_ops.h"
#include "rt/annotations.h"

namespace sopt {

enum class Quantity : std::int8_t { kPosition = 0, kVelocity = 1, kAcceleration = 2 };

struct KernelCapacity {
  int max_window = 60;
  int max_rows = 512;    // of try_add
  int max_active = 128;  // of the solver it is used with
};

// What a segment is between; arrays of one number per joint, read during reset().
template <class Scalar>
struct KernelSegment {
  int num_steps = 2;
  int num_joints = 1;
  const Scalar* first_position = nullptr;
  const Scalar* last_position = nullptr;
  const Scalar* first_velocity = nullptr;  // per step; acceleration input only
  const Scalar* last_velocity = nullptr;
  const Scalar* factors = nullptr;    // r_j > 0; null: 1
  const Scalar* attractor = nullptr;  // what w_q pulls positions to; null: 0
};

template <class ScalarType, int kLanes>
class KernelRows {
 public:
  using Scalar = ScalarType;

  KernelRows() noexcept = default;
  // The kernel is shared, read only, and outlives this.
  KernelRows(Arena& arena, const IntegratorKernel<Scalar>& kernel,
             const KernelCapacity& capacity) noexcept;

  // Starts a segment of order <= num_steps <= max_window and num_joints <= kLanes, without rows or
  // bounds, all hard. Anything else, or numbers that are not finite, make the problem invalid; rows
  // and bounds of a segment of the wrong size are ignored.
  void reset(const KernelSegment<Scalar>& segment) SOPT_RT;

  // Adds direction . quantity(t) >= bound, num_joints entries, bound < +inf; -inf: never priced,
  // for SumRows. Times are 0 .. n, for the input 0 .. n - 1; ends are fixed, so that rows there
  // hold or are a contradiction. Best in order of quantity and time: a group is one SIMD vector of
  // neighbours of the same. False when the rows are full.
  [[nodiscard]] bool try_add(Quantity quantity, int t, const Scalar* direction,
                             Scalar bound) SOPT_RT;
  // Bounds of all joints at times first_t .. last_t; infinite ones are none.
  void set_bounds(Quantity quantity, int first_t, int last_t, const Scalar* lower,
                  const Scalar* upper) SOPT_RT;
  // 0: rows are hard. > 0: rows (not bounds) may be violated at a cost of violation^2 / (2
  // softness).
  void set_softness(Scalar softness) SOPT_RT { softness_ = softness; }

  // --- what the active-set core asks of a row space (active_set_qp.h)
  [[nodiscard]] bool is_valid() const SOPT_RT { return not_finite_ == Scalar(0); }
  [[nodiscard]] static int num_equalities() SOPT_RT { return 0; }
  [[nodiscard]] int num_ids() const SOPT_RT { return num_padded() + 2 * kLanes * profile_size_; }
  [[nodiscard]] bool is_free(int id) const SOPT_RT;
  void enter(int id) SOPT_RT;
  void leave(int id) SOPT_RT;
  void gram(std::span<const int> ids, int id, Scalar* out) const SOPT_RT;
  [[nodiscard]] Scalar softness(int id) const SOPT_RT {
    return id < num_padded() ? softness_ : Scalar(0);
  }
  void update_primal(std::span<const int> ids, std::span<const Scalar> weights) SOPT_RT;
  void update_step(std::span<const int> ids, std::span<const Scalar> weights) SOPT_RT;
  [[nodiscard]] Scalar step_value(int id) const SOPT_RT;
  [[nodiscard]] Scalar step_energy() const SOPT_RT;
  void add_step() SOPT_RT;
  [[nodiscard]] Scalar violation(int id) const SOPT_RT;
  [[nodiscard]] Scalar size_of_terms(int id) const SOPT_RT;
  [[nodiscard]] int most_violated(Scalar tolerance) const SOPT_RT;

  // --- meaning of ids, and results
  [[nodiscard]] int num_steps() const SOPT_RT { return num_steps_; }
  [[nodiscard]] int num_rows() const SOPT_RT { return row_ids_.size(); }
  // Of the row added as number i, and of a bound.
  [[nodiscard]] int row_id(int i) const SOPT_RT { return row_ids_[i]; }
  [[nodiscard]] int bound_id(Quantity quantity, int t, int joint, bool is_upper) const SOPT_RT {
    return num_padded() + 2 * (kLanes * index_of(quantity, t) + joint) + (is_upper ? 1 : 0);
  }
  // quantity(t), kLanes numbers of which num_joints count.
  [[nodiscard]] const Scalar* value(Quantity quantity, int t) const SOPT_RT {
    return value_.begin() + kLanes * index_of(quantity, t);
  }
  // direction . quantity(t) of the row with this id.
  [[nodiscard]] Scalar row_value(int id) const SOPT_RT { return row_value_[id]; }

 private:
  static constexpr int kGroup = VectorOf<Scalar>::kLanes;
  using Joints = Lanes<Scalar, kLanes>;

  // Rows of one quantity and time, a vector of them at a time.
  struct Group {
    Scalar direction[kLanes][kGroup];
    Scalar priced_bound[kGroup];  // lowered out of sight for entered rows
    Scalar price[kGroup];         // 1 / sqrt(gram_ii)
  };
  struct Entered {
    const Scalar* column = nullptr;  // of G_n
    int index = 0;                   // in profiles
    Joints direction{};
    Joints weighted{};  // direction / r
    Scalar bound = 0;
  };
  struct Row {
    int index = 0;
    Joints direction{};
    Scalar bound = 0;
  };

  [[nodiscard]] int num_padded() const SOPT_RT { return kGroup * groups_.size(); }
  [[nodiscard]] int index_of(Quantity quantity, int t) const SOPT_RT {
    return static_cast<int>(quantity) * (num_steps_ + 1) + t;
  }
  [[nodiscard]] bool try_begin_group(int index) SOPT_RT;
  [[nodiscard]] Scalar bound_of(int id) const SOPT_RT;
  [[nodiscard]] Row row_of(int id) const SOPT_RT;
  void load_kernel() SOPT_RT;
  void update_row_values() SOPT_RT;
  void set_priced_bound(int id, Scalar bound) SOPT_RT;
  [[nodiscard]] int most_violated_bound(Scalar tolerance, int best,
                                        Scalar best_value) const SOPT_RT;
  void add_forces(std::span<const int> ids, std::span<const Scalar> weights) SOPT_RT;

  const IntegratorKernel<Scalar>* kernel_ = nullptr;
  int num_steps_ = 0;
  int num_joints_ = 0;
  int profile_size_ = 0;
  int num_in_group_ = 0;
  bool has_table_ = false;
  Scalar softness_ = 0;
  Scalar not_finite_ = 0;  // NaN once some number was not finite
  typename IntegratorKernel<Scalar>::template Ends<kLanes> ends_;
  Joints factors_{};                    // r
  Scalar inverse_factor_[kLanes] = {};  // 1 / r, 0 beyond the joints
  Joints joint_price_{};                // sqrt(r)
  const Scalar* end_response_ = nullptr;
  const Scalar* price_ = nullptr;  // profile: 1 / sqrt(G_ii)
  FixedVector<Group> groups_;
  FixedVector<int> group_index_;   // in profiles
  FixedVector<Scalar> row_value_;  // of padded rows, direction . quantity(t)
  FixedVector<int> row_ids_;
  FixedVector<Scalar> lower_, upper_;         // profile x kLanes, far away for entered bounds
  bool has_bounds_[3] = {};                   // of each quantity
  FixedVector<Scalar> force_, value_, step_;  // profile x kLanes
  FixedVector<Entered> entered_;              // slots
  FixedVector<int> free_slots_;
  FixedVector<int> slot_;                 // of ids that are entered; -1: not
  FixedVector<Scalar> columns_;           // slots x profile, segments without table
  FixedVector<Scalar> own_end_response_;  // order x profile, segments without table
  FixedVector<Scalar> own_price_;         // ones, segments without table
};

extern template class KernelRows<double, 4>;
extern template class KernelRows<double, 8>;
extern template class KernelRows<float, 8>;

}  // namespace sopt
