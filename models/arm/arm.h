// Robot arm of N joints in a chain: forward kinematics, Jacobians, limits, the path metric and what
// is needed to check its links. State z = (theta, omega), input u = alpha, configuration = theta.
// Links are groups of capsules (a sphere is a capsule whose ends coincide). Joint i, counted from
// 0, moves link i + 1; link 0 is the base. Units m, rad, s; "unit" below is rad for a joint that
// turns and m for one that slides. Method: at setup every link frame is turned into a joint frame J
// whose z is the joint's axis and whose x is perpendicular to the next axis too, as Denavit and
// Hartenberg do, but without moving its origin. Then X_J(i) = X_J(i-1) * (R_x(twist) R_z(offset +
// q), position): no general rotation is left in the loop.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <span>

#include "models/arm/arm_cover.h"
#include "models/arm/arm_description.h"
#include "models/arm/arm_spheres.h"
#include "models/capacity.h"
#include "models/config.h"
#include "models/margin.h"
#include "models/space/shape3.h"
#include "rt/annotations.h"

namespace sopt {

class World3;
struct ArmContact;

// Links that may collide keep this distance. The least that leaves something to prove that a motion
// between two checked configurations touches nothing.
inline constexpr double kSelfClearance_m = 1e-4;
// Stand for "no joint" and "no link" where the index of one is expected.
inline constexpr int kNoJoint = -1;
inline constexpr int kNoLink = -1;

// Frames in the world at one configuration: [0] base, [i] joint frame of link i (see the head of
// this file); the z column is the axis of joint i - 1, the position is the link's origin.
template <int N>
struct ArmPose {
  std::array<Pose3, N + 1> X_WJ;
};

// A group of capsules on one link, [first, last) of the arm's capsules.
struct ArmBody {
  int i_link = 0;
  int first = 0;
  int last = 0;
  Sphere3 sphere;  // joint frame; contains the capsules
};

template <int N>
struct ConfigBox {
  Eigen::Matrix<double, N, 1> lower, upper;
};

template <int N>
class Arm {
 public:
  static_assert(N >= kMinArmJoints && N <= kMaxArmJoints);
  static constexpr int kDof = N;
  using Config = Eigen::Matrix<double, N, 1>;
  using State = Eigen::Matrix<double, 2 * N, 1>;  // (theta, omega)
  using Input = Config;                           // alpha
  using World = World3;
  using Pose = ArmPose<N>;

  // Replaces the whole arm; on a status other than kOk it is unchanged.
  [[nodiscard]] ArmStatus reset(const ArmDescription<N>& description) noexcept;

  // Adds capsules, as of a grasped object, to links until `detach`; they collide with what the
  // bodies they name collide with. Between requests: capsule and body indices change. On a status
  // other than kOk nothing was added.
  [[nodiscard]] ArmStatus try_attach(std::span<const LinkCapsule> object) noexcept;
  void detach() noexcept;

  // --- kinematics
  void forward(const Config& q, Pose& pose) const SOPT_RT;
  // Frame of link i_link as the description has it.
  [[nodiscard]] Pose3 link_pose(const Pose& pose, int i_link) const SOPT_RT;
  [[nodiscard]] Capsule3 capsule_W(const Pose& pose, int i_capsule) const SOPT_RT {
    const Capsule3& c = capsules_[at(i_capsule)];
    const Pose3& X = pose.X_WJ[at(link_of_[at(i_capsule)])];
    return {transform(X, c.p0), transform(X, c.p1), c.radius_m};
  }
  // Contains the link's capsules; meaningless for a link without.
  [[nodiscard]] Sphere3 link_sphere_W(const Pose& pose, int i_link) const SOPT_RT {
    return to_world(pose, i_link, spheres_[at(i_link)]);
  }
  [[nodiscard]] Sphere3 body_sphere_W(const Pose& pose, int i_body) const SOPT_RT {
    return to_world(pose, bodies_[at(i_body)].i_link, bodies_[at(i_body)].sphere);
  }
  // d(normal . p)/dq with p fixed in link i_link; p and normal in the world.
  [[nodiscard]] Config distance_gradient(const Pose& pose, int i_link, const Vec3& p_W,
                                         const Vec3& normal_W) const SOPT_RT;

  // --- bounds on motion, over all configurations within the limits
  // What moves here are the capsules' cores and the centres of the bounding spheres: the clearance
  // of a capsule or sphere changes by no more than its core moves, whatever its radius.
  // Largest distance of link i_link's cores from the axis of joint i_joint; 1 when the joint
  // slides, 0 when it does not move the link. m/unit.
  [[nodiscard]] double max_reach(int i_joint, int i_link) const SOPT_RT {
    return reach_[at(i_link)][i_joint];
  }
  // Bound on how far link i_link's cores move against link i_base while joint j moves by at most
  // abs_dq[j] >= 0. i_base <= i_link; links between pairs move less against each other than against
  // the world. m.
  [[nodiscard]] double displacement_bound(int i_link, const Config& abs_dq,
                                          int i_base = 0) const SOPT_RT {
    double bound_m = 0.0;
    for (int j = i_base; j < i_link; ++j) bound_m += reach_[at(i_link)][j] * abs_dq[j];
    return bound_m * (1.0 + 1e-14);
  }
  // Likewise, of one capsule: those near the joints move less than the rest of their link.
  [[nodiscard]] double capsule_displacement_bound(int i_capsule, const Config& abs_dq,
                                                  int i_base = 0) const SOPT_RT {
    double bound_m = 0.0;
    for (int j = i_base; j < capsule_link(i_capsule); ++j) {
      bound_m += capsule_reach_[at(i_capsule)][j] * abs_dq[j];
    }
    return bound_m * (1.0 + 1e-14);
  }

  // --- metric and dynamics
  // b - a, the short way round for continuous joints: their share is in (-pi, pi].
  [[nodiscard]] Config difference(const Config& a, const Config& b) const SOPT_RT;
  [[nodiscard]] bool is_continuous(int i_joint) const SOPT_RT {
    return is_continuous_[i_joint] != 0.0;
  }
  // b up to whole turns of continuous joints, nearest to a: a + difference(a, b), but exactly b
  // where no turn is taken.
  [[nodiscard]] Config unwrapped(const Config& a, const Config& b) const SOPT_RT;
  // The path metric: 2-norm of the difference, each joint times its weight. With weights 1: rad,
  // sliding joints in m. Whatever is called a length is in this metric: steps, paths, costs.
  [[nodiscard]] double path_distance(const Config& a, const Config& b) const SOPT_RT {
    return motion_length(difference(a, b));
  }
  // Length of a motion by dq.
  [[nodiscard]] double motion_length(const Config& dq) const SOPT_RT {
    return weights_.cwiseProduct(dq).norm();
  }
  // The configuration at share s in [0, 1] of the motion from a to b. Continuous joints end at b's
  // angle up to whole turns, so that the motion has no jump.
  [[nodiscard]] Config interpolate(const Config& a, const Config& b, double s) const SOPT_RT {
    return a + s * difference(a, b);
  }
  // Exact for an acceleration constant over dt_s.
  [[nodiscard]] static State step(const State& state, const Input& input, double dt_s) SOPT_RT {
    State next;
    next.template head<N>() =
        state.template head<N>() + dt_s * state.template tail<N>() + 0.5 * dt_s * dt_s * input;
    next.template tail<N>() = state.template tail<N>() + dt_s * input;
    return next;
  }
  // The first joint outside its position limits (NaN is outside), or kNoJoint.
  [[nodiscard]] int joint_outside_limits(const Config& q) const SOPT_RT;
  [[nodiscard]] bool within_limits(const Config& q) const SOPT_RT {
    return joint_outside_limits(q) == kNoJoint;
  }

  // --- what planning asks
  // Nominal length of a trajectory step when the request gives no speed: that of the defaults.
  [[nodiscard]] double default_step_length(const World& /*world*/) const SOPT_RT {
    constexpr PlanOptions kDefaults = PlanOptions::arm();
    return kDefaults.speed_mps * kDefaults.dt_s;
  }
  // The position limits; one turn of a continuous joint, from -pi.
  [[nodiscard]] ConfigBox<N> sampling_box(const World& world,
                                          const ClearanceRule& rule) const SOPT_RT;
  // See arm_motion.h; pairs of links keep kSelfClearance_m.
  [[nodiscard]] bool motion_is_clear(const World& world, const ClearanceRule& rule, const Config& a,
                                     const Config& b) const SOPT_RT;
  // The nearest obstacle at `q` (arm_clearance.h), kNoObstacle when none is within limit_m; or,
  // with kSelfObstacle, the nearest pair of links when that is closer than kSelfClearance_m.
  [[nodiscard]] ArmContact clearance(const World& world, const Config& q,
                                     double limit_m) const SOPT_RT;

  // --- what the arm consists of
  [[nodiscard]] const ArmJoint& joint(int i_joint) const SOPT_RT { return joints_[at(i_joint)]; }
  [[nodiscard]] const Config& lower() const SOPT_RT { return lower_; }
  [[nodiscard]] const Config& upper() const SOPT_RT { return upper_; }
  [[nodiscard]] const Config& v_max() const SOPT_RT { return v_max_; }
  [[nodiscard]] const Config& a_max() const SOPT_RT { return a_max_; }
  [[nodiscard]] const Config& weights() const SOPT_RT { return weights_; }
  [[nodiscard]] int num_capsules() const SOPT_RT { return num_capsules_; }
  // Capsules of link i_link are [first_capsule(i_link), first_capsule(i_link + 1)).
  [[nodiscard]] int first_capsule(int i_link) const SOPT_RT { return first_[at(i_link)]; }
  [[nodiscard]] int capsule_link(int i_capsule) const SOPT_RT { return link_of_[at(i_capsule)]; }
  [[nodiscard]] const Capsule3& capsule_J(int i_capsule) const SOPT_RT {  // joint frame
    return capsules_[at(i_capsule)];
  }
  [[nodiscard]] const Sphere3& link_sphere_J(int i_link) const SOPT_RT {
    return spheres_[at(i_link)];
  }
  [[nodiscard]] int num_bodies() const SOPT_RT { return num_bodies_; }
  [[nodiscard]] const ArmBody& body(int i_body) const SOPT_RT { return bodies_[at(i_body)]; }
  // Pairs of bodies, by index into `body`, the lower link first.
  struct IndexPair {
    int i_body_a = 0;
    int i_body_b = 0;
  };
  [[nodiscard]] std::span<const IndexPair> self_collision_pairs() const SOPT_RT {
    return {pairs_.data(), at(num_pairs_)};
  }

  // The constants of `forward`, for code that moves several configurations at a time.
  struct Kinematics {
    Pose3 X_WB;
    Pose3 X_WJ1;                     // of the first joint frame at angle and slide 0
    std::array<Vec3, N> position{};  // of J(i+1) in J(i) at slide 0; [0] unused
    Config cos_twist, sin_twist;     // [0] unused
    Config offset;                   // angle = offset + turns * q
    Config turns;                    // 1 for a joint that turns, else 0
    Config slides;                   // 1 - turns; slide = slides * q
    bool has_prismatic = false;
  };
  [[nodiscard]] const Kinematics& kinematics() const SOPT_RT { return kinematics_; }
  // Spheres whose union contains capsule i_capsule, in its joint frame.
  [[nodiscard]] std::span<const CoverSphere> cover(int i_capsule) const SOPT_RT {
    return cover_.of(i_capsule);
  }
  // capsule_J in floats.
  [[nodiscard]] const CoverCapsule& cover_capsule(int i_capsule) const SOPT_RT {
    return cover_.capsule(i_capsule);
  }
  // As link_sphere_J and body(i_body).sphere.
  [[nodiscard]] const CoverSphere& link_cover(int i_link) const SOPT_RT {
    return link_cover_[at(i_link)];
  }
  [[nodiscard]] const CoverSphere& body_cover(int i_body) const SOPT_RT {
    return body_cover_[at(i_body)];
  }
  // Bounding spheres of capsules, in batches.
  [[nodiscard]] const ArmSpheres& capsule_spheres() const SOPT_RT { return capsule_spheres_; }

 private:
  [[nodiscard]] static constexpr std::size_t at(int i) noexcept {
    return static_cast<std::size_t>(i);
  }
  [[nodiscard]] static Sphere3 to_world(const Pose& pose, int i_link, const Sphere3& s) SOPT_RT {
    const Pose3& X = pose.X_WJ[at(i_link)];
    return {transform(X, s.center), s.radius_m};
  }
  void fold_frames(const Pose3& X_WB) noexcept;
  [[nodiscard]] ArmStatus rebuild() noexcept;  // all below from sources_ and source_pairs_
  void sort_capsules() noexcept;
  void resolve_pairs() noexcept;
  void bound_links() noexcept;
  [[nodiscard]] double reach_of(int i_joint, int i_link, const Vec3& point) const noexcept;

  std::array<ArmJoint, N> joints_{};
  Config lower_ = Config::Zero(), upper_ = Config::Zero();
  Config v_max_ = Config::Zero(), a_max_ = Config::Zero();
  Config weights_ = Config::Ones();
  Config is_continuous_ = Config::Zero();  // 1 or 0
  Kinematics kinematics_{};
  std::array<Mat3, N + 1> R_JL_{};  // link frame in its joint frame

  std::array<LinkCapsule, kMaxLinkCapsules> sources_{};  // as described, attached ones last
  std::array<BodyPair, kMaxBodyPairs> source_pairs_{};
  int num_own_ = 0;  // sources before the attached ones
  int num_source_pairs_ = 0;

  int num_capsules_ = 0;
  int num_bodies_ = 0;
  int num_pairs_ = 0;
  std::array<Capsule3, kMaxLinkCapsules> capsules_{};  // joint frames, by link and body
  std::array<int, kMaxLinkCapsules> link_of_{};
  std::array<int, N + 2> first_{};
  std::array<Sphere3, N + 1> spheres_{};  // joint frames
  std::array<ArmBody, kMaxBodies> bodies_{};
  std::array<int, kMaxBodies> body_name_{};  // LinkCapsule::i_body
  std::array<IndexPair, kMaxBodyPairs> pairs_{};
  std::array<Config, N + 1> reach_{};                     // [i_link][i_joint]
  std::array<Config, kMaxLinkCapsules> capsule_reach_{};  // [i_capsule][i_joint]
  ArmCover cover_;
  ArmSpheres capsule_spheres_;
  std::array<CoverSphere, N + 1> link_cover_{};
  std::array<CoverSphere, kMaxBodies> body_cover_{};
};

extern template class Arm<4>;
extern template class Arm<5>;
extern template class Arm<6>;
extern template class Arm<7>;
extern template class Arm<8>;

}  // namespace sopt
