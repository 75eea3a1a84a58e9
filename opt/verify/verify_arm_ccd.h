// Second opinion on an arm's clearance at waypoints, for verify: libccd is asked about every two
// capsules that may collide, and every capsule and obstacle, whose boxes come within the hard
// minimum plus kCcdReach_m of each other. Boxes alone decide whom to ask, of arm, link or body,
// then capsule; no distance of verify's is used, so that an error there is none here. All
// obstacles, all waypoints, no heap. Of an arm of 59 capsules 1 us per waypoint and 0.1 us per
// answer.
#pragma once

#include <array>

#include "models/capacity.h"
#include "opt/verify/verify.h"
#include "opt/verify/verify_arm_pairs.h"

namespace sopt {

// Boxes that are further apart prove by themselves what libccd would be asked, beyond kCcdPad_m;
// the rest, a thousand times as much, is for errors in the boxes.
inline constexpr double kCcdReach_m = 1e-3;

template <int N>
class ArmCcd {
 public:
  ArmCcd(const Arm<N>& arm, const VerifyProblem<Arm<N>>& problem,
         const ArmMotion<N>& motion) noexcept;

  // The first waypoint before x_stop, in steps, where contact cannot be ruled out, or kNone.
  [[nodiscard]] Violation run(double dt_s, double x_stop) noexcept;

 private:
  static constexpr int kMaxObstacles = 128;  // looked at together

  void load_obstacles(int first) noexcept;
  void place_arm(int waypoint) noexcept;
  // Of the arm as placed; the first pair that may touch.
  [[nodiscard]] bool find_bodies(ArmPair& pair) const noexcept;
  [[nodiscard]] bool find_obstacle(ArmPair& pair) const noexcept;
  [[nodiscard]] bool may_touch(const typename Arm<N>::IndexPair& bodies) const noexcept;
  [[nodiscard]] bool may_touch(int i_link, int i_obstacle, const Aabb3& near) const noexcept;
  [[nodiscard]] Capsule3 capsule_W(int i_capsule, int i_link) const noexcept;
  [[nodiscard]] Violation describe(double dt_s, int waypoint, ArmPair& pair) noexcept;

  const Arm<N>& arm_;
  const World3& world_;
  const ArmMotion<N>& motion_;
  double inflate_m_;
  double self_inflate_m_;
  int first_obstacle_ = 0;
  int num_obstacles_ = 0;
  std::array<Aabb3, kMaxObstacles> near_;  // boxes of obstacles, grown
  // --- at one waypoint
  LinkFrames<N> frames_;
  std::array<Aabb3, kMaxLinkCapsules> capsule_boxes_;
  std::array<Aabb3, kMaxBodies> body_boxes_;
  std::array<Aabb3, N + 1> link_boxes_;
  Aabb3 arm_box_;
};

extern template class ArmCcd<4>;
extern template class ArmCcd<5>;
extern template class ArmCcd<6>;
extern template class ArmCcd<7>;
extern template class ArmCcd<8>;

}  // namespace sopt
