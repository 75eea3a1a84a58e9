#include "opt/verify/verify_arm_pairs.h"

#include <algorithm>
#include <cmath>

namespace sopt {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRounding_m = 1e-12;  // of frames and points, metres away from the base

constexpr std::size_t at(int i) noexcept { return static_cast<std::size_t>(i); }

Vec3 seen_from(const Pose3& X, const Vec3& p) noexcept {
  const Vec3 d = p - X.position;
  return {X.rotation.col(0).dot(d), X.rotation.col(1).dot(d), X.rotation.col(2).dot(d)};
}

// Frame of link b in that of link a.
Pose3 relative(const Pose3& X_WA, const Pose3& X_WB) noexcept {
  const Mat3 R_AW = X_WA.rotation.transpose();
  return {R_AW * X_WB.rotation, R_AW * (X_WB.position - X_WA.position)};
}

// What both kinds of pairs gather: the lowest of the bounds of their capsules.
class Gathering {
 public:
  Gathering(bool is_instant, double enough_m) noexcept
      : is_instant_(is_instant), enough_m_(enough_m) {}

  [[nodiscard]] bool is_enough(double lower_m) noexcept {
    if (lower_m < enough_m_) return false;
    bounds_.lower_m = std::min(bounds_.lower_m, lower_m);
    return true;
  }
  // Looks for the distance between cores that offset_m is to be taken from. False when nothing more
  // needs to be known.
  [[nodiscard]] bool look(const Convex3& obstacle, std::span<const Vec3> points, double offset_m,
                          Vec3& direction) noexcept {
    const Separation3 found =
        separate(obstacle, points, direction, {enough_m_ + offset_m, !is_instant_});
    direction = found.direction;
    bounds_.lower_m = std::min(bounds_.lower_m, found.lower_m - offset_m);
    if (!is_instant_) return bounds_.lower_m >= enough_m_;
    bounds_.upper_m = std::min(bounds_.upper_m, found.upper_m - offset_m);
    enough_m_ = std::min(enough_m_, bounds_.upper_m);
    return true;
  }
  [[nodiscard]] const ClearanceBounds& bounds() const noexcept { return bounds_; }

 private:
  bool is_instant_;
  double enough_m_;
  ClearanceBounds bounds_;
};

}  // namespace

template <int N>
struct ArmPairs<N>::Places {
  std::array<Vec3, 4> points;
  int num = 0;

  [[nodiscard]] std::span<const Vec3> view() const noexcept { return {points.data(), at(num)}; }
};

template <int N>
typename ArmPairs<N>::Places ArmPairs<N>::places(const ArmStretch<N>& stretch, const Pose3& from,
                                                 const Pose3& to, int i_capsule) const noexcept {
  const Capsule3& c = motion_.capsule_L(i_capsule);
  const bool is_sphere = c.p0 == c.p1;
  Places places;
  places.points[at(places.num++)] = moved(from, c.p0);
  if (!is_sphere) places.points[at(places.num++)] = moved(from, c.p1);
  if (stretch.is_instant()) return places;
  places.points[at(places.num++)] = moved(to, c.p0);
  if (!is_sphere) places.points[at(places.num++)] = moved(to, c.p1);
  return places;
}

template <int N>
double ArmPairs<N>::quick_bound_m(const ArmStretch<N>& stretch, const ArmPair& pair) const SOPT_RT {
  const int l = pair.i_link;
  const Sphere3& sphere = motion_.sphere_L(l);
  const int base = pair.is_self() ? arm_.body(pair.i_other_body).i_link : 0;
  const double error_m =
      stretch.is_instant() ? 0.0 : motion_.chord_error_m(stretch.change, l, base);
  const Pose3& X_WL0 = stretch.from->X_WL[at(l)];
  const Pose3& X_WL1 = stretch.to->X_WL[at(l)];
  Vec3 centers[] = {moved(X_WL0, sphere.center), moved(X_WL1, sphere.center)};
  Aabb3 other = pair.obstacle_box;
  double radius_m = sphere.radius_m + error_m + kRounding_m;
  if (pair.is_self()) {
    centers[0] = seen_from(stretch.from->X_WL[at(base)], centers[0]);
    centers[1] = seen_from(stretch.to->X_WL[at(base)], centers[1]);
    const Sphere3& fixed = motion_.sphere_L(base);
    other = {fixed.center, fixed.center};
    radius_m += fixed.radius_m;
  }
  const double gap_m = box_gap_m(box_around(centers), other);
  return gap_m > 0.0 ? gap_m - radius_m : -kInfinity;
}

template <int N>
ClearanceBounds ArmPairs<N>::find_bounds(const ArmStretch<N>& stretch, double enough_m,
                                         ArmPair& pair) const SOPT_RT {
  const double quick_m = quick_bound_m(stretch, pair);
  if (quick_m >= enough_m) return {quick_m, kInfinity};
  return pair.is_self() ? self_bounds(stretch, enough_m, pair)
                        : obstacle_bounds(stretch, enough_m, pair);
}

template <int N>
ClearanceBounds ArmPairs<N>::obstacle_bounds(const ArmStretch<N>& stretch, double enough_m,
                                             ArmPair& pair) const noexcept {
  const int l = pair.i_link;
  const Convex3& obstacle = world_.obstacle(pair.i_obstacle);
  const Pose3& X_WL0 = stretch.from->X_WL[at(l)];
  const Pose3& X_WL1 = stretch.to->X_WL[at(l)];
  const double error_m = stretch.is_instant() ? 0.0 : motion_.chord_error_m(stretch.change, l, 0);
  Gathering gathering(stretch.is_instant(), enough_m);
  for (int i = arm_.first_capsule(l); i < arm_.first_capsule(l + 1); ++i) {
    const Places found = places(stretch, X_WL0, X_WL1, i);
    const double grow_m = motion_.capsule_L(i).radius_m + error_m + kRounding_m;
    const double gap_m = box_gap_m(box_around(found.view()), pair.obstacle_box);
    if (gap_m > 0.0 && gathering.is_enough(gap_m - grow_m)) continue;
    if (!gathering.look(obstacle, found.view(), grow_m + obstacle.radius_m, pair.direction)) break;
  }
  return gathering.bounds();
}

// The difference of two cores is the hull of the differences of their ends.
template <int N>
ClearanceBounds ArmPairs<N>::self_bounds(const ArmStretch<N>& stretch, double enough_m,
                                         ArmPair& pair) const noexcept {
  const ArmBody& fixed = arm_.body(pair.i_other_body);
  const ArmBody& moving = arm_.body(pair.i_body);
  const int a = fixed.i_link;
  const int b = moving.i_link;
  const Pose3 X_AB0 = relative(stretch.from->X_WL[at(a)], stretch.from->X_WL[at(b)]);
  const Pose3 X_AB1 = relative(stretch.to->X_WL[at(a)], stretch.to->X_WL[at(b)]);
  const double error_m = stretch.is_instant() ? 0.0 : motion_.chord_error_m(stretch.change, b, a);
  Gathering gathering(stretch.is_instant(), enough_m);
  for (int i = moving.first; i < moving.last; ++i) {
    const Places found = places(stretch, X_AB0, X_AB1, i);
    const Aabb3 box = box_around(found.view());
    for (int k = fixed.first; k < fixed.last; ++k) {
      const Capsule3& c = motion_.capsule_L(k);
      const double grow_m = motion_.capsule_L(i).radius_m + c.radius_m + error_m + kRounding_m;
      const double gap_m = box_gap_m(box, {c.p0.cwiseMin(c.p1), c.p0.cwiseMax(c.p1)});
      if (gap_m > 0.0 && gathering.is_enough(gap_m - grow_m)) continue;
      std::array<Vec3, 8> points;
      std::size_t num = 0;
      for (const Vec3& p : found.view()) {
        points[num++] = p - c.p0;
        if (c.p1 != c.p0) points[num++] = p - c.p1;
      }
      if (!gathering.look(origin_, {points.data(), num}, grow_m, pair.direction)) {
        return gathering.bounds();
      }
    }
  }
  return gathering.bounds();
}

template class ArmPairs<4>;
template class ArmPairs<5>;
template class ArmPairs<6>;
template class ArmPairs<7>;
template class ArmPairs<8>;

}  // namespace sopt
