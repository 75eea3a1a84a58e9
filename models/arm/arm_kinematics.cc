// What `Arm<N>` computes in real time; arm.cc has what it prepares. An explicit instantiation
// covers the members its file defines.
#include <cmath>

#include "models/arm/arm.h"
#include "models/arm/sin_cos.h"

namespace sopt {
namespace {

constexpr double kPi = 3.14159265358979323846;

// Four joints from kFirst on, zeros beyond the last; in registers, as vectors that were stored
// number by number are slow to load.
template <int kFirst, class Config>
[[gnu::always_inline]] inline V4d joints4(const Config& values) noexcept {
  constexpr int kNum = Config::RowsAtCompileTime - kFirst;
  const double* v = values.data() + kFirst;
  if constexpr (kNum >= kLanesDouble) return load4(v);
  if constexpr (kNum == 3) return V4d{v[0], v[1], v[2], 0.0};
  if constexpr (kNum == 2) return V4d{v[0], v[1], 0.0, 0.0};
  return V4d{v[0], 0.0, 0.0, 0.0};
}

template <int kFirst, class Config>
[[gnu::always_inline]] inline void sin_cos_lanes(const Config& offset, const Config& turns,
                                                 const Config& q, double* sine,
                                                 double* cosine) noexcept {
  V4d s;
  V4d c;
  sin_cos4(joints4<kFirst>(offset) + joints4<kFirst>(turns) * joints4<kFirst>(q), s, c);
  std::memcpy(sine + kFirst, &s, sizeof s);
  std::memcpy(cosine + kFirst, &c, sizeof c);
}

}  // namespace

template <int N>
void Arm<N>::forward(const Config& q, Pose& pose) const SOPT_RT {
  const Kinematics& k = kinematics_;
  alignas(32) double sine[kMaxArmJoints];
  alignas(32) double cosine[kMaxArmJoints];
  sin_cos_lanes<0>(k.offset, k.turns, q, sine, cosine);
  if constexpr (N > kLanesDouble) sin_cos_lanes<kLanesDouble>(k.offset, k.turns, q, sine, cosine);
  V4d x = load3(k.X_WJ1.rotation.data());
  V4d y = load3(k.X_WJ1.rotation.data() + 3);
  V4d z = load3(k.X_WJ1.rotation.data() + 6);
  V4d p = load3(k.X_WJ1.position.data());
  pose.X_WJ[0] = k.X_WB;
  for (int j = 0; j < N; ++j) {
    if (j > 0) {
      const Vec3& o = k.position[at(j)];
      p += o.x() * x + o.y() * y + o.z() * z;
      const V4d twisted_y = k.cos_twist[j] * y + k.sin_twist[j] * z;
      z = k.cos_twist[j] * z - k.sin_twist[j] * y;
      y = twisted_y;
    }
    const V4d turned_x = cosine[j] * x + sine[j] * y;
    y = cosine[j] * y - sine[j] * x;
    x = turned_x;
    if (k.has_prismatic) p += (k.slides[j] * q[j]) * z;
    Pose3& X = pose.X_WJ[at(j + 1)];
    store3(x, X.rotation.data());
    store3(y, X.rotation.data() + 3);
    store3(z, X.rotation.data() + 6);
    store3(p, X.position.data());
  }
}

template <int N>
Pose3 Arm<N>::link_pose(const Pose& pose, int i_link) const SOPT_RT {
  const Pose3& X = pose.X_WJ[at(i_link)];
  return {X.rotation * R_JL_[at(i_link)], X.position};
}

template <int N>
typename Arm<N>::Config Arm<N>::distance_gradient(const Pose& pose, int i_link, const Vec3& p_W,
                                                  const Vec3& normal_W) const SOPT_RT {
  Config gradient = Config::Zero();
  for (int j = 0; j < i_link; ++j) {
    const Pose3& X = pose.X_WJ[at(j + 1)];
    const Vec3 axis = X.rotation.col(2);
    gradient[j] = kinematics_.slides[j] > 0.0 ? normal_W.dot(axis)
                                              : normal_W.dot(axis.cross(p_W - X.position));
  }
  return gradient;
}

template <int N>
typename Arm<N>::Config Arm<N>::difference(const Config& a, const Config& b) const SOPT_RT {
  Config d = b - a;
  for (int j = 0; j < N; ++j) {
    // Exactly b - a when that lies in (-pi, pi].
    d[j] -= is_continuous_[j] * 2.0 * kPi * std::ceil((d[j] - kPi) / (2.0 * kPi));
  }
  return d;
}

template <int N>
typename Arm<N>::Config Arm<N>::unwrapped(const Config& a, const Config& b) const SOPT_RT {
  Config result = b;
  for (int j = 0; j < N; ++j) {
    result[j] -= is_continuous_[j] * 2.0 * kPi * std::ceil((b[j] - a[j] - kPi) / (2.0 * kPi));
  }
  return result;
}

template <int N>
int Arm<N>::joint_outside_limits(const Config& q) const SOPT_RT {
  for (int j = 0; j < N; ++j) {
    if (!(q[j] >= lower_[j] && q[j] <= upper_[j])) return j;
  }
  return kNoJoint;
}

template class Arm<4>;
template class Arm<5>;
template class Arm<6>;
template class Arm<7>;
template class Arm<8>;

}  // namespace sopt
