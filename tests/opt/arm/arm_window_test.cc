#include "opt/arm/arm_window.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "models/arm/arm_presets.h"
#include "tests/support/arm_segment.h"
#include "tests/support/rt_guard.h"
#include "tests/support/test_problem.h"

namespace sopt {
namespace {

using oracle::InArena;
using oracle::Random;

constexpr int kDof = 5;
constexpr double kDt_s = 0.05;
constexpr double kStep = 0.05;
constexpr double kMargin_m = 0.02;
constexpr double kMinClearance_m = 1e-4;
using Robot = Arm<kDof>;
using Config = Robot::Config;
using States = oracle::States<kDof>;

PlannerSettings settings_with(bool dense_solver, int max_window = 160) {
  PlannerSettings settings = PlannerSettings::arm();
  settings.max_window = max_window;
  settings.dense_solver = dense_solver;
  return settings;
}

class ArmWindowTest : public ::testing::Test {
 protected:
  void SetUp() override { draw(1); }
  // A way of two legs among obstacles that are in the way of a straight one.
  void draw(std::uint64_t seed, int num_obstacles = 8) {
    Random random(seed);
    const auto way = oracle::random_way(random, robot_, 2);
    oracle::draw_obstacles(random, robot_, way, num_obstacles, 0.8, kMargin_m + 0.002, test_.world);
    oracle::make_arm_reference(robot_, way, kStep, kDt_s, trajectory_.trajectory);
    reference_ = {trajectory_.trajectory.states.begin(), trajectory_.trajectory.states.end()};
    states_ = reference_;
  }
  [[nodiscard]] int horizon() const { return static_cast<int>(states_.size()) - 1; }
  [[nodiscard]] Window whole() const { return {0, std::min(horizon(), 150)}; }
  [[nodiscard]] SweepProblem<Robot> problem() {
    SweepProblem<Robot> problem;
    problem.robot = &robot_;
    problem.world = &test_.world;
    problem.profile.rule = {kMargin_m, 1.0, kMinClearance_m + 1e-8};
    problem.trust_m = kArmActivation_m;
    problem.ds_m = kStep;
    problem.states = states_;
    problem.dt_s = kDt_s;
    problem.min_clearance_m = kMinClearance_m;
    return problem;
  }
  WindowResult optimize(const Window& window) {
    return optimizer_.optimize(problem(), window, Deadline());
  }
  [[nodiscard]] double cost(const Window& window) const {
    const States part(states_.begin() + window.first, states_.begin() + window.last + 1);
    return oracle::arm_cost(robot_, part, kDt_s, kStep);
  }
  void expect_valid(const char* what) const {
    const auto facts = oracle::examine(robot_, test_.world, states_, kDt_s, 16);
    EXPECT_GE(facts.clearance_m, kMinClearance_m) << what;
    EXPECT_GE(facts.self_clearance_m, kSelfClearance_m) << what;
    EXPECT_LE(facts.limit_excess, 0.0) << what;
    EXPECT_LE(facts.defect, 1e-12) << what;
  }

  const Robot robot_ = lr_mate_200id_7l();
  oracle::ArmTestWorld test_;
  oracle::EmptyArmTrajectory<kDof> trajectory_;
  States reference_, states_;

  struct Optimizer {
    explicit Optimizer(const PlannerSettings& settings)
        : shared(settings), window(settings, *shared) {}
    WindowResult optimize(const SweepProblem<Robot>& problem, const Window& part,
                          const Deadline& deadline) {
      return window->optimize(problem, part, deadline);
    }
    InArena<WindowOptimizer<Robot>::Shared> shared;
    InArena<WindowOptimizer<Robot>> window;
  };
  Optimizer optimizer_{settings_with(false)};
};

TEST_F(ArmWindowTest, StraightensADetourInFreeSpace) {
  draw(3, 0);
  const WindowResult result = optimize(whole());
  EXPECT_EQ(result.status, WindowStatus::kMoved);
  EXPECT_FALSE(result.was_shortened);
  EXPECT_NEAR(result.cost_after, cost(whole()), 1e-9);
  // The cost treats all joints alike, so from rest to rest its minimum is a straight motion.
  ASSERT_EQ(whole().last, horizon());
  const Config start = states_.front().head<kDof>();
  const Config way = states_.back().head<kDof>() - start;
  for (const auto& z : states_) {
    const Config offset = z.head<kDof>() - start;
    EXPECT_LE((offset - offset.dot(way) / way.squaredNorm() * way).norm(), 1e-9);
  }
  EXPECT_EQ(optimize(whole()).status, WindowStatus::kConverged);
  expect_valid("free");
}

TEST_F(ArmWindowTest, NeverRaisesTheCostAndStaysClearBetweenWaypoints) {
  int num_active = 0;
  int num_shortened = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    draw(seed);
    expect_valid("reference");
    for (int round = 0; round < 3; ++round) {
      const Window window =
          round % 2 == 0 ? Window{0, whole().last} : Window{horizon() / 4, 3 * horizon() / 4};
      const double before = cost(window);
      const WindowResult result = optimize(window);
      EXPECT_NEAR(result.cost_before, before, 1e-9 * before);
      EXPECT_NEAR(result.cost_after, cost(window), 1e-9 * before);
      EXPECT_LE(result.cost_after, result.cost_before) << seed;
      num_active += result.has_active_rows ? 1 : 0;
      num_shortened += result.was_shortened ? 1 : 0;
      expect_valid("after a window");
    }
  }
  EXPECT_GT(num_active, 20);
  EXPECT_GT(num_shortened, 0);
}

TEST_F(ArmWindowTest, WritesOnlyTheInteriorOfItsWindow) {
  const Window window{10, horizon() - 10};
  ASSERT_EQ(optimize(window).status, WindowStatus::kMoved);
  for (int t = 0; t <= horizon(); ++t) {
    const auto i = static_cast<std::size_t>(t);
    const bool is_inside = t > window.first && t < window.last;
    EXPECT_EQ((states_[i] == reference_[i]), !is_inside) << t;
  }
}

TEST_F(ArmWindowTest, KeepsItsRowsAfterAFullStep) {
  int num_full = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    draw(seed);
    const WindowResult result = optimize(whole());
    const auto rows = optimizer_.window->rows();
    if (result.status != WindowStatus::kMoved || result.was_shortened || rows.empty() ||
        result.qp_solves > 2) {
      continue;  // soft rows need not hold
    }
    ++num_full;
    for (const ArmRow<kDof>& row : rows) {
      const Config q = states_[static_cast<std::size_t>(row.t)].head<kDof>();
      EXPECT_GE(row.gradient.dot(q), row.bound - 1e-9) << seed;
    }
  }
  EXPECT_GT(num_full, 3);
}

// Each row at the reference: gradient and distance of some link to some obstacle, by differences.
TEST_F(ArmWindowTest, HasRowsWhoseGradientsAreThoseOfTheDistance) {
  draw(2, 1);  // one obstacle: the nearest link's row is the least distance
  (void)optimize(whole());
  int num_checked = 0;
  for (const ArmRow<kDof>& row : optimizer_.window->rows()) {
    const Config q = reference_[static_cast<std::size_t>(row.t)].head<kDof>();
    const double distance_m = oracle::brute_clearance(robot_, test_.world, q);
    EXPECT_NEAR(row.gradient.dot(q) - row.bound, row.slack_m, 1e-12);
    if (std::abs(row.slack_m + kMargin_m - distance_m) > 1e-9) continue;  // of another link
    for (int j = 0; j < kDof; ++j) {
      constexpr double kStep_rad = 1e-6;
      const Config step = kStep_rad * Config::Unit(j);
      const double difference = oracle::brute_clearance<kDof>(robot_, test_.world, q + step) -
                                oracle::brute_clearance<kDof>(robot_, test_.world, q - step);
      EXPECT_NEAR(row.gradient[j], difference / (2.0 * kStep_rad), 1e-5);
    }
    ++num_checked;
  }
  EXPECT_GT(num_checked, 5);
}

TEST_F(ArmWindowTest, SkipsWindowsWithNothingToMove) {
  for (int n = 0; n < 3; ++n) {
    EXPECT_EQ(optimize({5, 5 + n}).status, WindowStatus::kTooShort);
  }
  EXPECT_EQ(states_, reference_);
  EXPECT_NE(optimize({5, 8}).status, WindowStatus::kTooShort);
}

TEST_F(ArmWindowTest, LeavesAWindowThatIsTooLongAlone) {
  Optimizer small(settings_with(false, 20));
  EXPECT_EQ(small.optimize(problem(), {0, 21}, Deadline()).status, WindowStatus::kNoRows);
  EXPECT_EQ(states_, reference_);
  EXPECT_NE(small.optimize(problem(), {0, 20}, Deadline()).status, WindowStatus::kNoRows);
}

TEST_F(ArmWindowTest, DoesNotRunAfterItsDeadline) {
  ManualClock clock;
  const Deadline deadline(clock.clock(), -1'000'000'000, 0.5);
  const WindowResult result = optimizer_.optimize(problem(), whole(), deadline);
  EXPECT_EQ(result.status, WindowStatus::kNotRun);
  EXPECT_EQ(states_, reference_);
}

TEST_F(ArmWindowTest, DropsTheFarthestRowsWhenTheyDoNotFit) {
  PlannerSettings settings = settings_with(false);
  std::vector<double> slacks;
  for (std::uint64_t seed = 1; seed <= 20 && slacks.size() <= 30; ++seed) {
    draw(seed);
    (void)optimize(whole());
    slacks.clear();
    for (const ArmRow<kDof>& row : optimizer_.window->rows()) slacks.push_back(row.slack_m);
  }
  ASSERT_GT(slacks.size(), 30u);
  std::sort(slacks.begin(), slacks.end());
  for (const int capacity : {0, 1, 30}) {
    settings.rows_per_window = capacity;
    Optimizer small(settings);
    states_ = reference_;
    const WindowResult result = small.optimize(problem(), whole(), Deadline());
    EXPECT_LE(result.cost_after, result.cost_before);
    const auto rows = small.window->rows();
    ASSERT_EQ(rows.size(), static_cast<std::size_t>(capacity));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      EXPECT_LE(rows[i].slack_m, slacks[rows.size() - 1]);
      EXPECT_LE(rows[i == 0 ? 0 : i - 1].t, rows[i].t);
    }
    expect_valid("few rows");
  }
}

// An obstacle that the reference runs through: rows contradict each other or the limits, and
// whatever the soft solution is, the check refuses what is not clear.
TEST_F(ArmWindowTest, GoesFromHardToSoftToKeepingTheWindow) {
  int num_soft = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    draw(seed, 0);
    const Config middle = reference_[reference_.size() / 2].head<kDof>();
    ArmPose<kDof> pose;
    robot_.forward(middle, pose);
    const Vec3 elbow = robot_.capsule_W(pose, robot_.num_capsules() - 1).p1;
    test_.world.reset();
    for (const double side : {-1.0, 1.0}) {  // two walls that leave less than the margin
      Box3 box;
      box.pose.position = elbow + side * 0.2 * Vec3::UnitZ();
      box.size_m = {0.5, 0.5, 0.3};
      (void)test_.world.try_add(box);
    }
    test_.world.build();
    const Window window{horizon() / 2 - 10, horizon() / 2 + 10};
    const WindowResult result = optimize(window);
    EXPECT_LE(result.cost_after, result.cost_before);
    const int num_solves = static_cast<int>(result.qp_solves);
    EXPECT_LE(num_solves, 3);
    num_soft += num_solves == 3 ? 1 : 0;
    if (result.status != WindowStatus::kMoved) {
      EXPECT_EQ(states_, reference_);
    }
  }
  EXPECT_GT(num_soft, 0);
}

// The way rests at a limit for one step. Rows and bounds hold at waypoints only: the QP's solution
// is at the limit at both of them and swings past it in between, which only the check can see.
TEST_F(ArmWindowTest, TakesNoSolutionThatPassesALimitBetweenWaypoints) {
  test_.world.reset();
  for (const int j : {0, 1, 3, 4}) {  // the third folds the arm into itself
    for (const double side : {-1.0, 1.0}) {
      const double limit = side * (side > 0.0 ? robot_.upper()[j] : robot_.lower()[j]);
      const Config push = side * robot_.a_max()[j] * Config::Unit(j);
      States back = {Robot::State::Unit(j) * (side * limit)};
      for (const double share : {0.3, 0.5}) {
        back.push_back(Robot::step(back.back(), -share * push, kDt_s));
      }
      reference_.assign(back.rbegin(), back.rend());
      for (auto& z : reference_) z.tail<kDof>() *= -1.0;
      reference_.insert(reference_.end(), back.begin(), back.end());
      const auto excess = [&] {
        return oracle::examine(robot_, test_.world, states_, kDt_s, 16).limit_excess;
      };
      states_ = reference_;
      EXPECT_LE(excess(), 1e-12);
      SweepProblem<Robot> problem = this->problem();
      problem.accept = false;
      (void)optimizer_.optimize(problem, {0, horizon()}, Deadline());
      for (const auto& z : states_) EXPECT_LE(side * z[j], limit + 1e-8);
      EXPECT_GT(excess(), 1e-4);
      std::copy(reference_.begin(), reference_.end(), states_.begin());
      problem.accept = true;
      (void)optimizer_.optimize(problem, {0, horizon()}, Deadline());
      EXPECT_LE(excess(), 1e-12) << "joint " << j << ", side " << side;
    }
  }
}

TEST_F(ArmWindowTest, GivesTheSameBytesTwice) {
  (void)optimize(whole());
  const States first = states_;
  states_ = reference_;
  (void)optimize(whole());
  EXPECT_EQ(states_, first);
}

TEST_F(ArmWindowTest, SolvesTheSameWindowWithEitherSolver) {
  Optimizer dense(settings_with(true, 40));
  int num_active = 0;
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    draw(seed);
    const Window window{horizon() / 2 - 18, horizon() / 2 + 18};
    SweepProblem<Robot> problem = this->problem();
    problem.accept = false;  // the solutions as they are, with the same rows
    const WindowResult closed_form = optimizer_.optimize(problem, window, Deadline());
    const States solution = states_;
    states_ = reference_;
    problem.solver = WindowSolver::kDense;
    const WindowResult condensed = dense.optimize(problem, window, Deadline());
    ASSERT_EQ(closed_form.qp_status, condensed.qp_status) << seed;
    EXPECT_EQ(closed_form.status, condensed.status) << seed;
    EXPECT_NEAR(closed_form.cost_after, condensed.cost_after, 1e-7) << seed;
    num_active += condensed.has_active_rows ? 1 : 0;
    for (std::size_t t = 0; t < states_.size(); ++t) {
      EXPECT_LE((solution[t] - states_[t]).cwiseAbs().maxCoeff(), 1e-5) << seed << ' ' << t;
    }
  }
  EXPECT_GT(num_active, 1);
}

TEST_F(ArmWindowTest, TouchesNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "this build cannot count allocations";
  const SweepProblem<Robot> problem = this->problem();
  RtGuard guard;
  const WindowResult result = optimizer_.window->optimize(problem, whole(), Deadline());
  guard.stop();
  EXPECT_EQ(result.status, WindowStatus::kMoved);
  EXPECT_EQ(guard.num_allocations() + guard.num_releases() + guard.num_locks(), 0);
}

}  // namespace
}  // namespace sopt
