// A window's QP as the paper solves it [Leu22, III-B]: condensed to the inputs, in steps
// w_t = z_{t+1} - z_t,
//     min 1/2 sum |w_t|^2   s.t.  sum w_t = z_n - z_0,   a_i . (z_0 + sum_{s<t_i} w_s) >= b_i
// with a Hessian that is factorised in every window, although it is the identity for this robot and
// cost: the paper's solver does not know that. O(n^3) per window and O(n) numbers per row; what the
// closed form saves is measured in docs/RESULTS.md. Same solution as PointRows.
#pragma once

#include <span>

#include "models/plane/convex2.h"
#include "opt/qp/active_set_qp.h"
#include "opt/qp/dense_rows.h"
#include "opt/qp/point_rows.h"
#include "rt/annotations.h"

namespace sopt {

class DenseWindow {
 public:
  DenseWindow() noexcept = default;
  DenseWindow(Arena& arena, int max_window, int max_rows) noexcept;

  // Solves the QP of `rows` and puts its points at the solution when there is one.
  [[nodiscard]] QpResult<double> solve(PointRows& rows, const QpOptions<double>& options,
                                       const Deadline& deadline) SOPT_RT;

 private:
  [[nodiscard]] bool condense(const PointRows& rows) SOPT_RT;
  void write_points(PointRows& rows) SOPT_RT;

  DenseRows<double> rows_;
  ActiveSetQp<double> qp_;
  FixedVector<double> hessian_;   // 2n x 2n
  FixedVector<double> gradient_;  // 2n, zero
  FixedVector<double> row_;       // 2n
  FixedVector<Vec2> points_;      // n + 1
};

}  // namespace sopt
