#include "alloc/fixed_vector.h"

#include <gtest/gtest.h>

#include <array>
#include <numeric>
#include <utility>

#include "tests/support/rt_guard.h"

namespace sopt {
namespace {

class FixedVectorOfInts : public testing::Test {
 protected:
  MemoryBlock block_{4096};
  Arena arena_{block_};
  FixedVector<int> vector_{arena_, 4};
};

TEST(FixedVector, IsEmptyWithoutStorage) {
  FixedVector<int> vector;
  EXPECT_EQ(vector.size(), 0);
  EXPECT_EQ(vector.capacity(), 0);
  EXPECT_TRUE(vector.empty());
  EXPECT_FALSE(vector.try_push_back(1));
  EXPECT_FALSE(vector.try_resize(1));
  EXPECT_TRUE(vector.try_resize(0));
  EXPECT_EQ(vector.begin(), vector.end());
}

TEST(FixedVector, HasNoCapacityWhenTheArenaIsExhausted) {
  const MemoryBlock block(4096);
  Arena arena(block);
  FixedVector<double> vector(arena, 1000);
  EXPECT_TRUE(arena.exhausted());
  EXPECT_EQ(vector.capacity(), 0);
  EXPECT_FALSE(vector.try_push_back(1.0));
}

TEST(FixedVector, HasNoCapacityWhenMeasuring) {
  Arena arena = Arena::measuring();
  FixedVector<double> vector(arena, 1000);
  EXPECT_EQ(arena.used_B(), 8000U);
  EXPECT_EQ(vector.capacity(), 0);
}

TEST(FixedVector, OfNoCapacityIsUsableAndTakesNothing) {
  const MemoryBlock block(4096);
  Arena arena(block);
  FixedVector<double> vector(arena, 0);
  EXPECT_EQ(arena.used_B(), 0U);
  EXPECT_FALSE(arena.exhausted());
  EXPECT_FALSE(vector.try_push_back(1.0));
}

TEST(FixedVector, OfNegativeCapacityHoldsNothing) {
  const MemoryBlock block(4096);
  Arena arena(block);
  FixedVector<double> vector(arena, -1);
  EXPECT_EQ(vector.capacity(), 0);
  EXPECT_EQ(arena.used_B(), 0U);
  EXPECT_FALSE(vector.try_push_back(1.0));
  EXPECT_FALSE(vector.try_resize(-1));
}

TEST_F(FixedVectorOfInts, RefusesToGrowBeyondItsCapacity) {
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(vector_.try_push_back(10 * i));
  EXPECT_FALSE(vector_.try_push_back(99));
  ASSERT_EQ(vector_.size(), 4);
  EXPECT_EQ(vector_.capacity(), 4);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(vector_[i], 10 * i);
  EXPECT_EQ(vector_.back(), 30);
  vector_.clear();
  EXPECT_TRUE(vector_.empty());
  EXPECT_TRUE(vector_.try_push_back(5));
  EXPECT_EQ(vector_.back(), 5);
}

TEST_F(FixedVectorOfInts, KeepsReferencesValidWhileItGrows) {
  ASSERT_TRUE(vector_.try_push_back(1));
  int& first = vector_[0];
  ASSERT_TRUE(vector_.try_push_back(2));
  ASSERT_TRUE(vector_.try_push_back(3));
  first = 42;
  EXPECT_EQ(vector_[0], 42);
}

TEST_F(FixedVectorOfInts, RefusesToResizeOutOfItsCapacity) {
  EXPECT_TRUE(vector_.try_resize(3));
  EXPECT_FALSE(vector_.try_resize(5));
  EXPECT_FALSE(vector_.try_resize(-1));
  EXPECT_EQ(vector_.size(), 3);
  EXPECT_TRUE(vector_.try_resize(4));
  EXPECT_TRUE(vector_.try_resize(0));
}

TEST_F(FixedVectorOfInts, KeepsWhatTheStorageHeldWhenResized) {
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(vector_.try_push_back(i + 1));
  ASSERT_TRUE(vector_.try_resize(1));
  ASSERT_TRUE(vector_.try_resize(4));
  for (int i = 0; i < 4; ++i) EXPECT_EQ(vector_[i], i + 1);
}

TEST_F(FixedVectorOfInts, RefusesToAssignWhatDoesNotFit) {
  const std::array<int, 4> four = {4, 3, 2, 1};
  const std::array<int, 5> five = {};
  ASSERT_TRUE(vector_.try_push_back(7));
  EXPECT_FALSE(vector_.try_assign(five));
  ASSERT_EQ(vector_.size(), 1);
  EXPECT_EQ(vector_[0], 7);
  EXPECT_TRUE(vector_.try_assign(four));
  ASSERT_EQ(vector_.size(), 4);
  EXPECT_TRUE(std::equal(vector_.begin(), vector_.end(), four.begin()));
  EXPECT_TRUE(vector_.try_assign({}));
  EXPECT_TRUE(vector_.empty());
}

TEST_F(FixedVectorOfInts, ShowsItselfAsASpanAndARange) {
  for (int i = 1; i <= 3; ++i) ASSERT_TRUE(vector_.try_push_back(i));
  EXPECT_EQ(vector_.span().size(), 3U);
  EXPECT_EQ(std::accumulate(vector_.begin(), vector_.end(), 0), 6);
  const FixedVector<int>& view = vector_;
  EXPECT_EQ(view.end() - view.begin(), 3);
  EXPECT_EQ(view[1], 2);
}

TEST_F(FixedVectorOfInts, MovesItsStorage) {
  ASSERT_TRUE(vector_.try_push_back(5));
  const int* const first = vector_.begin();
  const FixedVector<int> moved = std::move(vector_);
  EXPECT_EQ(moved.begin(), first);
  EXPECT_EQ(moved.size(), 1);
  EXPECT_EQ(moved.capacity(), 4);
}

TEST_F(FixedVectorOfInts, UsesNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "the guard cannot count under sanitizers";
  RtGuard guard;
  bool done = true;
  for (int i = 0; i < 4; ++i) done = vector_.try_push_back(i) && done;
  const bool refused = !vector_.try_push_back(9);
  done = vector_.try_resize(2) && done;
  guard.stop();
  EXPECT_TRUE(done && refused);
  EXPECT_EQ(guard.num_allocations(), 0);
}

}  // namespace
}  // namespace sopt
