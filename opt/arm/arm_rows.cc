#include "opt/arm/arm_rows.h"

#include <algorithm>

namespace sopt {
namespace {

// Squared gradients below this, (m/unit)^2, are rounding.
constexpr double kNoGradient2 = 1e-16;

}  // namespace

template <int N>
void ArmRows<N>::add(int t, const Config& at, const Config& gradient, double distance_m,
                     double required_m) SOPT_RT {
  if (!(gradient.squaredNorm() > kNoGradient2)) return;
  const double slack_m = distance_m - required_m;
  if (rows_.size() == rows_.capacity()) trim();
  (void)rows_.try_push_back({t, gradient, gradient.dot(at) - slack_m, slack_m});
}

template <int N>
void ArmRows<N>::trim() SOPT_RT {
  if (rows_.size() <= max_rows_) return;
  if (max_rows_ == 0) return rows_.clear();
  slacks_.clear();
  for (const ArmRow<N>& row : rows_) (void)slacks_.try_push_back(row.slack_m);
  double* const last_kept = slacks_.begin() + max_rows_ - 1;
  std::nth_element(slacks_.begin(), last_kept, slacks_.end());
  // Of equal ones the first stay.
  const double limit_m = *last_kept;
  auto num_equal = std::count(slacks_.begin(), slacks_.begin() + max_rows_, limit_m);
  const auto goes = [&](const ArmRow<N>& row) {
    return row.slack_m > limit_m || (row.slack_m == limit_m && num_equal-- <= 0);
  };
  const ArmRow<N>* const end = std::remove_if(rows_.begin(), rows_.end(), goes);
  (void)rows_.try_resize(static_cast<int>(end - rows_.begin()));
}

template class ArmRows<4>;
template class ArmRows<5>;
template class ArmRows<6>;
template class ArmRows<7>;
template class ArmRows<8>;

}  // namespace sopt
