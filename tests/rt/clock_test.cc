#include "rt/clock.h"

#include <gtest/gtest.h>

#include "tests/support/rt_guard.h"

namespace sopt {
namespace {

TEST(MonotonicClock, NeverGoesBack) {
  const Clock clock = monotonic_clock();
  std::int64_t last_ns = clock.now_ns();
  for (int i = 0; i < 10000; ++i) {
    const std::int64_t now_ns = clock.now_ns();
    ASSERT_GE(now_ns, last_ns);
    last_ns = now_ns;
  }
}

TEST(MonotonicClock, Advances) {
  const Clock clock = monotonic_clock();
  const std::int64_t start_ns = clock.now_ns();
  std::int64_t num_reads = 0;
  while (clock.now_ns() == start_ns && num_reads < 100'000'000) ++num_reads;
  EXPECT_GT(clock.now_ns(), start_ns);
}

TEST(MonotonicClock, ReadsWithoutHeapOrLock) {
  if (!RtGuard::available()) GTEST_SKIP() << "the guard cannot count under sanitizers";
  const Clock clock = monotonic_clock();
  RtGuard guard;
  const std::int64_t first_ns = clock.now_ns();
  const std::int64_t second_ns = thread_cpu_clock().now_ns();
  guard.stop();
  EXPECT_NE(first_ns, 0);
  EXPECT_GE(second_ns, 0);
  EXPECT_EQ(guard.num_allocations(), 0);
  EXPECT_EQ(guard.num_locks(), 0);
}

TEST(ThreadCpuClock, AdvancesWithWork) {
  const Clock clock = thread_cpu_clock();
  const std::int64_t start_ns = clock.now_ns();
  std::int64_t num_reads = 0;
  while (clock.now_ns() == start_ns && num_reads < 100'000'000) ++num_reads;
  EXPECT_GT(clock.now_ns(), start_ns);
}

TEST(ManualClock, StandsStillUntilMoved) {
  ManualClock manual;
  const Clock clock = manual.clock();
  const std::int64_t start_ns = clock.now_ns();
  EXPECT_EQ(clock.now_ns(), start_ns);
  manual.advance(250);
  EXPECT_EQ(clock.now_ns(), start_ns + 250);
  manual.advance(0);
  EXPECT_EQ(clock.now_ns(), start_ns + 250);
}

TEST(ManualClock, MovesByItsStepAtEachReading) {
  ManualClock manual(7);
  const Clock clock = manual.clock();
  const std::int64_t first_ns = clock.now_ns();
  EXPECT_EQ(clock.now_ns(), first_ns + 7);
  EXPECT_EQ(clock.now_ns(), first_ns + 14);
  manual.advance(100);
  EXPECT_EQ(clock.now_ns(), first_ns + 121);
}

TEST(ManualClock, CountsItsReadings) {
  ManualClock manual;
  EXPECT_EQ(manual.num_reads(), 0);
  const Clock first = manual.clock();
  const Clock second = manual.clock();
  EXPECT_EQ(manual.num_reads(), 0);
  EXPECT_EQ(first.now_ns(), second.now_ns());
  EXPECT_EQ(first.now_ns(), 0);
  EXPECT_EQ(manual.num_reads(), 3);
}

}  // namespace
}  // namespace sopt
