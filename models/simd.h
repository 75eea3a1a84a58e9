// Four doubles or eight floats at a time through the compilers' vector extension: the same source
// becomes AVX on x86-64-v3 and pairs of NEON registers on ARM. Loads take any element alignment.
// Always inlined: no copy compiled with other CPU flags can take their place at link time.
#pragma once

#include <cstdint>
#include <cstring>

#if defined(__AVX__)
#include <immintrin.h>
#endif

namespace sopt {

using V4d = double __attribute__((vector_size(32)));
using V4i = std::int64_t __attribute__((vector_size(32)));
using V8f = float __attribute__((vector_size(32)));
using V8i = std::int32_t __attribute__((vector_size(32)));

inline constexpr int kLanesDouble = 4;
inline constexpr int kLanesFloat = 8;

[[gnu::always_inline]] inline V4d load4(const double* from) noexcept {
  V4d v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
[[gnu::always_inline]] inline V8f load8(const float* from) noexcept {
  V8f v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
// Three numbers and a lane that nobody reads.
[[gnu::always_inline]] inline V4d load3(const double* from) noexcept {
  return V4d{from[0], from[1], from[2], 0.0};
}
[[gnu::always_inline]] inline void store3(V4d v, double* to) noexcept {
  std::memcpy(to, &v, 3 * sizeof(double));
}
[[gnu::always_inline]] inline V4d splat4(double s) noexcept { return V4d{s, s, s, s}; }
[[gnu::always_inline]] inline V8f splat8(float s) noexcept { return V8f{s, s, s, s, s, s, s, s}; }

// No less and no more than a value, unless that is below the smallest normal float.
[[gnu::always_inline]] inline float float_above(double value) noexcept {
  return static_cast<float>(value + 0x1p-23 * (value < 0.0 ? -value : value));
}
[[gnu::always_inline]] inline float float_below(double value) noexcept {
  return -float_above(-value);
}

// Both rounded to float.
[[gnu::always_inline]] inline V8f join8(V4d low, V4d high) noexcept {
  using V4f = float __attribute__((vector_size(16)));
  const V4f halves[2] = {__builtin_convertvector(low, V4f), __builtin_convertvector(high, V4f)};
  V8f v;
  std::memcpy(&v, halves, sizeof v);
  return v;
}

[[gnu::always_inline]] inline V4d abs4(V4d v) noexcept { return v < 0.0 ? -v : v; }
[[gnu::always_inline]] inline V4d min4(V4d a, V4d b) noexcept { return a < b ? a : b; }
[[gnu::always_inline]] inline V4d max4(V4d a, V4d b) noexcept { return a > b ? a : b; }
[[gnu::always_inline]] inline double min_lane4(V4d v) noexcept {
  const double low = v[0] < v[1] ? v[0] : v[1];
  const double high = v[2] < v[3] ? v[2] : v[3];
  return low < high ? low : high;
}
[[gnu::always_inline]] inline double max_lane4(V4d v) noexcept { return -min_lane4(-v); }

[[gnu::always_inline]] inline V8f abs8(V8f v) noexcept { return v < 0.0F ? -v : v; }
[[gnu::always_inline]] inline V8f min8(V8f a, V8f b) noexcept { return a < b ? a : b; }
[[gnu::always_inline]] inline V8f max8(V8f a, V8f b) noexcept { return a > b ? a : b; }
[[gnu::always_inline]] inline V8f sqrt8(V8f v) noexcept {
#if defined(__AVX__)
  __m256 root;
  std::memcpy(&root, &v, sizeof root);
  root = _mm256_sqrt_ps(root);
  std::memcpy(&v, &root, sizeof v);
#else
  for (int i = 0; i < kLanesFloat; ++i) v[i] = __builtin_sqrtf(v[i]);
#endif
  return v;
}

// Bit i is set when lane i of a comparison holds; Mask is whatever type the compiler gives to it.
template <class Mask>
[[gnu::always_inline]] inline unsigned lane_mask4(const Mask& m) noexcept {
  static_assert(sizeof(Mask) == sizeof(V4d));
#if defined(__AVX__)
  __m256d bits;
  std::memcpy(&bits, &m, sizeof bits);
  return static_cast<unsigned>(_mm256_movemask_pd(bits));
#else
  unsigned bits = 0;
  for (unsigned i = 0; i < 4; ++i) bits |= (m[i] != 0 ? 1U : 0U) << i;
  return bits;
#endif
}

template <class Mask>
[[gnu::always_inline]] inline unsigned lane_mask8(const Mask& m) noexcept {
  static_assert(sizeof(Mask) == sizeof(V8f));
#if defined(__AVX__)
  __m256 bits;
  std::memcpy(&bits, &m, sizeof bits);
  return static_cast<unsigned>(_mm256_movemask_ps(bits));
#else
  unsigned bits = 0;
  for (unsigned i = 0; i < 8; ++i) bits |= (m[i] != 0 ? 1U : 0U) << i;
  return bits;
#endif
}

}  // namespace sopt
