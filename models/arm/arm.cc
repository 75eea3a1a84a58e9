#include "models/arm/arm.h"

#include <algorithm>
#include <limits>

#include "models/arm/arm_checks.h"
#include "models/space/pose3.h"

namespace sopt {
namespace {

// A unit vector perpendicular to the unit vector z, and to w as well as rounding allows.
Vec3 perpendicular(const Vec3& z, const Vec3& w) noexcept {
  constexpr double kParallel = 1e-12;
  Vec3 x = z.cross(w);
  if (x.norm() < kParallel) {
    int i_least = 0;
    (void)z.cwiseAbs().minCoeff(&i_least);
    x = z.cross(Vec3::Unit(i_least));
  }
  x.normalize();
  return (x - z * z.dot(x)).normalized();
}

// Ball around the places a point can take while the joints between it and a frame move.
struct Reach {
  Vec3 center;
  double radius_m = 0.0;

  [[nodiscard]] double from_axis() const noexcept { return center.head<2>().norm() + radius_m; }
};

}  // namespace

template <int N>
ArmStatus Arm<N>::reset(const ArmDescription<N>& description) noexcept {
  const ArmStatus status = check_description<N>(description);
  if (status != ArmStatus::kOk) return status;
  Arm next;
  next.joints_ = description.joints;
  for (int j = 0; j < N; ++j) {
    const ArmJoint& joint = next.joints_[at(j)];
    next.lower_[j] = joint.lower;
    next.upper_[j] = joint.upper;
    next.v_max_[j] = joint.v_max;
    next.a_max_[j] = joint.a_max;
    next.weights_[j] = joint.weight;
    next.is_continuous_[j] = joint.kind == JointKind::kContinuous ? 1.0 : 0.0;
  }
  next.fold_frames(description.X_WB);
  std::copy(description.capsules.begin(), description.capsules.end(), next.sources_.begin());
  std::copy(description.pairs.begin(), description.pairs.end(), next.source_pairs_.begin());
  next.num_own_ = static_cast<int>(description.capsules.size());
  next.num_capsules_ = next.num_own_;
  next.num_source_pairs_ = static_cast<int>(description.pairs.size());
  const ArmStatus built = next.rebuild();
  if (built == ArmStatus::kOk) *this = next;
  return built;
}

template <int N>
ArmStatus Arm<N>::try_attach(std::span<const LinkCapsule> object) noexcept {
  const std::size_t room = at(kMaxLinkCapsules - num_capsules_);
  if (object.size() > room) return ArmStatus::kTooManyCapsules;
  const ArmStatus status = check_capsules(object, N + 1);
  if (status != ArmStatus::kOk) return status;
  Arm next = *this;
  std::copy(object.begin(), object.end(), next.sources_.begin() + num_capsules_);
  next.num_capsules_ += static_cast<int>(object.size());
  const ArmStatus built = next.rebuild();
  if (built == ArmStatus::kOk) *this = next;
  return built;
}

template <int N>
void Arm<N>::detach() noexcept {
  num_capsules_ = num_own_;
  (void)rebuild();  // fewer of what fitted before
}

// X_J(i-1)J(i) = [R_x(twist_i) R_z(offset_i), p_i] holds when x of J(i-1) is perpendicular to the
// axes of both joints: z of J(i) then lies in the y-z plane of J(i-1).
template <int N>
void Arm<N>::fold_frames(const Pose3& X_WB) noexcept {
  std::array<Mat3, N + 1> R_LJ;
  R_LJ[0].setIdentity();
  for (int i = 1; i <= N; ++i) {
    const Vec3 z = joints_[at(i - 1)].axis.normalized();
    const Vec3 next_axis = i < N ? Vec3(joints_[at(i)].origin.rotation * joints_[at(i)].axis) : z;
    const Vec3 x = perpendicular(z, next_axis);
    R_LJ[at(i)].col(0) = x;
    R_LJ[at(i)].col(1) = z.cross(x);
    R_LJ[at(i)].col(2) = z;
  }
  Kinematics& k = kinematics_;
  k.X_WB = X_WB;
  for (int i = 0; i <= N; ++i) R_JL_[at(i)] = R_LJ[at(i)].transpose();
  for (int j = 0; j < N; ++j) {
    const Pose3& origin = joints_[at(j)].origin;
    const Mat3 R_JJ = R_JL_[at(j)] * origin.rotation * R_LJ[at(j + 1)];
    const Vec3 z = R_JJ.col(2);
    k.sin_twist[j] = -z.y();
    k.cos_twist[j] = z.z();
    // The first column of R_x(-twist) R_JJ is (cos offset, sin offset, 0).
    k.offset[j] = std::atan2(k.cos_twist[j] * R_JJ(1, 0) + k.sin_twist[j] * R_JJ(2, 0), R_JJ(0, 0));
    k.position[at(j)] = R_JL_[at(j)] * origin.position;
    k.slides[j] = joints_[at(j)].kind == JointKind::kPrismatic ? 1.0 : 0.0;
    k.turns[j] = 1.0 - k.slides[j];
    if (k.slides[j] > 0.0) k.has_prismatic = true;
  }
  k.X_WJ1 = compose(compose(X_WB, joints_[0].origin), {R_LJ[1], Vec3::Zero()});
  k.offset[0] = 0.0;
}

template <int N>
ArmStatus Arm<N>::rebuild() noexcept {
  sort_capsules();
  if (num_bodies_ > kMaxBodies) return ArmStatus::kTooManyBodies;
  resolve_pairs();
  bound_links();
  const std::span<const Capsule3> capsules(capsules_.data(), at(num_capsules_));
  cover_.build(capsules);
  capsule_spheres_.build(capsules, {bodies_.data(), at(num_bodies_)});
  for (int l = 0; l <= N; ++l) link_cover_[at(l)] = to_cover(spheres_[at(l)]);
  for (int b = 0; b < num_bodies_; ++b) body_cover_[at(b)] = to_cover(bodies_[at(b)].sphere);
  return ArmStatus::kOk;
}

// Also counts bodies, beyond their capacity too, and lists those that fit.
template <int N>
void Arm<N>::sort_capsules() noexcept {
  std::array<int, kMaxLinkCapsules> order{};
  for (int i = 0; i < num_capsules_; ++i) {
    const auto key = [this](int c) {
      return sources_[at(c)].i_link * kMaxBodies + sources_[at(c)].i_body;
    };
    int place = i;  // insertion sort: stable, in place
    for (; place > 0 && key(order[at(place - 1)]) > key(i); --place) {
      order[at(place)] = order[at(place - 1)];
    }
    order[at(place)] = i;
  }
  num_bodies_ = 0;
  first_.fill(0);
  for (int i = 0; i < num_capsules_; ++i) {
    const LinkCapsule& source = sources_[at(order[at(i)])];
    const Mat3& R_JL = R_JL_[at(source.i_link)];
    capsules_[at(i)] = {R_JL * source.p0, R_JL * source.p1, source.radius_m};
    link_of_[at(i)] = source.i_link;
    for (int l = source.i_link + 1; l <= N + 1; ++l) first_[at(l)] = i + 1;
    const LinkCapsule& before = sources_[at(order[at(std::max(i, 1) - 1)])];
    const bool is_new = i == 0 || before.i_link != source.i_link || before.i_body != source.i_body;
    if (is_new && ++num_bodies_ > kMaxBodies) continue;
    if (num_bodies_ > kMaxBodies) continue;
    ArmBody& body = bodies_[at(num_bodies_ - 1)];
    if (is_new) body = {source.i_link, i, i, {}};
    body.last = i + 1;
    body_name_[at(num_bodies_ - 1)] = source.i_body;
  }
}

template <int N>
void Arm<N>::resolve_pairs() noexcept {
  const auto find_body = [this](int i_link, int i_body) {
    int i = 0;
    while (i < num_bodies_ && (bodies_[at(i)].i_link != i_link || body_name_[at(i)] != i_body)) ++i;
    return i;
  };
  num_pairs_ = 0;
  for (int p = 0; p < num_source_pairs_; ++p) {
    const BodyPair& pair = source_pairs_[at(p)];
    const int a = find_body(pair.i_link_a, pair.i_body_a);
    const int b = find_body(pair.i_link_b, pair.i_body_b);
    if (a == num_bodies_ || b == num_bodies_) continue;
    pairs_[at(num_pairs_++)] = {std::min(a, b), std::max(a, b)};
  }
}

template <int N>
void Arm<N>::bound_links() noexcept {
  const std::span<const Capsule3> all(capsules_.data(), at(num_capsules_));
  for (int l = 0; l <= N; ++l) {
    const int first = first_capsule(l);
    spheres_[at(l)] = enclosing_sphere(all.subspan(at(first), at(first_capsule(l + 1) - first)));
  }
  for (int b = 0; b < num_bodies_; ++b) {
    ArmBody& body = bodies_[at(b)];
    body.sphere = enclosing_sphere(all.subspan(at(body.first), at(body.last - body.first)));
  }
  for (int j = 0; j < N; ++j) {
    for (int k = 0; k < num_capsules_; ++k) {
      const int l = capsule_link(k);
      capsule_reach_[at(k)][j] = std::max(reach_of(j, l, capsules_[at(k)].p0),  //
                                          reach_of(j, l, capsules_[at(k)].p1));
    }
    for (int l = 0; l <= N; ++l) {
      reach_[at(l)][j] = reach_of(j, l, spheres_[at(l)].center);
      for (int k = first_capsule(l); k < first_capsule(l + 1); ++k) {
        reach_[at(l)][j] = std::max(reach_[at(l)][j], capsule_reach_[at(k)][j]);
      }
    }
    for (int b = 0; b < num_bodies_; ++b) {
      double& reach_m = reach_[at(bodies_[at(b)].i_link)][j];
      reach_m = std::max(reach_m, reach_of(j, bodies_[at(b)].i_link, bodies_[at(b)].sphere.center));
    }
  }
}

// Carries the point from its link down to the joint's frame. A joint that turns sweeps a ball
// about its axis, which a larger ball on the axis contains; one that slides lengthens it.
template <int N>
double Arm<N>::reach_of(int i_joint, int i_link, const Vec3& point) const noexcept {
  constexpr double kRounding = 1.0 + 1e-12;
  if (i_joint >= i_link) return 0.0;
  if (joints_[at(i_joint)].kind == JointKind::kPrismatic) return 1.0;
  Reach reach{point};
  for (int j = i_link - 1; j > i_joint; --j) {
    const double c = kinematics_.cos_twist[j];
    const double s = kinematics_.sin_twist[j];
    Vec3& p = reach.center;
    if (kinematics_.slides[j] > 0.0) {
      reach.radius_m += 0.5 * (upper_[j] - lower_[j]);
      p.z() += 0.5 * (upper_[j] + lower_[j]);
      const double co = std::cos(kinematics_.offset[j]);
      const double so = std::sin(kinematics_.offset[j]);
      p = Vec3(co * p.x() - so * p.y(), so * p.x() + co * p.y(), p.z());
    } else {
      reach = {Vec3(0.0, 0.0, p.z()), reach.from_axis()};
    }
    p = Vec3(p.x(), c * p.y() - s * p.z(), s * p.y() + c * p.z()) + kinematics_.position[at(j)];
  }
  return reach.from_axis() * kRounding;
}

template <int N>
ConfigBox<N> Arm<N>::sampling_box(const World& /*world*/,
                                  const ClearanceRule& /*rule*/) const SOPT_RT {
  constexpr double kPi = 3.14159265358979323846;
  ConfigBox<N> box{lower_, upper_};
  for (int j = 0; j < N; ++j) {
    if (!is_continuous(j)) continue;
    box.lower[j] = -kPi;
    box.upper[j] = kPi;
  }
  return box;
}

template class Arm<4>;
template class Arm<5>;
template class Arm<6>;
template class Arm<7>;
template class Arm<8>;

}  // namespace sopt
