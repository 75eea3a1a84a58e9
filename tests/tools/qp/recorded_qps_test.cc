#include "tools/qp/recorded_qps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "tools/bench/bench_qp_solvers.h"
#include "tools/io/file_list.h"

namespace sopt {
namespace {

std::vector<std::filesystem::path> shipped_scenes() {
  return list_files({SOPT_SOURCE_DIR "/tools/scenes/plane"}, ".json");
}

TEST(RecordedQpsTest, RowsHoldAtTheReference) {
  for (const std::filesystem::path& file : shipped_scenes()) {
    const Scene scene = load_scene(file);
    const std::vector<RecordedQp> recorded = record_qps(scene, 1);
    for (const RecordedQp& qp : recorded) {
      const KernelPart<double>& part = qp.problem.arm;
      ASSERT_GE(part.num_steps, 2);
      ASSERT_EQ(part.num_steps, qp.window.num_steps());
      ASSERT_EQ(qp.reference.size(), static_cast<std::size_t>(part.num_steps) + 1);
      EXPECT_EQ(Vec2(part.first_position.data()), qp.reference.front());
      EXPECT_EQ(Vec2(part.last_position.data()), qp.reference.back());
      ASSERT_FALSE(part.rows.empty());
      int t = 1;
      for (const KernelRow<double>& row : part.rows) {
        ASSERT_GE(row.t, t);
        ASSERT_LT(row.t, part.num_steps);
        t = row.t;
        const Vec2 normal(row.direction.data());
        EXPECT_NEAR(normal.norm(), 1.0, 1e-12);
        EXPECT_GE(normal.dot(qp.reference[static_cast<std::size_t>(t)]), row.bound - 2e-9)
            << scene.name << ", sweep " << qp.sweep << ", window " << qp.window.first;
      }
    }
  }
}

TEST(RecordedQpsTest, WindowsOfASweepDoNotOverlapAndComeBack) {
  const Scene scene = load_scene(shipped_scenes().front());
  const std::vector<RecordedQp> recorded = record_qps(scene, 1);
  ASSERT_FALSE(recorded.empty());
  std::set<int> sweeps;
  for (std::size_t i = 0; i < recorded.size(); ++i) {
    sweeps.insert(recorded[i].sweep);
    if (i == 0) continue;
    ASSERT_GE(recorded[i].sweep, recorded[i - 1].sweep);
    if (recorded[i].sweep > recorded[i - 1].sweep) continue;
    EXPECT_GE(recorded[i].window.first, recorded[i - 1].window.last);
  }
  EXPECT_GE(*sweeps.begin(), 1);
  EXPECT_LE(*sweeps.rbegin(), 4);
}

TEST(RecordedQpsTest, SolversAgree) {
  std::vector<BenchQpPair> pairs;
  for (const QpPair& pair : make_recorded_family(shipped_scenes(), 2).pairs) {
    pairs.push_back(make_bench_pair(pair));
  }
  ASSERT_GE(pairs.size(), 100U);
  const auto solvers = make_bench_solvers(pairs);
  std::set<std::string> names;
  for (const BenchQpPair& pair : pairs) {
    std::vector<double> expected[2];
    for (const auto& solver : solvers) {
      names.insert(solver->name());
      const double tolerance = solver->name() == "kernel, float" ? 1e-3 : 1e-9;
      for (const bool is_warm : {false, true}) {
        const BenchQpProblem& problem = is_warm ? pair.warm : pair.cold;
        solver->prepare(problem);
        ASSERT_EQ(solver->solve(problem, is_warm).status, QpStatus::kOptimal)
            << pair.name << ", " << solver->name() << (is_warm ? ", warm" : ", cold");
        const std::vector<double> inputs = solver->inputs();
        if (expected[is_warm].empty()) expected[is_warm] = inputs;
        ASSERT_EQ(inputs.size(), expected[is_warm].size());
        for (std::size_t i = 0; i < inputs.size(); ++i) {
          ASSERT_NEAR(inputs[i], expected[is_warm][i], tolerance)
              << pair.name << ", " << solver->name();
        }
        if (!is_warm) solver->remember(pair.warm_row_of);
      }
    }
  }
  const std::set<std::string> all = {"dense", "dense, H known", "kernel", "kernel, float", "point"};
  EXPECT_EQ(names, all);
}

TEST(RecordedQpsTest, PartnersHaveTheSameRows) {
  std::size_t num_warm_rows = 0;
  std::size_t num_matched = 0;
  for (const QpPair& pair : make_recorded_family(shipped_scenes(), 1).pairs) {
    const KernelPart<double>& cold = pair.cold.arm;
    const KernelPart<double>& warm = pair.warm.arm;
    EXPECT_EQ(cold.num_steps, warm.num_steps);
    ASSERT_EQ(pair.warm_row_of.size(), cold.rows.size());
    num_warm_rows += warm.rows.size();
    std::set<int> partners;
    for (std::size_t i = 0; i < cold.rows.size(); ++i) {
      const int partner = pair.warm_row_of[i];
      if (partner < 0) continue;
      ++num_matched;
      ASSERT_LT(partner, static_cast<int>(warm.rows.size()));
      EXPECT_TRUE(partners.insert(partner).second);
      const KernelRow<double>& row = warm.rows[static_cast<std::size_t>(partner)];
      EXPECT_EQ(row.t, cold.rows[i].t);
      const Vec2 a(cold.rows[i].direction.data());
      const Vec2 b(row.direction.data());
      EXPECT_GE(a.dot(b), std::cos(0.2) - 1e-12);
    }
  }
  EXPECT_GT(num_matched, num_warm_rows / 2);
}

TEST(RecordedQpsTest, SameSeedSameFamily) {
  const std::vector<std::filesystem::path> scenes = {shipped_scenes()[2]};
  const QpFamily a = make_recorded_family(scenes, 3);
  const QpFamily b = make_recorded_family(scenes, 3);
  ASSERT_EQ(a.pairs.size(), b.pairs.size());
  for (std::size_t i = 0; i < a.pairs.size(); ++i) {
    EXPECT_EQ(a.pairs[i].name, b.pairs[i].name);
    EXPECT_EQ(a.pairs[i].warm_row_of, b.pairs[i].warm_row_of);
    ASSERT_EQ(a.pairs[i].cold.arm.rows.size(), b.pairs[i].cold.arm.rows.size());
    for (std::size_t k = 0; k < a.pairs[i].cold.arm.rows.size(); ++k) {
      EXPECT_EQ(a.pairs[i].cold.arm.rows[k].bound, b.pairs[i].cold.arm.rows[k].bound);
    }
  }
}

KernelRow<double> row_at(int t, double angle_rad, double bound) {
  return {Quantity::kPosition, t, {std::cos(angle_rad), std::sin(angle_rad)}, bound};
}

TEST(RecordedQpsTest, RowsMatchWhenEachIsTheOthersNearest) {
  KernelPart<double> cold;
  KernelPart<double> warm;
  cold.rows = {row_at(1, 0.0, 1.0), row_at(1, 0.1, 1.0), row_at(1, 2.0, 1.0),
               row_at(2, 0.0, 1.0), row_at(3, 1.0, 5.0), row_at(3, 1.0, 7.0)};
  warm.rows = {row_at(1, 0.12, 0.9), row_at(1, 2.21, 1.0), row_at(2, 0.19, 1.0),
               row_at(3, 1.0, 7.1), row_at(3, 1.0, 5.1)};
  const std::vector<int> expected = {-1, 0, -1, 2, 4, 3};
  EXPECT_EQ(match_rows(cold, warm), expected);
  EXPECT_TRUE(match_rows({}, warm).empty());
}

}  // namespace
}  // namespace sopt
