// The clearance of one pair, a link and an obstacle or two bodies of the arm, at an instant or over
// a whole stretch of motion. Over a stretch a core stays within the hull of its places at both
// ends, grown by the error of the chords; so the gap between that hull and the obstacle bounds the
// clearance from below, and the bound converges as stretches get shorter. Two bodies are looked at
// in the frame of the lower one, where only the joints between them move. Boxes and spheres first.
#pragma once

#include <limits>

#include "models/space/world3.h"
#include "opt/verify/separation3.h"
#include "opt/verify/verify_arm_motion.h"

namespace sopt {

struct ArmPair {
  int i_link = 0;
  int i_obstacle = kNoObstacle;  // or two bodies:
  int i_body = -1;               // of i_link
  int i_other_body = -1;         // of a link below
  Aabb3 obstacle_box;
  Vec3 direction = Vec3::Zero();  // along which the pair was last found apart

  [[nodiscard]] bool is_self() const SOPT_RT { return i_body >= 0; }
};

// From x_from to x_to, or an instant, when `to` is `from`.
template <int N>
struct ArmStretch {
  const LinkFrames<N>* from = nullptr;
  const LinkFrames<N>* to = nullptr;
  double x_from = 0.0;
  double x_to = 0.0;
  typename ArmMotion<N>::Change change;

  [[nodiscard]] bool is_instant() const SOPT_RT { return from == to; }
};

struct ClearanceBounds {
  double lower_m = std::numeric_limits<double>::infinity();
  double upper_m = std::numeric_limits<double>::infinity();  // of an instant only
};

// Gap between two boxes, 0 when they overlap.
[[nodiscard]] inline double box_gap_m(const Aabb3& a, const Aabb3& b) SOPT_RT {
  return (a.lower - b.upper).cwiseMax(b.lower - a.upper).cwiseMax(0.0).norm();
}
[[nodiscard]] inline Aabb3 box_around(std::span<const Vec3> points) SOPT_RT {
  Aabb3 box{points[0], points[0]};
  for (const Vec3& p : points.subspan(1)) {
    box.lower = box.lower.cwiseMin(p);
    box.upper = box.upper.cwiseMax(p);
  }
  return box;
}

template <int N>
class ArmPairs {
 public:
  ArmPairs(const Arm<N>& arm, const World3& world, const ArmMotion<N>& motion) noexcept
      : arm_(arm), world_(world), motion_(motion) {}

  // Bounds that are as tight as what is asked: a lower bound of enough_m needs no improvement, and
  // of a stretch whose lower bound cannot be that high only this counts. Remembers a direction.
  [[nodiscard]] ClearanceBounds find_bounds(const ArmStretch<N>& stretch, double enough_m,
                                            ArmPair& pair) const SOPT_RT;

  // A quick lower bound by spheres and boxes.
  [[nodiscard]] double quick_bound_m(const ArmStretch<N>& stretch,
                                     const ArmPair& pair) const SOPT_RT;

 private:
  struct Places;  // of a core at both ends of a stretch

  [[nodiscard]] ClearanceBounds obstacle_bounds(const ArmStretch<N>& stretch, double enough_m,
                                                ArmPair& pair) const noexcept;
  [[nodiscard]] ClearanceBounds self_bounds(const ArmStretch<N>& stretch, double enough_m,
                                            ArmPair& pair) const noexcept;
  [[nodiscard]] Places places(const ArmStretch<N>& stretch, const Pose3& from, const Pose3& to,
                              int i_capsule) const noexcept;

  const Arm<N>& arm_;
  const World3& world_;
  const ArmMotion<N>& motion_;
  Convex3 origin_;  // a point
};

extern template class ArmPairs<4>;
extern template class ArmPairs<5>;
extern template class ArmPairs<6>;
extern template class ArmPairs<7>;
extern template class ArmPairs<8>;

}  // namespace sopt
