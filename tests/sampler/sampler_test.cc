#include "sampler/sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <set>
#include <vector>

#include "tests/support/rt_guard.h"
#include "tests/support/test_problem.h"
#include "tests/support/test_world.h"

namespace sopt {
namespace {

using oracle::InArena;
using oracle::Random;
using oracle::Scene;
using oracle::SceneOracle;

constexpr double kTol_m = 1e-9;

PlannerSettings small_settings() {
  PlannerSettings settings;
  settings.nodes_per_stream = 4000;
  settings.max_path_vertices = 256;
  return settings;
}

class SamplerTest : public ::testing::TestWithParam<SamplerMode> {
 protected:
  void SetUp() override {
    options_.sampler = GetParam();
    options_.num_samples = 4000;
    options_.num_batches = 2;
    problem_.robot = &robot_;
    problem_.world = &test_.world;
    problem_.ladder = &ladder_;
    problem_.options = &options_;
    problem_.start = {1.0, 1.0};
    problem_.goal = {9.0, 1.5};  // the straight line meets the wall of room_with_gap
    set_margin(0.05);
  }
  void set_margin(double margin_m) {
    for (std::size_t i = 0; i < ladder_.size(); ++i) {
      ladder_[i] = oracle::plain_profile(margin_m);
      ladder_[i].rule.rung = kMarginRungs[i];
    }
  }
  void use(const Scene& scene) {
    scene_ = scene;
    ASSERT_EQ(oracle::fill(scene, test_.world), WorldStatus::kOk);
  }
  // Ends exact, every motion clear at the rung that is reported; found by sampling.
  void check(const SamplerResult<Point2>& result) const {
    check_path(result);
    EXPECT_GT(result.counts.nodes, 0);
    EXPECT_GT(result.counts.rounds, 0);
  }
  void check_path(const SamplerResult<Point2>& result) const {
    ASSERT_EQ(result.status, SamplerStatus::kOk);
    ASSERT_NE(result.path, nullptr);
    const auto vertices = result.path->vertices.span();
    ASSERT_GE(vertices.size(), 2u);
    EXPECT_EQ(vertices.front(), problem_.start);
    EXPECT_EQ(vertices.back(), problem_.goal);
    const MarginProfile& profile = ladder_[static_cast<std::size_t>(result.i_rung)];
    EXPECT_GE(SceneOracle(scene_).path_slack(vertices, robot_.radius_m, profile), -kTol_m)
        << oracle::to_text(scene_) << oracle::to_text(vertices);
    EXPECT_LE(result.path->length(Point2{}), result.raw_length * (1.0 + 1e-12));
    EXPECT_GT(result.counts.edges, 0);
  }

  Point2 robot_{0.1};
  oracle::TestWorld test_;
  Scene scene_;
  PlanOptions options_;
  MarginLadder ladder_;
  SamplerProblem<Point2> problem_;
  SerialExecutor serial_;
  ManualClock clock_;
};

TEST_P(SamplerTest, FindsAStraightPathInAnEmptyRoom) {
  use({{Vec2::Zero(), {10.0, 6.0}}, {}});
  InArena<Sampler<Point2>> sampler(small_settings(), serial_, clock_.clock());
  const auto result = sampler->find_path(problem_, Deadline());
  check(result);
  EXPECT_EQ(result.i_rung, 0);
  EXPECT_NEAR(result.path->length(Point2{}), std::hypot(8.0, 0.5), 1e-9);
}

TEST_P(SamplerTest, FindsClearPathsInRandomWorlds) {
  Random random(1);
  InArena<Sampler<Point2>> sampler(small_settings(), serial_, clock_.clock());
  const Aabb2 bounds = {Vec2::Zero(), Vec2(10.0, 10.0)};
  const Aabb2 inner = {Vec2::Constant(0.5), Vec2::Constant(9.5)};
  for (int round = 0; round < 40; ++round) {
    // Some way is known to be clear.
    const auto way = oracle::random_polyline(random, inner, 4);
    use(oracle::random_scene_around(random, bounds, way, 50, 0.8, robot_.radius_m + 0.3));
    problem_.start = way.front();
    problem_.goal = way.back();
    problem_.seed = static_cast<std::uint64_t>(round);
    const auto result = sampler->find_path(problem_, Deadline());
    check(result);
    EXPECT_EQ(result.i_rung, 0);
  }
}

TEST_P(SamplerTest, GivesTheSameBytesOnEveryRunAndForEveryExecutor) {
  use(oracle::room_with_gap(0.5));
  oracle::ReverseExecutor reverse;
  InArena<Sampler<Point2>> first(small_settings(), serial_, clock_.clock());
  InArena<Sampler<Point2>> second(small_settings(), reverse, clock_.clock());
  for (std::uint64_t seed = 1; seed < 6; ++seed) {
    problem_.seed = seed;
    const auto a = first->find_path(problem_, Deadline());
    check(a);
    const std::vector<Vec2> path = oracle::copy_of(a.path->vertices.span());
    const auto b = second->find_path(problem_, Deadline());
    check(b);
    EXPECT_TRUE(oracle::same_bytes(path, b.path->vertices.span())) << seed;
    EXPECT_EQ(a.counts.nodes, b.counts.nodes);
    EXPECT_EQ(a.counts.edges, b.counts.edges);
    EXPECT_EQ(a.counts.rounds, b.counts.rounds);
    EXPECT_EQ(a.raw_length, b.raw_length);
    const auto again = first->find_path(problem_, Deadline());
    EXPECT_TRUE(oracle::same_bytes(path, again.path->vertices.span())) << seed;
  }
}

TEST_P(SamplerTest, AnswersDifferentSeedsDifferently) {
  use(oracle::room_with_gap(0.5));
  options_.shortcut = false;
  InArena<Sampler<Point2>> sampler(small_settings(), serial_, clock_.clock());
  problem_.seed = 1;
  const double length_1 = sampler->find_path(problem_, Deadline()).raw_length;
  problem_.seed = 2;
  EXPECT_NE(sampler->find_path(problem_, Deadline()).raw_length, length_1);
}

TEST_P(SamplerTest, SaysThatASealedRoomHasNoPathWithinItsBudget) {
  use(oracle::room_with_gap(0.0));
  options_.num_samples = 1000;
  InArena<Sampler<Point2>> sampler(small_settings(), serial_, clock_.clock());
  const auto result = sampler->find_path(problem_, Deadline());
  EXPECT_EQ(result.status, SamplerStatus::kNoPath);
  EXPECT_EQ(result.path, nullptr);
  // 4 rungs, each of at least one round; a round is at most 128 samples.
  EXPECT_GE(result.counts.rounds, 2 * 1000 / 128);
  EXPECT_LE(result.counts.rounds, 2 * (1000 / 128 + 1 + 4));
}

TEST_P(SamplerTest, StopsAtItsDeadline) {
  use(oracle::room_with_gap(0.0));
  InArena<Sampler<Point2>> sampler(small_settings(), serial_, clock_.clock());
  for (const double deadline_s : {0.0, 1e-6, 100e-6}) {
    ManualClock clock(1000);
    const auto result = sampler->find_path(problem_, Deadline(clock.clock(), 0, deadline_s));
    EXPECT_EQ(result.status, SamplerStatus::kDeadline);
    EXPECT_EQ(result.path, nullptr);
    EXPECT_LE(clock.num_reads(), 150);
  }
}

TEST_P(SamplerTest, LeavesWholePathsWhenTheDeadlineCutsShortening) {
  use(oracle::room_with_gap(0.5));
  InArena<Sampler<Point2>> sampler(small_settings(), serial_, clock_.clock());
  int num_found = 0;
  for (int polls = 1; polls < 2000; polls += 7) {
    ManualClock clock(1000);
    const auto result = sampler->find_path(problem_, Deadline(clock.clock(), 0, 1e-6 * polls));
    if (result.status == SamplerStatus::kDeadline) continue;
    check(result);
    ++num_found;
  }
  EXPECT_GT(num_found, 0);
}

TEST_P(SamplerTest, GivesWayToALowerRungInANarrowGap) {
  robot_.radius_m = 0.1;
  set_margin(0.4);
  InArena<Sampler<Point2>> sampler(small_settings(), serial_, clock_.clock());
  // Gap = 2 (radius + rung 0.4) + 0.06: passable at the rung, not at the one above.
  for (std::size_t i = 0; i < kMarginRungs.size(); ++i) {
    use(oracle::room_with_gap(2.0 * (0.1 + 0.4 * kMarginRungs[i]) + 0.06));
    options_.num_samples = 16000;
    const auto result = sampler->find_path(problem_, Deadline());
    check(result);
    EXPECT_EQ(result.i_rung, static_cast<int>(i));
  }
}

TEST_P(SamplerTest, LeavesAStartInsideTheMargin) {
  problem_.goal = {9.0, 5.0};
  // A box 0.02 m away from the robot at the start, another at the goal.
  use({{Vec2::Zero(), {10.0, 6.0}},
       {{oracle::box_between({0.5, 0.2}, {1.5, 0.88}), kDefaultMargin},
        {oracle::box_between({8.5, 5.12}, {9.5, 5.5}), kDefaultMargin},
        {oracle::box_between({4.0, 1.0}, {6.0, 5.5}), kDefaultMargin}}});
  for (MarginProfile& profile : ladder_) {
    profile.rule.margin_m = 0.3;
    profile.num_start_steps = 1;
    profile.num_goal_steps = 1;
    profile.start_cap_m = 0.018;
    profile.goal_cap_m = 0.018;
    profile.step_length = 1.0;
  }
  InArena<Sampler<Point2>> sampler(small_settings(), serial_, clock_.clock());
  check(sampler->find_path(problem_, Deadline()));
}

TEST_P(SamplerTest, SaysWhenEveryPathIsTooLongForItsMemory) {
  use(oracle::room_with_gap(0.6));
  PlannerSettings settings = small_settings();
  settings.max_path_vertices = 2;
  InArena<Sampler<Point2>> sampler(settings, serial_, clock_.clock());
  const auto result = sampler->find_path(problem_, Deadline());
  EXPECT_EQ(result.status, SamplerStatus::kCapacity);
  EXPECT_EQ(result.path, nullptr);
}

TEST_P(SamplerTest, UsesAsManyStreamsAsTheRequestAsksFor) {
  use(oracle::room_with_gap(0.5));
  InArena<Sampler<Point2>> sampler(small_settings(), serial_, clock_.clock());
  for (const int asked : {0, 1, 2, 4, 100}) {
    options_.num_streams = asked;
    check(sampler->find_path(problem_, Deadline()));
    EXPECT_EQ(sampler->num_streams(), asked == 0 || asked > 4 ? 4 : asked);
  }
}

TEST_P(SamplerTest, TouchesNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "this build cannot count allocations";
  use(oracle::room_with_gap(0.5));
  InArena<Sampler<Point2>> sampler(small_settings(), serial_, clock_.clock());
  (void)sampler->find_path(problem_, Deadline());
  RtGuard guard;
  const auto result = sampler->find_path(problem_, Deadline());
  guard.stop();
  EXPECT_EQ(result.status, SamplerStatus::kOk);
  EXPECT_EQ(guard.num_allocations() + guard.num_releases() + guard.num_locks(), 0);
}

// --- the lattice

// A door of 3 cm beyond what the body and its margin take: one round of samples finds it rarely.
TEST_P(SamplerTest, SearchesALatticeAfterARoundInVain) {
  use(oracle::room_with_gap(0.33));
  options_.num_samples = 4 * 128;  // one round for each rung
  InArena<Sampler<Point2>> sampler(small_settings(), serial_, clock_.clock());
  int num_sampled = 0;
  for (problem_.seed = 1; problem_.seed <= 20; ++problem_.seed) {
    options_.lattice = false;
    const auto sampled = sampler->find_path(problem_, Deadline());
    if (sampled.path != nullptr && sampled.i_rung == 0) ++num_sampled;
    options_.lattice = true;
    const auto searched = sampler->find_path(problem_, Deadline());
    check(searched);
    EXPECT_EQ(searched.i_rung, 0) << problem_.seed;
  }
  EXPECT_LT(num_sampled, 10);
}

TEST_P(SamplerTest, FindsTheSameByTheLatticeForEveryExecutor) {
  use(oracle::room_with_gap(0.33));
  oracle::ReverseExecutor reverse;
  InArena<Sampler<Point2>> first(small_settings(), serial_, clock_.clock());
  InArena<Sampler<Point2>> other(small_settings(), reverse, clock_.clock());
  for (problem_.seed = 1; problem_.seed <= 5; ++problem_.seed) {
    const auto a = first->find_path(problem_, Deadline());
    check(a);
    const auto b = other->find_path(problem_, Deadline());
    EXPECT_TRUE(oracle::same_bytes(a.path->vertices.span(), b.path->vertices.span()));
    EXPECT_EQ(a.counts.edges, b.counts.edges);
  }
}

TEST_P(SamplerTest, GoesWithoutALatticeThatHasNoRoom) {
  use(oracle::room_with_gap(0.6));
  PlannerSettings settings = small_settings();
  settings.max_lattice_points = 0;
  InArena<Sampler<Point2>> sampler(settings, serial_, clock_.clock());
  check(sampler->find_path(problem_, Deadline()));
}

// --- improve_path

// Through the gap of room_with_gap, by a detour; by samples alone.
class SamplerImproveTest : public SamplerTest {
 protected:
  void SetUp() override {
    SamplerTest::SetUp();
    use(oracle::room_with_gap(0.6));
    options_.lattice = false;
  }
  SamplerResult<Point2> improve(Sampler<Point2>& sampler, const std::vector<Vec2>& known,
                                int i_round = 0) {
    known_.emplace_back(std::make_unique<oracle::TestPath>(known));
    return sampler.improve_path(problem_, i_rung_, i_round, known_.back()->path, Deadline());
  }
  [[nodiscard]] std::vector<Vec2> detour() const {
    return {problem_.start, {2.0, 4.5}, {4.0, 3.0}, {6.0, 3.0}, {8.0, 5.5}, problem_.goal};
  }

  int i_rung_ = 0;
  std::vector<std::unique_ptr<oracle::TestPath>> known_;
  InArena<Sampler<Point2>> sampler_{small_settings(), serial_, clock_.clock()};
};

TEST_P(SamplerImproveTest, ShortensADetourAndKeepsTheRung) {
  set_margin(0.2);  // the gap lets the body through with 0.2 on each side
  for (const int i_rung : {1, 3}) {
    i_rung_ = i_rung;
    for (problem_.seed = 1; problem_.seed <= 5; ++problem_.seed) {
      const auto result = improve(*sampler_, detour());
      check(result);
      EXPECT_EQ(result.i_rung, i_rung);
      EXPECT_LT(result.path->length(Point2{}), 0.9 * oracle::length_of(detour()));
    }
  }
}

TEST_P(SamplerImproveTest, IsNeverLongerThanTheKnownPath) {
  std::vector<Vec2> known = detour();
  double length_m = oracle::length_of(known);
  for (int i_round = 0; i_round < 30; ++i_round) {
    const auto result = improve(*sampler_, known, i_round);
    if (result.status == SamplerStatus::kNoPath) continue;  // there is hardly room for one
    check(result);
    EXPECT_LE(result.path->length(Point2{}), length_m * (1.0 + 1e-12)) << i_round;
    known = oracle::copy_of(result.path->vertices.span());
    length_m = result.path->length(Point2{});
  }
  // The least for a body of 0.1 and a margin of 0.05 at the lower edge of a gap of 0.6.
  const double edge_m = 2.7 + 0.15;
  const double bound_m =
      (Vec2(5.0, edge_m) - problem_.start).norm() + (problem_.goal - Vec2(5.0, edge_m)).norm();
  EXPECT_LT(length_m, 1.02 * bound_m);
}

TEST_P(SamplerImproveTest, SearchesEveryLevelOfTheLatticeFirst) {
  options_.lattice = true;
  for (int i_round = 0; i_round < kLatticeLevels + 2; ++i_round) {
    const auto result = improve(*sampler_, detour(), i_round);
    check_path(result);
    EXPECT_EQ(result.counts.rounds == 0, i_round < kLatticeLevels) << i_round;
    EXPECT_LT(result.path->length(Point2{}), 0.9 * oracle::length_of(detour()));
  }
}

TEST_P(SamplerImproveTest, FindsNothingShorterThanAStraightPath) {
  const std::vector<Vec2> straight = {problem_.start, problem_.goal};
  for (const bool has_obstacles : {false, true}) {
    use({{Vec2::Zero(), {10.0, 6.0}}, {}});
    if (has_obstacles) use({scene_.bounds, {{oracle::box_between({3.0, 3.0}, {6.0, 5.0})}}});
    for (int i_round = 0; i_round < 5; ++i_round) {
      const auto result = improve(*sampler_, straight, i_round);
      if (result.path == nullptr) continue;
      EXPECT_GE(result.path->length(Point2{}), oracle::length_of(straight) * (1.0 - 1e-12));
    }
  }
}

TEST_P(SamplerImproveTest, SamplesOnlyWhereAPathCanBeShorter) {
  // Half of the room is in the ellipse: sixteen tries do not all miss it.
  const std::vector<Vec2> known = {problem_.start, {5.0, 4.5}, problem_.goal};
  const double length_m = oracle::length_of(known);
  for (int i_round = 0; i_round < 5; ++i_round) {
    (void)improve(*sampler_, known, i_round);
    for (int i = 0; i < sampler_->num_streams(); ++i) {
      const SamplerStream<Point2>& stream = sampler_->stream(i);
      for (int k = 0; k < stream.num_nodes(); ++k) {
        const double through =
            (stream.node(k) - problem_.start).norm() + (problem_.goal - stream.node(k)).norm();
        EXPECT_LE(through, length_m * (1.0 + 1e-12));
      }
    }
  }
}

TEST_P(SamplerImproveTest, DrawsOtherSamplesInEveryRoundThanInAnyBatch) {
  options_.shortcut = false;
  std::set<double> lengths = {sampler_->find_path(problem_, Deadline()).raw_length};
  for (int i_round = 0; i_round < 4; ++i_round) {
    lengths.insert(improve(*sampler_, detour(), i_round).raw_length);
  }
  EXPECT_EQ(lengths.size(), 5u);
}

TEST_P(SamplerImproveTest, GivesTheSameBytesOnEveryRunAndForEveryExecutor) {
  oracle::ReverseExecutor reverse;
  InArena<Sampler<Point2>> other(small_settings(), reverse, clock_.clock());
  for (int i_round = 0; i_round < 5; ++i_round) {
    const auto a = improve(*sampler_, detour(), i_round);
    check(a);
    const std::vector<Vec2> path = oracle::copy_of(a.path->vertices.span());
    const auto b = improve(*other, detour(), i_round);
    check(b);
    EXPECT_TRUE(oracle::same_bytes(path, b.path->vertices.span())) << i_round;
    EXPECT_EQ(a.counts.edges, b.counts.edges);
    EXPECT_TRUE(oracle::same_bytes(path, improve(*sampler_, detour(), i_round).path->vertices))
        << i_round;
  }
}

TEST_P(SamplerImproveTest, LeavesNoTraceInTheNextSearch) {
  const auto before = sampler_->find_path(problem_, Deadline());
  check(before);
  const std::vector<Vec2> path = oracle::copy_of(before.path->vertices.span());
  (void)improve(*sampler_, detour());
  const auto after = sampler_->find_path(problem_, Deadline());
  EXPECT_TRUE(oracle::same_bytes(path, after.path->vertices.span()));
}

TEST_P(SamplerImproveTest, StopsAtItsDeadline) {
  use(oracle::room_with_gap(0.0));
  const oracle::TestPath known(detour());
  for (const double deadline_s : {0.0, 1e-6, 100e-6}) {
    ManualClock clock(1000);
    const auto result =
        sampler_->improve_path(problem_, 0, 0, known.path, Deadline(clock.clock(), 0, deadline_s));
    EXPECT_EQ(result.status, SamplerStatus::kDeadline);
    EXPECT_EQ(result.path, nullptr);
    EXPECT_LE(clock.num_reads(), 150);
  }
}

TEST_P(SamplerImproveTest, TouchesNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "this build cannot count allocations";
  const oracle::TestPath known(detour());
  RtGuard guard;
  const auto result = sampler_->improve_path(problem_, 0, 0, known.path, Deadline());
  guard.stop();
  EXPECT_EQ(result.status, SamplerStatus::kOk);
  EXPECT_EQ(guard.num_allocations() + guard.num_releases() + guard.num_locks(), 0);
}

INSTANTIATE_TEST_SUITE_P(Modes, SamplerImproveTest,
                         ::testing::Values(SamplerMode::kRrtStar, SamplerMode::kRrtStarConnect),
                         [](const auto& test) {
                           return test.param == SamplerMode::kRrtStar ? "OneTree" : "TwoTrees";
                         });

INSTANTIATE_TEST_SUITE_P(Modes, SamplerTest,
                         ::testing::Values(SamplerMode::kRrtStar, SamplerMode::kRrtStarConnect),
                         [](const auto& test) {
                           return test.param == SamplerMode::kRrtStar ? "OneTree" : "TwoTrees";
                         });

}  // namespace
}  // namespace sopt
