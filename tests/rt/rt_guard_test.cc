// The guard is what other tests trust, so it is shown to catch what it is there for.
#include "tests/support/rt_guard.h"

#include <gtest/gtest.h>
#include <malloc.h>

#include <cstdlib>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace sopt {
namespace {

// Keeps a planted call from being optimised away.
template <class T>
void escape(T* pointer) {
  asm volatile("" : : "g"(pointer) : "memory");
}

class RtGuardCatches : public testing::Test {
 protected:
  void SetUp() override {
    if (!RtGuard::available()) GTEST_SKIP() << "sanitizers interpose malloc themselves";
  }
};

TEST_F(RtGuardCatches, NothingInCodeThatDoesNothing) {
  RtGuard guard;
  double sum = 0.0;
  for (int i = 0; i < 100; ++i) sum += i;
  escape(&sum);
  guard.stop();
  EXPECT_EQ(guard.num_allocations(), 0);
  EXPECT_EQ(guard.num_releases(), 0);
  EXPECT_EQ(guard.num_locks(), 0);
}

TEST_F(RtGuardCatches, MallocAndFree) {
  RtGuard guard;
  void* const memory = std::malloc(24);
  escape(memory);
  std::free(memory);
  guard.stop();
  EXPECT_EQ(guard.num_allocations(), 1);
  EXPECT_EQ(guard.num_releases(), 1);
}

TEST_F(RtGuardCatches, CallocAndRealloc) {
  RtGuard guard;
  void* memory = std::calloc(3, 8);
  escape(memory);
  memory = std::realloc(memory, 4096);
  escape(memory);
  guard.stop();
  std::free(memory);
  EXPECT_EQ(guard.num_allocations(), 2);
  EXPECT_EQ(guard.num_releases(), 0);
}

TEST_F(RtGuardCatches, EveryAlignedAllocation) {
  RtGuard guard;
  void* const first = std::aligned_alloc(64, 128);
  void* const second = memalign(64, 128);
  void* third = nullptr;
  const int error = posix_memalign(&third, 64, 128);
  guard.stop();
  EXPECT_EQ(error, 0);
  EXPECT_EQ(guard.num_allocations(), 3);
  for (void* memory : {first, second, third}) {
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(memory) % 64, 0U);
    std::free(memory);
  }
}

TEST_F(RtGuardCatches, OperatorNewAndDelete) {
  RtGuard guard;
  auto* const value = new double(1.0);
  escape(value);
  delete value;
  guard.stop();
  EXPECT_EQ(guard.num_allocations(), 1);
  EXPECT_EQ(guard.num_releases(), 1);
}

TEST_F(RtGuardCatches, OverAlignedOperatorNew) {
  struct alignas(64) Line {
    double values[8];
  };
  RtGuard guard;
  auto* const line = new Line();
  escape(line);
  delete line;
  guard.stop();
  EXPECT_EQ(guard.num_allocations(), 1);
}

TEST_F(RtGuardCatches, GrowthOfAVector) {
  std::vector<int> values;
  values.reserve(2);
  RtGuard guard;
  values.push_back(1);
  values.push_back(2);
  const auto within_capacity = guard.num_allocations();
  values.push_back(3);
  guard.stop();
  escape(values.data());
  EXPECT_EQ(within_capacity, 0);
  EXPECT_EQ(guard.num_allocations(), 1);
}

TEST_F(RtGuardCatches, MutexLock) {
  std::mutex mutex;
  RtGuard guard;
  mutex.lock();
  mutex.unlock();
  guard.stop();
  EXPECT_EQ(guard.num_locks(), 1);
}

TEST_F(RtGuardCatches, OnlyItsOwnThread) {
  RtGuard guard;
  const auto before = guard.num_allocations();
  std::int64_t in_thread = 0;
  std::thread worker([&] {
    RtGuard inner;
    escape(std::make_unique<double>(2.0).get());
    in_thread = inner.num_allocations();
  });
  const auto by_starting_it = guard.num_allocations();
  worker.join();
  EXPECT_EQ(before, 0);
  EXPECT_GE(by_starting_it, 1);
  EXPECT_EQ(in_thread, 1);
  EXPECT_EQ(guard.num_allocations(), by_starting_it);
}

TEST_F(RtGuardCatches, NothingAfterItWasStopped) {
  RtGuard guard;
  guard.stop();
  void* const memory = std::malloc(8);
  escape(memory);
  std::free(memory);
  EXPECT_EQ(guard.num_allocations(), 0);
}

TEST_F(RtGuardCatches, TheSameInNestedGuards) {
  RtGuard outer;
  void* const first = std::malloc(8);
  RtGuard inner;
  void* const second = std::malloc(8);
  escape(first);
  escape(second);
  inner.stop();
  outer.stop();
  EXPECT_EQ(outer.num_allocations(), 2);
  EXPECT_EQ(inner.num_allocations(), 1);
  std::free(first);
  std::free(second);
}

TEST_F(RtGuardCatches, BadAlignmentsLikeThePlatform) {
  volatile std::size_t not_a_power_of_two = 24;
  void* memory = nullptr;
  EXPECT_NE(posix_memalign(&memory, not_a_power_of_two, 64), 0);
}

}  // namespace
}  // namespace sopt
