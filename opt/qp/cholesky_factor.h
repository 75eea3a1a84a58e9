// Cholesky factor H = L L' of a dense symmetric matrix, one SIMD vector of rows at a time: n^3 / 6.
// The inverses of L's diagonal blocks of that size are stored in their place, so that solves
// advance by a block without substitution inside:
//     forward   x_b = D_b^-1 (x_b - L_b,<b x_<b)        backward   x_b = D_b^-T x_b,
//                                                                  x_<b = x_<b - L_b,<b' x_b
// The size is padded to a multiple of the vector length by rows of the identity.
#pragma once

#include "alloc/fixed_vector.h"
#include "opt/qp/vector_ops.h"
#include "rt/annotations.h"

namespace sopt {

template <class Scalar>
class CholeskyFactor {
 public:
  CholeskyFactor() noexcept = default;
  CholeskyFactor(Arena& arena, int max_size) noexcept
      : max_size_(max_size),
        stride_(padded<Scalar>(max_size)),
        factor_(arena, stride_ * stride_),
        diagonal_columns_(arena, kBlock * stride_),
        columns_(arena, kBlock * stride_) {
    (void)factor_.try_resize(factor_.capacity());
    (void)diagonal_columns_.try_resize(diagonal_columns_.capacity());
    (void)columns_.try_resize(columns_.capacity());
  }

  [[nodiscard]] int size() const SOPT_RT { return size_; }

  // Factorises a matrix of size x size numbers, of which the lower triangle is read. False, and the
  // size is 0, when it does not fit, is not finite, or has a pivot of at most size eps times its
  // diagonal entry: it is not safely positive definite.
  [[nodiscard]] bool factorize(int size, const Scalar* matrix) SOPT_RT;

  // In place, of padded size: L x = x for an x whose entries before `first` are zero, L' x = x.
  void solve_lower(Scalar* x, int first) const SOPT_RT;
  void solve_upper(Scalar* x) const SOPT_RT;

 private:
  static constexpr int kBlock = VectorOf<Scalar>::kLanes;
  using Vector = typename VectorOf<Scalar>::Type;

  [[nodiscard]] Scalar* row(int i) SOPT_RT { return factor_.begin() + i * stride_; }
  [[nodiscard]] const Scalar* row(int i) const SOPT_RT { return factor_.begin() + i * stride_; }
  void load_block(int size, const Scalar* matrix, int first) SOPT_RT;
  void eliminate_left(int first) SOPT_RT;
  [[nodiscard]] bool factorize_diagonal(int first, int num_rows, const Scalar* thresholds) SOPT_RT;
  void store_block(int first) SOPT_RT;

  int max_size_ = 0;
  int stride_ = 0;
  int size_ = 0;
  FixedVector<Scalar> factor_;            // lower L, rows of stride_, inverse diagonal blocks
  FixedVector<Scalar> diagonal_columns_;  // the same blocks, column after column
  FixedVector<Scalar> columns_;           // block of rows under way, column after column
};

extern template class CholeskyFactor<double>;
extern template class CholeskyFactor<float>;

}  // namespace sopt
