#include "sampler/sampler_stream.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/support/test_problem.h"
#include "tests/support/test_world.h"

namespace sopt {
namespace {

using oracle::InArena;
using oracle::SceneOracle;

constexpr double kTol_m = 1e-9;

PlannerSettings small_settings() {
  PlannerSettings settings;
  settings.nodes_per_stream = 4000;
  settings.max_path_vertices = 256;
  return settings;
}

class SamplerStreamTest : public ::testing::TestWithParam<SamplerMode> {
 protected:
  void use(const oracle::Scene& scene) {
    scene_ = scene;
    ASSERT_EQ(oracle::fill(scene, test_.world), WorldStatus::kOk);
    problem_.robot = &robot_;
    problem_.world = &test_.world;
    problem_.profile = oracle::plain_profile(0.05);
    problem_.start = {1.0, 1.0};
    problem_.goal = {9.0, 1.5};  // the straight line meets the wall
    problem_.mode = GetParam();
  }

  Point2 robot_{0.1};
  oracle::TestWorld test_;
  oracle::Scene scene_;
  StreamProblem<Point2> problem_;
};

TEST_P(SamplerStreamTest, FindsAClearPathThroughAGap) {
  use(oracle::room_with_gap(1.0));
  InArena<SamplerStream<Point2>> stream(small_settings());
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    stream->reset(problem_, CounterRng(seed));
    stream->run(3000, Deadline());
    ASSERT_TRUE(stream->has_path()) << seed;
    const auto vertices = stream->path().vertices.span();
    EXPECT_EQ(vertices.front(), problem_.start);
    EXPECT_EQ(vertices.back(), problem_.goal);
    const SceneOracle dense(scene_);
    EXPECT_GE(dense.path_slack(vertices, robot_.radius_m, problem_.profile), -kTol_m);
  }
}

TEST_P(SamplerStreamTest, GrowsTreesOfClearMotions) {
  use(oracle::room_with_gap(0.0));
  InArena<SamplerStream<Point2>> stream(small_settings());
  stream->reset(problem_, CounterRng(3));
  stream->run(300, Deadline());
  EXPECT_FALSE(stream->has_path());
  EXPECT_GT(stream->num_nodes(), 50);
  EXPECT_GT(stream->num_checks(), 50);
  const SceneOracle dense(scene_);
  int num_roots = 0;
  for (int i = 0; i < stream->num_nodes(); ++i) {
    if (stream->parent(i) == kNoNode) {
      ++num_roots;
      continue;
    }
    ASSERT_LT(stream->parent(i), stream->num_nodes());
    EXPECT_GE(dense.slack(stream->node(stream->parent(i)), stream->node(i), robot_.radius_m,
                          problem_.profile.rule),
              -kTol_m);
  }
  EXPECT_EQ(num_roots, 2);
}

TEST_P(SamplerStreamTest, GivesTheSameTreesInOneRunAndInSlices) {
  use(oracle::room_with_gap(0.0));
  InArena<SamplerStream<Point2>> whole(small_settings());
  InArena<SamplerStream<Point2>> sliced(small_settings());
  whole->reset(problem_, CounterRng(4));
  sliced->reset(problem_, CounterRng(4));
  whole->run(200, Deadline());
  for (int i = 0; i < 20; ++i) sliced->run(10, Deadline());
  ASSERT_EQ(whole->num_nodes(), sliced->num_nodes());
  for (int i = 0; i < whole->num_nodes(); ++i) {
    EXPECT_EQ(whole->node(i), sliced->node(i));
    EXPECT_EQ(whole->parent(i), sliced->parent(i));
  }
}

TEST_P(SamplerStreamTest, StopsWhenTheTreesAreFull) {
  use(oracle::room_with_gap(0.0));
  PlannerSettings settings = small_settings();
  settings.nodes_per_stream = 60;
  InArena<SamplerStream<Point2>> stream(settings);
  stream->reset(problem_, CounterRng(5));
  stream->run(100000, Deadline());
  EXPECT_FALSE(stream->has_path());
  EXPECT_TRUE(stream->exhausted());
  EXPECT_LE(stream->num_nodes(), 60);
}

TEST_P(SamplerStreamTest, SaysWhenAPathHasTooManyVertices) {
  use(oracle::room_with_gap(0.6));
  PlannerSettings settings = small_settings();
  settings.max_path_vertices = 2;
  InArena<SamplerStream<Point2>> stream(settings);
  stream->reset(problem_, CounterRng(6));
  stream->run(100000, Deadline());
  EXPECT_FALSE(stream->has_path());
  EXPECT_TRUE(stream->path_overflow());
  EXPECT_TRUE(stream->exhausted());
}

TEST_P(SamplerStreamTest, TakesNoSampleAfterItsDeadline) {
  use(oracle::room_with_gap(1.0));
  ManualClock clock;
  InArena<SamplerStream<Point2>> stream(small_settings());
  stream->reset(problem_, CounterRng(7));
  const int num_nodes = stream->num_nodes();
  stream->run(1000, Deadline(clock.clock(), 0, 0.0));
  EXPECT_FALSE(stream->has_path());
  // The direct attempt from start to goal takes no sample.
  EXPECT_LE(stream->num_nodes(), num_nodes + 1);
}

TEST_P(SamplerStreamTest, PollsItsDeadlineAtEverySample) {
  use(oracle::room_with_gap(0.0));
  ManualClock clock(1000);
  InArena<SamplerStream<Point2>> stream(small_settings());
  stream->reset(problem_, CounterRng(8));
  stream->run(1000, Deadline(clock.clock(), 0, 50e-6));
  EXPECT_FALSE(stream->exhausted());
  EXPECT_GT(stream->num_nodes(), 2);
  EXPECT_LE(clock.num_reads(), 51);
}

TEST_P(SamplerStreamTest, ForgetsThePathAtReset) {
  use(oracle::room_with_gap(1.0));
  InArena<SamplerStream<Point2>> stream(small_settings());
  stream->reset(problem_, CounterRng(9));
  stream->run(3000, Deadline());
  ASSERT_TRUE(stream->has_path());
  stream->reset(problem_, CounterRng(9));
  EXPECT_FALSE(stream->has_path());
  EXPECT_LE(stream->num_nodes(), 2);
}

// Length of the way over q.
double through(const StreamProblem<Point2>& problem, const Vec2& q) {
  return (q - problem.start).norm() + (problem.goal - q).norm();
}

double longest_through(const StreamProblem<Point2>& problem, const SamplerStream<Point2>& stream) {
  double longest = 0.0;
  for (int i = 0; i < stream.num_nodes(); ++i) {
    longest = std::max(longest, through(problem, stream.node(i)));
  }
  return longest;
}

// The ellipses are so large that hardly ever all tries miss them. A node lies between its parent
// and a sample, and ellipses are convex.
TEST_P(SamplerStreamTest, GrowsOnlyWhereAPathCanBeShorter) {
  use(oracle::room_with_gap(0.0));
  InArena<SamplerStream<Point2>> stream(small_settings());
  const double straight = (problem_.goal - problem_.start).norm();
  double everywhere = 0.0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    problem_.max_length = std::numeric_limits<double>::infinity();
    stream->reset(problem_, CounterRng(seed));
    stream->run(300, Deadline());
    everywhere = std::max(everywhere, longest_through(problem_, *stream));
    for (const double share : {1.3, 1.2}) {
      problem_.max_length = share * straight;
      stream->reset(problem_, CounterRng(seed));
      stream->run(300, Deadline());
      EXPECT_GT(stream->num_nodes(), 30);
      EXPECT_LE(longest_through(problem_, *stream), problem_.max_length * (1.0 + 1e-12));
    }
  }
  EXPECT_GT(everywhere, 1.4 * straight);
}

// No sample helps: the last of the tries is taken, and the search goes on as without a limit.
TEST_P(SamplerStreamTest, GrowsSomewhereWhenNoPathCanBeShorter) {
  use(oracle::room_with_gap(0.5));
  InArena<SamplerStream<Point2>> stream(small_settings());
  const double straight = (problem_.goal - problem_.start).norm();
  for (const double max_length : {straight, 0.5 * straight, 0.0}) {
    problem_.max_length = max_length;
    stream->reset(problem_, CounterRng(10));
    stream->run(3000, Deadline());
    EXPECT_TRUE(stream->has_path());
  }
}

TEST_P(SamplerStreamTest, GrowsTheSameTreesUnderALimitThatNoSampleExceeds) {
  use(oracle::room_with_gap(0.0));
  InArena<SamplerStream<Point2>> free(small_settings());
  InArena<SamplerStream<Point2>> limited(small_settings());
  free->reset(problem_, CounterRng(11));
  problem_.max_length = 100.0;
  limited->reset(problem_, CounterRng(11));
  free->run(200, Deadline());
  limited->run(200, Deadline());
  ASSERT_EQ(free->num_nodes(), limited->num_nodes());
  for (int i = 0; i < free->num_nodes(); ++i) EXPECT_EQ(free->node(i), limited->node(i));
}

INSTANTIATE_TEST_SUITE_P(Modes, SamplerStreamTest,
                         ::testing::Values(SamplerMode::kRrtStar, SamplerMode::kRrtStarConnect),
                         [](const auto& test) {
                           return test.param == SamplerMode::kRrtStar ? "OneTree" : "TwoTrees";
                         });

}  // namespace
}  // namespace sopt
