#include "alloc/arena.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

namespace sopt {
namespace {

constexpr std::size_t kPage_B = 4096;

bool is_aligned(const void* memory) {
  return reinterpret_cast<std::uintptr_t>(memory) % Arena::kAlignment == 0;
}

struct Pair {
  double value = 3.5;
  int count = 7;
};

// Takes the same mixed bag from whatever arena it is given.
void take_mixture(Arena& arena) {
  (void)arena.take<char>(1);
  (void)arena.take<double>(9);
  (void)arena.take<Pair>(3);
  (void)arena.take<int>(0);
  (void)arena.take<std::int64_t>(8);
}

TEST(Arena, HandsOutCacheLines) {
  const MemoryBlock block(kPage_B);
  Arena arena(block);
  const char* const first = arena.take<char>(1);
  const double* const second = arena.take<double>(3);
  const int* const third = arena.take<int>(17);
  ASSERT_NE(third, nullptr);
  EXPECT_TRUE(is_aligned(first));
  EXPECT_TRUE(is_aligned(second));
  EXPECT_TRUE(is_aligned(third));
  EXPECT_EQ(reinterpret_cast<const char*>(second) - first, 64);
  EXPECT_EQ(reinterpret_cast<const char*>(third) - first, 128);
  EXPECT_EQ(arena.used_B(), 64U + 64U + 128U);
  EXPECT_FALSE(arena.exhausted());
}

TEST(Arena, ValueInitialisesWhatItHandsOut) {
  const MemoryBlock block(kPage_B);
  {
    Arena dirty(block);
    double* const values = dirty.take<double>(kPage_B / sizeof(double));
    for (std::size_t i = 0; i < kPage_B / sizeof(double); ++i) values[i] = -1.0;
  }
  Arena arena(block);
  const double* const zeros = arena.take<double>(5);
  const Pair* const pairs = arena.take<Pair>(4);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(zeros[i], 0.0);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(pairs[i].value, 3.5);
    EXPECT_EQ(pairs[i].count, 7);
  }
}

TEST(Arena, MeasuresExactlyWhatItTakes) {
  Arena measuring = Arena::measuring();
  EXPECT_TRUE(measuring.is_measuring());
  take_mixture(measuring);
  EXPECT_EQ(measuring.used_B(), 64U + 128U + 64U + 0U + 64U);
  EXPECT_FALSE(measuring.exhausted());

  const MemoryBlock block(kPage_B);
  Arena real(block);
  EXPECT_FALSE(real.is_measuring());
  take_mixture(real);
  EXPECT_EQ(real.used_B(), measuring.used_B());
}

TEST(Arena, HandsOutNullWhenMeasuring) {
  Arena arena = Arena::measuring();
  EXPECT_EQ(arena.take<double>(1'000'000'000), nullptr);
  EXPECT_EQ(arena.used_B(), 8'000'000'000U);
  EXPECT_FALSE(arena.exhausted());
}

TEST(Arena, HandsOutNullForNothingWithoutBeingExhausted) {
  const MemoryBlock block(kPage_B);
  Arena arena(block);
  EXPECT_EQ(arena.take<double>(0), nullptr);
  EXPECT_EQ(arena.used_B(), 0U);
  EXPECT_FALSE(arena.exhausted());
}

TEST(Arena, GivesItsLastByte) {
  const MemoryBlock block(kPage_B);
  Arena arena(block);
  ASSERT_EQ(block.size_B(), kPage_B);
  EXPECT_NE(arena.take<char>(kPage_B), nullptr);
  EXPECT_EQ(arena.used_B(), kPage_B);
  EXPECT_FALSE(arena.exhausted());
  EXPECT_EQ(arena.take<char>(1), nullptr);
  EXPECT_TRUE(arena.exhausted());
}

TEST(Arena, StaysExhausted) {
  const MemoryBlock block(kPage_B);
  Arena arena(block);
  EXPECT_NE(arena.take<char>(64), nullptr);
  EXPECT_EQ(arena.take<char>(kPage_B), nullptr);
  EXPECT_TRUE(arena.exhausted());
  EXPECT_EQ(arena.take<char>(1), nullptr);
  EXPECT_TRUE(arena.exhausted());
}

TEST(Arena, IsExhaustedFromTheStartOnAnEmptyBlock) {
  const MemoryBlock block(0);
  Arena arena(block);
  EXPECT_FALSE(arena.exhausted());
  EXPECT_EQ(arena.take<char>(1), nullptr);
  EXPECT_TRUE(arena.exhausted());
}

// A size whose byte count does not fit must not wrap around to a small one.
TEST(Arena, RefusesSizesThatOverflow) {
  const MemoryBlock block(kPage_B);
  Arena arena(block);
  constexpr std::size_t kHuge = std::numeric_limits<std::size_t>::max() / sizeof(double) + 2;
  EXPECT_EQ(arena.take<double>(kHuge), nullptr);
  EXPECT_TRUE(arena.exhausted());
}

}  // namespace
}  // namespace sopt
