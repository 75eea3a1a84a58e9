#include "opt/plane/rediscretize.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/rt_guard.h"
#include "tests/support/test_problem.h"

namespace sopt {
namespace {

using oracle::InArena;
using oracle::Random;

using Points = std::vector<Vec2>;

const Aabb2 kBox = {Vec2::Zero(), Vec2::Constant(10.0)};

struct Resampled {
  explicit Resampled(const Points& states, int max_horizon = 1000) : memory(max_horizon) {
    trajectory.dt_s = 0.125;
    for (const Vec2& z : states) (void)trajectory.states.try_push_back(z);
  }
  [[nodiscard]] Points states() const { return oracle::copy_of(trajectory.states.span()); }

  InArena<Trajectory<Point2>> memory;
  Trajectory<Point2>& trajectory = *memory;
};

// State of `old_states` at time share s of the whole.
Vec2 at_share(const Points& old_states, double s) {
  const double t = s * static_cast<double>(old_states.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(t), old_states.size() - 2);
  const double share = t - static_cast<double>(i);
  return (1.0 - share) * old_states[i] + share * old_states[i + 1];
}

void expect_resampled(const Points& old_states, const Trajectory<Point2>& trajectory) {
  const int horizon = trajectory.horizon();
  EXPECT_EQ(trajectory.dt_s, 0.125);
  EXPECT_EQ(trajectory.states[0], old_states.front());
  EXPECT_EQ(trajectory.states[horizon], old_states.back());
  for (int t = 0; t <= horizon; ++t) {
    const Vec2 expected = at_share(old_states, static_cast<double>(t) / horizon);
    ASSERT_LE((trajectory.states[t] - expected).norm(), 1e-10)
        << t << " of " << horizon << " " << oracle::to_text(old_states);
  }
}

TEST(Rediscretize, TakesAsManyStepsAsThePathNeeds) {
  Random random(1);
  int num_shrunk = 0;
  int num_grown = 0;
  for (int round = 0; round < 1000; ++round) {
    const Points old_states = oracle::random_polyline(random, kBox, 3 + random.index(40));
    const int old_horizon = static_cast<int>(old_states.size()) - 1;
    const double length = oracle::length_of(old_states);
    const double step = length / random.uniform(0.5, 2.5 * old_horizon);
    Resampled r(old_states);
    const bool has_changed = rediscretize(step, r.trajectory);
    const int wanted = std::max(2, static_cast<int>(std::ceil(length / step - 1e-9)));
    ASSERT_EQ(r.trajectory.horizon(), wanted);
    EXPECT_EQ(has_changed, wanted != old_horizon);
    expect_resampled(old_states, r.trajectory);
    EXPECT_LE(oracle::length_of(r.states()), length * (1.0 + 1e-12));
    num_shrunk += wanted < old_horizon ? 1 : 0;
    num_grown += wanted > old_horizon ? 1 : 0;
  }
  EXPECT_GT(num_shrunk, 100);
  EXPECT_GT(num_grown, 100);
}

TEST(Rediscretize, LeavesWhatHasTheRightHorizon) {
  Random random(2);
  for (int round = 0; round < 200; ++round) {
    const int horizon = 2 + random.index(60);
    const Points states = oracle::random_polyline(random, kBox, horizon + 1);
    Resampled r(states);
    EXPECT_FALSE(rediscretize(oracle::length_of(states) / (horizon - 0.5), r.trajectory));
    EXPECT_TRUE(oracle::same_bytes(r.states(), states));
  }
}

TEST(Rediscretize, AddsNoStepToAPathOfWholeSteps) {
  for (const double step : {0.1, 0.3, 1.0 / 3.0}) {
    for (int horizon = 2; horizon < 300; ++horizon) {
      Points states;
      for (int t = 0; t <= horizon; ++t) states.emplace_back(t * step, 1.0);
      Resampled r(states);
      EXPECT_FALSE(rediscretize(step, r.trajectory)) << step << " " << horizon;
    }
  }
}

TEST(Rediscretize, KeepsTwoStepsAtLeast) {
  Resampled still({{1.0, 1.0}, {1.0, 1.0}, {1.0, 1.0}, {1.0, 1.0}});
  EXPECT_TRUE(rediscretize(0.5, still.trajectory));
  EXPECT_EQ(still.states(), (Points{{1.0, 1.0}, {1.0, 1.0}, {1.0, 1.0}}));
  EXPECT_FALSE(rediscretize(0.5, still.trajectory));

  Resampled near({{1.0, 1.0}, {1.1, 1.0}, {1.2, 1.0}, {1.3, 1.0}, {1.4, 1.0}});
  EXPECT_TRUE(rediscretize(100.0, near.trajectory));
  EXPECT_EQ(near.trajectory.horizon(), 2);
  EXPECT_NEAR(near.trajectory.states[1].x(), 1.2, 1e-15);
}

TEST(Rediscretize, StopsAtTheCapacityOfTheTrajectory) {
  const Points states = {{0.0, 0.0}, {4.0, 0.0}, {4.0, 4.0}, {8.0, 4.0}};
  for (const double step : {1.0, 1e-3, 1e-300}) {
    Resampled r(states, 7);
    EXPECT_TRUE(rediscretize(step, r.trajectory));
    EXPECT_EQ(r.trajectory.horizon(), 7);
    expect_resampled(states, r.trajectory);
    EXPECT_FALSE(rediscretize(step, r.trajectory));
  }
}

TEST(Rediscretize, TouchesNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "this build cannot count allocations";
  Resampled r({{0.0, 0.0}, {4.0, 0.0}, {4.0, 4.0}, {8.0, 4.0}});
  RtGuard guard;
  const bool has_grown = rediscretize(0.1, r.trajectory);
  const bool has_shrunk = rediscretize(1.0, r.trajectory);
  guard.stop();
  EXPECT_TRUE(has_grown && has_shrunk);
  EXPECT_EQ(guard.num_allocations() + guard.num_releases() + guard.num_locks(), 0);
}

}  // namespace
}  // namespace sopt
