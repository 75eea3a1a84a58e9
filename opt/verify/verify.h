// The independent check that every plan passes before it leaves, and the only maker of a
// VerifiedPlan. It shares no data and no geometry code with sampler and optimiser: its own distance
// formulas and kinematics, every obstacle visited, no broad phase. Checks shape and finiteness,
// exact start and goal, dynamics, limits at all times, and clearance along the continuous motion:
// of a point exact, of an arm proven stretch by stretch, see verify_arm.cc. Away from obstacles
// O(obstacles x log horizon) box tests, plus distances where boxes are near; no heap, bounded.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "models/arm/arm.h"
#include "models/plane/point2.h"
#include "models/space/world3.h"
#include "models/trajectory.h"
#include "rt/annotations.h"

namespace sopt {

// Largest accepted |states[t+1] - rollout(states[t], inputs[t])|, in the state's units.
inline constexpr double kMaxDynamicsDefect = 1e-9;

enum class ViolationKind : std::int8_t {
  kNone = 0,
  kShape = -1,      // no step, inputs.size() != horizon, or dt_s not positive; amount: dt_s
  kNotFinite = -2,  // a state or input is NaN or infinite
  kStart = -3,      // states[0] is not the start; amount: distance
  kGoal = -4,       // the last state is not the goal; amount: distance
  kDynamics = -5,   // defect above kMaxDynamicsDefect; amount: defect
  kSpeed = -6,      // above the robot's limit; amount: excess in m/s
  kCollision = -7,  // below min_clearance to an obstacle or bound; amount: clearance in m
  // Of arms, with the joint or the other link. Units are the joint's.
  kNotAtRest = -8,       // moves at the start or at the goal; amount: velocity
  kPosition = -9,        // outside the joint's limits; amount: by how much
  kVelocity = -10,       // likewise
  kAcceleration = -11,   // likewise
  kSelfCollision = -12,  // two links below min_self_clearance; amount: clearance in m
  kSecondOpinion = -13,  // libccd cannot rule out contact at a waypoint; amount: clearance in m
};

// Largest accepted excess over a joint's limit: the rounding of what was computed to be at it.
inline constexpr double kMaxLimitExcess = 1e-9;

// The first thing that is wrong, in trajectory time. Of an arm that collides, the closest approach
// of the pair that does so first, within the step where it does; where the cores of capsule and
// obstacle overlap, the amount is minus their radii.
struct Violation {
  ViolationKind kind = ViolationKind::kShape;
  int step = 0;  // it happens between waypoint `step` and the next
  double t_s = 0.0;
  int i_link = 0;
  int i_obstacle = kNoObstacle;  // kBoundsObstacle: the bounds; kSelfObstacle: another link
  double amount = 0.0;
  int i_other_link = kNoLink;  // of two links, the lower one
  int i_joint = kNoJoint;
};

struct Certificate {
  // Over the whole continuous motion, obstacles and bounds. Of an arm a proven lower bound, at most
  // max(1 mm, 1 %) below the clearance at where_t_s.
  double min_clearance_m = 0.0;
  double where_t_s = 0.0;  // where it is reached
  int i_link = 0;
  int i_obstacle = kNoObstacle;
  // Min over limits of (limit - value) / limit; 1: no limit. Joint positions: the distance to the
  // nearer limit, as a share of half the range.
  double worst_limit_margin = 0.0;
  double goal_error = 0.0;
  double dynamics_defect = 0.0;
  // --- of arms
  int i_joint = kNoJoint;  // of the worst limit margin
  // Between links that may collide; bounded as min_clearance_m is.
  double min_self_clearance_m = std::numeric_limits<double>::infinity();
  double self_where_t_s = 0.0;
  int i_self_link = kNoLink;
  int i_other_link = kNoLink;  // < i_self_link
};

// What a plan is checked against.
template <class Robot>
struct VerifyProblem {
  typename Robot::Config start{};
  typename Robot::Config goal{};
  const typename Robot::World* world = nullptr;
  double min_clearance_m = 1e-4;
  double min_self_clearance_m = 0.0;  // between links that may collide
};

template <class Robot>
struct VerifyResult;

// A trajectory that passed `verify`, with the certificate. A view: the trajectory stays where it
// was checked and must not change while the view is used.
template <class Robot>
class VerifiedPlan {
 public:
  [[nodiscard]] const Trajectory<Robot>& trajectory() const SOPT_RT { return *trajectory_; }
  [[nodiscard]] const Certificate& certificate() const SOPT_RT { return certificate_; }

 private:
  VerifiedPlan(const Trajectory<Robot>& trajectory, const Certificate& certificate) noexcept
      : trajectory_(&trajectory), certificate_(certificate) {}
  template <class R>
  friend VerifyResult<R> verify(const R& robot, const Trajectory<R>& trajectory,
                                const VerifyProblem<R>& problem) SOPT_RT;

  const Trajectory<Robot>* trajectory_;
  Certificate certificate_;
};

template <class Robot>
struct VerifyResult {
  std::optional<VerifiedPlan<Robot>> plan;  // present exactly when violation.kind is kNone
  Violation violation;
};

// The first violation, or kind kNone and the certificate. See `verify`.
[[nodiscard]] Violation find_violation(const Point2& robot, const Trajectory<Point2>& trajectory,
                                       const VerifyProblem<Point2>& problem,
                                       Certificate& certificate) SOPT_RT;
template <int N>
[[nodiscard]] Violation find_violation(const Arm<N>& arm, const Trajectory<Arm<N>>& trajectory,
                                       const VerifyProblem<Arm<N>>& problem,
                                       Certificate& certificate) SOPT_RT;

// Checks `trajectory` from whatever source: the optimiser, a file, the wire.
template <class Robot>
[[nodiscard]] VerifyResult<Robot> verify(const Robot& robot, const Trajectory<Robot>& trajectory,
                                         const VerifyProblem<Robot>& problem) SOPT_RT {
  VerifyResult<Robot> result;
  Certificate certificate;
  result.violation = find_violation(robot, trajectory, problem, certificate);
  if (result.violation.kind == ViolationKind::kNone) {
    result.plan = VerifiedPlan<Robot>(trajectory, certificate);
  }
  return result;
}

}  // namespace sopt
