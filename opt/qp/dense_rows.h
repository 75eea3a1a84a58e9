// The row space of a general strictly convex QP,
//     min 1/2 x'Hx + f'x   s.t.  lower <= A x <= upper,  lower <= x <= upper,
// by the Cholesky factor H = R'R. A row that becomes active gets y = R^-T a; nothing is computed
// for rows that never do:
//     gram(i,k) = y_i . y_k        x(lambda) = R^-1 (sum lambda_i y_i - R^-T f)
// n^3/6 for the factor, n^2/2 per entering row (bounds: from their variable on), and per pricing
// pass the nonzero stretches of A, a vector of rows at a time. Rows are scaled to unit length, and
// to unit bounds where those are longer, so that one tolerance fits all of them, and priced by
// violation^2 / sum a_j^2 / H_jj, an estimate of their gram entry. docs/qp.md, 5.
//
// Constraint c in [0, m) is a row, m + j the bounds of variable j. Ids are [equality constraints]
// [lower, upper of every constraint]; a constraint with lower == upper is an equality. Infinite
// bounds are none. lower > upper is a contradiction the solver reports; NaN, lower = +inf, and
// upper = -inf make the problem invalid.
#pragma once

#include <span>

#include "alloc/fixed_vector.h"
#include "opt/qp/cholesky_factor.h"
#include "opt/qp/vector_ops.h"
#include "rt/annotations.h"

namespace sopt {

struct DenseCapacity {
  int max_variables = 0;
  int max_rows = 0;
  int max_active = 0;  // of the solver it is used with
};

template <class ScalarType>
class DenseRows {
 public:
  using Scalar = ScalarType;

  DenseRows() noexcept = default;
  DenseRows(Arena& arena, const DenseCapacity& capacity) noexcept;

  // Takes the Hessian, n x n symmetric, row after row, of which the lower triangle is read. False,
  // and problems are invalid, when it is too large, not finite, or not positive definite (a pivot
  // below n eps of its diagonal entry). Call reset() next.
  bool factorize(int num_variables, const Scalar* hessian) SOPT_RT;

  // Starts a new problem with the same Hessian: gradient f (n), no rows, no bounds.
  void reset(const Scalar* gradient) SOPT_RT;

  // Adds lower <= a . x <= upper, a of n entries. A row without a finite bound is carried along
  // unscaled, for SumRows; one whose squared length underflows counts as zeros. False when the rows
  // are full.
  [[nodiscard]] bool try_add(const Scalar* a, Scalar lower, Scalar upper) SOPT_RT;
  // After all rows; the last bounds of a variable count.
  void set_bounds(int variable, Scalar lower, Scalar upper) SOPT_RT;

  // --- what the active-set core asks of a row space (active_set_qp.h)
  [[nodiscard]] bool is_valid() const SOPT_RT { return is_convex_ && not_finite_ == Scalar(0); }
  [[nodiscard]] int num_equalities() const SOPT_RT { return equalities_.size(); }
  [[nodiscard]] int num_ids() const SOPT_RT {
    return equalities_.size() + 2 * (num_rows_ + num_variables_);
  }
  [[nodiscard]] bool is_free(int id) const SOPT_RT;
  void enter(int id) SOPT_RT;
  void leave(int id) SOPT_RT;
  void gram(std::span<const int> ids, int id, Scalar* out) const SOPT_RT;
  [[nodiscard]] Scalar softness(int id) const SOPT_RT {
    return softness_[position(constraint(id))] * scale(id) * scale(id);
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
  [[nodiscard]] int num_variables() const SOPT_RT { return num_variables_; }
  [[nodiscard]] int num_rows() const SOPT_RT { return num_rows_; }
  [[nodiscard]] int constraint(int id) const SOPT_RT { return id_side(id) / 2; }
  [[nodiscard]] bool is_upper(int id) const SOPT_RT { return id_side(id) % 2 == 1; }
  // Id of the lower bound of a constraint that is not an equality; of the upper one, one more.
  [[nodiscard]] int lower_id(int constraint) const SOPT_RT {
    return equalities_.size() + 2 * constraint;
  }
  // Softens a constraint: it may be violated at a cost of violation^2 / (2 softness) in the units
  // of the problem. After all rows and bounds.
  void set_softness(int constraint, Scalar softness) SOPT_RT;
  // a . x
  [[nodiscard]] Scalar value(int constraint) const SOPT_RT {
    return constraint < num_rows_ ? row_value_[constraint] : x_[constraint - num_rows_];
  }
  [[nodiscard]] std::span<const Scalar> primal() const SOPT_RT {
    return x_.span().first(static_cast<std::size_t>(num_variables_));
  }
  // Multipliers of all constraints (m + n) in the units of the problem: H x + f = A' lambda, >= 0
  // at a lower bound, <= 0 at an upper one.
  void write_multipliers(std::span<const int> ids, std::span<const Scalar> multipliers,
                         Scalar* out) const SOPT_RT;

 private:
  static constexpr int kGroup = VectorOf<Scalar>::kLanes;

  // Equality ids name the lower side.
  [[nodiscard]] int id_side(int id) const SOPT_RT {
    return id < equalities_.size() ? 2 * equalities_[id] : id - equalities_.size();
  }
  // Where a constraint's numbers are: bounds begin behind room for all rows.
  [[nodiscard]] int position(int constraint) const SOPT_RT {
    return constraint < num_rows_ ? constraint : constraint - num_rows_ + bounds_begin_;
  }
  // Of a side: the row it means is scale * sign * a . x >= scale * sign * bound.
  [[nodiscard]] Scalar scale(int id) const SOPT_RT {
    const int p = position(constraint(id));
    return is_upper(id) ? -upper_.scale[p] : lower_.scale[p];
  }
  [[nodiscard]] int& slot(int id) SOPT_RT {
    return slot_[2 * position(constraint(id)) + (is_upper(id) ? 1 : 0)];
  }
  [[nodiscard]] const Scalar* y_of(int id) const SOPT_RT {
    const int side = 2 * position(constraint(id)) + (is_upper(id) ? 1 : 0);
    return y_.begin() + slot_[side] * stride_;
  }
  // Coefficients of a row: every kGroup-th number from here on.
  [[nodiscard]] Scalar* row(int i) SOPT_RT {
    return rows_.begin() + (i / kGroup) * kGroup * stride_ + i % kGroup;
  }
  [[nodiscard]] const Scalar* row(int i) const SOPT_RT {
    return rows_.begin() + (i / kGroup) * kGroup * stride_ + i % kGroup;
  }
  [[nodiscard]] int violated_side(int p) const SOPT_RT;
  void add_rows(std::span<const int> ids, std::span<const Scalar> weights,
                Scalar* sum) const SOPT_RT;
  void update_row_values() SOPT_RT;
  void clear_constraints(int first, int last) SOPT_RT;
  void set_constraint(int constraint, Scalar lower, Scalar upper, Scalar length) SOPT_RT;
  void forget_equality(int constraint) SOPT_RT;
  void set_price(int constraint, Scalar gram) SOPT_RT;

  // One side of all constraints, by position.
  struct Sides {
    FixedVector<Scalar> bound;
    FixedVector<Scalar> priced_bound;  // out of sight while entered
    FixedVector<Scalar> scale;
  };
  // Nonzero columns of a group of rows.
  struct Stretch {
    int first = 0, last = 0;
  };

  int stride_ = 0;  // max_variables, padded
  int bounds_begin_ = 0;
  int max_rows_ = 0;
  int num_variables_ = 0;
  int num_rows_ = 0;
  bool is_convex_ = false;
  Scalar not_finite_ = 0;          // NaN once some number was not finite
  CholeskyFactor<Scalar> factor_;  // n x n: R' of H = R'R
  FixedVector<Scalar> rows_;       // groups of kGroup rows, column after column
  FixedVector<Stretch> stretch_;   // of groups
  FixedVector<Scalar> row_value_;  // a . x
  Sides lower_, upper_;
  FixedVector<Scalar> inverse_diagonal_;  // n: 1 / H_jj
  FixedVector<Scalar> price_;             // by position: 1 / sum a_j^2 / H_jj
  FixedVector<Scalar> softness_;          // by position
  FixedVector<int> slot_;                 // of y while entered, by position and side
  FixedVector<int> equalities_;           // constraints
  FixedVector<Scalar> y_;                 // slots x n: scale sign R^-T a
  FixedVector<int> free_slots_;
  // Of n numbers, padded, as is y:
  FixedVector<Scalar> base_;  // -R^-T f
  FixedVector<Scalar> x_;
  FixedVector<Scalar> step_;  // sum w_i y_i
  FixedVector<Scalar> scratch_;
};

extern template class DenseRows<double>;
extern template class DenseRows<float>;

}  // namespace sopt
