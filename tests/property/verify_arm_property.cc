// verify for arms against dense sampling: presets and random chains of 4 to 8 joints, all joint
// kinds, worlds of all shapes, random exact motions. It must accept no motion that the oracle sees
// below the hard minimum, accept all that stay 1 mm above it, keep the certificate's promises, and
// find planted defects.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "opt/verify/verify.h"
#include "tests/support/arm_cases.h"
#include "tests/support/arm_motion_oracle.h"
#include "tests/support/property.h"
#include "tests/support/test_arm.h"

namespace {

using namespace sopt;
using namespace sopt::oracle;

constexpr double kTol_m = 1e-9;
constexpr double kSureClear_m = 1e-3;
constexpr int kSamplesPerStep = 10;

template <int N>
double self_minimum_of(RandomArm<N>& drawn, const Trajectory<Arm<N>>& motion,
                       std::span<const BodyPair> pairs) {
  drawn.description.pairs = pairs;
  if (drawn.arm.reset(drawn.description) != ArmStatus::kOk) return -1.0;
  return self_minimum(drawn.arm, motion, 2).clearance_m;
}

// Fewer and thinner capsules than draw_arm gives, so that there is room for motion.
template <int N>
bool thin_out(RandomArm<N>& drawn) {
  drawn.capsules.resize(static_cast<std::size_t>(N + 2));
  for (LinkCapsule& capsule : drawn.capsules) capsule.radius_m *= 0.4;
  drawn.description.capsules = drawn.capsules;
  return drawn.arm.reset(drawn.description) == ArmStatus::kOk;
}

template <int N>
std::vector<BodyPair> draw_pairs(Random& random, RandomArm<N>& drawn,
                                 const Trajectory<Arm<N>>& motion) {
  std::vector<BodyPair> pairs;
  const bool keep_clear = random.chance(0.8);
  for (int i = random.index(8); i > 0; --i) {
    const int a = random.index(N);
    const BodyPair pair{a, a + 1 + random.index(N - a)};
    if (keep_clear && self_minimum_of(drawn, motion, {&pair, 1}) < 0.01) continue;
    pairs.push_back(pair);
  }
  return pairs;
}

template <int N>
void fill_world(Random& random, const Arm<N>& arm, const Trajectory<Arm<N>>& motion,
                World3& world) {
  const bool keep_clear = random.chance(0.8);
  const int num = random.index(8);
  for (int i = 0; i < num; ++i) {
    const auto kind = static_cast<SolidKind>(random.index(kNumSolidKinds));
    const Solid solid = random_solid(random, kind, random.uniform(0.5, 2.5), random.chance(0.3));
    HullData hull;
    Convex3 shape;
    if (!try_make(solid, hull, shape)) continue;
    const Convex3* one[] = {&shape};
    if (keep_clear && obstacle_minimum(arm, motion, one, 1).clearance_m < 0.0) continue;
    (void)add_to(world, solid);
  }
  world.build();
}

// Breaks the plan; the kind that must be found, if nothing comes before it.
template <int N>
ViolationKind plant(Random& random, const Arm<N>& arm, Trajectory<Arm<N>>& motion,
                    VerifyProblem<Arm<N>>& problem) {
  const int t = random.index(motion.horizon());
  const int j = random.index(N);
  switch (random.index(7)) {
    case 0:
      problem.start[j] += 1e-7;
      return ViolationKind::kStart;
    case 1:
      problem.goal[j] -= 1e-7;
      return ViolationKind::kGoal;
    case 2:
      motion.states[t + 1][j] += 3e-9;  // of the last state the goal is wrong, too
      return t + 1 == motion.horizon() ? ViolationKind::kGoal : ViolationKind::kDynamics;
    case 3:
      motion.inputs[t][j] += 3e-9 / motion.dt_s;
      return ViolationKind::kDynamics;
    case 4:
      motion.states[t][N + j] = std::numeric_limits<double>::quiet_NaN();
      return ViolationKind::kNotFinite;
    case 5:
      motion.inputs[t][j] = 1.01 * arm.a_max()[j];
      return ViolationKind::kAcceleration;
    default:
      motion.states[0][N + j] = 1e-8;
      return ViolationKind::kNotAtRest;
  }
}

void check_promise(const char* what, double certified_m, double expected_m, CaseReport& report) {
  if (std::isinf(expected_m)) return report.expect(what, std::isinf(certified_m));
  const double promise_m = std::max(1e-3, 0.01 * std::abs(expected_m));
  report.expect_within(what, certified_m - expected_m, kTol_m);
  report.expect_within(what, expected_m - certified_m, promise_m);
}

template <int N>
void check_certificate(const Arm<N>& arm, const Trajectory<Arm<N>>& motion,
                       std::span<const Convex3* const> obstacles, const Certificate& certificate,
                       double obstacle_m, double self_m, CaseReport& report) {
  check_promise("certified clearance", certificate.min_clearance_m, obstacle_m, report);
  check_promise("certified self clearance", certificate.min_self_clearance_m, self_m, report);
  report.expect("limits hold", certificate.worst_limit_margin >= -1e-9);
  if (!std::isinf(obstacle_m)) {
    const auto q = configuration_at<N>(motion, certificate.where_t_s);
    const MotionMinimum there = obstacle_clearance(arm, q, obstacles);
    report.expect_within("clearance where the certificate says it is",
                         there.clearance_m - certificate.min_clearance_m,
                         std::max(1e-3, 0.01 * std::abs(obstacle_m)) + 1e-6);
  }
  if (!std::isinf(self_m)) {
    const auto q = configuration_at<N>(motion, certificate.self_where_t_s);
    const MotionMinimum there = self_clearance(arm, q);
    report.expect_within("self clearance where the certificate says it is",
                         there.clearance_m - certificate.min_self_clearance_m,
                         std::max(1e-3, 0.01 * std::abs(self_m)) + 1e-6);
  }
}

template <int N>
void check_rejected(const Arm<N>& arm, const Trajectory<Arm<N>>& motion,
                    std::span<const Convex3* const> obstacles, const VerifyProblem<Arm<N>>& problem,
                    const Violation& found, double obstacle_m, double self_m, CaseReport& report) {
  report.expect("accepts what is clear", obstacle_m < problem.min_clearance_m + kSureClear_m ||
                                             self_m < problem.min_self_clearance_m + kSureClear_m);
  report.expect("the step holds the time", found.t_s >= found.step * motion.dt_s - 1e-12 &&
                                               found.t_s <= (found.step + 1) * motion.dt_s + 1e-12);
  const auto q = configuration_at<N>(motion, found.t_s);
  if (found.kind == ViolationKind::kCollision) {
    const Convex3* hit[] = {obstacles[static_cast<std::size_t>(found.i_obstacle)]};
    report.expect_within("the named obstacle is hit there",
                         obstacle_clearance(arm, q, hit).clearance_m - problem.min_clearance_m,
                         1e-4);
  } else if (found.kind == ViolationKind::kSelfCollision) {
    report.expect_within("links collide there",
                         self_clearance(arm, q).clearance_m - problem.min_self_clearance_m, 1e-4);
  } else {
    report.expect("nothing else is wrong", found.kind == ViolationKind::kSecondOpinion);
  }
}

template <int N>
std::string check_arm(Random& random, const Arm<N>& arm, ArmTrajectory<N>& test,
                      CaseReport& report) {
  static constexpr double kMinClearances_m[] = {0.0, 1e-4, 0.01};
  TestWorld3 scene({16, 16});
  const World3& world = scene.world;
  fill_world(random, arm, test.trajectory, scene.world);
  std::vector<const Convex3*> obstacles;
  for (int i = 0; i < world.num_obstacles(); ++i) obstacles.push_back(&world.obstacle(i));
  VerifyProblem<Arm<N>> problem{test.start(), test.goal(), &world,
                                kMinClearances_m[random.index(3)], 0.0};
  const bool is_planted = random.chance(0.2);
  const ViolationKind planted =
      is_planted ? plant(random, arm, test.trajectory, problem) : ViolationKind::kNone;
  const VerifyResult<Arm<N>> result = verify(arm, test.trajectory, problem);
  const ViolationKind kind = result.violation.kind;
  report.expect("a plan exactly when nothing is wrong",
                result.plan.has_value() == (kind == ViolationKind::kNone));
  if (is_planted) {
    const bool is_earlier =
        kind == ViolationKind::kCollision || kind == ViolationKind::kSelfCollision ||
        kind == ViolationKind::kSecondOpinion || kind == ViolationKind::kDynamics;
    report.expect("finds the planted defect", kind == planted || is_earlier);
  } else {
    const double obstacle_m =
        obstacle_minimum<N>(arm, test.trajectory, obstacles, kSamplesPerStep).clearance_m;
    const double self_m = self_minimum(arm, test.trajectory, kSamplesPerStep).clearance_m;
    if (result.plan.has_value()) {
      report.expect("accepts only what is clear",
                    obstacle_m >= problem.min_clearance_m - kTol_m && self_m >= -kTol_m);
      check_certificate<N>(arm, test.trajectory, obstacles, result.plan->certificate(), obstacle_m,
                           self_m, report);
    } else {
      check_rejected<N>(arm, test.trajectory, obstacles, problem, result.violation, obstacle_m,
                        self_m, report);
    }
  }
  return std::to_string(N) + " joints, " + std::to_string(obstacles.size()) +
         " obstacles, horizon " + std::to_string(test.trajectory.horizon()) + ", violation " +
         std::to_string(static_cast<int>(kind)) + " at " + std::to_string(result.violation.t_s);
}

template <int N>
std::string check_chain(Random& random, CaseReport& report) {
  static RandomArm<N> drawn;
  draw_arm(random, drawn);
  drawn.description.pairs = {};
  report.expect("a valid arm is taken", thin_out(drawn));
  ArmTrajectory<N> test =
      random_motion(random, drawn.arm, 1 + random.index(24), random.uniform(0.02, 0.15));
  const std::vector<BodyPair> pairs = draw_pairs(random, drawn, test.trajectory);
  drawn.description.pairs = pairs;
  report.expect("a valid arm is taken", drawn.arm.reset(drawn.description) == ArmStatus::kOk);
  return check_arm(random, drawn.arm, test, report);
}

std::string check_case(Random& random, CaseReport& report) {
  const int num_joints = 4 + random.index(6);
  if (num_joints <= 8) {
    return with_joints(num_joints, [&](auto n) { return check_chain<n>(random, report); });
  }
  const Arm<5>& arm = random_preset(random);
  ArmTrajectory<5> test = random_motion(random, arm, 1 + random.index(40), 0.05);
  return check_arm(random, arm, test, report);
}

}  // namespace

int main(int argc, char** argv) { return run_property("verify_arm", argc, argv, check_case); }
