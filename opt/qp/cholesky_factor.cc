#include "opt/qp/cholesky_factor.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sopt {

template <class Scalar>
bool CholeskyFactor<Scalar>::factorize(int size, const Scalar* matrix) SOPT_RT {
  size_ = 0;
  if (size < 0 || size > max_size_) return false;
  const Scalar relative = static_cast<Scalar>(size) * std::numeric_limits<Scalar>::epsilon();
  for (int first = 0; first < size; first += kBlock) {
    Scalar thresholds[kBlock] = {};
    for (int k = 0; k < kBlock && first + k < size; ++k) {
      thresholds[k] = relative * matrix[(first + k) * (size + 1)];
    }
    load_block(size, matrix, first);
    eliminate_left(first);
    if (!factorize_diagonal(first, size - first, thresholds)) return false;
    store_block(first);
  }
  size_ = size;
  return true;
}

// Rows first .. of the lower triangle, rows of the identity beyond the matrix, as columns.
template <class Scalar>
void CholeskyFactor<Scalar>::load_block(int size, const Scalar* matrix, int first) SOPT_RT {
  Scalar* const to = columns_.begin();
  std::fill(to, to + kBlock * (first + kBlock), Scalar(0));
  for (int k = 0; k < kBlock; ++k) {
    const int i = first + k;
    if (i >= size) {
      to[kBlock * i + k] = Scalar(1);
      continue;
    }
    for (int j = 0; j <= i; ++j) to[kBlock * j + k] = matrix[i * size + j];
  }
}

// X_c <- (X_c - sum_j<c X_j L_cj') D_c^-T, block of columns c after block.
template <class Scalar>
void CholeskyFactor<Scalar>::eliminate_left(int first) SOPT_RT {
  Scalar* const x = columns_.begin();
  for (int c = 0; c <= first; c += kBlock) {
    Vector sum[kBlock];
    for (int m = 0; m < kBlock; ++m) sum[m] = load_vector(x + kBlock * (c + m));
    for (int j = 0; j < c; ++j) {
      const Vector v = load_vector(x + kBlock * j);
      for (int m = 0; m < kBlock; ++m) {
        sum[m] -= v * (c < first ? row(c + m)[j] : x[kBlock * j + m]);
      }
    }
    for (int m = 0; m < kBlock; ++m) {
      Vector value = sum[m];
      if (c < first) {
        value *= row(c + m)[c + m];
        for (int r = 0; r < m; ++r) value += sum[r] * row(c + m)[c + r];
      }
      store_vector<Scalar>(value, x + kBlock * (c + m));
    }
  }
}

// The diagonal block, which has all but its own part eliminated: L, then its inverse in place. Of
// its rows num_rows are the matrix's; the identity beyond is its own factor.
template <class Scalar>
bool CholeskyFactor<Scalar>::factorize_diagonal(int first, int num_rows,
                                                const Scalar* thresholds) SOPT_RT {
  Scalar* const block = columns_.begin() + kBlock * first;  // entry (k, m) at [kBlock m + k]
  Scalar inverse[kBlock] = {};
  std::fill(inverse, inverse + kBlock, Scalar(1));
  for (int m = 0; m < std::min(kBlock, num_rows); ++m) {
    Scalar pivot = block[kBlock * m + m];
    for (int r = 0; r < m; ++r) pivot -= block[kBlock * r + m] * block[kBlock * r + m];
    if (!(pivot > thresholds[m]) || !(pivot < std::numeric_limits<Scalar>::infinity())) {
      return false;
    }
    inverse[m] = Scalar(1) / std::sqrt(pivot);
    for (int k = m + 1; k < kBlock; ++k) {
      Scalar value = block[kBlock * m + k];
      for (int r = 0; r < m; ++r) value -= block[kBlock * r + k] * block[kBlock * r + m];
      block[kBlock * m + k] = value * inverse[m];
    }
  }
  Scalar result[kBlock * kBlock] = {};
  for (int m = 0; m < kBlock; ++m) {
    result[kBlock * m + m] = inverse[m];
    for (int r = 0; r < m; ++r) {
      Scalar sum = 0;
      for (int t = r; t < m; ++t) sum += block[kBlock * t + m] * result[kBlock * r + t];
      result[kBlock * r + m] = -inverse[m] * sum;
    }
  }
  std::copy(result, result + kBlock * kBlock, block);
  return true;
}

template <class Scalar>
void CholeskyFactor<Scalar>::store_block(int first) SOPT_RT {
  const Scalar* const from = columns_.begin();
  for (int k = 0; k < kBlock; ++k) {
    for (int j = 0; j < first + kBlock; ++j) row(first + k)[j] = from[kBlock * j + k];
  }
  std::copy(from + kBlock * first, from + kBlock * (first + kBlock),
            diagonal_columns_.begin() + kBlock * first);
}

template <class Scalar>
void CholeskyFactor<Scalar>::solve_lower(Scalar* x, int first) const SOPT_RT {
  const int begin = first / kBlock * kBlock;
  for (int i = begin; i < size_; i += kBlock) {
    Scalar sums[kBlock];
    for (int k = 0; k < kBlock; k += 4) {
      const Scalar* const rows[4] = {row(i + k) + begin, row(i + k + 1) + begin,
                                     row(i + k + 2) + begin, row(i + k + 3) + begin};
      dot4(rows, x + begin, i - begin, sums + k);
    }
    const Scalar* const columns = diagonal_columns_.begin() + kBlock * i;
    Vector value{};
    for (int k = 0; k < kBlock; ++k) {
      value += load_vector(columns + kBlock * k) * (x[i + k] - sums[k]);
    }
    store_vector<Scalar>(value, x + i);
  }
}

template <class Scalar>
void CholeskyFactor<Scalar>::solve_upper(Scalar* x) const SOPT_RT {
  for (int i = padded<Scalar>(size_) - kBlock; i >= 0; i -= kBlock) {
    Vector value{};
    for (int k = 0; k < kBlock; ++k) value += load_vector(row(i + k) + i) * x[i + k];
    store_vector<Scalar>(value, x + i);
    for (int k = 0; k < kBlock; k += 4) {
      const Scalar weights[4] = {-x[i + k], -x[i + k + 1], -x[i + k + 2], -x[i + k + 3]};
      const Scalar* const rows[4] = {row(i + k), row(i + k + 1), row(i + k + 2), row(i + k + 3)};
      add_scaled4(weights, rows, x, i);
    }
  }
}

template class CholeskyFactor<double>;
template class CholeskyFactor<float>;

}  // namespace sopt
