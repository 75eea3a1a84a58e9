// Eight configurations of an arm at a time, frames in float; angles are reduced in double.
//
// The pad. Let u = 2^-24. Turning a frame by a twist and by an angle adds at most 12 u to each of
// its columns (constants rounded, sine and cosine within 2 u, two products, a sum; twice), so after
// j joints they are off by 12 j u. A point is the sum of the base's position and of frames times
// offsets: off by the columns' error and 4 u for the product, times the offset's 1-norm, and by u
// times the sum for every addition. With N <= 8 that is less than 112 u L, L the sum of all
// 1-norms; kLanePad is 192.
#pragma once

#include <algorithm>

#include "models/arm/arm.h"
#include "models/arm/sin_cos.h"
#include "models/simd.h"

namespace sopt {

inline constexpr double kLanePad = 0x1.8p-17;

struct LaneVec3 {
  V8f x, y, z;
};

struct LaneFrame {
  LaneVec3 x, y, z;  // columns
  LaneVec3 position;
};

// One joint of eight configurations.
struct LaneJoint {
  V4d low, high;
};

template <int N>
struct LaneConfig {
  std::array<LaneJoint, N> joint;
};

template <int N>
struct LanePose {
  std::array<LaneFrame, N + 1> X_WJ;
};

[[gnu::always_inline]] inline LaneVec3 splat(const Vec3& v) noexcept {
  return {splat8(static_cast<float>(v.x())), splat8(static_cast<float>(v.y())),
          splat8(static_cast<float>(v.z()))};
}
[[gnu::always_inline]] inline LaneVec3 operator+(const LaneVec3& a, const LaneVec3& b) noexcept {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
[[gnu::always_inline]] inline LaneVec3 operator-(const LaneVec3& a, const LaneVec3& b) noexcept {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class Scalar>  // float or V8f
[[gnu::always_inline]] inline LaneVec3 operator*(const Scalar& s, const LaneVec3& v) noexcept {
  return {s * v.x, s * v.y, s * v.z};
}
[[gnu::always_inline]] inline V8f dot(const LaneVec3& a, const LaneVec3& b) noexcept {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
[[gnu::always_inline]] inline LaneVec3 turn(const LaneFrame& X, float x, float y,
                                            float z) noexcept {
  return x * X.x + y * X.y + z * X.z;
}

template <int N>
[[gnu::always_inline]] inline void forward_lanes(const Arm<N>& arm, const LaneConfig<N>& q,
                                                 LanePose<N>& pose) noexcept {
  const auto& k = arm.kinematics();
  pose.X_WJ[0] = {splat(k.X_WB.rotation.col(0)), splat(k.X_WB.rotation.col(1)),
                  splat(k.X_WB.rotation.col(2)), splat(k.X_WB.position)};
  LaneFrame X{splat(k.X_WJ1.rotation.col(0)), splat(k.X_WJ1.rotation.col(1)),
              splat(k.X_WJ1.rotation.col(2)), splat(k.X_WJ1.position)};
  for (int j = 0; j < N; ++j) {
    const auto i = static_cast<std::size_t>(j);
    if (j > 0) {
      const Eigen::Vector3f o = k.position[i].template cast<float>();
      X.position = X.position + turn(X, o.x(), o.y(), o.z());
      const auto c = static_cast<float>(k.cos_twist[j]);
      const auto s = static_cast<float>(k.sin_twist[j]);
      const LaneVec3 twisted_y = c * X.y + s * X.z;
      X.z = c * X.z - s * X.y;
      X.y = twisted_y;
    }
    const auto& [low, high] = q.joint[i];
    V8f s, c;
    sin_cos8(k.offset[j] + k.turns[j] * low, k.offset[j] + k.turns[j] * high, s, c);
    const LaneVec3 turned_x = c * X.x + s * X.y;
    X.y = c * X.y - s * X.x;
    X.x = turned_x;
    if (k.has_prismatic) {
      X.position = X.position + join8(k.slides[j] * low, k.slides[j] * high) * X.z;
    }
    pose.X_WJ[i + 1] = X;
  }
}

// How far off a point fixed to link i_link may be: its 1-norm in the link's joint frame is at most
// reach_m, every joint's travel at most max_slide_m where it slides.
template <int N>
[[nodiscard]] double lane_pad_m(const Arm<N>& arm, double reach_m, double slides_m) SOPT_RT {
  const auto& k = arm.kinematics();
  double sum_m = k.X_WJ1.position.template lpNorm<1>() + reach_m + slides_m;
  for (int j = 1; j < N; ++j) {
    sum_m += k.position[static_cast<std::size_t>(j)].template lpNorm<1>();
  }
  return kLanePad * sum_m;
}

}  // namespace sopt
