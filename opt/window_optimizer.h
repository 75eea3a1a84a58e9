// One window of one sweep [Leu22, Alg. 1 l.8-10]: linearise what is near, solve the segment QP with
// both ends fixed, take the largest step towards its solution that keeps every row, and write the
// waypoints between the ends. Rows and cost are convex and hold at the reference, so in the plane
// any step from it to the solution is safe and does not raise the cost; the check stands all the
// same, because it is what makes the window trustworthy when an assumption fails.
// Owns its scratch memory: one per worker.
#pragma once

#include <cstdint>
#include <span>

#include "models/config.h"
#include "models/margin.h"
#include "models/point2.h"
#include "opt/dense_window.h"
#include "opt/obstacle_rows.h"
#include "opt/qp/active_set_qp.h"
#include "opt/qp/point_rows.h"
#include "opt/splits.h"
#include "rt/annotations.h"
#include "rt/deadline.h"

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
  double cost_before = 0.0;  // sum |dz|^2 / ds over the window
  double cost_after = 0.0;
  double displacement_m = 0.0;  // largest move of a waypoint
  bool was_shortened = false;   // the step ended at the trust radius, not at the solution
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
  double trust_m = 0.0;                     // how far a waypoint may move
  double ds_m = 0.0;                        // nominal step length, the cost's scale
  std::span<typename Robot::State> states;  // the whole trajectory
  RowMode rows = RowMode::kEdge;
  WindowSolver solver = WindowSolver::kClosedForm;
  bool accept = true;                 // check steps before they are taken
  bool linearize_about_rest = false;  // u = 0: rows think that the window stands at its first point
};

template <>
class WindowOptimizer<Point2> {
 public:
  WindowOptimizer() noexcept = default;
  WindowOptimizer(Arena& arena, const PlannerSettings& settings) noexcept;

  // Optimises states(window.first, window.last), both exclusive, in place.
  [[nodiscard]] WindowResult optimize(const SweepProblem<Point2>& problem, const Window& window,
                                      const Deadline& deadline) SOPT_RT;

  // The trust radius is halved at most this often to make the rows fit.
  static constexpr int kMaxTrustHalvings = 6;
  // Rows may be violated by this much after a step, m.
  static constexpr double kRowTolerance_m = 2e-9;

 private:
  // Steps tried towards the solution: 1, 1/2, .. 1/16.
  static constexpr int kMaxStepHalvings = 4;
  // And by this much in the QP.
  static constexpr double kQpTolerance_m = 1e-9;

  [[nodiscard]] bool make_rows(const SweepProblem<Point2>& problem, const Window& window,
                               double trust_m, std::int64_t& num_queries) SOPT_RT;
  void linearize_about_rest(const Vec2* reference) SOPT_RT;
  [[nodiscard]] WindowStatus take_solution(const SweepProblem<Point2>& problem,
                                           const Window& window, WindowResult& result) SOPT_RT;
  [[nodiscard]] WindowStatus take_step(const SweepProblem<Point2>& problem, const Window& window,
                                       double trust_m, WindowResult& result) SOPT_RT;

  int max_window_ = 0;
  PointRows rows_;
  ActiveSetQp<double> qp_;
  DenseWindow dense_;          // empty without PlannerSettings::dense_solver
  FixedVector<Vec2> offsets_;  // of a window's waypoints
};

}  // namespace sopt
