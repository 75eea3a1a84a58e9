// Sine and cosine of four angles at a time. Angles are reduced by multiples of pi/2 held in three
// parts (33 + 33 + 53 bits), then Taylor-like minimax polynomials on [-pi/4, pi/4] (the
// coefficients of fdlibm's k_sin.c and k_cos.c). Absolute error below 3e-16 for |angle| <= 1e5 rad;
// beyond 1e9 rad the result means nothing, though it stays finite. NaN and infinity give NaN. Only
// IEEE operations: the same bits on every machine, which libm does not promise.
#pragma once

#include "models/simd.h"

namespace sopt {

[[gnu::always_inline]] inline void sin_cos4(V4d angle, V4d& sine, V4d& cosine) noexcept {
  constexpr double kTwoOverPi = 6.36619772367581382433e-01;
  constexpr double kPart1 = 1.57079632673412561417e+00;  // pi/2 = kPart1 + kPart2 + kPart3
  constexpr double kPart2 = 6.07710050630396597660e-11;
  constexpr double kPart3 = 2.02226624879595063154e-21;
  constexpr double kRounder = 0x1.8p52;  // adding it rounds to an integer, held in the low bits

  const V4d shifted = angle * kTwoOverPi + kRounder;
  const V4d turns = shifted - kRounder;
  const V4d r = ((angle - turns * kPart1) - turns * kPart2) - turns * kPart3;
  const V4d z = r * r;
  const V4d sin_tail =
      8.33333333332248946124e-03 +
      z * (-1.98412698298579493134e-04 +
           z * (2.75573137070700676789e-06 +
                z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)));
  const V4d sin_r = r + (z * r) * (-1.66666666666666324348e-01 + z * sin_tail);
  const V4d cos_tail =
      4.16666666666666019037e-02 +
      z * (-1.38888888888741095749e-03 +
           z * (2.48015872894767294178e-05 +
                z * (-2.75573143513906633035e-07 +
                     z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11))));
  // 1 - z/2 is rounded once; its error is known and added back.
  const V4d half = 0.5 * z;
  const V4d w = 1.0 - half;
  const V4d cos_r = w + (((1.0 - w) - half) + z * z * cos_tail);

  V4i quadrant;
  std::memcpy(&quadrant, &shifted, sizeof quadrant);
  const auto is_odd = (quadrant & 1) != 0;
  const V4d s = is_odd ? cos_r : sin_r;
  const V4d c = is_odd ? sin_r : cos_r;
  sine = (quadrant & 2) != 0 ? -s : s;
  cosine = ((quadrant + 1) & 2) != 0 ? -c : c;
}

// Of eight angles, in float: absolute error below 2^-23. Reduced in double by pi/2 in one part, so
// for |angle| <= 1e5 rad; the polynomials are those of Cephes' sinf and cosf.
[[gnu::always_inline]] inline void sin_cos8(V4d low, V4d high, V8f& sine, V8f& cosine) noexcept {
  constexpr double kTwoOverPi = 6.36619772367581382433e-01;
  constexpr double kHalfPi = 1.57079632679489655800e+00;
  constexpr double kRounder = 0x1.8p52;
  const auto reduce = [](V4d angle, V4d & r, V4d & quadrant) __attribute__((always_inline)) {
    const V4d turns = (angle * kTwoOverPi + kRounder) - kRounder;
    r = angle - turns * kHalfPi;
    quadrant = turns - 4.0 * ((0.25 * turns + kRounder) - kRounder);  // -2..2
  };
  V4d r_low, r_high, quadrant_low, quadrant_high;
  reduce(low, r_low, quadrant_low);
  reduce(high, r_high, quadrant_high);
  const V8f r = join8(r_low, r_high);
  const V8f quadrant = join8(quadrant_low, quadrant_high);
  const V8f z = r * r;
  const V8f sin_r =
      r + (z * r) * (-1.6666654611e-1F + z * (8.3321608736e-3F + z * -1.9515295891e-4F));
  const V8f cos_r =
      (1.0F - 0.5F * z) +
      (z * z) * (4.166664568298827e-2F + z * (-1.388731625493765e-3F + z * 2.443315711809948e-5F));
  const V8f turned = abs8(quadrant);
  const auto is_odd = turned == 1.0F;
  const auto is_back = turned == 2.0F;
  const V8f s = is_odd ? cos_r : sin_r;
  const V8f c = is_odd ? sin_r : cos_r;
  sine = (quadrant == -1.0F) | is_back ? -s : s;
  cosine = (quadrant == 1.0F) | is_back ? -c : c;
}

}  // namespace sopt
