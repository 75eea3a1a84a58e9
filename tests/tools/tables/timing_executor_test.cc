#include "tools/tables/timing_executor.h"

#include <gtest/gtest.h>

#include <vector>

namespace sopt {
namespace {

// Every reading of the clock moves it by as much.
constexpr std::int64_t kReading_ns = 100;

class TimingExecutorTest : public ::testing::Test {
 protected:
  // Task i takes durations_ns[i].
  void run(const std::vector<std::int64_t>& durations_ns) {
    auto work = [&](int /*i_worker*/, int i) {
      clock_.advance(durations_ns[static_cast<std::size_t>(i)]);
      order_.push_back(i);
    };
    executor_.run(Task(work), static_cast<int>(durations_ns.size()));
  }

  ManualClock clock_{kReading_ns};
  TimingExecutor executor_{clock_.clock()};
  std::vector<int> order_;
};

TEST_F(TimingExecutorTest, KnowsSumAndLongestTaskOfEveryCallWithoutTheClockItself) {
  executor_.set_recording(true);
  run({300, 700, 200});
  run({50});
  EXPECT_EQ(order_, (std::vector<int>{0, 1, 2, 0}));
  ASSERT_EQ(executor_.calls().size(), 2U);
  EXPECT_EQ(executor_.calls()[0].num_tasks, 3);
  EXPECT_EQ(executor_.calls()[0].sum_ns, 1200);
  EXPECT_EQ(executor_.calls()[0].longest_ns, 700);
  EXPECT_EQ(executor_.calls()[1].sum_ns, 50);
  EXPECT_EQ(executor_.calls()[1].longest_ns, 50);
}

TEST_F(TimingExecutorTest, RunsWithoutReadingTheClockUnlessItRecords) {
  executor_.set_recording(true);
  run({300});
  executor_.set_recording(false);
  const std::int64_t num_reads = clock_.num_reads();
  run({300, 700});
  EXPECT_EQ(clock_.num_reads(), num_reads);
  EXPECT_EQ(order_, (std::vector<int>{0, 0, 1}));
  EXPECT_TRUE(executor_.calls().empty());
}

TEST_F(TimingExecutorTest, AWorkerPerTaskSavesAllButTheLongestTaskOfEachCall) {
  const std::vector<TaskCall> calls = {{3, 1200, 700}, {1, 50, 50}, {2, 400, 250}};
  const TaskTimes times = add_up(calls);
  EXPECT_EQ(times.serial_ns, 1650);
  EXPECT_EQ(times.saved_ns, 500 + 0 + 150);
  EXPECT_EQ(critical_path_ns(2000, times), 1350);  // the serial rest of 350 stays
  EXPECT_EQ(critical_path_ns(1650, times), 1000);
}

TEST_F(TimingExecutorTest, ACriticalPathIsWithinTheStageAndCoversTheTasksThatWereTimed) {
  const TaskTimes times{1000, 600};
  EXPECT_EQ(critical_path_ns(900, times), 400);  // the stage ran faster than the timed call
  EXPECT_EQ(critical_path_ns(300, times), 300);
  EXPECT_EQ(critical_path_ns(0, add_up({})), 0);
  EXPECT_EQ(critical_path_ns(80, add_up({})), 80);
}

}  // namespace
}  // namespace sopt
