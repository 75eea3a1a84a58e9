// The loops that linear algebra here is made of. The order of every sum is fixed: vector lanes in
// parallel, then the lanes from low to high. Arrays may have any alignment. "Padded" sizes are
// multiples of the vector length; what lies between the data and them is zero.
#pragma once

#include <cstring>

#include "models/simd.h"

namespace sopt {

template <class Scalar>
struct VectorOf;
template <>
struct VectorOf<double> {
  using Type = V4d;
  static constexpr int kLanes = kLanesDouble;
};
template <>
struct VectorOf<float> {
  using Type = V8f;
  static constexpr int kLanes = kLanesFloat;
};

template <class Scalar>
[[nodiscard]] constexpr int padded(int n) noexcept {
  constexpr int kLanes = VectorOf<Scalar>::kLanes;
  return (n + kLanes - 1) / kLanes * kLanes;
}

[[gnu::always_inline]] inline double sum_lanes(V4d v) noexcept {
  return (v[0] + v[1]) + (v[2] + v[3]);
}
[[gnu::always_inline]] inline float sum_lanes(V8f v) noexcept {
  return ((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[5]) + (v[6] + v[7]));
}

template <class Scalar>
[[gnu::always_inline]] inline typename VectorOf<Scalar>::Type load_vector(
    const Scalar* from) noexcept {
  typename VectorOf<Scalar>::Type v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
template <class Scalar>
[[gnu::always_inline]] inline void store_vector(const typename VectorOf<Scalar>::Type& v,
                                                Scalar* to) noexcept {
  std::memcpy(to, &v, sizeof v);
}

// sum x_i y_i, n padded
template <class Scalar>
[[gnu::always_inline]] inline Scalar dot(const Scalar* x, const Scalar* y, int n) noexcept {
  using Vector = typename VectorOf<Scalar>::Type;
  constexpr int kLanes = VectorOf<Scalar>::kLanes;
  Vector even{};
  Vector odd{};
  int i = 0;
  for (; i + 2 * kLanes <= n; i += 2 * kLanes) {
    even += load_vector(x + i) * load_vector(y + i);
    odd += load_vector(x + i + kLanes) * load_vector(y + i + kLanes);
  }
  if (i < n) even += load_vector(x + i) * load_vector(y + i);
  return sum_lanes(even + odd);
}

// Four rows against one y, n padded: out[k] = sum x_k,i y_i
template <class Scalar>
[[gnu::always_inline]] inline void dot4(const Scalar* const (&x)[4], const Scalar* y, int n,
                                        Scalar* out) noexcept {
  using Vector = typename VectorOf<Scalar>::Type;
  Vector sum[4] = {};
  for (int i = 0; i < n; i += VectorOf<Scalar>::kLanes) {
    const Vector v = load_vector(y + i);
    for (int k = 0; k < 4; ++k) sum[k] += load_vector(x[k] + i) * v;
  }
  for (int k = 0; k < 4; ++k) out[k] = sum_lanes(sum[k]);
}

// y += a x, n padded
template <class Scalar>
[[gnu::always_inline]] inline void add_scaled(Scalar a, const Scalar* x, Scalar* y,
                                              int n) noexcept {
  for (int i = 0; i < n; i += VectorOf<Scalar>::kLanes) {
    store_vector<Scalar>(load_vector(y + i) + load_vector(x + i) * a, y + i);
  }
}

// y += sum of four a_k x_k, n padded
template <class Scalar>
[[gnu::always_inline]] inline void add_scaled4(const Scalar (&a)[4], const Scalar* const (&x)[4],
                                               Scalar* y, int n) noexcept {
  for (int i = 0; i < n; i += VectorOf<Scalar>::kLanes) {
    auto sum = load_vector(y + i);
    for (int k = 0; k < 4; ++k) sum += load_vector(x[k] + i) * a[k];
    store_vector<Scalar>(sum, y + i);
  }
}

}  // namespace sopt
