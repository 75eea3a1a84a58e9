#include "opt/qp/gram_inverse.h"

#include <algorithm>
#include <cmath>

namespace sopt {

template <class Scalar>
GramInverse<Scalar>::GramInverse(Arena& arena, int max_rows) noexcept
    : max_rows_(max_rows), stride_(padded<Scalar>(max_rows)) {
  factor_ = {arena, max_rows * stride_};
  (void)factor_.try_resize(factor_.capacity());
  for (auto* vector : {&column_, &forward_, &direction_, &scratch_, &scratch_y_}) {
    *vector = {arena, stride_ + kLanes};
    (void)vector->try_resize(vector->capacity());
    std::fill(vector->begin(), vector->end(), Scalar(0));
  }
}

template <class Scalar>
Scalar GramInverse<Scalar>::solve_column(int first, Scalar diagonal) SOPT_RT {
  std::fill_n(column_.begin() + size_, kLanes, Scalar(0));
  multiply(first, column_.begin(), forward_.begin());
  multiply_transposed(forward_.begin(), direction_.begin());
  std::fill_n(forward_.begin() + size_, kLanes, Scalar(0));
  return diagonal - dot(forward_.begin(), forward_.begin(), padded<Scalar>(size_));
}

template <class Scalar>
void GramInverse<Scalar>::solve(Scalar* x) SOPT_RT {
  std::copy(x, x + size_, scratch_.begin());
  std::fill_n(scratch_.begin() + size_, kLanes, Scalar(0));
  multiply(0, scratch_.begin(), scratch_y_.begin());
  multiply_transposed(scratch_y_.begin(), scratch_.begin());
  std::copy(scratch_.begin(), scratch_.begin() + size_, x);
}

// y = T x from row `first` on.
template <class Scalar>
void GramInverse<Scalar>::multiply(int first, const Scalar* x, Scalar* y) const SOPT_RT {
  int i = first / 4 * 4;
  for (; i + 4 <= size_; i += 4) {
    const Scalar* const rows[4] = {row(i), row(i + 1), row(i + 2), row(i + 3)};
    dot4(rows, x, padded<Scalar>(i + 4), y + i);
  }
  for (; i < size_; ++i) y[i] = dot(row(i), x, padded<Scalar>(i + 1));
}

// x = T'y.
template <class Scalar>
void GramInverse<Scalar>::multiply_transposed(const Scalar* y, Scalar* x) const SOPT_RT {
  std::fill_n(x, padded<Scalar>(size_), Scalar(0));
  int i = 0;
  for (; i + 4 <= size_; i += 4) {
    const Scalar weights[4] = {y[i], y[i + 1], y[i + 2], y[i + 3]};
    const Scalar* const rows[4] = {row(i), row(i + 1), row(i + 2), row(i + 3)};
    add_scaled4(weights, rows, x, padded<Scalar>(i + 4));
  }
  for (; i < size_; ++i) add_scaled(y[i], row(i), x, padded<Scalar>(i + 1));
}

template <class Scalar>
bool GramInverse<Scalar>::try_append(Scalar curvature) SOPT_RT {
  if (size_ >= max_rows_) return false;
  Scalar* const t = row(size_);
  const Scalar inverse = Scalar(1) / std::sqrt(curvature);
  for (int j = 0; j < size_; ++j) t[j] = -inverse * direction_[j];
  t[size_] = inverse;
  std::fill(t + size_ + 1, t + stride_, Scalar(0));
  ++size_;
  return true;
}

// Rotations of rows i and i + 1 move column `position` down:
//     [ a  x  0 ]      [ 0  x  x ]
//     [ b  x  x ]  ->  [ b' x  x ]
// Then that column and the last row go.
template <class Scalar>
void GramInverse<Scalar>::remove(int position) SOPT_RT {
  using Vector = typename VectorOf<Scalar>::Type;
  const int last = size_ - 1;
  for (int i = position; i < last; ++i) {
    Scalar* const upper = row(i);
    Scalar* const lower = row(i + 1);
    const Scalar a = upper[position];
    const Scalar b = lower[position];
    const Scalar inverse = Scalar(1) / std::sqrt(a * a + b * b);
    const Scalar c = b * inverse;
    const Scalar s = a * inverse;
    for (int j = 0; j <= i + 1; j += kLanes) {
      const Vector u = load_vector(upper + j);
      const Vector l = load_vector(lower + j);
      store_vector<Scalar>(c * u - s * l, upper + j);
      store_vector<Scalar>(s * u + c * l, lower + j);
    }
    std::copy(upper + position + 1, upper + i + 2, upper + position);
    upper[i + 1] = Scalar(0);
  }
  std::copy(column_.begin() + position + 1, column_.begin() + size_, column_.begin() + position);
  size_ = last;
}

template class GramInverse<double>;
template class GramInverse<float>;

}  // namespace sopt
