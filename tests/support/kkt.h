// A QP as dense matrices and how far an answer is from its KKT conditions,
//     min 1/2 x'Hx + f'x   s.t.  lower <= A x <= upper,  lower_x <= x <= upper_x
//     H x + f = A'l + l_x,   l >= 0 at a lower side, <= 0 at an upper one, 0 in between
// computed in 80-bit arithmetic from these data alone; shares nothing with the solver. Constraint
// c in [0, m) is a row, m + j the bounds of variable j, as in opt/qp/dense_rows.h.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "opt/qp/dense_rows.h"

namespace sopt::oracle {

struct DenseQp {
  Eigen::MatrixXd h;                 // n x n
  Eigen::VectorXd f;                 // n
  Eigen::MatrixXd a;                 // m x n
  Eigen::VectorXd lower, upper;      // m
  Eigen::VectorXd lower_x, upper_x;  // n

  // Without rows and bounds.
  [[nodiscard]] static DenseQp unconstrained(const Eigen::MatrixXd& h, const Eigen::VectorXd& f);
  [[nodiscard]] int num_variables() const { return static_cast<int>(f.size()); }
  [[nodiscard]] int num_rows() const { return static_cast<int>(a.rows()); }
  [[nodiscard]] int num_constraints() const { return num_rows() + num_variables(); }
  // Of constraint c.
  [[nodiscard]] Eigen::VectorXd normal(int c) const;
  [[nodiscard]] double lower_of(int c) const;
  [[nodiscard]] double upper_of(int c) const;
  void set_bounds(int c, double lower, double upper);
  void add_row(const Eigen::VectorXd& normal, double lower, double upper);
};

// All without unit; 0 is exact.
struct ScaledKkt {
  double stationarity = 0.0;     // |Hx + f - A'l| / max(1, largest of |H||x| + |f| + |A'||l|)
  double violation = 0.0;        // of a row, / max(|a|, |bound|); of zero rows 0 >= 0, / 1
  double sign = 0.0;             // |l||a| towards a side without bound, / as stationarity
  double complementarity = 0.0;  // smaller of scaled |l||a| and scaled distance from the bound

  [[nodiscard]] double worst() const;  // NaN when any is
};
// `multipliers`: m + n.
[[nodiscard]] ScaledKkt scaled_kkt(const DenseQp& qp, const Eigen::VectorXd& x,
                                   const Eigen::VectorXd& multipliers);

// Scaled violation of the worst row alone.
[[nodiscard]] double scaled_violation(const DenseQp& qp, const Eigen::VectorXd& x);

// One side of a constraint: normal . x >= bound.
struct OneSided {
  Eigen::VectorXd normal;
  double bound = 0.0;
};

// How well `blocking` and `others` prove that there is no feasible point: blocking's normal as
// minus a combination of the others', nonnegative but for the first `num_free` ones (equalities).
// Least squares; the others are meant to be independent.
struct FarkasCertificate {
  double residual = 0.0;    // of the combination, / |normal|
  double negativity = 0.0;  // most negative weight, in units where normals have unit length
  double gap = 0.0;         // > 0: contradiction; / |normal|
};
[[nodiscard]] FarkasCertificate farkas_certificate(const OneSided& blocking,
                                                   const std::vector<OneSided>& others,
                                                   int num_free);

// Gives the problem to the library; false when it does not fit or H is refused.
template <class Scalar>
[[nodiscard]] bool fill(const DenseQp& qp, DenseRows<Scalar>& rows);
extern template bool fill(const DenseQp&, DenseRows<double>&);
extern template bool fill(const DenseQp&, DenseRows<float>&);

// The same problem with every number rounded to single precision.
[[nodiscard]] DenseQp rounded_to_float(const DenseQp& qp);

[[nodiscard]] std::string to_text(const DenseQp& qp);

}  // namespace sopt::oracle
