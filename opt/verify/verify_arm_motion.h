// What verify knows about how an arm moves, none of it from the code that planned: link frames by
// products of the described origins and general axis-angle rotations, and a bound on how far a
// point of a link strays from the straight line between two of its places. Positions along the
// trajectory are in steps: 2.5 is half-way from waypoint 2 to 3. The bound: while joints move from
// q0 to q1, each within stray_j of the straight line in joint space, a point at most r_j from the
// axis of joint j stays within
//   sum_j r_j stray_j + 1/8 sum_jk r_max(j,k) |dq_j| |dq_k|
// of its chord, as |d2p/dq_j dq_k| <= r_max(j,k) in a chain (1 in place of r_j for a joint that
// slides, 0 where it comes first or twice). All in the frame of any link below, whose joints count.
#pragma once

#include <array>

#include "models/arm/arm.h"
#include "models/trajectory.h"
#include "rt/annotations.h"

namespace sopt {

template <int N>
struct LinkFrames {
  std::array<Pose3, N + 1> X_WL;
};

// By columns: Eigen's product is a call.
[[nodiscard]] inline Vec3 moved(const Pose3& X, const Vec3& p) SOPT_RT {
  return p.x() * X.rotation.col(0) + p.y() * X.rotation.col(1) + p.z() * X.rotation.col(2) +
         X.position;
}

template <int N>
class ArmMotion {
 public:
  using Config = typename Arm<N>::Config;

  // How joints get from one configuration to another, as magnitudes.
  struct Change {
    Config travel = Config::Zero();  // |q1 - q0|
    Config stray = Config::Zero();   // farthest from the straight line between
  };
  // What a joint reaches on the way, the extrema of its parabolas included.
  struct Range {
    Config lower, upper;
  };

  // A trajectory of the right shape, finite, whose defects are at most `defect`. O(horizon).
  ArmMotion(const Arm<N>& arm, const Trajectory<Arm<N>>& trajectory, double defect) noexcept;

  [[nodiscard]] int horizon() const SOPT_RT { return trajectory_.horizon(); }
  [[nodiscard]] Config configuration_at(double x) const SOPT_RT;
  void find_frames(double x, LinkFrames<N>& frames) const SOPT_RT;

  // From x0 to x1: waypoints, or both within one step. O(x1 - x0).
  [[nodiscard]] Change change(double x0, double x1) const SOPT_RT;
  // How far a point of link i_link's cores strays from its chord in the frame of link i_base. m.
  [[nodiscard]] double chord_error_m(const Change& change, int i_link, int i_base) const SOPT_RT;

  // Ends of a capsule's core in its link's frame.
  [[nodiscard]] const Capsule3& capsule_L(int i_capsule) const SOPT_RT {
    return capsules_[static_cast<std::size_t>(i_capsule)];
  }
  // Holds the link's capsules; link frame.
  [[nodiscard]] const Sphere3& sphere_L(int i_link) const SOPT_RT {
    return spheres_[static_cast<std::size_t>(i_link)];
  }

  // Over step t; `end_defect` of the states is not part of it.
  [[nodiscard]] static Range step_range(const Trajectory<Arm<N>>& trajectory, int t) SOPT_RT;

 private:
  // R(q) = cos q * in_plane + sin q * turned + along, all times the rotation of the origin.
  struct Joint {
    Mat3 in_plane, turned, along;
    Vec3 position, slide;  // slide: the axis where the joint slides, else 0
    Vec3 axis;             // in its own frame
    bool turns = true;

    [[nodiscard]] Pose3 motion(double q) const noexcept;
  };

  void set_joints(const Arm<N>& arm) noexcept;
  void set_capsules(const Arm<N>& arm) noexcept;
  void set_reach(const Arm<N>& arm, const Range& range) noexcept;

  const Trajectory<Arm<N>>& trajectory_;
  double defect_;
  Pose3 X_WB_;
  std::array<Joint, N> joints_;
  std::array<Capsule3, kMaxLinkCapsules> capsules_;
  std::array<Sphere3, N + 1> spheres_;
  std::array<Config, N + 1> reach_m_;  // [i_link][i_joint]: r_j above, 1 where the joint slides
};

extern template class ArmMotion<4>;
extern template class ArmMotion<5>;
extern template class ArmMotion<6>;
extern template class ArmMotion<7>;
extern template class ArmMotion<8>;

}  // namespace sopt
