#include "opt/qp/integrator_kernel.h"

#include <algorithm>
#include <cmath>

namespace sopt {
namespace {

// Size of all tables G_n, n = 1 .. max_table.
int total_table_size(int order, int max_table) noexcept {
  int total = 0;
  for (int n = 1; n <= max_table; ++n) total += (order + 1) * (order + 1) * (n + 1) * (n + 1);
  return total;
}

}  // namespace

template <class Scalar>
IntegratorKernel<Scalar>::IntegratorKernel(Arena& arena, int order,
                                           const IntegratorWeights& weights, int max_window,
                                           int max_table) noexcept
    : order_(order),
      max_window_(max_window),
      max_table_(std::min(max_table, max_window)),
      weights_{static_cast<Scalar>(weights.position), static_cast<Scalar>(weights.velocity),
               static_cast<Scalar>(weights.acceleration)},
      stages_(arena, max_window),
      table_begin_(arena, max_table_ + 1),
      tables_(arena, total_table_size(order, max_table_)),
      prices_(arena, profile_size_before(max_table_ + 1)),
      end_responses_(arena, order * profile_size_before(max_table_ + 1)) {
  if (!stages_.try_resize(max_window_) || !table_begin_.try_resize(max_table_ + 1) ||
      !tables_.try_resize(total_table_size(order, max_table_)) ||
      !prices_.try_resize(profile_size_before(max_table_ + 1)) ||
      !end_responses_.try_resize(order * profile_size_before(max_table_ + 1))) {
    return;  // the arena measures or is exhausted, which its owner sees
  }
  build_stages(weights);
  build_tables();
}

// Value function 1/2 x'S x with a free end, S = 0 there, for x = (q, v):
//     D = w + b'S b,   gains = b'S A / D,   S <- Q + A'S A - gains' D gains
template <class Scalar>
void IntegratorKernel<Scalar>::build_stages(const IntegratorWeights& weights) noexcept {
  double s_qq = 0.0;
  double s_qv = 0.0;
  double s_vv = 0.0;
  for (Stage& stage : stages_) {
    if (order_ == 1) {
      const double curvature = weights.velocity + s_qq;
      const double gain = s_qq / curvature;
      stage = {static_cast<Scalar>(gain), Scalar(0), static_cast<Scalar>(1.0 / curvature)};
      s_qq = weights.position + s_qq - gain * gain * curvature;
    } else {
      const double sb_q = 0.5 * s_qq + s_qv;
      const double sb_v = 0.5 * s_qv + s_vv;
      const double curvature = weights.acceleration + 0.5 * sb_q + sb_v;
      const double gain_q = sb_q / curvature;
      const double gain_v = (sb_q + sb_v) / curvature;
      stage = {static_cast<Scalar>(gain_q), static_cast<Scalar>(gain_v),
               static_cast<Scalar>(1.0 / curvature)};
      s_vv = weights.velocity + s_qq + 2.0 * s_qv + s_vv - gain_v * gain_v * curvature;
      s_qv = s_qq + s_qv - gain_q * gain_v * curvature;
      s_qq = weights.position + s_qq - gain_q * gain_q * curvature;
    }
  }
}

template <class Scalar>
void IntegratorKernel<Scalar>::build_tables() noexcept {
  int begin = 0;
  table_begin_[0] = 0;
  std::fill(prices_.begin(), prices_.end(), Scalar(1));
  std::fill(end_responses_.begin(), end_responses_.end(), Scalar(0));
  for (int n = 1; n <= max_table_; ++n) {
    table_begin_[n] = begin;
    Scalar* const response = end_responses_.begin() + order_ * profile_size_before(n);
    compute_end_response(n, response);
    const int size = profile_size(n);
    Scalar* const price = prices_.begin() + profile_size_before(n);
    for (int i = 0; i < size; ++i, begin += size) {
      Scalar* const column = tables_.begin() + begin;
      compute_column(n, i, response, column);
      price[i] = column[i] > Scalar(0) ? Scalar(1) / std::sqrt(column[i]) : Scalar(1);
    }
  }
}

template <class Scalar>
void IntegratorKernel<Scalar>::compute_column(int n, int index, const Scalar* end_response,
                                              Scalar* column) const SOPT_RT {
  std::fill(column, column + profile_size(n), Scalar(0));
  // Both ends are fixed, the input has n values, and with n <= order nothing can move.
  const int t = index % (n + 1);
  const bool is_input = index / (n + 1) == order_;
  if (n <= order_ || t == n || (t == 0 && !is_input)) return;
  column[index] = Scalar(1);
  sweep<1>(n, {}, end_response, column, column);
}

// Forces on the end, R M^-1: M maps them to the end itself.
template <class Scalar>
void IntegratorKernel<Scalar>::compute_end_response(int n, Scalar* profiles) const SOPT_RT {
  const int size = profile_size(n);
  std::fill(profiles, profiles + order_ * size, Scalar(0));
  if (n < order_) return;
  for (int k = 0; k < order_; ++k) {
    Scalar* const profile = profiles + k * size;
    profile[k * (n + 1) + n] = Scalar(1);
    sweep_free_end<1>(n, {}, profile, profile);
  }
  Scalar* const p = profiles;
  if (order_ == 1) {
    const Scalar inverse = Scalar(1) / p[n];
    for (int i = 0; i < size; ++i) p[i] *= inverse;
    return;
  }
  Scalar* const v = profiles + size;
  const Scalar m_pp = p[n];
  const Scalar m_vp = p[2 * n + 1];
  const Scalar m_pv = v[n];
  const Scalar m_vv = v[2 * n + 1];
  const Scalar inverse = Scalar(1) / (m_pp * m_vv - m_pv * m_vp);
  for (int i = 0; i < size; ++i) {
    const Scalar a = p[i];
    const Scalar b = v[i];
    p[i] = (a * m_vv - b * m_vp) * inverse;
    v[i] = (b * m_pp - a * m_pv) * inverse;
  }
}

// Backward: the costate p collects the forces, and offsets of the inputs go where the inputs will
// be. Forward: the state follows. `force` and `value` may be the same.
template <class Scalar>
template <int kLanes>
[[gnu::always_inline]] inline void IntegratorKernel<Scalar>::sweep_velocity_input(
    int n, const Ends<kLanes>& ends, Scalar* force, Scalar* value) const SOPT_RT {
  using Joints = Lanes<Scalar, kLanes>;
  const Joints pull = ends.attractor * weights_[0];
  Scalar* const force_v = force + kLanes * (n + 1);
  Scalar* const value_v = value + kLanes * (n + 1);
  Joints p = Joints::take(force + kLanes * n);
  for (int t = n - 1; t >= 0; --t) {
    const Stage& stage = stages_[n - 1 - t];
    const Joints h = Joints::take(force_v + kLanes * t) + p;
    p = p + Joints::take(force + kLanes * t) + pull - h * stage.position_gain;
    (h * stage.inverse_curvature).store(value_v + kLanes * t);
  }
  Joints q = ends.first_position;
  q.store(value);
  for (int t = 0; t < n; ++t) {
    const Stage& stage = stages_[n - 1 - t];
    const Joints v = Joints::load(value_v + kLanes * t) - q * stage.position_gain;
    v.store(value_v + kLanes * t);
    q += v;
    q.store(value + kLanes * (t + 1));
  }
}

template <class Scalar>
template <int kLanes>
[[gnu::always_inline]] inline void IntegratorKernel<Scalar>::sweep_acceleration_input(
    int n, const Ends<kLanes>& ends, Scalar* force, Scalar* value) const SOPT_RT {
  using Joints = Lanes<Scalar, kLanes>;
  const Joints pull = ends.attractor * weights_[0];
  Scalar* const force_v = force + kLanes * (n + 1);
  Scalar* const force_a = force_v + kLanes * (n + 1);
  Scalar* const value_v = value + kLanes * (n + 1);
  Scalar* const value_a = value_v + kLanes * (n + 1);
  Joints p_q = Joints::take(force + kLanes * n);
  Joints p_v = Joints::take(force_v + kLanes * n);
  for (int t = n - 1; t >= 0; --t) {
    const Stage& stage = stages_[n - 1 - t];
    const Joints h = Joints::take(force_a + kLanes * t) + p_q * Scalar(0.5) + p_v;
    p_v = Joints::take(force_v + kLanes * t) + p_q + p_v - h * stage.velocity_gain;
    p_q = Joints::take(force + kLanes * t) + p_q + pull - h * stage.position_gain;
    (h * stage.inverse_curvature).store(value_a + kLanes * t);
  }
  Joints q = ends.first_position;
  Joints v = ends.first_velocity;
  q.store(value);
  v.store(value_v);
  for (int t = 0; t < n; ++t) {
    const Stage& stage = stages_[n - 1 - t];
    const Joints a =
        Joints::load(value_a + kLanes * t) - q * stage.position_gain - v * stage.velocity_gain;
    a.store(value_a + kLanes * t);
    q += v + a * Scalar(0.5);
    v += a;
    q.store(value + kLanes * (t + 1));
    v.store(value_v + kLanes * (t + 1));
  }
}

template <class Scalar>
template <int kLanes>
[[gnu::always_inline]] inline void IntegratorKernel<Scalar>::sweep_free_end(
    int n, const Ends<kLanes>& ends, Scalar* force, Scalar* value) const SOPT_RT {
  if (order_ == 1) {
    sweep_velocity_input<kLanes>(n, ends, force, value);
  } else {
    sweep_acceleration_input<kLanes>(n, ends, force, value);
  }
}

template <class Scalar>
template <int kLanes>
void IntegratorKernel<Scalar>::sweep(int n, const Ends<kLanes>& ends, const Scalar* end_response,
                                     Scalar* force, Scalar* value) const SOPT_RT {
  using Joints = Lanes<Scalar, kLanes>;
  sweep_free_end<kLanes>(n, ends, force, value);
  const int size = profile_size(n);
  Scalar* const last_q = value + kLanes * n;
  const Joints miss_q = ends.last_position - Joints::load(last_q);
  if (order_ == 1) {
    for (int i = 0; i < size; ++i) {
      (Joints::load(value + kLanes * i) + miss_q * end_response[i]).store(value + kLanes * i);
    }
  } else {
    Scalar* const last_v = value + kLanes * (2 * n + 1);
    const Joints miss_v = ends.last_velocity - Joints::load(last_v);
    for (int i = 0; i < size; ++i) {
      (Joints::load(value + kLanes * i) + miss_q * end_response[i] +
       miss_v * end_response[size + i])
          .store(value + kLanes * i);
    }
    ends.last_velocity.store(last_v);
  }
  ends.last_position.store(last_q);
}

template class IntegratorKernel<double>;
template class IntegratorKernel<float>;
template void IntegratorKernel<double>::sweep(int, const Ends<4>&, const double*, double*,
                                              double*) const SOPT_RT;
template void IntegratorKernel<double>::sweep(int, const Ends<8>&, const double*, double*,
                                              double*) const SOPT_RT;
template void IntegratorKernel<float>::sweep(int, const Ends<8>&, const float*, float*,
                                             float*) const SOPT_RT;

}  // namespace sopt
