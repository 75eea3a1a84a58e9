// The linearised clearances of one arm window [Leu22, Alg. 2]: per interior waypoint t and contact
// within the activation radius the row
//     gradient . theta_t >= required - distance + gradient . theta_ref,t
// with the gradient by the envelope theorem (models/arm/arm_clearance.h). Rows in order of time.
// When they do not fit, those with the largest slack at the reference go first.
#pragma once

#include "alloc/fixed_vector.h"
#include "models/arm/arm.h"
#include "models/arm/arm_clearance.h"
#include "rt/annotations.h"

namespace sopt {

template <int N>
struct ArmRow {
  int t = 0;  // within the window
  typename Arm<N>::Config gradient;
  double bound = 0.0;    // gradient . theta_t >= bound, m
  double slack_m = 0.0;  // distance - required at the reference
};

template <int N>
class ArmRows {
 public:
  using Config = typename Arm<N>::Config;

  ArmRows() noexcept = default;
  ArmRows(Arena& arena, int max_rows) noexcept
      : max_rows_(max_rows), rows_(arena, kRoom * max_rows), slacks_(arena, kRoom * max_rows) {}

  void clear() SOPT_RT { rows_.clear(); }
  // Adds the row of a contact at waypoint t, no earlier than those before; `at` is what theta_t is
  // compared with: the reference. A contact that the joints do not change gives none.
  void add(int t, const Config& at, const Config& gradient, double distance_m,
           double required_m) SOPT_RT;
  // After the last row: leaves as many as fit.
  void trim() SOPT_RT;

  [[nodiscard]] std::span<const ArmRow<N>> rows() const SOPT_RT { return rows_.span(); }

 private:
  static constexpr int kRoom = 4;  // times max_rows, so that few of them have to be sorted out

  int max_rows_ = 0;
  FixedVector<ArmRow<N>> rows_;
  FixedVector<double> slacks_;
};

extern template class ArmRows<4>;
extern template class ArmRows<5>;
extern template class ArmRows<6>;
extern template class ArmRows<7>;
extern template class ArmRows<8>;

}  // namespace sopt
