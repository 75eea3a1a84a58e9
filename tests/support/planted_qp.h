// Random strictly convex QPs whose solution is known because it was chosen first: Hessian with
// given condition (random orthogonal times log-spaced eigenvalues), x*, active rows and bounds,
// multipliers (some tiny, some zero); then f = A'l - H x*, and bounds through x* or at a distance
// from it. The data carry rounding of f and b only.
#pragma once

#include <vector>

#include "tests/support/kkt.h"
#include "tests/support/oracle2.h"

namespace sopt::oracle {

struct PlantedLimits {
  int max_variables = 40;
  double max_condition = 1e8;         // of H
  double min_slack = 1e-8;            // of inactive rows, per length of the row
  double max_norm_ratio = 1e2;        // row lengths in [1 / ratio, ratio]
  bool has_exact_duplicates = false;  // dependent rows are powers of 2 times others, no sums
};

struct PlantedQp {
  DenseQp qp;
  Eigen::VectorXd x;            // n
  Eigen::VectorXd multipliers;  // m + n, as in the KKT conditions of kkt.h
  double condition = 1.0;       // of H
  double gram_condition = 1.0;  // of rows with a multiplier
};
[[nodiscard]] PlantedQp random_planted_qp(Random& random, const PlantedLimits& limits = {});

// Condition of A H^-1 A' over the given constraints' rows, scaled to unit diagonal; at most 1e16.
[[nodiscard]] double gram_condition(const DenseQp& qp, const std::vector<int>& constraints);

// H's eigenvalues run from `lowest` to condition x lowest.
[[nodiscard]] Eigen::MatrixXd random_hessian(Random& random, int n, double condition,
                                             double lowest);

// The same problem with every row turned and stretched by up to `share` of its length, x* feasible
// still and at the same distance from all bounds.
[[nodiscard]] DenseQp perturbed_partner(Random& random, const PlantedQp& planted, double share);

// Adds rows that contradict others of the problem, or each other, or nothing but themselves, by
// `gap` per length of the row.
void add_contradiction(Random& random, double gap, DenseQp& qp);

}  // namespace sopt::oracle
