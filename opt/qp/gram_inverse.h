// Factor of the inverse of the active rows' Gram matrix, K_aa^-1 = T'T with T = L^-1 lower
// triangular, kept up to date as rows enter and leave. For the column k and diagonal d of a row:
//     y = T k,   direction r = T'y = K_aa^-1 k,   curvature s = d - y'y
//     enters:   [  T            .       ]      leaves at p: rows p.. are rotated in pairs until
//               [ -r'/sqrt(s)  1/sqrt(s)]      column p is left in the last one; both go
// Products with T have no chain of dependent operations as substitution with L has, and an entering
// row costs no arithmetic but its direction (docs/qp.md, 2). What the explicit inverse loses in
// accuracy, at most a factor of the condition of L, the solver's refinement gives back. O(q^2) for
// solves and leaving, with q rows.
#pragma once

#include "alloc/fixed_vector.h"
#include "opt/qp/vector_ops.h"
#include "rt/annotations.h"

namespace sopt {

template <class Scalar>
class GramInverse {
 public:
  GramInverse() noexcept = default;
  GramInverse(Arena& arena, int max_rows) noexcept;

  [[nodiscard]] int size() const SOPT_RT { return size_; }
  void clear() SOPT_RT { size_ = 0; }

  // Column k of the row to enter: size() entries to be filled in. remove() takes its entry out.
  [[nodiscard]] Scalar* column() SOPT_RT { return column_.begin(); }
  // Solves for the column, y's entries before `first` being right already; returns the curvature.
  // Direction r has size() entries.
  Scalar solve_column(int first, Scalar diagonal) SOPT_RT;
  [[nodiscard]] Scalar* direction() SOPT_RT { return direction_.begin(); }
  [[nodiscard]] const Scalar* direction() const SOPT_RT { return direction_.begin(); }

  // x = K_aa^-1 x, in place, of size() entries.
  void solve(Scalar* x) SOPT_RT;

  // Appends the row that direction() is of; curvature > 0. False when full.
  [[nodiscard]] bool try_append(Scalar curvature) SOPT_RT;
  // Precondition: 0 <= position < size().
  void remove(int position) SOPT_RT;

 private:
  static constexpr int kLanes = VectorOf<Scalar>::kLanes;

  [[nodiscard]] Scalar* row(int i) SOPT_RT { return factor_.begin() + i * stride_; }
  [[nodiscard]] const Scalar* row(int i) const SOPT_RT { return factor_.begin() + i * stride_; }
  void multiply(int first, const Scalar* x, Scalar* y) const SOPT_RT;
  void multiply_transposed(const Scalar* y, Scalar* x) const SOPT_RT;

  int max_rows_ = 0;
  int size_ = 0;
  int stride_ = 0;
  FixedVector<Scalar> factor_;  // T, rows of stride_, zero right of the diagonal
  // Padded by a vector; of column_ and scratch_, zero behind the last entry during products.
  FixedVector<Scalar> column_;     // k
  FixedVector<Scalar> forward_;    // y
  FixedVector<Scalar> direction_;  // r
  FixedVector<Scalar> scratch_;    // x and T x of solve()
  FixedVector<Scalar> scratch_y_;
};

extern template class GramInverse<double>;
extern template class GramInverse<float>;

}  // namespace sopt
