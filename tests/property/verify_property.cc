// verify against brute force: random scenes, wandering trajectories, random defects. What it
// accepts must be clear by the oracle, with the oracle's smallest clearance; what collides must be
// rejected at the first colliding step; every planted defect must be found.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "opt/verify/verify.h"
#include "tests/support/property.h"
#include "tests/support/test_trajectory.h"
#include "tests/support/test_world.h"

namespace {

using namespace sopt;
using namespace sopt::oracle;

constexpr double kTol_m = 1e-9;
constexpr double kExtent_m = 10.0;

struct Case {
  Scene scene;
  std::vector<Vec2> states;
  double dt_s = 0.1;
  double radius_m = 0.0;
  double min_clearance_m = 0.0;
  ViolationKind planted = ViolationKind::kNone;
  int i_planted = 0;
};

std::vector<Vec2> draw_states(Random& random, double radius_m) {
  // Well inside, along the wall with exactly no clearance, or partly outside.
  const double kind = random.uniform(0.0, 1.0);
  const double inset = kind < 0.7 ? 0.5 + radius_m : kind < 0.85 ? radius_m : -0.5;
  const Aabb2 area = {Vec2::Constant(inset), Vec2::Constant(kExtent_m - inset)};
  Vec2 z = random.point(area);
  double heading = random.uniform(-3.14, 3.14);
  const double step_m = random.uniform(0.05, 0.6);
  std::vector<Vec2> states = {z};
  for (int i = 1 + random.index(50); i > 0; --i) {
    heading += random.uniform(-0.4, 0.4);
    if (random.chance(0.05)) heading += random.uniform(-3.0, 3.0);
    z += step_m * Vec2(std::cos(heading), std::sin(heading));
    z = z.cwiseMax(area.lower).cwiseMin(area.upper);  // may stand still at the border
    states.push_back(z);
  }
  return states;
}

Case draw_case(Random& random) {
  static constexpr double kRadii[] = {0.0, 0.05, 0.2};
  static constexpr double kMinClearances[] = {0.0, 1e-4, 0.01};
  Case c;
  c.radius_m = kRadii[random.index(3)];
  c.min_clearance_m = kMinClearances[random.index(3)];
  c.dt_s = random.uniform(0.01, 0.5);
  c.states = draw_states(random, c.radius_m);
  const Aabb2 bounds = {Vec2::Zero(), Vec2::Constant(kExtent_m)};
  const Scene drawn = random_scene(random, bounds, random.index(30), random.uniform(0.05, 1.0));
  // Thinned out along the trajectory most of the time, so that about half of all cases are clear.
  const bool keep_clear = random.chance(0.6);
  c.scene.bounds = bounds;
  for (const Obstacle& obstacle : drawn.obstacles) {
    const Outline outline = outline_of(obstacle.shape);
    bool is_near = false;
    for (const Vec2& z : c.states) {
      is_near = is_near || point_distance(outline, z) < c.radius_m + c.min_clearance_m;
    }
    if (!keep_clear || !is_near) c.scene.obstacles.push_back(obstacle);
  }
  if (random.chance(0.3)) {
    c.planted = static_cast<ViolationKind>(-1 - random.index(6));
    c.i_planted = random.index(static_cast<int>(c.states.size()) - 1);
  }
  return c;
}

std::string to_text(const Case& c) {
  std::string text = "{" + sopt::oracle::to_text(c.scene) + ",\n  \"states\":[";
  for (const Vec2& z : c.states) text += sopt::oracle::to_text(z) + ",";
  text.back() = ']';
  char rest[200];
  std::snprintf(rest, sizeof rest,
                R"(,"dt_s":%.17g,"radius":%.17g,"min_clearance":%.17g,"planted":%d,"at":%d})",
                c.dt_s, c.radius_m, c.min_clearance_m, static_cast<int>(c.planted), c.i_planted);
  return text + rest;
}

// Breaks trajectory, robot or problem in the planted way.
void plant(const Case& c, Trajectory<Point2>& trajectory, Point2& robot,
           VerifyProblem<Point2>& problem) {
  switch (c.planted) {
    case ViolationKind::kNone:
    case ViolationKind::kCollision:
    // Of arms alone.
    case ViolationKind::kNotAtRest:
    case ViolationKind::kPosition:
    case ViolationKind::kVelocity:
    case ViolationKind::kAcceleration:
    case ViolationKind::kSelfCollision:
    case ViolationKind::kSecondOpinion:
      break;
    case ViolationKind::kShape:
      (void)trajectory.inputs.try_resize(c.i_planted);
      break;
    case ViolationKind::kNotFinite:
      trajectory.states[c.i_planted].x() = std::numeric_limits<double>::quiet_NaN();
      break;
    case ViolationKind::kStart:
      problem.start.x() += 1e-7;
      break;
    case ViolationKind::kGoal:
      problem.goal.y() -= 1e-7;
      break;
    case ViolationKind::kDynamics:
      trajectory.inputs[c.i_planted].x() += 3e-9 / c.dt_s;
      break;
    case ViolationKind::kSpeed:
      robot.v_max_mps = 0.0;
      for (const Vec2& u : trajectory.inputs) {
        robot.v_max_mps = std::max(robot.v_max_mps, 0.99 * u.norm());
      }
      break;
  }
}

struct StepClearance {
  double distance_m = 0.0;
  int i_obstacle = kBoundsObstacle;
};

std::vector<StepClearance> brute_force(const Case& c) {
  std::vector<StepClearance> steps;
  for (std::size_t t = 1; t < c.states.size(); ++t) {
    StepClearance step;
    step.distance_m = scene_distance(c.scene, c.states[t - 1], c.states[t], &step.i_obstacle);
    step.distance_m -= c.radius_m;
    steps.push_back(step);
  }
  return steps;
}

Vec2 state_at(const Case& c, double t_s) {
  const double steps = std::clamp(t_s / c.dt_s, 0.0, static_cast<double>(c.states.size() - 1));
  const auto t = std::min(static_cast<std::size_t>(steps), c.states.size() - 2);
  const double share = steps - static_cast<double>(t);
  return (1.0 - share) * c.states[t] + share * c.states[t + 1];
}

double clearance_at(const Case& c, int i_obstacle, double t_s) {
  const Vec2 z = state_at(c, t_s);
  if (i_obstacle == kBoundsObstacle) return wall_distance(c.scene.bounds, z) - c.radius_m;
  if (i_obstacle < 0 || i_obstacle >= static_cast<int>(c.scene.obstacles.size())) return kFar_m;
  const auto& shape = c.scene.obstacles[static_cast<std::size_t>(i_obstacle)].shape;
  return point_distance(outline_of(shape), z) - c.radius_m;
}

void check_accepted(const Case& c, const Certificate& certificate,
                    const std::vector<StepClearance>& steps, CaseReport& report) {
  double expected_m = std::numeric_limits<double>::infinity();
  for (const StepClearance& step : steps) expected_m = std::min(expected_m, step.distance_m);
  report.expect("accepts only what is clear", expected_m >= c.min_clearance_m - kTol_m);
  report.expect("accepts only what has no defect", c.planted == ViolationKind::kNone);
  report.expect_within("certified clearance", std::abs(certificate.min_clearance_m - expected_m),
                       kTol_m);
  report.expect_within(
      "clearance where the certificate says it is",
      std::abs(clearance_at(c, certificate.i_obstacle, certificate.where_t_s) - expected_m), 1e-7);
}

void check_collision(const Case& c, const Violation& found, const std::vector<StepClearance>& steps,
                     CaseReport& report) {
  // Steps within the tolerance of the limit may count either way.
  int first_sure = static_cast<int>(steps.size());
  int first_possible = first_sure;
  for (int t = static_cast<int>(steps.size()) - 1; t >= 0; --t) {
    const double distance_m = steps[static_cast<std::size_t>(t)].distance_m;
    if (distance_m < c.min_clearance_m - kTol_m) first_sure = t;
    if (distance_m < c.min_clearance_m + kTol_m) first_possible = t;
  }
  report.expect("collides at the first step that does",
                found.step >= first_possible && found.step <= first_sure &&
                    first_possible < static_cast<int>(steps.size()));
  report.expect("amount is below the minimum", found.amount < c.min_clearance_m);
  report.expect_within(
      "time lies in the step",
      std::max(found.step * c.dt_s - found.t_s, found.t_s - (found.step + 1) * c.dt_s), 1e-9);
  report.expect_within("the named obstacle is hit there",
                       clearance_at(c, found.i_obstacle, found.t_s) - c.min_clearance_m, 1e-7);
}

std::string check_case(Random& random, CaseReport& report) {
  const Case c = draw_case(random);
  TestWorld test_world;
  if (fill(c.scene, test_world.world) != WorldStatus::kOk) {
    report.fail("the world refuses a valid scene");
    return to_text(c);
  }
  TestTrajectory test(c.states, c.dt_s);
  Point2 robot{c.radius_m, std::numeric_limits<double>::infinity()};
  VerifyProblem<Point2> problem = {c.states.front(), c.states.back(), &test_world.world,
                                   c.min_clearance_m};
  plant(c, test.trajectory, robot, problem);
  const VerifyResult<Point2> result = verify(robot, test.trajectory, problem);

  const std::vector<StepClearance> steps = brute_force(c);
  const ViolationKind kind = result.violation.kind;
  report.expect("a plan exactly when nothing is wrong",
                result.plan.has_value() == (kind == ViolationKind::kNone));
  if (result.plan.has_value()) {
    check_accepted(c, result.plan->certificate(), steps, report);
  } else if (kind == ViolationKind::kCollision) {
    check_collision(c, result.violation, steps, report);
  } else {
    report.expect("reports the planted defect", kind == c.planted);
  }
  return report.failed() ? to_text(c) : std::string();
}

}  // namespace

int main(int argc, char** argv) { return run_property("verify", argc, argv, check_case); }
