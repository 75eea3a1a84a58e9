#include "rt/float_env.h"

#include <gtest/gtest.h>

#include <cfenv>
#include <limits>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace sopt {
namespace {

// Hidden from the compiler, so that the arithmetic happens at run time in the current mode.
[[gnu::noinline]] double half_of(double value) {
  volatile double input = value;
  return 0.5 * input;
}

const double kSmallestNormal = std::numeric_limits<double>::min();

TEST(ScopedFlushDenormals, KeepsDenormalsOutside) { EXPECT_GT(half_of(kSmallestNormal), 0.0); }

#if defined(__x86_64__) || defined(__aarch64__)
TEST(ScopedFlushDenormals, FlushesDenormalResultsInside) {
  const ScopedFlushDenormals scope;
  EXPECT_EQ(half_of(kSmallestNormal), 0.0);
}

TEST(ScopedFlushDenormals, TreatsDenormalOperandsAsZeroInside) {
  volatile double denormal = 0.25 * kSmallestNormal;
  const ScopedFlushDenormals scope;
  volatile double scaled = denormal * 16.0;
  EXPECT_EQ(scaled, 0.0);
}
#endif

TEST(ScopedFlushDenormals, RestoresWhatWasThere) {
  { const ScopedFlushDenormals scope; }
  EXPECT_EQ(half_of(kSmallestNormal), 0.5 * kSmallestNormal);
  EXPECT_GT(half_of(kSmallestNormal), 0.0);
}

TEST(ScopedFlushDenormals, RestoresTheOuterScopeWhenNested) {
  {
    const ScopedFlushDenormals outer;
    { const ScopedFlushDenormals inner; }
    EXPECT_EQ(half_of(kSmallestNormal), 0.0);
  }
  EXPECT_GT(half_of(kSmallestNormal), 0.0);
}

TEST(ScopedFlushDenormals, LeavesTheRoundingModeAlone) {
  ASSERT_EQ(std::fesetround(FE_UPWARD), 0);
  {
    const ScopedFlushDenormals scope;
    EXPECT_EQ(std::fegetround(), FE_UPWARD);
  }
  EXPECT_EQ(std::fegetround(), FE_UPWARD);
  ASSERT_EQ(std::fesetround(FE_TONEAREST), 0);
}

#if defined(__x86_64__)
TEST(ScopedFlushDenormals, RestoresEveryControlBit) {
  constexpr unsigned kExceptionFlags = 0x3f;  // sticky, may be raised meanwhile
  const unsigned before = _mm_getcsr() & ~kExceptionFlags;
  {
    const ScopedFlushDenormals scope;
    EXPECT_NE(_mm_getcsr() & ~kExceptionFlags, before);
  }
  EXPECT_EQ(_mm_getcsr() & ~kExceptionFlags, before);
}
#endif

TEST(ScopedFlushDenormals, KeepsOrdinaryArithmetic) {
  const ScopedFlushDenormals scope;
  EXPECT_EQ(half_of(3.0), 1.5);
  EXPECT_EQ(half_of(2.0 * kSmallestNormal), kSmallestNormal);
}

}  // namespace
}  // namespace sopt
