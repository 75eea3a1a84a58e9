#include "models/arm/arm_motion.h"

#include <cmath>
#include <limits>

#include "models/arm/arm_clearance.h"
#include "models/arm/arm_lanes.h"

namespace sopt {
namespace {

// Of the clearance asked for above the floor, what a link may travel to the ends of a piece.
constexpr double kRoomShare = 0.5;
constexpr int kMaxTurns = 1 << 14;
constexpr double kLeastHalf = 0x1p-24;
// 8 pieces at first, one more for each that is halved, 21 times at most.
constexpr int kStack = 256;

constexpr int kObstaclesAtOnce = 16;
constexpr int kSpheresAtOnce = 16;

constexpr std::size_t at(int i) noexcept { return static_cast<std::size_t>(i); }

template <int N>
class MotionCheck {
 public:
  using Config = typename Arm<N>::Config;

  MotionCheck(const Arm<N>& arm, const World3& world, const ClearanceRule& rule,
              double self_clearance_m, const Config& a, const Config& b) noexcept
      : arm_(arm),
        world_(world),
        rule_(rule),
        a_(a),
        travel_(arm.difference(a, b)),
        abs_travel_(travel_.cwiseAbs()) {
    self_m_ = std::max(self_clearance_m, kSelfClearance_m);
    rule_.floor_m = rule.floor_m + kMotionRoom_m;
    rule_.cap_m = std::max(rule.cap_m, rule_.floor_m);
    room_m_ = float_below(
        std::max(kMotionRoom_m, kRoomShare * (world.min_required_m(rule_) - rule.floor_m)));
    self_room_m_ = float_below(self_m_);
    double reach_m = 0.0;
    double slides_m = 0.0;
    for (int l = 1; l <= N; ++l) {
      travel_m_[at(l)] = float_above(arm.displacement_bound(l, abs_travel_));
      const Sphere3& sphere = arm.link_sphere_J(l);
      reach_m = std::max(reach_m, sphere.center.template lpNorm<1>() + 2.0 * sphere.radius_m);
      slides_m += arm.kinematics().slides[l - 1] * (std::abs(a[l - 1]) + abs_travel_[l - 1]);
    }
    pad_m_ = float_above(lane_pad_m(arm, reach_m, slides_m));
    self_reach_m_ = float_above(self_m_) + 4.0F * pad_m_;
  }

  [[nodiscard]] bool is_clear() noexcept {
    if (!base_is_clear()) return false;
    for (int i = kLanesFloat - 1; i >= 0; --i) push((2.0 * i + 1.0) / 16.0, 1.0 / 16.0);
    for (int turns = 0; size_ > 0; ++turns) {
      if (turns == kMaxTurns || !take_turn()) return false;
    }
    return true;
  }

 private:
  struct Piece {
    double middle;
    double half;
  };
  // How far links get from where they are in the middle of a piece.
  struct Spread {
    V8f extra_m;       // 0 where that is within the room
    unsigned divides;  // lanes where it is not: halved if something is that near
  };

  void push(double middle, double half) noexcept { stack_[at(size_++)] = {middle, half}; }

  [[nodiscard]] Spread spread_of(float travel_m, float room_m) const noexcept {
    const V8f extra_m = half_ * travel_m;
    const auto divides = extra_m > splat8(room_m);
    return {divides ? extra_m : splat8(0.0F), lane_mask8(divides)};
  }

  // The base does not move.
  [[nodiscard]] bool base_is_clear() const noexcept {
    if (arm_.first_capsule(0) == arm_.first_capsule(1)) return true;
    ArmPose<N> pose;
    pose.X_WJ[0] = arm_.kinematics().X_WB;
    const Aabb3 area = box_around(arm_.link_sphere_W(pose, 0), world_.max_required_m(rule_));
    return world_.for_each_near(area, [&](int i) { return !is_near(pose, 0, i); });
  }

  [[nodiscard]] bool is_near(const ArmPose<N>& pose, int i_link, int i_obstacle) const noexcept {
    return link_is_within(arm_, pose, i_link, world_.obstacle(i_obstacle),
                          world_.required_m(i_obstacle, rule_));
  }

  // False when a middle is not clear.
  [[nodiscard]] bool take_turn() noexcept {
    const int num = std::min(size_, kLanesFloat);
    size_ -= num;
    for (int i = 0; i < kLanesFloat; ++i) {
      taken_[at(i)] = stack_[at(size_ + std::max(num - 1 - i, 0))];
      half_[i] = static_cast<float>(taken_[at(i)].half);  // a power of two
    }
    live_ = kAllLanes >> (kLanesFloat - num);
    open_ = 0;
    posed_ = 0;
    if (!move_lanes()) return false;
    for (int l = N; l >= 1; --l) {  // the outer links meet more
      if (arm_.first_capsule(l) < arm_.first_capsule(l + 1) && !link_is_clear(l)) return false;
    }
    const int num_pairs = static_cast<int>(arm_.self_collision_pairs().size());
    for (int i = 0; i < num_pairs; ++i) {
      if (!pair_is_clear(i)) return false;
    }
    for (int i = num - 1; i >= 0; --i) {
      if (((open_ >> i) & 1U) == 0) continue;
      const Piece piece = taken_[at(i)];
      const double half = 0.5 * piece.half;
      if (half < kLeastHalf || size_ + 2 > kStack) return false;
      push(piece.middle + half, half);
      push(piece.middle - half, half);
    }
    return true;
  }

  // False when a frame is not finite; the last position has seen them all.
  [[nodiscard]] bool move_lanes() noexcept {
    alignas(32) double middle[kLanesFloat];
    for (int i = 0; i < kLanesFloat; ++i) middle[i] = taken_[at(i)].middle;
    const V4d low = load4(middle);
    const V4d high = load4(middle + kLanesDouble);
    LaneConfig<N> q{};
    for (int j = 0; j < N; ++j) {
      q.joint[at(j)] = {a_[j] + low * travel_[j], a_[j] + high * travel_[j]};
    }
    forward_lanes(arm_, q, lanes_);
    const LaneVec3& tool = lanes_.X_WJ[N].position;
    const V8f sum = abs8(tool.x) + abs8(tool.y) + abs8(tool.z);
    return lane_mask8(sum < std::numeric_limits<float>::infinity()) == kAllLanes;
  }

  // The configuration of a lane, exactly.
  [[nodiscard]] const ArmPose<N>& pose_of(int lane) noexcept {
    ArmPose<N>& pose = poses_[at(lane)];
    if (((posed_ >> lane) & 1U) == 0) arm_.forward(a_ + taken_[at(lane)].middle * travel_, pose);
    posed_ |= 1U << lane;
    return pose;
  }

  [[nodiscard]] LaneVec3 center_W(int i_link, const CoverSphere& s) const noexcept {
    const LaneFrame& X = lanes_.X_WJ[at(i_link)];
    return X.position + turn(X, s.center[0], s.center[1], s.center[2]);
  }

  [[nodiscard]] bool link_is_clear(int l) noexcept {
    const Spread spread = spread_of(travel_m_[at(l)], room_m_);
    const CoverSphere& cover = arm_.link_cover(l);
    const LaneVec3 c = center_W(l, cover);
    const PaddedLanes sphere({c.x, c.y, c.z, (cover.radius_m + pad_m_) + spread.extra_m});
    std::array<NearObstacle, kObstaclesAtOnce> near{};
    std::size_t num = 0;
    const bool is_clear = world_.for_each_near(sphere, live_, rule_, [&](int i, unsigned lanes) {
      near[num++] = {i, lanes, 0};
      if (num < near.size()) return true;
      num = 0;
      return capsules_are_clear(l, near);
    });
    return is_clear && capsules_are_clear(l, std::span(near).first(num));
  }

  // Covering spheres of a link's capsules against obstacles that are near the link.
  struct NearObstacle {
    int i_obstacle;
    unsigned lanes;
    unsigned touching;  // of these, lanes that need the exact answer
  };
  [[nodiscard]] bool capsules_are_clear(int l, std::span<NearObstacle> obstacles) noexcept {
    if (obstacles.empty()) return true;
    // Outer capsules first, too.
    for (int k = arm_.first_capsule(l + 1) - 1; k >= arm_.first_capsule(l); --k) {
      const Spread own =
          spread_of(float_above(arm_.capsule_displacement_bound(k, abs_travel_)), room_m_);
      for (const CoverSphere& s : arm_.cover(k)) {
        const LaneVec3 c = center_W(l, s);
        const NestedLanes lanes(c.x, c.y, c.z, s.radius_m + pad_m_, own.extra_m,
                                s.inner_m - pad_m_);
        for (NearObstacle& o : obstacles) {
          const NestedNear found = world_.lanes_near(o.i_obstacle, lanes, rule_);
          if ((found.inner & o.lanes) != 0) return false;
          open_ |= found.wide & own.divides & o.lanes;
          o.touching |= found.sphere & o.lanes;
        }
      }
    }
    for (const NearObstacle& o : obstacles) {
      for (unsigned lanes = o.touching; lanes != 0; lanes &= lanes - 1) {
        if (is_near(pose_of(__builtin_ctz(lanes)), l, o.i_obstacle)) return false;
      }
    }
    return true;
  }

  // Lanes where the points are at most `reach_m` apart.
  [[nodiscard]] static unsigned lanes_within(const V8f& distance2, const V8f& reach_m) noexcept {
    return ~lane_mask8(distance2 > reach_m * reach_m) & kAllLanes;
  }

  [[nodiscard]] bool pair_is_clear(int i_pair) noexcept {
    const auto& pair = arm_.self_collision_pairs()[at(i_pair)];
    const ArmBody& a = arm_.body(pair.i_body_a);
    const ArmBody& b = arm_.body(pair.i_body_b);
    const Spread spread = spread_of(
        float_above(arm_.displacement_bound(b.i_link, abs_travel_, a.i_link)), self_room_m_);
    const CoverSphere& sphere_a = arm_.body_cover(pair.i_body_a);
    const CoverSphere& sphere_b = arm_.body_cover(pair.i_body_b);
    const LaneVec3 middle_b = center_W(b.i_link, sphere_b);
    const float reach_m = sphere_b.radius_m + self_reach_m_;
    const auto lanes_near_b = [&](const CoverSphere& s) __attribute__((always_inline)) {
      const LaneVec3 apart = middle_b - center_W(a.i_link, s);
      return lanes_within(dot(apart, apart), (s.radius_m + reach_m) + spread.extra_m) & live_;
    };
    if (lanes_near_b(sphere_a) == 0) return true;
    PairLook look;
    for (int i = a.first; i < a.last; ++i) {
      for (const CoverSphere& s : arm_.cover(i)) {
        const unsigned lanes = lanes_near_b(s);
        if (lanes == 0) continue;
        pair_spheres_[at(look.num++)] = {to_frame(b.i_link, center_W(a.i_link, s)), s.radius_m,
                                         lanes};
        if (look.num == kSpheresAtOnce) look_at_capsules(a, b, look);
      }
    }
    look_at_capsules(a, b, look);
    open_ |= look.near;
    for (unsigned touching = look.touching; touching != 0; touching &= touching - 1) {
      const ArmPose<N>& pose = pose_of(__builtin_ctz(touching));
      if (bodies_are_within(arm_, pose, pair.i_body_a, pair.i_body_b, self_m_)) return false;
    }
    return true;
  }

  // The first `num` of pair_spheres_ against the capsules of a body; and what was found.
  struct PairSphere {
    LaneVec3 middle;
    float radius_m;
    unsigned lanes;
  };
  struct PairLook {
    int num = 0;
    unsigned near = 0;      // lanes to be halved
    unsigned touching = 0;  // lanes that need the exact answer
  };
  void look_at_capsules(const ArmBody& a, const ArmBody& b, PairLook& look) const noexcept {
    for (int k = look.num > 0 ? b.first : b.last; k < b.last; ++k) {
      const CoverCapsule& c = arm_.cover_capsule(k);
      const Spread spread = spread_of(
          float_above(arm_.capsule_displacement_bound(k, abs_travel_, a.i_link)), self_room_m_);
      for (int i = 0; i < look.num; ++i) {
        const auto& [middle, radius_m, lanes] = pair_spheres_[at(i)];
        LaneVec3 apart{middle.x - c.p0[0], middle.y - c.p0[1], middle.z - c.p0[2]};
        if (c.inverse_length2 > 0.0F) {
          const V8f along = apart.x * c.axis[0] + apart.y * c.axis[1] + apart.z * c.axis[2];
          const V8f share = min8(max8(along * c.inverse_length2, splat8(0.0F)), splat8(1.0F));
          apart = {apart.x - share * c.axis[0], apart.y - share * c.axis[1],
                   apart.z - share * c.axis[2]};
        }
        const V8f distance2 = dot(apart, apart);
        const float reach_m = radius_m + c.radius_m + self_reach_m_;
        look.near |= lanes_within(distance2, reach_m + spread.extra_m) & lanes & spread.divides;
        look.touching |= lanes_within(distance2, splat8(reach_m)) & lanes;
      }
    }
    look.num = 0;
  }

  // Of a point in world coordinates.
  [[nodiscard]] LaneVec3 to_frame(int i_link, const LaneVec3& p_W) const noexcept {
    const LaneFrame& X = lanes_.X_WJ[at(i_link)];
    const LaneVec3 p = p_W - X.position;
    return {dot(X.x, p), dot(X.y, p), dot(X.z, p)};
  }

  const Arm<N>& arm_;
  const World3& world_;
  ClearanceRule rule_;  // with room above its floor
  Config a_;
  Config travel_;
  Config abs_travel_;
  double self_m_ = 0.0;
  float room_m_ = 0.0F;
  float self_room_m_ = 0.0F;
  float self_reach_m_ = 0.0F;  // what pairs must keep, with the pads of both and of their distance
  float pad_m_ = 0.0F;
  std::array<float, N + 1> travel_m_{};  // of links, over the whole motion

  std::array<Piece, kStack> stack_;
  int size_ = 0;
  // This turn's pieces.
  std::array<Piece, kLanesFloat> taken_;
  V8f half_{};
  unsigned live_ = 0;  // lanes that are pieces of their own
  unsigned open_ = 0;  // lanes to be halved
  LanePose<N> lanes_;
  std::array<ArmPose<N>, kLanesFloat> poses_;
  std::array<PairSphere, kSpheresAtOnce> pair_spheres_;  // in the frame of the other body's link
  unsigned posed_ = 0;
};

}  // namespace

template <int N>
bool motion_is_clear(const Arm<N>& arm, const World3& world, const ClearanceRule& rule,
                     double self_clearance_m, const typename Arm<N>::Config& a,
                     const typename Arm<N>::Config& b) SOPT_RT {
  if (!a.allFinite() || !b.allFinite()) return false;
  MotionCheck<N> check(arm, world, rule, self_clearance_m, a, b);
  return check.is_clear();
}

template <int N>
bool Arm<N>::motion_is_clear(const World& world, const ClearanceRule& rule, const Config& a,
                             const Config& b) const SOPT_RT {
  return sopt::motion_is_clear(*this, world, rule, kSelfClearance_m, a, b);
}

#define SOPT_ARM_MOTION(N)                                                                  \
  template bool motion_is_clear(const Arm<N>&, const World3&, const ClearanceRule&, double, \
                                const Arm<N>::Config&, const Arm<N>::Config&) SOPT_RT;      \
  template bool Arm<N>::motion_is_clear(const World&, const ClearanceRule&, const Config&,  \
                                        const Config&) const SOPT_RT;
SOPT_ARM_MOTION(4)
SOPT_ARM_MOTION(5)
SOPT_ARM_MOTION(6)
SOPT_ARM_MOTION(7)
SOPT_ARM_MOTION(8)
#undef SOPT_ARM_MOTION

}  // namespace sopt
