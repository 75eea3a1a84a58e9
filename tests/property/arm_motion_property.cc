// Random arms of 4 to 8 joints, all joint kinds, and random motions near random obstacles: a motion
// that is said to be clear keeps the rule's floor and its links apart, found by samples refined
// around the least distance; one that is said to be blocked does come closer than the rule asks for
// somewhere; lanes never call clear what the exact check does not.
#include "models/arm/arm_clearance.h"
#include "models/arm/arm_motion.h"
#include "tests/support/arm_cases.h"
#include "tests/support/property.h"
#include "tests/support/test_arm.h"

namespace {

using namespace sopt;
using namespace sopt::oracle;

// The least value over [0, 1]: samples, then more of them around the lowest.
template <class F>
double least_on_motion(F&& value) {
  constexpr int kSamples = 80;
  double least = std::numeric_limits<double>::infinity();
  double at = 0.0;
  const auto look = [&](double s) {
    const double v = value(std::clamp(s, 0.0, 1.0));
    if (v < least) {
      least = v;
      at = s;
    }
  };
  for (int i = 0; i <= kSamples; ++i) look(static_cast<double>(i) / kSamples);
  double width = 1.0 / kSamples;
  for (int round = 0; round < 4; ++round, width /= 4.0) {
    const double middle = at;
    for (int i = -4; i <= 4; ++i) look(middle + 0.25 * width * i);
  }
  return least;
}

template <int N>
std::string check_arm(Random& random, CaseReport& report) {
  RandomArm<N> drawn;
  draw_arm(random, drawn);
  std::vector<BodyPair> pairs;
  for (int i = 0; i < 2; ++i) {
    const int link = random.index(N);
    pairs.push_back({link, link + 1 + random.index(N - link)});
  }
  if (random.chance(0.5)) drawn.description.pairs = pairs;
  if (drawn.arm.reset(drawn.description) != ArmStatus::kOk) report.fail("the arm is refused");
  const Arm<N>& arm = drawn.arm;
  const auto a = random_configuration(random, arm);
  const auto to = random_configuration(random, arm);
  const typename Arm<N>::Config b = arm.interpolate(a, to, random.uniform(0.0, 0.3));
  TestWorld3 test({32, 32});
  const int num = random.chance(0.2) ? 20 : 3;
  for (int i = 0; i < num; ++i) {
    // Beside a capsule on the way.
    ArmPose<N> pose;
    arm.forward(arm.interpolate(a, b, random.uniform(0.0, 1.0)), pose);
    const Capsule3 capsule = arm.capsule_W(pose, random.index(arm.num_capsules()));
    const Vec3 center = capsule.p0 + random_vector(random, num > 3 ? 2.5 : 0.8);
    if (add_to(test.world, random_obstacle(random, center),
               random.chance(0.7) ? kDefaultMargin : random.uniform(0.0, 0.05)) !=
        WorldStatus::kOk) {
      report.fail("an obstacle is refused");
    }
  }
  test.world.build();
  ClearanceRule rule{random.chance(0.5) ? 0.02 : random.uniform(0.0, 0.03), 1.0,
                     random.chance(0.5) ? 1e-4 : random.uniform(0.0, 5e-3)};
  if (random.chance(0.2)) rule.cap_m = random.uniform(0.5, 2.0) * rule.floor_m;
  const ClearanceRule floor{0.0, 0.0, rule.floor_m};
  const auto at = [&](double s) { return arm.interpolate(a, b, s); };
  const bool clear = motion_is_clear(arm, test.world, rule, kSelfClearance_m, a, b);
  const double floor_m =
      least_on_motion([&](double s) { return least_excess(arm, test.world, at(s), floor); });
  const double self_m = least_on_motion([&](double s) { return least_self_distance(arm, at(s)); });
  if (clear) {
    report.expect_within("obstacles nearer than the floor", -floor_m, 1e-9);
    report.expect_within("links that touch", -self_m, 1e-9);
  } else {
    constexpr double kPad_m = 1e-3;
    const double excess_m =
        least_on_motion([&](double s) { return least_excess(arm, test.world, at(s), rule); });
    report.expect("blocked only by what is near", excess_m < kPad_m || self_m < kPad_m);
  }
  for (const double s : {0.0, 0.5, 1.0}) {
    ArmPose<N> pose;
    arm.forward(at(s), pose);
    ClearanceRule raised = rule;
    raised.floor_m += 1e-4;  // more than is added to a floor
    raised.cap_m = std::max(rule.cap_m, raised.floor_m);
    const bool is_clear_there = is_clear(arm, test.world, pose, raised, kSelfClearance_m);
    const bool stays = motion_is_clear(arm, test.world, rule, kSelfClearance_m, at(s), at(s));
    report.expect("a motion that stays where it is clear is clear", !is_clear_there || stays);
    report.expect("a motion that stays where it is not clear is not",
                  !stays || is_clear(arm, test.world, pose, rule, kSelfClearance_m));
  }
  return std::to_string(N) + " joints, " + std::to_string(num) + " obstacles, " +
         (clear ? "clear" : "blocked");
}

std::string check(Random& random, CaseReport& report) {
  return with_joints(4 + random.index(5), [&](auto n) { return check_arm<n>(random, report); });
}

}  // namespace

int main(int argc, char** argv) { return run_property("arm_motion", argc, argv, check); }
