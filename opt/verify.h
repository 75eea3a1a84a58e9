// The independent check that every plan passes before it leaves, and the only maker of a
// VerifiedPlan. It shares no data and no geometry code with sampler and optimiser: its own distance
// formulas, every obstacle visited, trajectory boxes instead of the world's broad phase. Checks
// shape and finiteness, exact start and goal, dynamics, limits, and clearance along the continuous
// motion (in the plane exact, not sampled). Cost: O(obstacles x log horizon) box tests away from
// obstacles, plus exact distances where boxes are near; no heap, bounded.
#pragma once

#include <cstdint>
#include <optional>

#include "models/point2.h"
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
};

// The first thing that is wrong, in trajectory time.
struct Violation {
  ViolationKind kind = ViolationKind::kShape;
  int step = 0;  // it happens between waypoint `step` and the next
  double t_s = 0.0;
  int i_link = 0;
  int i_obstacle = kNoObstacle;  // for kCollision; kBoundsObstacle for the bounds
  double amount = 0.0;
};

struct Certificate {
  double min_clearance_m = 0.0;  // over the whole continuous motion, obstacles and bounds
  double where_t_s = 0.0;        // where it is reached
  int i_link = 0;
  int i_obstacle = kNoObstacle;
  double worst_limit_margin = 0.0;  // min over limits of (limit - value) / limit; 1: no limit
  double goal_error = 0.0;
  double dynamics_defect = 0.0;
};

// What a plan is checked against.
template <class Robot>
struct VerifyProblem {
  typename Robot::Config start{};
  typename Robot::Config goal{};
  const typename Robot::World* world = nullptr;
  double min_clearance_m = 1e-4;
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

// Checks `trajectory` from whatever source: the optimiser, a file, the wire.
template <class Robot>
[[nodiscard]] VerifyResult<Robot> verify(const Robot& robot, const Trajectory<Robot>& trajectory,
                                         const VerifyProblem<Robot>& problem) SOPT_RT;

extern template VerifyResult<Point2> verify(const Point2&, const Trajectory<Point2>&,
                                            const VerifyProblem<Point2>&) SOPT_RT;

}  // namespace sopt
