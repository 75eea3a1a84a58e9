// The counts in tests/data/qp_counts.json are exact: whatever changes them changes the method, and
// is written down with
//     sopt bench qp --repeat 1 --counts tests/data/qp_counts.json
#include "tools/bench/bench_qp.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <new>
#include <string>
#include <vector>

#include "tools/bench/allocation_counter.h"
#include "tools/bench/bench_qp_report.h"
#include "tools/io/file_list.h"
#include "tools/io/input_error.h"
#include "tools/qp/recorded_qps.h"

namespace sopt {
namespace {

TEST(BenchQpTest, CountsAreThoseOnRecord) {
  std::vector<BenchQpFamily> families;
  for (const char name : std::string(kQpFamilies)) {
    families.push_back(run_bench_qp(make_qp_family(name, 40, 1), 0, thread_cpu_clock()));
  }
  const auto scenes = list_files({SOPT_SOURCE_DIR "/tools/scenes/plane"}, ".json");
  families.push_back(run_bench_qp(make_recorded_family(scenes, 1), 0, thread_cpu_clock()));
  std::ifstream file(SOPT_SOURCE_DIR "/tests/data/qp_counts.json");
  const auto expected = nlohmann::ordered_json::parse(file);
  const nlohmann::ordered_json counts = counts_json(families);
  EXPECT_EQ(counts, expected) << counts.dump(1);
  EXPECT_EQ(num_failures(families), 0);
  for (const BenchQpFamily& family : families) {
    for (const BenchQpResult& result : family.results) {
      EXPECT_EQ(result.num_allocations, 0) << family.name << ' ' << result.solver;
      const double tolerance = result.solver == "kernel, float" ? 1e-4 : 1e-8;
      EXPECT_LE(result.max_difference, tolerance) << family.name << ' ' << result.solver;
    }
  }
}

TEST(BenchQpTest, TimesEverySolverAsOftenAsAskedFor) {
  ManualClock clock(1000);
  const BenchQpFamily family = run_bench_qp(make_qp_family('c', 3, 1), 4, clock.clock());
  EXPECT_EQ(family.num_pairs, 3);
  EXPECT_EQ(family.num_variables, 100);
  ASSERT_EQ(family.results.size(), 8U);
  for (const BenchQpResult& result : family.results) {
    EXPECT_EQ(result.time_us.count, 12);
    EXPECT_DOUBLE_EQ(result.time_us.median, 1.0);
    EXPECT_DOUBLE_EQ(result.time_us.max, 1.0);
    EXPECT_DOUBLE_EQ(result.slowest_us, 1.0);
    EXPECT_EQ(result.steps.count, 3);
    EXPECT_NEAR(result.ns_per_step, 3000.0 / static_cast<double>(result.total_steps), 1e-9);
  }
  const std::string text = describe(family);
  EXPECT_NE(text.find("family c, 5 joints, 20 steps: 3 pairs, 100 variables"), std::string::npos);
  EXPECT_EQ(to_json(family)["results"].size(), 8U);
}

// A straight segment of `num_steps` with one row in its way.
SegmentQp detour(int num_steps, double bound) {
  SegmentQp problem;
  KernelPart<double>& arm = problem.arm;
  arm.order = 2;
  arm.weights = {0.0, 1.0, 2.0};
  arm.num_steps = num_steps;
  arm.num_joints = 2;
  arm.first_position = {0.0, 0.0};
  arm.last_position = {1.0, 0.0};
  arm.first_velocity = arm.last_velocity = {0.0, 0.0};
  arm.rows.push_back({Quantity::kPosition, num_steps / 2, {0.0, 1.0}, bound});
  return problem;
}

TEST(BenchQpTest, TakesProblemsOfDifferentLengths) {
  QpFamily family = {"recorded", "three lengths", {}};
  for (const int num_steps : {5, 30, 80}) {
    family.pairs.push_back(
        {std::to_string(num_steps), detour(num_steps, 0.5), detour(num_steps, 0.51)});
  }
  const BenchQpFamily result = run_bench_qp(family, 1, thread_cpu_clock());
  EXPECT_EQ(num_failures({result}), 0);
  EXPECT_EQ(result.num_variables, 160);
  for (const BenchQpResult& solver : result.results) {
    EXPECT_LE(solver.max_difference, solver.solver == "kernel, float" ? 1e-4 : 1e-8)
        << solver.solver;
  }
}

TEST(BenchQpTest, NamesWhatFailed) {
  QpFamily family = {"odd", "contradiction", {{"first", detour(9, 0.5), detour(9, 0.5)}}};
  KernelPart<double>& arm = family.pairs[0].warm.arm;
  arm.rows.push_back({Quantity::kPosition, 4, {0.0, -1.0}, -0.4});
  const BenchQpFamily result = run_bench_qp(family, 1, thread_cpu_clock());
  for (const BenchQpResult& solver : result.results) {
    ASSERT_EQ(solver.failed.size(), solver.is_warm ? 1U : 0U) << solver.solver;
    if (!solver.is_warm) continue;
    EXPECT_EQ(solver.failed[0], "first: infeasible");
  }
  EXPECT_EQ(num_failures({result}), 4);
  EXPECT_NE(describe(result).find("failed: first: infeasible (kernel, warm)"), std::string::npos);
}

TEST(BenchQpTest, RefusesAFamilyWithoutProblems) {
  EXPECT_THROW((void)run_bench_qp({"empty", "", {}}, 1, thread_cpu_clock()), InputError);
}

// Calls rather than new expressions, which a compiler may leave out.
TEST(AllocationCounterTest, CountsEveryFormOfNew) {
  constexpr std::align_val_t kLine{64};
  const std::int64_t before = num_allocations();
  void* const plain = ::operator new(8);
  void* const nothing = ::operator new(0);
  void* const aligned = ::operator new(100, kLine);
  void* const quiet = ::operator new(8, std::nothrow);
  EXPECT_EQ(num_allocations() - before, 4);
  EXPECT_NE(nothing, nullptr);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(aligned) % 64, 0U);
  ::operator delete(plain);
  ::operator delete(nothing);
  ::operator delete(aligned, kLine);
  ::operator delete(quiet);
}

}  // namespace
}  // namespace sopt
