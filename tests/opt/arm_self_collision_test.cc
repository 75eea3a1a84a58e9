// Arms that are in their own way, in an empty world: the straight motion between two configurations
// would have links hit each other. The planner goes round, the optimiser has rows between links and
// leans on them, verify certifies how far apart links stay; an oracle of its own agrees.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "opt/arm/arm_window.h"
#include "tests/support/arm_planner_fixture.h"
#include "tests/support/test_problem.h"

namespace sopt::oracle {
namespace {

// Links are apart at both ends and overlap on the straight motion between them.
template <int N>
bool draw_ends(Random& random, const Arm<N>& arm, typename Arm<N>::Config& start,
               typename Arm<N>::Config& goal) {
  constexpr double kApart_m = 0.01;
  const PlainArm<N> plain(arm);
  for (int i = 0; i < 300; ++i) {
    start = random_configuration(random, arm);
    goal = random_configuration(random, arm);
    if (plain.self_clearance_m(start) < kApart_m || plain.self_clearance_m(goal) < kApart_m) {
      continue;
    }
    for (int k = 1; k < 50; ++k) {
      if (plain.self_clearance_m(arm.interpolate(start, goal, k / 50.0)) < -kApart_m) return true;
    }
  }
  return false;
}

// The arm with more capsules and other pairs.
template <int N>
Arm<N> rebuilt(const Arm<N>& arm, std::vector<LinkCapsule> capsules,
               std::span<const BodyPair> pairs) {
  ArmDescription<N> description;
  ArmPose<N> pose;
  arm.forward(Arm<N>::Config::Zero(), pose);
  description.X_WB = arm.kinematics().X_WB;
  for (int j = 0; j < N; ++j) description.joints[static_cast<std::size_t>(j)] = arm.joint(j);
  for (int i = 0; i < arm.num_capsules(); ++i) {
    const Capsule3 c = arm.capsule_W(pose, i);
    const Pose3 X = arm.link_pose(pose, arm.capsule_link(i));
    const auto to_link = [&](const Vec3& p) -> Vec3 {
      return X.rotation.transpose() * (p - X.position);
    };
    capsules.push_back({arm.capsule_link(i), to_link(c.p0), to_link(c.p1), c.radius_m});
  }
  description.capsules = capsules;
  description.pairs = pairs;
  Arm<N> out;
  EXPECT_EQ(out.reset(description), ArmStatus::kOk);
  return out;
}

// Links free to pass through each other.
template <int N>
Arm<N> without_pairs(const Arm<N>& arm) {
  return rebuilt(arm, {}, {});
}

// The LR Mate with a post on its base, which its arm passes folded or not at all.
Arm<5> arm_with_a_post() {
  const BodyPair pairs[] = {{0, 2}, {0, 3}, {0, 4}, {1, 3}, {1, 4}};
  return rebuilt(lr_mate_200id_7l(), {{0, {0.4, 0.0, 0.0}, {0.4, 0.0, 0.9}, 0.05}}, pairs);
}

template <int N>
class SelfCollision {
 public:
  explicit SelfCollision(const Arm<N>& arm) : arm_(arm), test_planner_(arm) {
    test_.world.build();
    request_.world = &test_.world;
    request_.options = PlanOptions::arm();
    request_.options.num_batches = 1;
  }

  // Draws a request and plans it; true when there is a plan, which is then as it must be.
  bool plans(Random& random) {
    if (!draw_ends(random, arm_, request_.start, request_.goal)) return false;
    const PlanResult<Arm<N>> result = test_planner_.planner.plan(request_);
    if (result.status == PlanStatus::kNoPath) {
      EXPECT_EQ(result.failure.stage, PlanStage::kSample);
      return false;
    }
    expect_valid(arm_, request_, result);
    EXPECT_FALSE(result.fell_back);
    EXPECT_GT(result.path_length, arm_.path_distance(request_.start, request_.goal));
    expect_certified(result);
    return true;
  }

  void expect_certified(const PlanResult<Arm<N>>& result) {
    if (!result.plan) return;
    const Certificate& certificate = result.plan->certificate();
    const double found_m = examine_plan(arm_, test_.world, result.plan->trajectory(),
                                        request_.start, request_.goal, 20)
                               .self_clearance_m;
    EXPECT_GE(certificate.min_self_clearance_m, 0.0);
    EXPECT_LE(certificate.min_self_clearance_m, found_m + 1e-9);
    EXPECT_GE(certificate.min_self_clearance_m, found_m - 2e-3);
    EXPECT_GT(certificate.i_self_link, certificate.i_other_link);
    EXPECT_GE(certificate.i_other_link, 0);
    EXPECT_EQ(certificate.min_clearance_m, std::numeric_limits<double>::infinity());
  }

  // Planned by an arm that does not see itself, a plan hits itself and verify says so.
  void expect_blind_plan_refused() {
    const Arm<N> blind = without_pairs(arm_);
    TestArmPlanner<N> blind_planner(blind);
    const PlanResult<Arm<N>> result = blind_planner.planner.plan(request_);
    ASSERT_EQ(result.status, PlanStatus::kOk);
    const Trajectory<Arm<N>>& plan = result.plan->trajectory();
    const PlanFacts facts = examine_plan(arm_, test_.world, plan, request_.start, request_.goal);
    ASSERT_STREQ(find_fault(facts, 1e-4), "hits itself");
    const VerifyResult<Arm<N>> verified =
        verify(arm_, plan, {request_.start, request_.goal, &test_.world});
    EXPECT_EQ(verified.violation.kind, ViolationKind::kSelfCollision);
    EXPECT_EQ(verified.violation.i_obstacle, kSelfObstacle);
    EXPECT_LT(verified.violation.i_other_link, verified.violation.i_link);
    EXPECT_LT(verified.violation.amount, 0.0);
  }

  Arm<N> arm_;
  TestWorld3 test_;
  PlanRequest<Arm<N>> request_;
  TestArmPlanner<N> test_planner_;
};

TEST(ArmSelfCollision, IsPlannedRoundAPostOfTheBase) {
  SelfCollision<5> test(arm_with_a_post());
  Random random(11);
  for (int i = 0; i < 15; ++i) {
    EXPECT_TRUE(test.plans(random)) << i;
    test.expect_blind_plan_refused();
  }
}

template <int N>
void expect_chains_plan_round() {
  SCOPED_TRACE(N);
  Random random(60 + N);
  int num_planned = 0;
  for (int i = 0; i < 60 && num_planned < 4; ++i) {
    RandomArm<N> drawn;
    ASSERT_TRUE(draw_chain(random, drawn));
    SelfCollision<N> test(drawn.arm);
    test.request_.options.num_samples = 4000;
    if (!test.plans(random)) continue;
    ++num_planned;
    test.expect_blind_plan_refused();
  }
  EXPECT_EQ(num_planned, 4);
}

TEST(ArmSelfCollision, IsPlannedRoundByFourToEightJoints) {
  expect_chains_plan_round<4>();
  expect_chains_plan_round<5>();
  expect_chains_plan_round<6>();
  expect_chains_plan_round<7>();
  expect_chains_plan_round<8>();
}

// --- rows between links

class SelfRows : public testing::Test {
 protected:
  using Robot = Arm<5>;
  using States = std::vector<Robot::State>;

  struct Optimizer {
    PlannerSettings settings = PlannerSettings::arm();
    InArena<WindowOptimizer<Robot>::Shared> shared{settings};
    InArena<WindowOptimizer<Robot>> window{settings, *shared};
  };

  void SetUp() override { test_.world.build(); }

  void use(const Robot& robot) {
    robot_ = robot;
    plain_ = PlainArm<5>(robot);
  }
  // The reference along a sampled path, which turns sharply.
  bool draw(Random& random) {
    SelfCollision<5> test(robot_);
    test.request_.options.max_iterations = 0;
    test.request_.options.resampling = Resampling::kOff;
    if (!draw_ends(random, robot_, test.request_.start, test.request_.goal)) return false;
    const PlanResult<Robot> result = test.test_planner_.planner.plan(test.request_);
    if (!result.plan) return false;
    const Trajectory<Robot>& plan = result.plan->trajectory();
    states_ = {plan.states.begin(), plan.states.end()};
    return plan.horizon() <= optimizer_.settings.max_window;
  }
  WindowResult optimize(const Robot& robot) {
    SweepProblem<Robot> problem;
    problem.robot = &robot;
    problem.world = &test_.world;
    problem.profile.rule = {0.02, 1.0, 1e-4 + 1e-8};
    problem.trust_m = kArmActivation_m;
    problem.ds_m = PlanOptions::arm().dt_s;
    problem.states = states_;
    problem.dt_s = PlanOptions::arm().dt_s;
    problem.min_clearance_m = 1e-4;
    return optimizer_.window->optimize(problem, {0, static_cast<int>(states_.size()) - 1},
                                       Deadline());
  }
  double self_clearance_m(int t) const {
    return plain_.self_clearance_m(states_[static_cast<std::size_t>(t)].head<5>());
  }

  // By differences; the number of joints compared, none when another pair is nearer.
  int check_gradient(const ArmRow<5>& row) const {
    constexpr double kStep = 1e-6;
    const Robot::Config q = states_[static_cast<std::size_t>(row.t)].head<5>();
    const double known_m = row.slack_m + kSelfRow_m;
    if (std::abs(self_clearance_m(row.t) - known_m) > 1e-9) return 0;
    int num_checked = 0;
    for (int j = 0; j < 5; ++j) {
      const Robot::Config step = kStep * Robot::Config::Unit(j);
      const double ahead = plain_.self_clearance_m(q + step) - known_m;
      const double behind = known_m - plain_.self_clearance_m(q - step);
      if (std::abs(ahead - behind) > 1e-4 * kStep) continue;  // where nearest points jump
      EXPECT_NEAR(row.gradient[j], 0.5 * (ahead + behind) / kStep, 1e-4);
      ++num_checked;
    }
    return num_checked;
  }

  Robot robot_ = arm_with_a_post();
  PlainArm<5> plain_{robot_};
  TestWorld3 test_;
  Optimizer optimizer_;
  States states_;
};

TEST_F(SelfRows, HoldASolutionThatWouldHitItselfWithoutThem) {
  const Robot bare = without_pairs(robot_);
  Random random(3);
  int num_held = 0;
  for (int i = 0; i < 12; ++i) {
    if (!draw(random)) continue;
    const States reference = states_;
    const WindowResult held = optimize(robot_);
    if (optimizer_.window->rows().empty()) continue;
    EXPECT_LE(held.cost_after, held.cost_before);
    double least_m = std::numeric_limits<double>::infinity();
    for (int t = 0; t < static_cast<int>(states_.size()); ++t) {
      least_m = std::min(least_m, self_clearance_m(t));
    }
    EXPECT_GE(least_m, kSelfClearance_m - 1e-9);
    if (!held.has_active_rows) continue;
    states_ = reference;
    const WindowResult passed = optimize(bare);
    EXPECT_EQ(optimizer_.window->rows().size(), 0U);
    EXPECT_FALSE(passed.has_active_rows);
    EXPECT_LT(passed.cost_after, held.cost_after);
    ++num_held;
  }
  EXPECT_GT(num_held, 3);
}

TEST_F(SelfRows, HaveTheGradientsOfTheDistanceOfTheirLinks) {
  Random random(3);
  int num_checked = 0;
  // With links of any two; a chain at a time, the post at first.
  for (int i = 0; i < 40; ++i) {
    RandomArm<5> drawn;
    ASSERT_TRUE(draw_chain(random, drawn));
    if (i > 3) use(drawn.arm);
    if (i == 4) {
      EXPECT_GT(num_checked, 50);
    }
    if (!draw(random)) continue;
    const States reference = states_;
    (void)optimize(robot_);
    states_ = reference;
    for (const ArmRow<5>& row : optimizer_.window->rows()) num_checked += check_gradient(row);
  }
  EXPECT_GT(num_checked, 500);
}

}  // namespace
}  // namespace sopt::oracle
