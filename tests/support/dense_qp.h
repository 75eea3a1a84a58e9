// The segment QP of opt/qp/point_rows.h written out densely: Hessian as the second-difference
// matrix, rows as a matrix, KKT residuals computed from them. Shares nothing with the kernel form.
// Also random problems with known properties. For tests.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "opt/qp/active_set_qp.h"
#include "opt/qp/point_rows.h"
#include "tests/support/oracle2.h"

namespace sopt::oracle {

struct SegmentRow {
  int t = 1;  // waypoint in [1, n - 1]
  Vec2 normal = Vec2::UnitX();
  double bound = 0.0;
};

// min 1/2 sum |z(t+1) - z(t)|^2 over n steps with z(0), z(n) fixed, rows normal . z(t) >= bound.
// x stacks z(1) .. z(n-1).
struct SegmentQp {
  int num_steps = 2;
  Vec2 first = Vec2::Zero();
  Vec2 last = Vec2::Zero();
  std::vector<SegmentRow> rows;  // in time order

  [[nodiscard]] Eigen::MatrixXd hessian() const;     // 2(n-1) x 2(n-1)
  [[nodiscard]] Eigen::VectorXd gradient() const;    // f of 1/2 x'Hx + f'x
  [[nodiscard]] Eigen::MatrixXd row_matrix() const;  // m x 2(n-1)
  [[nodiscard]] Eigen::MatrixXd gram() const;        // A H^-1 A'
  [[nodiscard]] Eigen::VectorXd primal(const Eigen::VectorXd& lambda) const;
  [[nodiscard]] double violation(std::size_t i, const Eigen::VectorXd& x) const;
};

// Sorts rows by time, as PointRows wants them.
void sort_rows(SegmentQp& qp);
// False when the rows do not fit.
[[nodiscard]] bool fill(const SegmentQp& qp, PointRows& rows);
// Id in PointRows of every row: groups of four per waypoint.
[[nodiscard]] std::vector<int> row_indices(const SegmentQp& qp);

struct KktResidual {
  double stationarity = 0.0;     // |H x + f - A' lambda|, largest component
  double violation = 0.0;        // largest, or 0
  double negativity = 0.0;       // of multipliers, largest
  double complementarity = 0.0;  // largest min(lambda_i, |slack_i|)
  bool has_padding = false;      // a padding row is active
};
[[nodiscard]] KktResidual kkt_residual(const SegmentQp& qp, const PointRows& rows,
                                       const ActiveSetQp<double>& solver);

// The nearest that `row` (an index of `qp.rows`) and others at its waypoint come to proving
// infeasibility: minus the row's normal as a nonnegative combination of at most two of them (two
// are enough in the plane), whose bounds then contradict it by the largest gap.
struct Certificate2 {
  double residual = 0.0;  // of the combination
  double gap = 0.0;       // > 0: contradiction
};
[[nodiscard]] Certificate2 infeasibility_certificate(const SegmentQp& qp, int row,
                                                     const std::vector<int>& others);

// A polyline that satisfies all rows exists, each row kept by at least `slack` at it.
[[nodiscard]] SegmentQp random_feasible_qp(Random& random, int num_steps, int num_rows,
                                           double slack = 0.0);

[[nodiscard]] std::string to_text(const SegmentQp& qp);

}  // namespace sopt::oracle
