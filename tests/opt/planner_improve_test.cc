// The search for shorter plans after the first one: what leaves is never longer than the first plan
// and passes every check again, the record of improvements and the report belong to it, the budget
// and the request's deadline end it, and the planner's real-time contract holds as without it.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <limits>
#include <optional>
#include <set>
#include <vector>

#include "opt/planner.h"
#include "opt/verify/verify.h"
#include "tests/support/planner_fixture.h"
#include "tests/support/rt_guard.h"
#include "tests/support/test_problem.h"
#include "tests/support/threaded_executor.h"

namespace sopt::oracle {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::int64_t kTick_ns = 100'000;

// Its clock moves by one tick after each batch of tasks and never within one: what a deadline cuts
// does not depend on the order of the tasks.
class TickingExecutor final : public Executor {
 public:
  explicit TickingExecutor(Executor& inner) : inner_(&inner) {}
  [[nodiscard]] int num_workers() const noexcept override { return inner_->num_workers(); }
  void run(Task task, int num_tasks) SOPT_RT override {
    inner_->run(task, num_tasks);
    now_ns_ += kTick_ns;
  }
  [[nodiscard]] Clock clock() noexcept { return {read, &now_ns_}; }

 private:
  static std::int64_t read(void* now_ns) noexcept {
    return *static_cast<std::atomic<std::int64_t>*>(now_ns);
  }

  Executor* inner_;
  std::atomic<std::int64_t> now_ns_ = 0;
};

struct TickingPlanner {
  TickingPlanner() : TickingPlanner(small_settings()) {}
  explicit TickingPlanner(const PlannerSettings& settings) : TickingPlanner(settings, serial) {}
  TickingPlanner(const PlannerSettings& settings, Executor& inner)
      : executor(inner), test(settings, executor.clock(), executor) {}

  SerialExecutor serial;
  TickingExecutor executor;
  TestPlanner test;
};

// What the caller keeps of a result: the next call writes over its spans.
struct Kept {
  std::vector<double> numbers;
  double path_length = 0.0;
  bool fell_back = false;
  std::int64_t rounds = 0;
};

Kept keep(const PlanResult<Point2>& result) {
  return {numbers_of(result), result.path_length, result.fell_back, result.sampler_counts.rounds};
}

// Numbers of the plan and of the record.
std::vector<double> all_numbers_of(const PlanResult<Point2>& result) {
  std::vector<double> numbers = numbers_of(result);
  for (const ImprovementRecord& record : result.improvements) {
    numbers.insert(numbers.end(), {static_cast<double>(record.time_ns), record.path_length});
  }
  return numbers;
}

class PlannerImprove : public PlannerTest {
 protected:
  // Discs between start and goal: many ways, of which the first to be found is rarely the shortest.
  void use_forest(std::uint64_t seed) {
    Random random(seed);
    Scene forest = {{{0.0, 0.0}, {10.0, 10.0}}, {}};
    request_.start = {0.5, 0.5};
    request_.goal = {9.5, 9.5};
    while (forest.obstacles.size() < 40) {
      const Disc disc{random.point(forest.bounds), random.uniform(0.2, 0.7)};
      const double keep_m = disc.radius_m + 0.4;
      if ((disc.center - request_.start).norm() > keep_m &&
          (disc.center - request_.goal).norm() > keep_m) {
        forest.obstacles.push_back({disc});
      }
    }
    set_scene(forest);
  }

  PlanResult<Point2> plan(Planner<Point2>& planner, double improve_s) {
    request_.options.improve_s = improve_s;
    return planner.plan(request_);
  }

  void expect_record(const PlanResult<Point2>& result, double first_length_m) const {
    const auto& records = result.improvements;
    ASSERT_FALSE(records.empty());
    EXPECT_EQ(records.front().path_length, first_length_m);
    EXPECT_EQ(records.back().path_length, result.path_length);
    EXPECT_LE(result.path_length, first_length_m);
    for (std::size_t i = 1; i < records.size(); ++i) {
      EXPECT_LT(records[i].path_length, records[i - 1].path_length);
      EXPECT_GE(records[i].time_ns, records[i - 1].time_ns);
    }
    EXPECT_GE(records.front().time_ns, 0);
    EXPECT_LE(records.back().time_ns, result.times.total_ns);
    EXPECT_GE(result.times.improve_ns, 0);
  }

  // All that is told about a plan is told about the one that leaves.
  void expect_report(const PlanResult<Point2>& result) const {
    ASSERT_TRUE(static_cast<bool>(result.plan));
    const int horizon = result.plan->trajectory().horizon();
    ASSERT_FALSE(result.history.empty());
    const IterationRecord& left = result.fell_back ? result.history.front() : result.history.back();
    EXPECT_EQ(left.path_length, result.path_length);
    EXPECT_EQ(left.cost, result.cost);
    EXPECT_EQ(result.history.back().iteration, result.iterations);
    EXPECT_EQ(result.history.front().segments, result.segments_initial);
    ASSERT_FALSE(result.splits.empty());
    if (request_.options.merge != MergeRule::kPrinted) {
      EXPECT_EQ(static_cast<int>(result.splits.size()), 2 * result.segments_final + 1);
    }
    EXPECT_EQ(result.splits.front(), 0);
    // Of a plan that fell back they are those of the sweeps, which may have changed the horizon.
    EXPECT_TRUE(result.splits.back() == horizon || result.fell_back);
    ASSERT_NE(result.path, nullptr);
    EXPECT_NEAR(result.path->length(Point2{}), result.history.front().path_length, 1e-9);
  }

  // By the oracle and by verify.
  void expect_verified(const PlanResult<Point2>& result) const {
    expect_valid(scene_, request_, result);
    ASSERT_TRUE(static_cast<bool>(result.plan));
    EXPECT_EQ(result.status, PlanStatus::kOk);
    const Point2 robot{kBodyRadius_m, kInfinity};
    const VerifyResult<Point2> again =
        verify(robot, result.plan->trajectory(),
               {request_.start, request_.goal, request_.world, request_.options.min_clearance_m});
    ASSERT_TRUE(again.plan.has_value());
    EXPECT_EQ(again.plan->certificate().min_clearance_m,
              result.plan->certificate().min_clearance_m);
    EXPECT_EQ(again.plan->certificate().where_t_s, result.plan->certificate().where_t_s);
  }

  // Plans without and with `improve_s`; true when the plan became shorter.
  bool expect_improved_or_same(Planner<Point2>& planner, double improve_s) {
    const Kept first = keep(plan(planner, 0.0));
    const PlanResult<Point2> result = plan(planner, improve_s);
    expect_verified(result);
    expect_record(result, first.path_length);
    expect_report(result);
    if (result.improvements.size() > 1) {
      EXPECT_FALSE(result.fell_back);
      return true;
    }
    EXPECT_EQ(numbers_of(result), first.numbers);
    EXPECT_EQ(result.fell_back, first.fell_back);
    return false;
  }

  TickingPlanner ticking_;
  Planner<Point2>& planner_ = ticking_.test.planner;
};

// --- what leaves

TEST_F(PlannerImprove, KeepsNoRecordWithoutABudget) {
  const PlanResult<Point2> result = plan(planner_, 0.0);
  EXPECT_EQ(result.status, PlanStatus::kOk);
  EXPECT_TRUE(result.improvements.empty());
  EXPECT_EQ(result.times.improve_ns, 0);
}

TEST_F(PlannerImprove, LeavesAVerifiedPlanThatIsNeverLongerThanTheFirst) {
  int num_improved = 0;
  for (std::uint64_t forest = 1; forest <= 4; ++forest) {
    use_forest(forest);
    for (request_.seed = 1; request_.seed <= 6; ++request_.seed) {
      SCOPED_TRACE(testing::Message() << "forest " << forest << ", seed " << request_.seed);
      num_improved += expect_improved_or_same(planner_, 20e-3) ? 1 : 0;
    }
  }
  EXPECT_GT(num_improved, 5);
}

// Candidates that are shorter as paths and longer as plans are the rule here.
TEST_F(PlannerImprove, ReportsThePlanThatLeavesWhenCandidatesLose) {
  request_.options.shortcut = false;
  for (const SamplerMode mode : {SamplerMode::kRrtStar, SamplerMode::kRrtStarConnect}) {
    request_.options.sampler = mode;
    for (const double tol_step : {0.0, 1e-2}) {
      request_.options.tol_step = tol_step;
      for (request_.seed = 1; request_.seed <= 8; ++request_.seed) {
        SCOPED_TRACE(request_.seed);
        (void)expect_improved_or_same(planner_, 10e-3);
      }
    }
  }
}

TEST_F(PlannerImprove, HoldsItsPromisesUnderEveryOption) {
  PlannerSettings settings = small_settings();
  settings.dense_solver = true;
  TickingPlanner dense(settings);
  const PlanOptions defaults = request_.options;
  const auto expect_with = [&](const char* name, auto&& change) {
    for (request_.seed = 1; request_.seed <= 4; ++request_.seed) {
      SCOPED_TRACE(testing::Message() << name << ", seed " << request_.seed);
      request_.options = defaults;
      change(request_.options);
      (void)expect_improved_or_same(dense.test.planner, 10e-3);
    }
  };
  use_forest(2);
  expect_with("no iterations", [](PlanOptions& o) { o.max_iterations = 0; });
  expect_with("one stream", [](PlanOptions& o) { o.num_streams = 1; });
  expect_with("no time scaling", [](PlanOptions& o) { o.resampling = Resampling::kOff; });
  expect_with("new horizons", [](PlanOptions& o) { o.resampling = Resampling::kRediscretize; });
  expect_with("few samples", [](PlanOptions& o) { o.num_samples = 40; });
  expect_with("wide margin", [](PlanOptions& o) { o.margin_m = 0.3; });
  expect_with("paper", [](PlanOptions& o) { o = PlanOptions::paper(); });
  expect_with("most batches",
              [](PlanOptions& o) { o.num_batches = std::numeric_limits<int>::max(); });
}

// Linearised about one obstacle per waypoint and accepted unseen, plans are often refused.
TEST_F(PlannerImprove, TellsAPlanThatFellBackFromOneThatDidNot) {
  PlannerSettings settings = small_settings();
  settings.dense_solver = true;
  TickingPlanner dense(settings);
  set_scene({{{0.0, 0.0}, {10.0, 10.0}}, {{box_between({4.98, 0.5}, {5.02, 7.0})}}});
  request_.start = {1.0, 2.0};
  request_.goal = {9.0, 2.0};
  request_.options = PlanOptions::paper();
  request_.options.rows = RowMode::kWaypoint;
  request_.options.speed_mps = 10.0;
  int num_fell_back = 0;
  for (request_.seed = 1; request_.seed <= 20; ++request_.seed) {
    SCOPED_TRACE(request_.seed);
    num_fell_back += plan(dense.test.planner, 0.0).fell_back ? 1 : 0;
    (void)expect_improved_or_same(dense.test.planner, 5e-3);
  }
  EXPECT_GT(num_fell_back, 0);
}

// The wall can be passed below and above; below is 10 % longer.
TEST_F(PlannerImprove, FindsTheShorterWayFromEverySeed) {
  double first_min_m = kInfinity, first_max_m = 0.0, min_m = kInfinity, max_m = 0.0;
  set_scene({{{0.0, 0.0}, {10.0, 10.0}}, {{box_between({4.5, 1.5}, {5.5, 8.0})}}});
  for (request_.seed = 1; request_.seed <= 30; ++request_.seed) {
    const PlanResult<Point2> result = plan(planner_, 50e-3);
    ASSERT_EQ(result.status, PlanStatus::kOk);
    const double first_m = result.improvements.front().path_length;
    first_min_m = std::min(first_min_m, first_m);
    first_max_m = std::max(first_max_m, first_m);
    min_m = std::min(min_m, result.path_length);
    max_m = std::max(max_m, result.path_length);
  }
  EXPECT_GT(first_max_m, 1.05 * first_min_m);
  EXPECT_LT(max_m, 1.01 * min_m);
}

TEST_F(PlannerImprove, FindsNothingShorterThanAStraightPlan) {
  set_scene({{{0.0, 0.0}, {10.0, 10.0}}, {}});
  EXPECT_FALSE(expect_improved_or_same(planner_, 5e-3));
  set_scene({{{0.0, 0.0}, {10.0, 10.0}}, {{box_between({4.0, 6.0}, {6.0, 8.0})}}});
  EXPECT_FALSE(expect_improved_or_same(planner_, 5e-3));
}

TEST_F(PlannerImprove, FindsNothingShorterThanToStay) {
  request_.goal = request_.start;
  EXPECT_FALSE(expect_improved_or_same(planner_, 5e-3));
  EXPECT_EQ(plan(planner_, 5e-3).path_length, 0.0);
}

TEST_F(PlannerImprove, DoesNotBeginWithoutAFirstPlan) {
  seal_the_goal();
  request_.options.num_samples = 300;
  const PlanResult<Point2> result = plan(planner_, 1.0);
  EXPECT_EQ(result.status, PlanStatus::kNoPath);
  EXPECT_TRUE(result.improvements.empty());
  EXPECT_EQ(result.times.improve_ns, 0);
}

TEST_F(PlannerImprove, RefusesABudgetThatIsNoFiniteDuration) {
  for (const double improve_s : {kNan, kInfinity, -kInfinity, -1.0, -1e-300}) {
    const PlanResult<Point2> result = plan(planner_, improve_s);
    EXPECT_EQ(result.status, PlanStatus::kBadInput) << improve_s;
    EXPECT_EQ(result.failure.stage, PlanStage::kRequest);
    EXPECT_EQ(std::strncmp(result.failure.reason, "improve_s ", 10), 0) << result.failure.reason;
    EXPECT_EQ(std::memcmp(&result.failure.amount, &improve_s, sizeof improve_s), 0);
    EXPECT_FALSE(static_cast<bool>(result.plan));
    EXPECT_TRUE(result.improvements.empty());
  }
  for (const double improve_s : {-0.0, 1e-300}) {
    EXPECT_EQ(plan(planner_, improve_s).status, PlanStatus::kOk) << improve_s;
  }
}

// --- budgets

class PlannerImproveBudget : public PlannerImprove {
 protected:
  // One reading of the clock is a microsecond.
  static constexpr std::int64_t kRead_ns = 1000;
  static constexpr double kRead_s = 1e-6;
  // Every stream and window may look once more after the budget has ended.
  static constexpr std::int64_t kReadsToStop = 150;

  PlannerImproveBudget() : timed_(small_settings(), manual_.clock()) { use_forest(1); }

  // Readings that one call took.
  std::int64_t plan_reads(double improve_s) {
    const std::int64_t before = manual_.num_reads();
    result_.emplace(plan(timed_.planner, improve_s));
    return manual_.num_reads() - before;
  }

  ManualClock manual_{kRead_ns};
  TestPlanner timed_;
  std::optional<PlanResult<Point2>> result_;
};

TEST_F(PlannerImproveBudget, IsUsedAndEndsSoonAfterItIsUsedUp) {
  for (request_.seed = 1; request_.seed <= 4; ++request_.seed) {
    const std::int64_t first_reads = plan_reads(0.0);
    for (const std::int64_t budget : {1, 2, 5, 20, 100, 333, 1000, 5000, 20000, 100000}) {
      SCOPED_TRACE(budget);
      const std::int64_t reads = plan_reads(kRead_s * static_cast<double>(budget)) - first_reads;
      EXPECT_EQ(result_->status, PlanStatus::kOk);
      EXPECT_GE(reads, budget);
      EXPECT_LE(reads, budget + kReadsToStop);
      EXPECT_GE(result_->times.improve_ns, kRead_ns * budget);
      expect_verified(*result_);
    }
  }
}

// Also where most of the readings are the optimiser's.
TEST_F(PlannerImproveBudget, EndsSoonInEveryStage) {
  request_.options.tol_step = 0.0;
  request_.options.max_iterations = kMaxIterations;
  const std::int64_t first_reads = plan_reads(0.0);
  for (std::int64_t budget = 10; budget < 8000; budget += 97) {
    SCOPED_TRACE(budget);
    EXPECT_LE(plan_reads(kRead_s * static_cast<double>(budget)) - first_reads,
              budget + kReadsToStop);
  }
}

TEST_F(PlannerImproveBudget, CountsFromTheFirstPlan) {
  const std::int64_t first_reads = plan_reads(0.0);
  (void)plan_reads(5e-3);
  EXPECT_EQ(result_->improvements.front().time_ns, kRead_ns * (first_reads - 1));
}

TEST_F(PlannerImproveBudget, OfALongerSearchBeginsWithWhatAShorterOneFound) {
  for (request_.seed = 1; request_.seed <= 4; ++request_.seed) {
    (void)plan_reads(4e-3);
    const std::vector<ImprovementRecord> before(result_->improvements.begin(),
                                                result_->improvements.end());
    const std::int64_t until_ns = before.front().time_ns + 4'000'000;
    (void)plan_reads(40e-3);
    ASSERT_GE(result_->improvements.size(), before.size() > 1 ? 2u : 1u);
    for (std::size_t i = 0; i < before.size() && before[i].time_ns < until_ns; ++i) {
      EXPECT_EQ(result_->improvements[i].time_ns, before[i].time_ns);
      EXPECT_EQ(result_->improvements[i].path_length, before[i].path_length);
    }
  }
}

// With status kOk: the first plan was whole, and what follows is a gift.
TEST_F(PlannerImproveBudget, OfTheRequestWinsOverALongerOne) {
  constexpr std::int64_t kReserveReads = 1000;  // more than is kept for verification, twice
  request_.deadline_s = 1e6;
  const std::int64_t first_reads = plan_reads(0.0);
  const double first_m = result_->path_length;
  int num_improved = 0;
  for (std::int64_t deadline = first_reads + kReserveReads; deadline < 40000;
       deadline += deadline / 7) {
    SCOPED_TRACE(deadline);
    request_.deadline_s = kRead_s * static_cast<double>(deadline);
    const std::int64_t reads = plan_reads(1e3);
    EXPECT_LE(reads, deadline);
    EXPECT_GE(reads, deadline - kReserveReads);
    EXPECT_EQ(result_->status, PlanStatus::kOk);
    expect_verified(*result_);
    expect_record(*result_, first_m);
    expect_report(*result_);
    num_improved += result_->improvements.size() > 1 ? 1 : 0;
  }
  EXPECT_GT(num_improved, 0);
}

// What was cut before the first plan was whole is not improved.
TEST_F(PlannerImproveBudget, DoesNotRescueAPlanThatTheDeadlineCut) {
  std::set<PlanStatus> seen;
  for (std::int64_t deadline = 1; deadline < 2000; deadline += 3) {
    SCOPED_TRACE(deadline);
    request_.deadline_s = kRead_s * static_cast<double>(deadline);
    EXPECT_LE(plan_reads(1e3), deadline + kReadsToStop);
    seen.insert(result_->status);
    if (result_->status == PlanStatus::kOk) {
      expect_verified(*result_);
      EXPECT_FALSE(result_->improvements.empty());
      continue;
    }
    if (result_->plan) expect_valid(scene_, request_, *result_);
    EXPECT_TRUE(result_->improvements.empty());
    EXPECT_EQ(result_->times.improve_ns, 0);
  }
  EXPECT_EQ(seen, (std::set<PlanStatus>{PlanStatus::kOk, PlanStatus::kDeadlineFeasible,
                                        PlanStatus::kDeadline}));
}

// --- the same bytes

TEST_F(PlannerImprove, AnswersTheSameOnEveryRunOfTheSameClock) {
  use_forest(3);
  for (request_.seed = 1; request_.seed <= 4; ++request_.seed) {
    std::vector<double> first;
    for (int run = 0; run < 3; ++run) {
      ManualClock manual(1000);
      TestPlanner timed(small_settings(), manual.clock());
      const std::vector<double> numbers = all_numbers_of(plan(timed.planner, 20e-3));
      ASSERT_FALSE(numbers.empty());
      if (run == 0) first = numbers;
      EXPECT_EQ(numbers, first);
    }
  }
}

TEST_F(PlannerImprove, AnswersTheSameForAnyNumberAndOrderOfWorkers) {
  ReverseExecutor backward;
  ThreadedExecutor threaded;
  TickingPlanner other(small_settings(), backward);
  TickingPlanner parallel(small_settings(), threaded);
  use_forest(3);
  bool is_improved = false;
  for (request_.seed = 1; request_.seed <= 4; ++request_.seed) {
    std::vector<double> one;
    {
      const PlanResult<Point2> result = plan(planner_, 20e-3);
      is_improved = is_improved || result.improvements.size() > 1;
      one = numbers_of(result);
    }
    ASSERT_FALSE(one.empty());
    EXPECT_EQ(numbers_of(plan(other.test.planner, 20e-3)), one);
    EXPECT_EQ(numbers_of(plan(parallel.test.planner, 20e-3)), one);
  }
  EXPECT_TRUE(is_improved);
}

TEST_F(PlannerImprove, DoesNotChangeTheNextCall) {
  use_forest(1);
  int num_improved = 0;
  for (request_.seed = 1; request_.seed <= 6; ++request_.seed) {
    const std::vector<double> plain = numbers_of(plan(planner_, 0.0));
    const std::vector<double> improved = numbers_of(plan(planner_, 20e-3));
    num_improved += improved != plain ? 1 : 0;
    EXPECT_EQ(numbers_of(plan(planner_, 0.0)), plain);
    EXPECT_EQ(numbers_of(plan(planner_, 20e-3)), improved);
  }
  EXPECT_GT(num_improved, 0);
}

// --- slots

TEST_F(PlannerImprove, TakesOneSlotAndLeavesTheOthersAsTheyAre) {
  use_forest(1);
  std::vector<PlanLease<Point2>> held;
  std::vector<std::vector<Vec2>> states;
  const auto expect_untouched = [&] {
    for (std::size_t i = 0; i < held.size(); ++i) {
      EXPECT_TRUE(same_bytes(states[i], held[i]->trajectory().states.span())) << i;
    }
  };
  int num_improved = 0;
  for (int round = 0; round < 3; ++round) {
    for (int i = 0; i < kNumPlanSlots; ++i) {
      PlanResult<Point2> result = plan(planner_, 20e-3);
      expect_verified(result);
      num_improved += result.improvements.size() > 1 ? 1 : 0;
      expect_untouched();
      for (const auto& lease : held) {
        EXPECT_NE(&lease->trajectory(), &result.plan->trajectory());
        EXPECT_NE(lease->trajectory().states.begin(), result.plan->trajectory().states.begin());
      }
      states.push_back(copy_of(result.plan->trajectory().states.span()));
      held.push_back(std::move(result.plan));
      ++request_.seed;
    }
    EXPECT_EQ(plan(planner_, 20e-3).status, PlanStatus::kNoSlot);
    expect_untouched();
    held.clear();
    states.clear();
  }
  EXPECT_GT(num_improved, 0);
}

// --- heap and locks

TEST_F(PlannerImprove, UsesNeitherHeapNorLock) {
  if (!RtGuard::available()) GTEST_SKIP() << "the guard cannot count under sanitizers";
  use_forest(1);
  for (const SamplerMode mode : {SamplerMode::kRrtStarConnect, SamplerMode::kRrtStar}) {
    request_.options.sampler = mode;
    request_.options.improve_s = 50e-3;
    std::size_t num_plans = 0;
    for (request_.seed = 1; request_.seed <= 4; ++request_.seed) {
      const RtGuard guard;
      const PlanResult<Point2> result = planner_.plan(request_);
      EXPECT_EQ(guard.num_allocations(), 0);
      EXPECT_EQ(guard.num_releases(), 0);
      EXPECT_EQ(guard.num_locks(), 0);
      EXPECT_EQ(result.status, PlanStatus::kOk);
      num_plans = std::max(num_plans, result.improvements.size());
    }
    EXPECT_GT(num_plans, 1u);
  }
}

}  // namespace
}  // namespace sopt::oracle
