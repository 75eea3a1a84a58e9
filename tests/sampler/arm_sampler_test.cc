// The sampler in joint space: Arm<N> where sampler_test.cc has Point2.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <type_traits>

#include "sampler/sampler.h"
#include "sampler/shortcut.h"
#include "tests/support/rt_guard.h"
#include "tests/support/test_arm.h"
#include "tests/support/test_problem.h"
#include "tests/support/threaded_executor.h"

namespace sopt {
namespace {

using oracle::InArena;
using oracle::Random;
using oracle::TestWorld3;

const ClearanceRule kRule{0.02, 1.0, 1e-4};

PlannerSettings settings() {
  PlannerSettings settings;
  settings.nodes_per_stream = 8192;
  settings.max_path_vertices = 256;
  settings.max_lattice_points = 0;
  return settings;
}

template <int N>
class ArmSampling {
 public:
  using Config = typename Arm<N>::Config;

  explicit ArmSampling(const Arm<N>& arm) : arm_(arm) {
    for (std::size_t i = 0; i < ladder_.size(); ++i) {
      ladder_[i].rule = kRule;
      ladder_[i].rule.rung = kMarginRungs[i];
    }
    problem_.robot = &arm_;
    problem_.world = &test_.world;
    problem_.ladder = &ladder_;
    problem_.options = &options_;
  }

  // A scene with 7 to 9 obstacles in which the straight motion is blocked, but which a short search
  // solves at the full margin.
  void draw(std::uint64_t scene) {
    Random random(scene);
    bool found = false;
    options_.num_samples = 2000;
    options_.num_batches = 1;
    for (int i = 0; i < 50 && !found; ++i) {
      oracle::scatter_obstacles(random, arm_, 7 + random.index(3), test_.world);
      if (!oracle::draw_request(random, arm_, test_.world, kRule, problem_.start, problem_.goal)) {
        continue;
      }
      const auto result = find(1000000);
      found = result.status == SamplerStatus::kOk && result.i_rung == 0;
    }
    options_ = PlanOptions();
    ASSERT_TRUE(found);
  }

  SamplerResult<Arm<N>> find(std::uint64_t seed) {
    problem_.seed = seed;
    return sampler_->find_path(problem_, Deadline());
  }

  // Ends exact up to whole turns, no jump between vertices, and clear: nowhere below the floor, by
  // the exact clearance at every 2 mm or so.
  void check(const SamplerResult<Arm<N>>& result) {
    ASSERT_EQ(result.status, SamplerStatus::kOk);
    const auto v = result.path->vertices.span();
    ASSERT_GE(v.size(), 2U);
    EXPECT_EQ(v.front(), problem_.start);
    EXPECT_EQ(v.back(), arm_.unwrapped(v[v.size() - 2], problem_.goal));
    EXPECT_LT(arm_.path_distance(v.back(), problem_.goal), 1e-12);
    EXPECT_LE(result.path->length(arm_), result.raw_length * (1.0 + 1e-12));
    for (std::size_t i = 0; i + 1 < v.size(); ++i) {
      EXPECT_LT((v[i + 1] - v[i] - arm_.difference(v[i], v[i + 1])).norm(), 1e-12);
      const int num = 1 + static_cast<int>(arm_.path_distance(v[i], v[i + 1]) / 4e-3);
      for (int k = 0; k <= num; ++k) {
        const Config q = arm_.interpolate(v[i], v[i + 1], static_cast<double>(k) / num);
        ASSERT_GE(oracle::least_excess(arm_, test_.world, q, {0.0, 0.0, 1e-4}), 0.0);
        ASSERT_GT(oracle::least_self_distance(arm_, q), 0.0);
        ASSERT_TRUE(arm_.within_limits(q));
      }
    }
  }

  Arm<N> arm_;
  TestWorld3 test_;
  PlanOptions options_;
  MarginLadder ladder_;
  SamplerProblem<Arm<N>> problem_;
  SerialExecutor serial_;
  ManualClock clock_;
  InArena<Sampler<Arm<N>>> sampler_{settings(), serial_, clock_.clock()};
};

TEST(ArmSampler, FindsClearPathsWithExactEnds) {
  for (const Arm<5>& arm : {lr_mate_200id_7l(), widowx_250()}) {
    ArmSampling<5> sampling(arm);
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      sampling.draw(seed);
      sampling.check(sampling.find(seed));
    }
  }
}

TEST(ArmSampler, SolvesAThousandSeeds) {
  ArmSampling<5> sampling(lr_mate_200id_7l());
  int num_solved = 0;
  for (std::uint64_t scene = 0; scene < 20; ++scene) {
    sampling.draw(100 + scene);
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
      num_solved += sampling.find(seed).status == SamplerStatus::kOk ? 1 : 0;
    }
  }
  EXPECT_EQ(num_solved, 1000);
}

TEST(ArmSampler, PlansForFourToEightJointsOfAllKinds) {
  const auto solve = [](auto&& drawn) {
    constexpr int kDof = std::decay_t<decltype(drawn.arm)>::kDof;
    Random random(7 + kDof);
    int num_solved = 0;
    for (int i = 0; i < 40 && num_solved < 5; ++i) {
      oracle::draw_arm(random, drawn);
      ASSERT_EQ(drawn.arm.reset(drawn.description), ArmStatus::kOk);
      auto sampling = std::make_unique<ArmSampling<kDof>>(drawn.arm);
      oracle::scatter_obstacles(random, drawn.arm, 3, sampling->test_.world);
      auto& problem = sampling->problem_;
      if (!oracle::draw_request(random, drawn.arm, sampling->test_.world, kRule, problem.start,
                                problem.goal)) {
        continue;
      }
      sampling->options_.num_samples = 4000;
      sampling->options_.num_batches = 1;
      const auto result = sampling->find(1);
      if (result.status != SamplerStatus::kOk) continue;  // there may be no way
      sampling->check(result);
      ++num_solved;
    }
    EXPECT_EQ(num_solved, 5);
  };
  solve(oracle::RandomArm<4>());
  solve(oracle::RandomArm<5>());
  solve(oracle::RandomArm<6>());
  solve(oracle::RandomArm<7>());
  solve(oracle::RandomArm<8>());
}

TEST(ArmSampler, AnswersTheSameOnAnyNumberOfWorkers) {
  ArmSampling<5> sampling(widowx_250());
  sampling.draw(5);
  ThreadedExecutor threads;
  ManualClock clock;
  InArena<Sampler<Arm<5>>> threaded(settings(), threads, clock.clock());
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const auto serial = sampling.find(seed);
    const auto parallel = threaded->find_path(sampling.problem_, Deadline());
    ASSERT_EQ(serial.status, SamplerStatus::kOk);
    ASSERT_EQ(parallel.status, SamplerStatus::kOk);
    const auto one = serial.path->vertices.span();
    const auto other = parallel.path->vertices.span();
    EXPECT_TRUE(std::equal(one.begin(), one.end(), other.begin(), other.end()));
    EXPECT_EQ(serial.counts.edges, parallel.counts.edges);
  }
}

TEST(ArmSampler, ShortensPathsMuch) {
  ArmSampling<5> sampling(lr_mate_200id_7l());
  double sum = 0.0;
  double raw_sum = 0.0;
  for (std::uint64_t scene = 0; scene < 10; ++scene) {
    sampling.draw(200 + scene);
    const auto result = sampling.find(scene);
    ASSERT_EQ(result.status, SamplerStatus::kOk);
    sum += result.path->length(sampling.arm_);
    raw_sum += result.raw_length;
  }
  EXPECT_LT(sum, 0.85 * raw_sum);
}

TEST(ArmSampler, TouchesNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "this build cannot count allocations";
  ArmSampling<5> sampling(widowx_250());
  sampling.draw(6);
  (void)sampling.find(1);
  RtGuard guard;
  const auto result = sampling.find(2);
  guard.stop();
  EXPECT_EQ(result.status, SamplerStatus::kOk);
  EXPECT_EQ(guard.num_allocations() + guard.num_releases() + guard.num_locks(), 0);
}

}  // namespace
}  // namespace sopt
