// N numbers, one per joint, computed together: SIMD vectors when N is a multiple of their width,
// plain numbers otherwise.
#pragma once

#include <cstring>
#include <type_traits>

#include "opt/qp/vector_ops.h"

namespace sopt {

template <class Scalar, int N>
struct Lanes {
  static constexpr bool kIsVector = N % VectorOf<Scalar>::kLanes == 0;
  using Part = std::conditional_t<kIsVector, typename VectorOf<Scalar>::Type, Scalar>;
  static constexpr int kWidth = kIsVector ? VectorOf<Scalar>::kLanes : 1;
  static constexpr int kParts = N / kWidth;

  Part part[kParts] = {};

  // Part by part: a copy of the whole would go through memory.
  [[gnu::always_inline]] static Lanes load(const Scalar* from) noexcept {
    Lanes v;
    for (int i = 0; i < kParts; ++i) {
      Part p;
      std::memcpy(&p, from + i * kWidth, sizeof p);
      v.part[i] = p;
    }
    return v;
  }
  // Loads and leaves zeros.
  [[gnu::always_inline]] static Lanes take(Scalar* from) noexcept {
    const Lanes v = load(from);
    Lanes().store(from);
    return v;
  }
  [[gnu::always_inline]] void store(Scalar* to) const noexcept {
    for (int i = 0; i < kParts; ++i) {
      const Part p = part[i];
      std::memcpy(to + i * kWidth, &p, sizeof p);
    }
  }
  [[gnu::always_inline]] void set(int i, Scalar value) noexcept {
    if constexpr (kIsVector) {
      part[i / kWidth][i % kWidth] = value;
    } else {
      part[i] = value;
    }
  }
  [[nodiscard, gnu::always_inline]] Scalar dot(const Lanes& other) const noexcept {
    Part sum = part[0] * other.part[0];
    for (int i = 1; i < kParts; ++i) sum += part[i] * other.part[i];
    if constexpr (kIsVector) {
      return sum_lanes(sum);
    } else {
      return sum;
    }
  }

  [[gnu::always_inline]] Lanes& operator+=(const Lanes& b) noexcept {
    for (int i = 0; i < kParts; ++i) part[i] += b.part[i];
    return *this;
  }
  [[gnu::always_inline]] friend Lanes operator+(Lanes a, const Lanes& b) noexcept { return a += b; }
  [[gnu::always_inline]] friend Lanes operator-(Lanes a, const Lanes& b) noexcept {
    for (int i = 0; i < kParts; ++i) a.part[i] -= b.part[i];
    return a;
  }
  [[gnu::always_inline]] friend Lanes operator*(Lanes a, Scalar s) noexcept {
    for (int i = 0; i < kParts; ++i) a.part[i] *= s;
    return a;
  }
  [[gnu::always_inline]] friend Lanes operator*(Lanes a, const Lanes& b) noexcept {
    for (int i = 0; i < kParts; ++i) a.part[i] *= b.part[i];
    return a;
  }
};

}  // namespace sopt
