// The real-time contract of Planner<Arm<N>>: memory known beforehand, no heap, no lock, no page
// fault, a bounded stack, the same bytes every time, and deadlines that leave a verified plan or
// none.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <set>
#include <string>
#include <vector>

#include "tests/support/arm_planner_fixture.h"
#include "tests/support/rt_guard.h"
#include "tests/support/test_problem.h"
#include "tests/support/threaded_executor.h"

namespace sopt::oracle {
namespace {

using Robot = Arm<5>;

class ArmPlannerContract : public ArmPlannerTest {
 protected:
  std::vector<double> numbers() { return numbers_of(test_planner_.planner.plan(request_)); }

  TestArmPlanner<5> test_planner_{robot_};
};

template <int N>
void expect_exact_memory(const PlannerSettings& settings) {
  for (const int num_workers : {1, 3}) {
    ReverseExecutor executor(num_workers);
    TestArmPlanner<N> test(Arm<N>(), settings, monotonic_clock(), executor);
    EXPECT_TRUE(test.planner.is_ready());
    EXPECT_EQ(test.arena.used_B(), Planner<Arm<N>>::required_bytes(settings, num_workers));
    const MemoryBlock block(test.arena.used_B() - 4096);
    Arena arena(block);
    const Planner<Arm<N>> starved(arena, Arm<N>(), settings, executor);
    EXPECT_TRUE(arena.exhausted());
    EXPECT_FALSE(starved.is_ready());
  }
}

TEST_F(ArmPlannerContract, TakesExactlyTheMemoryItRequires) {
  PlannerSettings dense = small_arm_settings();
  dense.max_window = 40;
  dense.dense_solver = true;
  for (const PlannerSettings& settings : {small_arm_settings(), dense}) {
    expect_exact_memory<4>(settings);
    expect_exact_memory<5>(settings);
    expect_exact_memory<8>(settings);
  }
}

TEST_F(ArmPlannerContract, UsesNeitherHeapNorLock) {
  if (!RtGuard::available()) GTEST_SKIP() << "the guard cannot count under sanitizers";
  PlannerSettings settings = small_arm_settings();
  settings.dense_solver = true;
  TestArmPlanner<5> fresh(robot_, settings);
  const auto expect_none = [&](const char* what, PlanStatus status) {
    SCOPED_TRACE(what);
    RtGuard guard;
    const PlanStatus found = fresh.planner.plan(request_).status;
    guard.stop();
    EXPECT_EQ(found, status);
    EXPECT_EQ(guard.num_allocations() + guard.num_releases() + guard.num_locks(), 0);
  };
  const PlanRequest<Robot> good = request_;
  expect_none("first call", PlanStatus::kOk);
  expect_none("second call", PlanStatus::kOk);
  request_.options.sampler = SamplerMode::kRrtStar;
  expect_none("one tree", PlanStatus::kOk);
  request_.options = PlanOptions::paper_arm();
  expect_none("paper", PlanStatus::kOk);
  request_ = good;
  request_.options.improve_s = 2e-3;
  expect_none("improving", PlanStatus::kOk);
  request_ = good;
  request_.options.num_samples = request_.options.num_batches = 1;
  expect_none("no path", PlanStatus::kNoPath);
  request_.start = {0.0, 2.5, -1.2, 0.0, 0.0};
  expect_none("self-collision", PlanStatus::kBadStart);
  request_.start[0] = 7.0;
  expect_none("beyond a limit", PlanStatus::kBadStart);
}

TEST_F(ArmPlannerContract, CausesNoPageFaultsOnceWarm) {
  if (!RtGuard::available()) GTEST_SKIP() << "sanitizers touch shadow pages of their own";
  rusage before{};
  rusage after{};
  (void)test_planner_.planner.plan(request_);
  getrusage(RUSAGE_THREAD, &before);
  const PlanStatus status = test_planner_.planner.plan(request_).status;
  getrusage(RUSAGE_THREAD, &after);
  EXPECT_EQ(status, PlanStatus::kOk);
  EXPECT_EQ(after.ru_minflt - before.ru_minflt, 0);
  EXPECT_EQ(after.ru_majflt - before.ru_majflt, 0);
}

// --- the same bytes

TEST_F(ArmPlannerContract, AnswersTheSameWhateverItDidBefore) {
  const std::vector<double> first = numbers();
  ASSERT_FALSE(first.empty());
  EXPECT_EQ(numbers(), first);
  const PlanRequest<Robot> request = request_;
  request_.seed = 77;
  std::swap(request_.start, request_.goal);
  EXPECT_NE(numbers(), first);
  request_.options.improve_s = 1e-3;
  request_.options.sampler = SamplerMode::kRrtStar;
  EXPECT_FALSE(numbers().empty());
  request_ = request;
  const PlanResult<Robot> held = test_planner_.planner.plan(request_);
  EXPECT_EQ(numbers_of(held), first);
  EXPECT_EQ(numbers(), first);  // of another slot
}

TEST_F(ArmPlannerContract, AnswersTheSameForOneToThreeWorkersInAnyOrder) {
  ThreadedExecutor threads;
  for (int num_workers = 1; num_workers <= 3; ++num_workers) {
    ReverseExecutor reverse(num_workers);
    TestArmPlanner<5> other(robot_, small_arm_settings(), monotonic_clock(), reverse);
    TestArmPlanner<5> threaded(robot_, small_arm_settings(), monotonic_clock(), threads);
    for (request_.seed = 1; request_.seed <= 5; ++request_.seed) {
      for (const int num_segments : {0, 7}) {
        request_.options.num_segments = num_segments;
        const std::vector<double> one = numbers();
        ASSERT_FALSE(one.empty());
        EXPECT_EQ(numbers_of(other.planner.plan(request_)), one) << request_.seed;
        EXPECT_EQ(numbers_of(threaded.planner.plan(request_)), one) << request_.seed;
      }
    }
  }
}

TEST_F(ArmPlannerContract, AnswersTheSameUnderADeadlineThatIsNotReached) {
  const std::vector<double> first = numbers();
  ManualClock manual(1);
  TestArmPlanner<5> timed(robot_, small_arm_settings(), manual.clock());
  request_.deadline_s = 1e6;
  EXPECT_EQ(numbers_of(timed.planner.plan(request_)), first);
}

// --- deadlines

class ArmPlannerDeadline : public ArmPlannerTest {
 protected:
  // Plans with a clock that moves 1 us at each reading, of which `num_reads_` are counted.
  PlanStatus plan_within(double deadline_s) {
    ManualClock manual(1000);
    TestArmPlanner<5> timed(robot_, small_arm_settings(), manual.clock());
    request_.deadline_s = deadline_s;
    const PlanResult<Robot> result = timed.planner.plan(request_);
    num_reads_ = manual.num_reads();
    if (static_cast<int>(result.status) >= 0) {
      expect_valid(robot_, request_, result);
    } else {
      EXPECT_EQ(result.status, PlanStatus::kDeadline);
      EXPECT_FALSE(static_cast<bool>(result.plan));
      seen_at_.insert(result.failure.stage);
    }
    return result.status;
  }

  std::int64_t num_reads_ = 0;
  std::set<PlanStage> seen_at_;
};

TEST_F(ArmPlannerDeadline, LeavesAVerifiedPlanOrSaysThatThereIsNone) {
  ASSERT_EQ(plan_within(1e9), PlanStatus::kOk);
  const std::int64_t num_reads = num_reads_;
  std::set<PlanStatus> seen;
  // Cut at every reading of the clock, and where part of the time is kept for verification.
  for (std::int64_t i = 1; i <= num_reads; i += std::max<std::int64_t>(1, num_reads / 100)) {
    SCOPED_TRACE(i);
    seen.insert(plan_within(static_cast<double>(i) * 1e-6));
    EXPECT_LE(num_reads_, num_reads);
  }
  for (double deadline_s = 1e-5; deadline_s < 0.1; deadline_s *= 1.1) {
    seen.insert(plan_within(deadline_s));
  }
  EXPECT_EQ(seen, (std::set<PlanStatus>{PlanStatus::kOk, PlanStatus::kDeadlineFeasible,
                                        PlanStatus::kDeadline}));
  EXPECT_EQ(seen_at_.count(PlanStage::kSample), 1U);
}

// Each reading belongs to a bounded unit of work; every stream and window may look once more.
TEST_F(ArmPlannerDeadline, StopsSoonAfterItExpires) {
  constexpr std::int64_t kReadsToStop = 150;
  request_.options.tol_step = 0.0;
  request_.options.num_segments = 9;
  ASSERT_EQ(plan_within(1e9), PlanStatus::kOk);
  const std::int64_t num_reads = num_reads_;
  for (std::int64_t i = 1; i < num_reads; i += std::max<std::int64_t>(1, num_reads / 50)) {
    SCOPED_TRACE(i);
    (void)plan_within(static_cast<double>(i) * 1e-6);
    EXPECT_LE(num_reads_ - i, kReadsToStop);
  }
}

TEST_F(ArmPlannerDeadline, CutsImprovementsAndLeavesAPlan) {
  request_.options.improve_s = 1.0;
  for (const double deadline_s : {3e-3, 1e-2, 3e-2}) {
    EXPECT_EQ(plan_within(deadline_s), PlanStatus::kOk) << deadline_s;
    EXPECT_LE(static_cast<double>(num_reads_) * 1e-6, deadline_s + 1.5e-4);
  }
}

}  // namespace
}  // namespace sopt::oracle
