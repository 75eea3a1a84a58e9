// What a window of a sweep is asked for and what it answers, the same for every robot, and the
// window optimisers' common name: opt/plane/point_window.h for the point, opt/arm/arm_window.h for
// arms. Each has a type `Shared`, built once and read by all workers, and a constructor (Arena&,
// const PlannerSettings&, const Shared&).
#pragma once

#include <cstdint>
#include <span>

#include "models/config.h"
#include "models/margin.h"
#include "opt/qp/qp_result.h"
#include "rt/annotations.h"

namespace sopt {

enum class WindowStatus : std::int8_t {
  kMoved = 0,      // a step was taken
  kConverged = 1,  // the solution is where the reference is already
  kNotRun = -1,    // default, or the deadline had passed
  kTooShort = -2,  // fewer than 2 steps: nothing to move
  kNoRows = -3,    // the window or its rows do not fit, even with the smallest trust radius
  kQpFailed = -4,  // the QP has no solution or was interrupted
  kRejected = -5,  // no step passed the check
};

struct WindowResult {
  WindowStatus status = WindowStatus::kNotRun;
  QpStatus qp_status = QpStatus::kNotSolved;
  double cost_before = 0.0;  // of the window, see opt/step_measure.h
  double cost_after = 0.0;
  double displacement_m = 0.0;  // largest move of a waypoint, of an arm: bound on its links'
  bool was_shortened = false;   // the step ended before the solution
  bool has_active_rows = false;
  std::int64_t clearance_queries = 0;
  std::int64_t qp_solves = 0;
  std::int64_t qp_steps = 0;
};

template <class Robot>
class WindowOptimizer;

// What all windows of a sweep have in common.
template <class Robot>
struct SweepProblem {
  const Robot* robot = nullptr;
  const typename Robot::World* world = nullptr;
  MarginProfile profile;
  double trust_m = 0.0;  // how far a waypoint may move; of an arm: activation radius of rows
  double ds_m = 0.0;     // nominal step length, the cost's scale
  std::span<typename Robot::State> states;  // the whole trajectory
  RowMode rows = RowMode::kEdge;
  WindowSolver solver = WindowSolver::kClosedForm;
  bool accept = true;                 // check steps before they are taken
  bool linearize_about_rest = false;  // u = 0: rows think that the window goes on as it began
  double dt_s = 0.0;                  // of the trajectory; for robots with velocities in the state
  double min_clearance_m = 0.0;       // hard; for robots whose steps are checked against it
};

}  // namespace sopt
