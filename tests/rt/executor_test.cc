#include "rt/executor.h"

#include <gtest/gtest.h>

#include <array>

#include "tests/support/rt_guard.h"

namespace sopt {
namespace {

TEST(SerialExecutor, DoesEveryIndexOnceAndInOrder) {
  SerialExecutor executor;
  std::array<int, 17> num_done{};
  int last = -1;
  auto work = [&](int i_worker, int i_task) {
    EXPECT_EQ(i_worker, 0);
    EXPECT_EQ(i_task, last + 1);
    last = i_task;
    ++num_done[static_cast<std::size_t>(i_task)];
  };
  executor.run(Task(work), 17);
  for (const int num : num_done) EXPECT_EQ(num, 1);
}

TEST(SerialExecutor, HasOneWorker) { EXPECT_EQ(SerialExecutor().num_workers(), 1); }

TEST(SerialExecutor, DoesNothingWithoutTasks) {
  SerialExecutor executor;
  int num_calls = 0;
  auto work = [&](int, int) { ++num_calls; };
  executor.run(Task(work), 0);
  executor.run(Task(work), -1);
  EXPECT_EQ(num_calls, 0);
}

TEST(SerialExecutor, CanRunFromWithinATask) {
  SerialExecutor executor;
  int num_calls = 0;
  auto inner = [&](int, int) { ++num_calls; };
  auto outer = [&](int, int) { executor.run(Task(inner), 3); };
  executor.run(Task(outer), 4);
  EXPECT_EQ(num_calls, 12);
}

TEST(SerialExecutor, RunsWithoutHeapOrLockThroughTheInterface) {
  if (!RtGuard::available()) GTEST_SKIP() << "the guard cannot count under sanitizers";
  SerialExecutor serial;
  Executor& executor = serial;
  std::array<double, 64> ones{};  // more than a small-object buffer of a type-erased callable
  ones.fill(1.0);
  double sum = 0.0;
  auto work = [ones, &sum](int, int i_task) { sum += ones[static_cast<std::size_t>(i_task)]; };
  RtGuard guard;
  executor.run(Task(work), 64);
  guard.stop();
  EXPECT_EQ(sum, 64.0);
  EXPECT_EQ(guard.num_allocations(), 0);
  EXPECT_EQ(guard.num_locks(), 0);
}

TEST(Task, BorrowsItsCallable) {
  int sum = 0;
  auto work = [&sum](int i_worker, int i_task) { sum += 100 * i_worker + i_task; };
  const Task task(work);
  const Task copy = task;
  task(1, 2);
  copy(3, 4);
  EXPECT_EQ(sum, 406);
}

}  // namespace
}  // namespace sopt
