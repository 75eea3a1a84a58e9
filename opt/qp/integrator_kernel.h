// The segment QP's inverse Hessian for linear time-invariant robots: per joint, in step units,
//     velocity input       q(t+1) = q(t) + v(t)
//     acceleration input   q(t+1) = q(t) + v(t) + a(t) / 2,   v(t+1) = v(t) + a(t)
//     cost                 1/2 sum_t w_q |q(t) - attractor|^2 + w_v |v(t)|^2 + w_a |a(t)|^2
// over n steps with both ends (position, and velocity with acceleration input) fixed. The response
// of all quantities to unit forces on all quantities is one constant matrix per n,
//     G_n((i,t),(k,s)) = d quantity_i(t) / d force on quantity_k(s),
// the same for every joint up to its factor r_j, every dt and all data. Evaluated by one backward
// and one forward sweep of the Riccati recursion with a free end, then moved onto the fixed end by
// the response to end forces: O(n), no matrix. Tables of G_n, built by the same sweeps, give its
// entries for n <= max_table; longer segments sweep a column per row that becomes active.
// docs/qp.md, 4. Deviation: [Leu22 III-B] condenses every segment to a dense QP in its inputs; here
// the Hessian is never formed and costs nothing per segment.
//
// Quantities: 0 position, 1 velocity, 2 acceleration; the last one of the order is the input, with
// n values; the others have n + 1. A profile lists them all: index quantity (n + 1) + t.
#pragma once

#include "alloc/fixed_vector.h"
#include "opt/qp/lanes.h"
#include "rt/annotations.h"

namespace sopt {

struct IntegratorWeights {
  double position = 0.0;      // w_q >= 0
  double velocity = 1.0;      // w_v >= 0, > 0 when it is the input
  double acceleration = 2.0;  // w_a > 0; not used with velocity input
};

template <class Scalar>
class IntegratorKernel {
 public:
  IntegratorKernel() noexcept = default;
  // order 1: velocity input, 2: acceleration input. Segments of up to max_window steps, tables for
  // up to max_table (5.6 MB for order 2 and 60 in double precision).
  IntegratorKernel(Arena& arena, int order, const IntegratorWeights& weights, int max_window,
                   int max_table) noexcept;

  [[nodiscard]] int order() const SOPT_RT { return order_; }
  [[nodiscard]] int max_window() const SOPT_RT { return max_window_; }
  [[nodiscard]] int max_table() const SOPT_RT { return max_table_; }
  [[nodiscard]] int profile_size(int n) const SOPT_RT { return (order_ + 1) * (n + 1); }
  // w_q, w_v, w_a; of the quantities there are.
  [[nodiscard]] Scalar weight(int quantity) const SOPT_RT { return weights_[quantity]; }

  // Column (quantity, t) of G_n as a profile; n <= max_table.
  [[nodiscard]] const Scalar* table_column(int n, int index) const SOPT_RT {
    return tables_.begin() + table_begin_[n] + index * profile_size(n);
  }
  // 1 / sqrt(G_n(i,i)) as a profile, 1 where nothing can move; n <= max_table.
  [[nodiscard]] const Scalar* table_price(int n) const SOPT_RT {
    return prices_.begin() + profile_size_before(n);
  }
  // A column for any n <= max_window, into profile_size(n) numbers. Uses profiles of
  // `end_response`.
  void compute_column(int n, int index, const Scalar* end_response, Scalar* column) const SOPT_RT;

  // How the quantities follow the end: order profiles, one per unit change of q(n) and v(n).
  [[nodiscard]] const Scalar* table_end_response(int n) const SOPT_RT {
    return end_responses_.begin() + order_ * profile_size_before(n);
  }
  void compute_end_response(int n, Scalar* profiles) const SOPT_RT;

  // Both ends of a segment, and what pulls positions.
  template <int kLanes>
  struct Ends {
    Lanes<Scalar, kLanes> first_position{}, first_velocity{};
    Lanes<Scalar, kLanes> last_position{}, last_velocity{};
    Lanes<Scalar, kLanes> attractor{};
  };
  // Quantities under `force`, a profile with kLanes numbers per entry that is zero again
  // afterwards, into the profile `value`.
  template <int kLanes>
  void sweep(int n, const Ends<kLanes>& ends, const Scalar* end_response, Scalar* force,
             Scalar* value) const SOPT_RT;

 private:
  // Of the stage with g + 1 steps to go: input = offset - position_gain q - velocity_gain v.
  struct Stage {
    Scalar position_gain = 0, velocity_gain = 0, inverse_curvature = 0;
  };

  [[nodiscard]] int profile_size_before(int n) const SOPT_RT {
    return (order_ + 1) * (n * (n + 1) / 2);
  }
  void build_stages(const IntegratorWeights& weights) noexcept;
  void build_tables() noexcept;
  template <int kLanes>
  void sweep_velocity_input(int n, const Ends<kLanes>& ends, Scalar* force,
                            Scalar* value) const SOPT_RT;
  template <int kLanes>
  void sweep_acceleration_input(int n, const Ends<kLanes>& ends, Scalar* force,
                                Scalar* value) const SOPT_RT;
  template <int kLanes>
  void sweep_free_end(int n, const Ends<kLanes>& ends, Scalar* force, Scalar* value) const SOPT_RT;

  int order_ = 0;
  int max_window_ = 0;
  int max_table_ = 0;
  Scalar weights_[3] = {};
  FixedVector<Stage> stages_;          // max_window
  FixedVector<int> table_begin_;       // max_table + 1
  FixedVector<Scalar> tables_;         // G_n, n = 1 .. max_table
  FixedVector<Scalar> prices_;         // n = 0 .. max_table
  FixedVector<Scalar> end_responses_;  // n = 0 .. max_table
};

extern template class IntegratorKernel<double>;
extern template class IntegratorKernel<float>;

}  // namespace sopt
