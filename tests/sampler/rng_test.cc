#include "sampler/rng.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace sopt {
namespace {

// Computed apart from this code, by exact integer arithmetic from the definition of SplitMix64.
TEST(CounterRng, GivesTheValuesOfItsDefinition) {
  CounterRng plain(1);
  EXPECT_EQ(plain.next_u64(), 0xe848b57330008cfbULL);
  EXPECT_EQ(plain.next_u64(), 0xe9752a8ff382eb96ULL);
  EXPECT_EQ(plain.next_u64(), 0x479c99a29667bc18ULL);
  CounterRng keyed(42, 3, 1, 2);
  EXPECT_EQ(keyed.next_u64(), 0x4d013e2781a432daULL);
  EXPECT_EQ(keyed.next_u64(), 0xce8033f8def570feULL);
}

TEST(CounterRng, TakesUniformsFromTheUpper53Bits) {
  CounterRng rng(1);
  EXPECT_EQ(rng.next_uniform(), static_cast<double>(0xe848b57330008cfbULL >> 11U) / 0x1.0p53);
}

TEST(CounterRng, RepeatsItselfForTheSameKey) {
  CounterRng a(7, 1, 2, 3);
  CounterRng b(7, 1, 2, 3);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(a.next_u64(), b.next_u64());
}

TEST(CounterRng, GivesEveryKeyItsOwnStream) {
  std::set<std::uint64_t> firsts;
  std::size_t num_keys = 0;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    for (std::uint64_t a = 0; a < 5; ++a) {
      for (std::uint64_t b = 0; b < 5; ++b) {
        for (std::uint64_t c = 0; c < 5; ++c) {
          CounterRng rng(seed, a, b, c);
          for (int i = 0; i < 4; ++i) firsts.insert(rng.next_u64());
          num_keys += 4;
        }
      }
    }
  }
  EXPECT_EQ(firsts.size(), num_keys);
}

TEST(CounterRng, StaysInTheHalfOpenUnitInterval) {
  CounterRng rng(3);
  double low = 1.0;
  double high = 0.0;
  for (int i = 0; i < 100000; ++i) {
    const double u = rng.next_uniform();
    low = std::min(low, u);
    high = std::max(high, u);
  }
  EXPECT_GE(low, 0.0);
  EXPECT_LT(high, 1.0);
  EXPECT_LT(low, 1e-3);
  EXPECT_GT(high, 1.0 - 1e-3);
}

// 63 degrees of freedom: mean 63, standard deviation 11; bounds at about 5 of them.
TEST(CounterRng, FillsBinsEvenlyInOneAndTwoDimensions) {
  constexpr int kNumDraws = 64000;
  for (std::uint64_t stream = 0; stream < 8; ++stream) {
    CounterRng rng(11, stream);
    std::array<int, 64> line{};
    std::array<int, 64> plane{};
    for (int i = 0; i < kNumDraws; ++i) {
      const double u = rng.next_uniform();
      const double v = rng.next_uniform();
      ++line[static_cast<std::size_t>(u * 64.0)];
      ++plane[static_cast<std::size_t>(u * 8.0) * 8 + static_cast<std::size_t>(v * 8.0)];
    }
    for (const auto& bins : {line, plane}) {
      double chi2 = 0.0;
      for (const int n : bins) chi2 += (n - 1000.0) * (n - 1000.0) / 1000.0;
      EXPECT_GT(chi2, 20.0);
      EXPECT_LT(chi2, 120.0);
    }
  }
}

TEST(CounterRng, DoesNotCorrelateNeighbouringStreams) {
  constexpr int kNumDraws = 20000;
  CounterRng a(5, 0);
  CounterRng b(5, 1);
  double sum = 0.0;
  for (int i = 0; i < kNumDraws; ++i) sum += (a.next_uniform() - 0.5) * (b.next_uniform() - 0.5);
  // Standard deviation of the mean product: 1/12 / sqrt(n).
  EXPECT_LT(std::abs(sum / kNumDraws), 5.0 / 12.0 / std::sqrt(kNumDraws));
}

}  // namespace
}  // namespace sopt
