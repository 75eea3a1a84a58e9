// One window of one sweep [Leu22, Alg. 1 l.8-10]: linearise what is near, solve the segment QP with
// both ends fixed, take the largest step towards its solution that keeps every row, and write the
// waypoints between the ends. Rows and cost are convex and hold at the reference, so in the plane
// any step from it to the solution is safe and does not raise the cost; the check stands all the
// same, because it is what makes the window trustworthy when an assumption fails.
// Owns its scratch memory: one per worker.
#pragma once

#include <cstdint>

#include "models/config.h"
#include "models/plane/point2.h"
#include "opt/plane/dense_window.h"
#include "opt/plane/obstacle_rows.h"
#include "opt/qp/active_set_qp.h"
#include "opt/qp/point_rows.h"
#include "opt/splits.h"
#include "opt/sweep_problem.h"
#include "rt/annotations.h"
#include "rt/deadline.h"

namespace sopt {

template <>
class WindowOptimizer<Point2> {
 public:
  // Workers share nothing.
  struct Shared {
    Shared() noexcept = default;
    Shared(Arena& /*arena*/, const PlannerSettings& /*settings*/) noexcept {}
  };

  WindowOptimizer() noexcept = default;
  WindowOptimizer(Arena& arena, const PlannerSettings& settings,
                  const Shared& shared = Shared()) noexcept;

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
