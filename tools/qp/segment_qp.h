// A segment QP as structured data: a linear time-invariant part over IntegratorKernel, for a mobile
// robot a base part with a Hessian of its own, and rows that couple both. It fills the structured
// row spaces (KernelRows, SumRows), and condense() writes the same problem as the QP in the inputs
// alone that a general solver is given [Leu22 III-B]: both have the same solution.
// Step units as in opt/qp/integrator_kernel.h. Inputs are ordered by time; at each time those of
// the base come first.
#pragma once

#include <string>
#include <vector>

#include "opt/qp/dense_rows.h"
#include "opt/qp/integrator_kernel.h"
#include "opt/qp/kernel_rows.h"
#include "opt/qp/sum_rows.h"
#include "tools/io/qp_problem.h"

namespace sopt {

// direction . quantity(t) >= bound
template <class Scalar>
struct KernelRow {
  Quantity quantity = Quantity::kPosition;
  int t = 0;
  std::vector<Scalar> direction;
  Scalar bound = 0;
};

// Of every joint at first_t .. last_t.
template <class Scalar>
struct KernelBounds {
  Quantity quantity = Quantity::kPosition;
  int first_t = 0;
  int last_t = 0;
  std::vector<Scalar> lower, upper;
};

// One number per joint in every vector; velocities with acceleration input only.
template <class Scalar>
struct KernelPart {
  int order = 2;
  IntegratorWeights weights;
  int num_steps = 0;
  int num_joints = 0;
  std::vector<Scalar> first_position, last_position;
  std::vector<Scalar> first_velocity, last_velocity;
  std::vector<Scalar> attractor;        // empty: 0
  std::vector<Scalar> factors;          // empty: 1
  std::vector<KernelRow<Scalar>> rows;  // in time order
  std::vector<KernelBounds<Scalar>> bounds;

  [[nodiscard]] Quantity input() const { return static_cast<Quantity>(order); }
};

// The base's own variables are its inputs, num_inputs at each of num_steps times.
struct BasePart {
  int num_inputs = 0;  // 0: there is no base
  std::vector<double> hessian, gradient;
  std::vector<std::vector<double>> equality_rows;
  std::vector<double> equality_values;
  std::vector<double> lower, upper;
};

// base . x_base + arm . position(t) >= bound
struct CoupledRow {
  std::vector<double> base;
  int t = 0;
  std::vector<double> arm;
  double bound = 0.0;
};

struct SegmentQp {
  KernelPart<double> arm;
  BasePart base;
  std::vector<CoupledRow> coupled;
};

// In another number type.
[[nodiscard]] KernelPart<float> to_float(const KernelPart<double>& part);

// The problem in the inputs. Equalities first: the base's, then the ends of the joints.
[[nodiscard]] QpProblem condense(const SegmentQp& problem, const std::string& name);

// These reset the row spaces and fill them, without heap; false when a capacity is too small. The
// base's Hessian is factorised too.
template <class Scalar, int kLanes>
[[nodiscard]] bool fill(const KernelPart<Scalar>& part, KernelRows<Scalar, kLanes>& rows);
template <int kLanes>
[[nodiscard]] bool fill(const SegmentQp& problem, DenseRows<double>& base,
                        KernelRows<double, kLanes>& arm,
                        SumRows<DenseRows<double>, KernelRows<double, kLanes>>& sum);

extern template bool fill(const KernelPart<double>&, KernelRows<double, 4>&);
extern template bool fill(const KernelPart<double>&, KernelRows<double, 8>&);
extern template bool fill(const KernelPart<float>&, KernelRows<float, 8>&);
extern template bool fill(const SegmentQp&, DenseRows<double>&, KernelRows<double, 4>&,
                          SumRows<DenseRows<double>, KernelRows<double, 4>>&);
extern template bool fill(const SegmentQp&, DenseRows<double>&, KernelRows<double, 8>&,
                          SumRows<DenseRows<double>, KernelRows<double, 8>>&);

}  // namespace sopt
