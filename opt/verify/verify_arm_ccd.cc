#include "opt/verify/verify_arm_ccd.h"

#include <algorithm>

#include "models/space/ccd_check.h"

namespace sopt {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr std::size_t at(int i) noexcept { return static_cast<std::size_t>(i); }

Aabb3 no_box() noexcept { return {Vec3::Constant(kInfinity), Vec3::Constant(-kInfinity)}; }

Aabb3 widened(const Aabb3& box, double by_m) noexcept {
  return {box.lower - Vec3::Constant(by_m), box.upper + Vec3::Constant(by_m)};
}

void extend(Aabb3& box, const Aabb3& by) noexcept {
  box.lower = box.lower.cwiseMin(by.lower);
  box.upper = box.upper.cwiseMax(by.upper);
}

bool overlap(const Aabb3& a, const Aabb3& b) noexcept {
  for (int i = 0; i < 3; ++i) {
    if (a.lower[i] > b.upper[i] || b.lower[i] > a.upper[i]) return false;
  }
  return true;
}

// Whether the capsule's box along the obstacle's own axes comes within reach_m of the obstacle.
bool are_near(const Convex3& obstacle, const Capsule3& capsule, double reach_m) noexcept {
  if (obstacle.kind != CoreKind::kBox && obstacle.kind != CoreKind::kCylinder) return true;
  const double apart_m = obstacle.radius_m + capsule.radius_m + reach_m;
  const Vec3 d0 = capsule.p0 - obstacle.center;
  const Vec3 d1 = capsule.p1 - obstacle.center;
  for (int i = 0; i < 3; ++i) {
    const double a = obstacle.axes.col(i).dot(d0);
    const double b = obstacle.axes.col(i).dot(d1);
    const double beyond_m = obstacle.half_m[i] + apart_m;
    if (std::min(a, b) > beyond_m || std::max(a, b) < -beyond_m) return false;
  }
  return true;
}

}  // namespace

template <int N>
ArmCcd<N>::ArmCcd(const Arm<N>& arm, const VerifyProblem<Arm<N>>& problem,
                  const ArmMotion<N>& motion) noexcept
    : arm_(arm),
      world_(*problem.world),
      motion_(motion),
      inflate_m_(std::max(problem.min_clearance_m, 0.0)),
      self_inflate_m_(std::max(problem.min_self_clearance_m, 0.0)) {}

template <int N>
Violation ArmCcd<N>::run(double dt_s, double x_stop) noexcept {
  ArmPair pair;
  int found = -1;
  for (int first = 0; first == 0 || first < world_.num_obstacles(); first += kMaxObstacles) {
    load_obstacles(first);
    for (int t = 0; t <= motion_.horizon() && t < x_stop; ++t) {
      place_arm(t);
      if (!(first == 0 && find_bodies(pair)) && !find_obstacle(pair)) continue;
      found = t;
      x_stop = t;
    }
  }
  if (found >= 0) return describe(dt_s, found, pair);
  Violation none;
  none.kind = ViolationKind::kNone;
  return none;
}

template <int N>
void ArmCcd<N>::load_obstacles(int first) noexcept {
  first_obstacle_ = first;
  num_obstacles_ = std::min(world_.num_obstacles() - first, kMaxObstacles);
  for (int i = 0; i < num_obstacles_; ++i) {
    near_[at(i)] = widened(box_around(world_.obstacle(first + i)), inflate_m_ + kCcdReach_m);
  }
}

template <int N>
void ArmCcd<N>::place_arm(int waypoint) noexcept {
  motion_.find_frames(waypoint, frames_);
  link_boxes_.fill(no_box());
  for (int b = 0; b < arm_.num_bodies(); ++b) {
    const ArmBody& body = arm_.body(b);
    Aabb3 box = no_box();
    for (int i = body.first; i < body.last; ++i) {
      capsule_boxes_[at(i)] = bounding_box(capsule_W(i, body.i_link));
      extend(box, capsule_boxes_[at(i)]);
    }
    body_boxes_[at(b)] = box;
    extend(link_boxes_[at(body.i_link)], box);
  }
  arm_box_ = no_box();
  for (const Aabb3& box : link_boxes_) extend(arm_box_, box);
}

template <int N>
bool ArmCcd<N>::find_bodies(ArmPair& pair) const noexcept {
  for (const auto& bodies : arm_.self_collision_pairs()) {
    const Aabb3 near = widened(body_boxes_[at(bodies.i_body_b)], self_inflate_m_ + kCcdReach_m);
    if (!overlap(near, body_boxes_[at(bodies.i_body_a)]) || !may_touch(bodies)) continue;
    pair.i_link = arm_.body(bodies.i_body_b).i_link;
    pair.i_body = bodies.i_body_b;
    pair.i_other_body = bodies.i_body_a;
    return true;
  }
  return false;
}

template <int N>
bool ArmCcd<N>::may_touch(const typename Arm<N>::IndexPair& bodies) const noexcept {
  const ArmBody& one = arm_.body(bodies.i_body_b);
  const ArmBody& other = arm_.body(bodies.i_body_a);
  for (int i = one.first; i < one.last; ++i) {
    const Aabb3 near = widened(capsule_boxes_[at(i)], self_inflate_m_ + kCcdReach_m);
    if (!overlap(near, body_boxes_[at(bodies.i_body_a)])) continue;
    for (int k = other.first; k < other.last; ++k) {
      if (!overlap(near, capsule_boxes_[at(k)])) continue;
      const Convex3 second = to_convex(capsule_W(k, other.i_link));
      if (may_overlap(second, capsule_W(i, one.i_link), self_inflate_m_)) return true;
    }
  }
  return false;
}

template <int N>
bool ArmCcd<N>::find_obstacle(ArmPair& pair) const noexcept {
  for (int i = 0; i < num_obstacles_; ++i) {
    const Aabb3& near = near_[at(i)];
    if (!overlap(near, arm_box_)) continue;
    for (int l = 0; l <= N; ++l) {
      if (!overlap(near, link_boxes_[at(l)])) continue;
      if (!may_touch(l, first_obstacle_ + i, near)) continue;
      pair = {};
      pair.i_link = l;
      pair.i_obstacle = first_obstacle_ + i;
      pair.obstacle_box = box_around(world_.obstacle(pair.i_obstacle));
      return true;
    }
  }
  return false;
}

template <int N>
bool ArmCcd<N>::may_touch(int i_link, int i_obstacle, const Aabb3& near) const noexcept {
  const Convex3& obstacle = world_.obstacle(i_obstacle);
  for (int i = arm_.first_capsule(i_link); i < arm_.first_capsule(i_link + 1); ++i) {
    if (!overlap(near, capsule_boxes_[at(i)])) continue;
    const Capsule3 capsule = capsule_W(i, i_link);
    if (!are_near(obstacle, capsule, inflate_m_ + kCcdReach_m)) continue;
    if (may_overlap(obstacle, capsule, inflate_m_)) return true;
  }
  return false;
}

template <int N>
Capsule3 ArmCcd<N>::capsule_W(int i_capsule, int i_link) const noexcept {
  const Capsule3& c = motion_.capsule_L(i_capsule);
  const Pose3& X = frames_.X_WL[at(i_link)];
  const Vec3 p0 = moved(X, c.p0);
  return {p0, c.p1 == c.p0 ? p0 : moved(X, c.p1), c.radius_m};
}

template <int N>
Violation ArmCcd<N>::describe(double dt_s, int waypoint, ArmPair& pair) noexcept {
  motion_.find_frames(waypoint, frames_);
  const double x = waypoint;
  const ArmStretch<N> instant{&frames_, &frames_, x, x, {}};
  const ArmPairs<N> bounds(arm_, world_, motion_);
  const bool is_self = pair.is_self();
  return {ViolationKind::kSecondOpinion,
          std::min(waypoint, motion_.horizon() - 1),
          x * dt_s,
          pair.i_link,
          is_self ? kSelfObstacle : pair.i_obstacle,
          bounds.find_bounds(instant, kInfinity, pair).upper_m,
          is_self ? arm_.body(pair.i_other_body).i_link : kNoLink,
          kNoJoint};
}

template class ArmCcd<4>;
template class ArmCcd<5>;
template class ArmCcd<6>;
template class ArmCcd<7>;
template class ArmCcd<8>;

}  // namespace sopt
