// The planner's real-time contract: memory known beforehand, no heap, no lock, no page fault, small
// stack, the same bytes every time, and a deadline that always leaves a verified plan or none.
#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstring>
#include <set>
#include <vector>

#include "opt/planner.h"
#include "tests/support/planner_fixture.h"
#include "tests/support/rt_guard.h"
#include "tests/support/threaded_executor.h"

namespace sopt::oracle {
namespace {

constexpr std::size_t kPage_B = 4096;

class PlannerContract : public PlannerTest {
 protected:
  TestPlanner test_planner_;
};

// --- memory

TEST_F(PlannerContract, TakesExactlyWhatItRequires) {
  PlannerSettings large = small_settings();
  large.num_streams = 5;
  large.max_window = 40;
  large.rows_per_window = 100;
  PlannerSettings dense = small_settings();
  dense.dense_solver = true;
  for (const PlannerSettings& settings : {small_settings(), large, dense}) {
    for (const int num_workers : {1, 3}) {
      class CountedExecutor final : public Executor {
       public:
        explicit CountedExecutor(int count) : count_(count) {}
        [[nodiscard]] int num_workers() const noexcept override { return count_; }
        void run(Task, int) SOPT_RT override {}

       private:
        int count_;
      } executor(num_workers);
      const std::size_t required_B = Planner<Point2>::required_bytes(settings, num_workers);
      const MemoryBlock block(required_B);
      Arena arena(block);
      const Planner<Point2> planner(arena, {}, settings, executor);
      EXPECT_FALSE(arena.exhausted());
      EXPECT_EQ(arena.used_B(), required_B);

      const MemoryBlock short_block(required_B - kPage_B);
      Arena short_arena(short_block);
      const Planner<Point2> starved(short_arena, {}, settings, executor);
      EXPECT_TRUE(short_arena.exhausted());
    }
  }
}

TEST_F(PlannerContract, UsesNeitherHeapNorLock) {
  if (!RtGuard::available()) GTEST_SKIP() << "the guard cannot count under sanitizers";
  (void)test_planner_.planner.plan(request_);
  for (const SamplerMode mode : {SamplerMode::kRrtStarConnect, SamplerMode::kRrtStar}) {
    request_.options.sampler = mode;
    RtGuard guard;
    const PlanResult<Point2> result = test_planner_.planner.plan(request_);
    guard.stop();
    EXPECT_EQ(result.status, PlanStatus::kOk);
    EXPECT_EQ(guard.num_allocations(), 0);
    EXPECT_EQ(guard.num_releases(), 0);
    EXPECT_EQ(guard.num_locks(), 0);
  }
}

TEST_F(PlannerContract, UsesNeitherHeapNorLockInItsFirstCallNorWhenItFails) {
  if (!RtGuard::available()) GTEST_SKIP() << "the guard cannot count under sanitizers";
  TestPlanner fresh;
  RtGuard first;
  const PlanStatus status = fresh.planner.plan(request_).status;
  first.stop();
  EXPECT_EQ(status, PlanStatus::kOk);
  EXPECT_EQ(first.num_allocations() + first.num_locks(), 0);

  seal_the_goal();
  request_.options.num_samples = 300;
  RtGuard failing;
  const PlanStatus no_path = fresh.planner.plan(request_).status;
  request_.start.x() = 3.0;
  request_.start.y() = 2.0;
  const PlanStatus bad_start = fresh.planner.plan(request_).status;
  failing.stop();
  EXPECT_EQ(no_path, PlanStatus::kNoPath);
  EXPECT_EQ(bad_start, PlanStatus::kBadStart);
  EXPECT_EQ(failing.num_allocations() + failing.num_locks(), 0);
}

// With the paper's choices, and a world in which their result is refused.
TEST_F(PlannerContract, UsesNeitherHeapNorLockInPaperMode) {
  if (!RtGuard::available()) GTEST_SKIP() << "the guard cannot count under sanitizers";
  PlannerSettings settings = small_settings();
  settings.dense_solver = true;
  TestPlanner dense(settings);
  request_.options = PlanOptions::paper();
  const auto plan_guarded = [&] {
    RtGuard guard;
    const PlanResult<Point2> result = dense.planner.plan(request_);
    guard.stop();
    EXPECT_EQ(result.status, PlanStatus::kOk);
    EXPECT_EQ(guard.num_allocations(), 0);
    EXPECT_EQ(guard.num_releases(), 0);
    EXPECT_EQ(guard.num_locks(), 0);
    return result.fell_back;
  };
  for (const RowMode rows : {RowMode::kLabelMap, RowMode::kWaypoint}) {
    request_.options.rows = rows;
    (void)plan_guarded();
  }
  set_scene({{{0.0, 0.0}, {10.0, 10.0}}, {{box_between({4.98, 0.5}, {5.02, 7.0})}}});
  request_.start = {1.0, 2.0};
  request_.goal = {9.0, 2.0};
  request_.options.speed_mps = 10.0;
  int num_fell_back = 0;
  for (request_.seed = 1; request_.seed <= 10; ++request_.seed) {
    num_fell_back += plan_guarded() ? 1 : 0;
  }
  EXPECT_GT(num_fell_back, 0);
}

TEST_F(PlannerContract, CausesNoPageFaultsOnceWarm) {
  if (!RtGuard::available()) GTEST_SKIP() << "sanitizers touch shadow pages of their own";
  rusage before{};
  rusage after{};
  getrusage(RUSAGE_THREAD, &before);
  (void)test_planner_.planner.plan(request_);
  getrusage(RUSAGE_THREAD, &before);
  const PlanStatus status = test_planner_.planner.plan(request_).status;
  getrusage(RUSAGE_THREAD, &after);
  EXPECT_EQ(status, PlanStatus::kOk);
  EXPECT_EQ(after.ru_minflt - before.ru_minflt, 0);
  EXPECT_EQ(after.ru_majflt - before.ru_majflt, 0);
}

// Runs `body` on a stack that was painted beforehand; returns the bytes it wrote over.
template <class Body>
std::size_t stack_used_B(Body& body) {
  constexpr std::size_t kStack_B = 1 << 20;
  constexpr std::byte kPaint{0xa5};
  std::vector<std::byte> memory(kStack_B + kPage_B, kPaint);
  const auto address = reinterpret_cast<std::uintptr_t>(memory.data());
  std::byte* const stack = memory.data() + (kPage_B - address % kPage_B) % kPage_B;
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstack(&attributes, stack, kStack_B);
  pthread_t thread{};
  const auto run = [](void* context) -> void* {
    (*static_cast<Body*>(context))();
    return nullptr;
  };
  EXPECT_EQ(pthread_create(&thread, &attributes, run, &body), 0);
  pthread_join(thread, nullptr);
  pthread_attr_destroy(&attributes);
  const std::byte* const deepest =
      std::find_if(stack, stack + kStack_B, [](std::byte b) { return b != kPaint; });
  return static_cast<std::size_t>(stack + kStack_B - deepest);
}

TEST_F(PlannerContract, UsesAModerateStack) {
  if (!RtGuard::available()) GTEST_SKIP() << "sanitizers enlarge stack frames";
  PlanStatus status = PlanStatus::kBadInput;
  auto nothing = [&] { status = PlanStatus::kBadInput; };
  auto work = [&] { status = test_planner_.planner.plan(request_).status; };
  const std::size_t thread_B = stack_used_B(nothing);
  const std::size_t used_B = stack_used_B(work) - thread_B;
  EXPECT_EQ(status, PlanStatus::kOk);
  EXPECT_LE(used_B, 64U * 1024U);
}

// --- the same bytes

TEST_F(PlannerContract, AnswersTheSameRequestWithTheSameBytes) {
  const std::vector<double> first = numbers_of(test_planner_.planner.plan(request_));
  ASSERT_FALSE(first.empty());
  EXPECT_EQ(numbers_of(test_planner_.planner.plan(request_)), first);
  PlanRequest<Point2> other = request_;
  other.seed = 77;
  std::swap(other.start, other.goal);
  (void)test_planner_.planner.plan(other);
  EXPECT_EQ(numbers_of(test_planner_.planner.plan(request_)), first);
}

TEST_F(PlannerContract, AnswersTheSameFromTwoPlanners) {
  TestPlanner other;
  for (request_.seed = 1; request_.seed <= 5; ++request_.seed) {
    const std::vector<double> one = numbers_of(test_planner_.planner.plan(request_));
    ASSERT_FALSE(one.empty());
    EXPECT_EQ(numbers_of(other.planner.plan(request_)), one);
  }
}

TEST_F(PlannerContract, AnswersTheSameWhicheverSlotIsFree) {
  const PlanResult<Point2> first = test_planner_.planner.plan(request_);
  const PlanResult<Point2> second = test_planner_.planner.plan(request_);
  EXPECT_NE(&first.plan->trajectory(), &second.plan->trajectory());
  EXPECT_EQ(numbers_of(first), numbers_of(second));
}

TEST_F(PlannerContract, AnswersTheSameUnderADeadlineThatIsNotReached) {
  const std::vector<double> first = numbers_of(test_planner_.planner.plan(request_));
  ManualClock manual(1);
  TestPlanner timed(small_settings(), manual.clock());
  request_.deadline_s = 1e6;
  EXPECT_EQ(numbers_of(timed.planner.plan(request_)), first);
}

// Hands tasks out backwards, to workers in turn.
class BackwardExecutor final : public Executor {
 public:
  [[nodiscard]] int num_workers() const noexcept override { return 3; }
  void run(Task task, int num_tasks) SOPT_RT override {
    for (int i = num_tasks - 1; i >= 0; --i) task(i % num_workers(), i);
  }
};

TEST_F(PlannerContract, AnswersTheSameForAnyNumberAndOrderOfWorkers) {
  BackwardExecutor backward;
  TestPlanner other(small_settings(), monotonic_clock(), backward);
  for (request_.seed = 1; request_.seed <= 5; ++request_.seed) {
    const std::vector<double> one = numbers_of(test_planner_.planner.plan(request_));
    ASSERT_FALSE(one.empty());
    EXPECT_EQ(numbers_of(other.planner.plan(request_)), one);
  }
}

TEST_F(PlannerContract, AnswersTheSameInPaperModeForAnyNumberAndOrderOfWorkers) {
  PlannerSettings settings = small_settings();
  settings.dense_solver = true;
  BackwardExecutor backward;
  TestPlanner one_worker(settings);
  TestPlanner three_workers(settings, monotonic_clock(), backward);
  request_.options = PlanOptions::paper();
  for (request_.seed = 1; request_.seed <= 5; ++request_.seed) {
    const std::vector<double> one = numbers_of(one_worker.planner.plan(request_));
    ASSERT_FALSE(one.empty());
    EXPECT_EQ(numbers_of(three_workers.planner.plan(request_)), one);
  }
}

TEST_F(PlannerContract, AnswersTheSameOnThreads) {
  ThreadedExecutor threaded;
  TestPlanner other(small_settings(), monotonic_clock(), threaded);
  const std::vector<double> one = numbers_of(test_planner_.planner.plan(request_));
  ASSERT_FALSE(one.empty());
  EXPECT_EQ(numbers_of(other.planner.plan(request_)), one);
}

// --- deadlines

class PlannerDeadline : public PlannerTest {
 protected:
  // Plans with a clock that moves `step_ns` at each reading.
  PlanStatus plan_with_step(std::int64_t step_ns, double deadline_s) {
    ManualClock manual(step_ns);
    PlannerSettings settings = small_settings();
    settings.dense_solver = true;
    TestPlanner timed(settings, manual.clock());
    request_.deadline_s = deadline_s;
    const PlanResult<Point2> result = timed.planner.plan(request_);
    if (static_cast<int>(result.status) >= 0) {
      expect_valid(scene_, request_, result);
    } else {
      EXPECT_EQ(result.status, PlanStatus::kDeadline);
      EXPECT_FALSE(static_cast<bool>(result.plan));
    }
    num_reads_ = manual.num_reads();
    return result.status;
  }

  std::int64_t num_reads_ = 0;
};

TEST_F(PlannerDeadline, LeavesAVerifiedPlanOrSaysThatThereIsNone) {
  std::set<PlanStatus> seen;
  for (double step_ns = 1.0; step_ns < 2e6; step_ns *= 1.15) {
    SCOPED_TRACE(step_ns);
    seen.insert(plan_with_step(static_cast<std::int64_t>(step_ns), 2e-3));
  }
  EXPECT_EQ(seen, (std::set<PlanStatus>{PlanStatus::kOk, PlanStatus::kDeadlineFeasible,
                                        PlanStatus::kDeadline}));
}

TEST_F(PlannerDeadline, IsKeptInEveryStage) {
  ASSERT_EQ(plan_with_step(1000, 1e9), PlanStatus::kOk);
  const std::int64_t num_reads = num_reads_;
  // Cut at every reading of the clock, from the first to the last.
  for (std::int64_t i = 1; i <= num_reads; i += std::max<std::int64_t>(1, num_reads / 200)) {
    SCOPED_TRACE(i);
    (void)plan_with_step(1000, static_cast<double>(i) * 1e-6);
    EXPECT_LE(num_reads_, num_reads);
  }
}

TEST_F(PlannerDeadline, IsKeptInEveryStageOfPaperMode) {
  request_.options = PlanOptions::paper();
  ASSERT_EQ(plan_with_step(1000, 1e9), PlanStatus::kOk);
  const std::int64_t num_reads = num_reads_;
  for (std::int64_t i = 1; i <= num_reads; i += std::max<std::int64_t>(1, num_reads / 200)) {
    SCOPED_TRACE(i);
    (void)plan_with_step(1000, static_cast<double>(i) * 1e-6);
  }
}

// Each reading belongs to a bounded unit of work; every stream and window may look once more.
TEST_F(PlannerDeadline, StopsSoonAfterItExpires) {
  constexpr std::int64_t kReadsToStop = 150;
  request_.options.tol_step = 0.0;
  ASSERT_EQ(plan_with_step(1000, 1e9), PlanStatus::kOk);
  const std::int64_t num_reads = num_reads_;
  for (std::int64_t i = 1; i < num_reads; i += std::max<std::int64_t>(1, num_reads / 50)) {
    SCOPED_TRACE(i);
    (void)plan_with_step(1000, static_cast<double>(i) * 1e-6);
    EXPECT_LE(num_reads_ - i, kReadsToStop);
  }
}

TEST_F(PlannerDeadline, CutsAHopelessSearch) {
  seal_the_goal();
  EXPECT_EQ(plan_with_step(1000, 1e-3), PlanStatus::kDeadline);
}

TEST_F(PlannerDeadline, CutsTheOptimiserAndLeavesItsLastPlan) {
  // Without iterations to do, what is cut must be at most as good as what is finished.
  ManualClock manual(1000);
  TestPlanner timed(small_settings(), manual.clock());
  const PlanResult<Point2> whole = timed.planner.plan(request_);
  ASSERT_EQ(whole.status, PlanStatus::kOk);
  const double best_m = whole.path_length;
  int num_cut = 0;
  for (double deadline_s = 1e-5; deadline_s < 1.0; deadline_s *= 1.05) {
    request_.deadline_s = deadline_s;
    const PlanResult<Point2> cut = timed.planner.plan(request_);
    if (cut.status != PlanStatus::kDeadlineFeasible) continue;
    ++num_cut;
    expect_valid(scene_, request_, cut);
    EXPECT_GE(cut.path_length, best_m * (1.0 - 1e-2));
  }
  EXPECT_GT(num_cut, 0);
}

TEST_F(PlannerDeadline, OfTheShortestDurationIsADeadlineNotAnError) {
  ManualClock manual(1);
  TestPlanner timed(small_settings(), manual.clock());
  for (const double deadline_s : {1e-300, 1e-12}) {
    request_.deadline_s = deadline_s;
    EXPECT_EQ(timed.planner.plan(request_).status, PlanStatus::kDeadline) << deadline_s;
  }
}

TEST_F(PlannerDeadline, OfCenturiesIsNoDeadline) {
  for (const double deadline_s : {1e12, 1e300, std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(plan_with_step(1000, deadline_s), PlanStatus::kOk) << deadline_s;
  }
}

TEST_F(PlannerDeadline, CountsFromTheCall) {
  ManualClock manual(1);
  TestPlanner timed(small_settings(), manual.clock());
  request_.deadline_s = 1.0;
  for (int i = 0; i < 3; ++i) {
    manual.advance(3'000'000'000);
    EXPECT_EQ(timed.planner.plan(request_).status, PlanStatus::kOk);
  }
}

}  // namespace
}  // namespace sopt::oracle
