// Plans that the planner returns, each spoilt in one way after the other: verify must refuse every
// one with the right reason, and an oracle that shares no geometry with the library must see the
// fault as well. What is not spoilt enough to matter must pass, so that refusing is not a habit.
// Clearance is compared on ten times as many instants as elsewhere.
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <string>

#include "opt/verify/verify.h"
#include "tests/support/arm_cases.h"
#include "tests/support/arm_motion_oracle.h"
#include "tests/support/arm_planner_fixture.h"
#include "tests/support/property.h"

namespace {

using namespace sopt;
using namespace sopt::oracle;

constexpr double kMinClearance_m = 1e-4;
constexpr int kFineSamples = 40;  // per step

template <int N>
class Mutation {
 public:
  Mutation(const Arm<N>& arm, const TestWorld3& test, const PlanRequest<Arm<N>>& request,
           const Trajectory<Arm<N>>& plan, CaseReport& report)
      : arm_(arm),
        problem_{request.start, request.goal, &test.world, kMinClearance_m, 0.0},
        report_(report),
        copy_(request.start, {plan.inputs.begin(), plan.inputs.end()}, plan.dt_s),
        plan_(copy_.trajectory) {
    // To the bit: what was added up again is not.
    (void)plan_.states.try_assign(plan.states.span());
  }

  Trajectory<Arm<N>>& plan() { return plan_; }
  VerifyProblem<Arm<N>>& problem() { return problem_; }

  void expect(const char* what, std::initializer_list<ViolationKind> kinds, const char* fault) {
    expect(what, arm_, kinds, fault);
  }
  // Refused as one of `kinds`, and for `fault` by the oracle; empty: one that it does not look for.
  void expect(const char* what, const Arm<N>& arm, std::initializer_list<ViolationKind> kinds,
              const char* fault) {
    const VerifyResult<Arm<N>> result = verify(arm, plan_, problem_);
    bool is_expected = false;
    for (const ViolationKind kind : kinds) is_expected |= result.violation.kind == kind;
    if (!is_expected || result.plan.has_value()) {
      report_.fail(std::string(what) + ": verify says " +
                   std::to_string(static_cast<int>(result.violation.kind)));
    }
    if (std::strlen(fault) == 0) return;
    const PlanFacts facts =
        examine_plan(arm, *problem_.world, plan_, problem_.start, problem_.goal, 1);
    const char* const found = find_fault(facts, problem_.min_clearance_m);
    if (std::strcmp(found, fault) != 0) {
      report_.fail(std::string(what) + ": the oracle says it " + found);
    }
  }
  void expect_accepted(const char* what, const Arm<N>& arm) {
    const VerifyResult<Arm<N>> result = verify(arm, plan_, problem_);
    report_.expect(what, result.plan.has_value());
  }

 private:
  const Arm<N>& arm_;
  VerifyProblem<Arm<N>> problem_;
  CaseReport& report_;
  ArmTrajectory<N> copy_;
  Trajectory<Arm<N>>& plan_;
};

template <int N, class Spoil>
void spoil_numbers(Random& random, const Arm<N>& arm, Spoil&& make) {
  using Kind = ViolationKind;
  const auto with = [&](auto&& change) {
    Mutation<N> mutation = make();
    const int t = random.index(mutation.plan().horizon());
    change(mutation, t, random.index(N), random.chance(0.5) ? 1.0 : -1.0);
  };
  with([](auto& m, int t, int j, double side) {
    m.plan().states[t][j] += side * 1e-4;
    m.expect("a waypoint moved", {t == 0 ? Kind::kStart : Kind::kDynamics},
             t == 0 ? "begins elsewhere" : "breaks its dynamics");
  });
  with([](auto& m, int t, int j, double side) {
    m.plan().states[t][N + j] += side * 1e-4;
    m.expect("a velocity changed", {t == 0 ? Kind::kNotAtRest : Kind::kDynamics},
             t == 0 ? "is not at rest at its ends" : "breaks its dynamics");
  });
  with([](auto& m, int t, int j, double side) {
    m.plan().inputs[t][j] += side * 1e-6 / m.plan().dt_s;
    m.expect("an input changed", {Kind::kDynamics, Kind::kAcceleration}, "breaks its dynamics");
  });
  with([](auto& m, int, int j, double side) {
    m.problem().goal[j] += side * 1e-6;
    m.expect("the goal shifted", {Kind::kGoal}, "ends elsewhere");
  });
  with([](auto& m, int, int j, double side) {
    m.problem().start[j] += side * 1e-9;
    m.expect("the start shifted", {Kind::kStart}, "begins elsewhere");
  });
  with([](auto& m, int t, int j, double) {
    m.plan().inputs[t][j] = std::numeric_limits<double>::quiet_NaN();
    m.expect("not a number", {Kind::kNotFinite}, "is no trajectory");
  });
  with([](auto& m, int, int, double) {
    (void)m.plan().inputs.try_resize(m.plan().inputs.size() - 1);
    m.expect("an input missing", {Kind::kShape}, "is no trajectory");
  });
  // The same way in less time: 1 % above the first limit that is reached, then 1 % below.
  with([&](auto& m, int, int, double) {
    Trajectory<Arm<N>>& plan = m.plan();
    double share = 0.0;  // of the limits
    for (const auto& z : plan.states) {
      share =
          std::max(share, (z.template tail<N>().cwiseAbs().cwiseQuotient(arm.v_max())).maxCoeff());
    }
    for (const auto& u : plan.inputs) {
      share = std::max(share, std::sqrt(u.cwiseAbs().cwiseQuotient(arm.a_max()).maxCoeff()));
    }
    if (share == 0.0) return;
    const auto speed_up = [&](double factor) {
      plan.dt_s /= factor;
      for (auto& z : plan.states) z.template tail<N>() *= factor;
      for (auto& u : plan.inputs) u *= factor * factor;
    };
    speed_up(0.99 / share);
    m.expect_accepted("just within the limits", arm);
    speed_up(1.01 / 0.99);
    m.expect("too fast", {Kind::kVelocity, Kind::kAcceleration}, "breaks a limit");
  });
}

// A joint's limit drawn in to where the plan goes, then a little further.
template <int N>
void spoil_limits(Random& random, const RandomArm<N>& drawn, std::span<const BodyPair> pairs,
                  Mutation<N>& mutation, CaseReport& report) {
  const int j = random.index(N);
  double reached = -std::numeric_limits<double>::infinity();
  for (const auto& z : mutation.plan().states) reached = std::max(reached, z[j]);
  if (drawn.arm.is_continuous(j) || reached - drawn.arm.lower()[j] < 1e-3) return;
  RandomArm<N> tight = drawn;
  tight.description.capsules = tight.capsules;
  tight.description.pairs = pairs;
  tight.description.joints[static_cast<std::size_t>(j)].upper = reached - 1e-6;
  report.expect("the tight arm is taken", tight.arm.reset(tight.description) == ArmStatus::kOk);
  mutation.expect("beyond a limit", tight.arm, {ViolationKind::kPosition}, "breaks a limit");
}

// A ball beside a link somewhere on the way: too close by a little, or just not.
template <int N>
void spoil_world(Random& random, const Arm<N>& arm, Mutation<N>& mutation, TestWorld3& test,
                 CaseReport& report) {
  const Trajectory<Arm<N>>& plan = mutation.plan();
  const auto q = configuration_at<N>(plan, random.uniform(0.0, plan.duration_s()));
  const std::vector<Capsule3> capsules = PlainArm<N>(arm).capsules_at(q);
  const Capsule3& c = capsules[static_cast<std::size_t>(1 + random.index(N))];
  const Vec3 along = (c.p1 - c.p0).normalized();
  Vec3 away = along.unitOrthogonal();
  away = rotation_about(along, random.uniform(0.0, 6.28)) * away;
  const double radius_m = random.uniform(0.01, 0.1);
  const double gap_m = kMinClearance_m + (random.chance(0.5) ? -1.0 : 1.0) *
                                             std::pow(10.0, random.uniform(-5.0, -2.0));
  const Vec3 middle =
      c.p0 + random.uniform(0.0, 1.0) * (c.p1 - c.p0) + (c.radius_m + radius_m + gap_m) * away;
  if (test.world.try_add(Sphere3{middle, radius_m}) != WorldStatus::kOk) {
    return report.fail("a ball is refused");
  }
  test.world.build();
  const VerifyProblem<Arm<N>>& problem = mutation.problem();
  const PlanFacts facts =
      examine_plan(arm, test.world, plan, problem.start, problem.goal, kFineSamples);
  const VerifyResult<Arm<N>> result = verify(arm, plan, problem);
  if (result.plan.has_value()) {
    report.expect_within("accepts only what is clear", kMinClearance_m - facts.clearance_m, 1e-9);
  } else {
    const bool is_hit = result.violation.kind == ViolationKind::kCollision ||
                        result.violation.kind == ViolationKind::kSecondOpinion;
    report.expect("refuses for the ball", is_hit);
    report.expect("refuses only what is near", facts.clearance_m < kMinClearance_m + 1e-3);
  }
  if (gap_m < kMinClearance_m - 1e-9) report.expect("a link in the ball", !result.plan.has_value());
}

template <int N>
void spoil_self_clearance(const Arm<N>& arm, Mutation<N>& mutation, CaseReport& report) {
  const VerifyResult<Arm<N>> whole = verify(arm, mutation.plan(), mutation.problem());
  if (!whole.plan.has_value()) return report.fail("the plan is refused");
  const double certified_m = whole.plan->certificate().min_self_clearance_m;
  if (std::isinf(certified_m)) return;
  mutation.problem().min_self_clearance_m = certified_m * 1.02 + 3e-3;
  mutation.expect("links too close", {ViolationKind::kSelfCollision, ViolationKind::kSecondOpinion},
                  "");
  mutation.problem().min_self_clearance_m = std::max(0.0, certified_m * 0.98 - 2e-3);
  mutation.expect_accepted("links far enough apart", arm);
}

template <int N>
std::string check_chain(Random& random, CaseReport& report) {
  const RandomArm<N>& drawn = random_chain<N>(random, report);
  const Arm<N>& arm = drawn.arm;
  TestWorld3 test({16, 16});
  scatter_obstacles(random, arm, random.index(6), test.world);
  PlanRequest<Arm<N>> request;
  request.world = &test.world;
  request.options = PlanOptions::arm();
  request.options.min_clearance_m = kMinClearance_m;
  request.options.num_samples = 1000;
  request.options.num_batches = 1;
  for (auto* end : {&request.start, &request.goal}) {
    draw_free(random, arm, test.world, {0.0, 0.0, 1e-3}, 1e-3, 100, *end);
  }
  TestArmPlanner<N> test_planner(arm);
  const PlanResult<Arm<N>> result = test_planner.planner.plan(request);
  if (!result.plan) return "no plan";
  const auto make = [&] {
    return Mutation<N>(arm, test, request, result.plan->trajectory(), report);
  };
  make().expect_accepted("what is not spoilt", arm);
  spoil_numbers(random, arm, make);
  const LinkPairList pairs = find_pairs_apart(arm);
  Mutation<N> whole = make();
  spoil_limits(random, drawn, pairs.view(), whole, report);
  spoil_self_clearance(arm, whole, report);
  Mutation<N> crowded = make();
  spoil_world(random, arm, crowded, test, report);
  return std::to_string(N) + " joints, horizon " +
         std::to_string(result.plan->trajectory().horizon());
}

std::string check_case(Random& random, CaseReport& report) {
  return with_joints(4 + random.index(5), [&](auto n) { return check_chain<n>(random, report); });
}

}  // namespace

int main(int argc, char** argv) { return run_property("arm_mutation", argc, argv, check_case); }
