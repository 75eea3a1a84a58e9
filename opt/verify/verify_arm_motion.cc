#include "opt/verify/verify_arm_motion.h"

#include <algorithm>
#include <cmath>

namespace sopt {
namespace {

constexpr std::size_t at(int i) noexcept { return static_cast<std::size_t>(i); }

// Where a point can get to while the joints above move.
struct Ball {
  Vec3 center;
  double radius_m = 0.0;
};

}  // namespace

template <int N>
ArmMotion<N>::ArmMotion(const Arm<N>& arm, const Trajectory<Arm<N>>& trajectory,
                        double defect) noexcept
    : trajectory_(trajectory), defect_(defect), X_WB_(arm.kinematics().X_WB) {
  Range range = step_range(trajectory, 0);
  for (int t = 1; t < trajectory.horizon(); ++t) {
    const Range step = step_range(trajectory, t);
    range.lower = range.lower.cwiseMin(step.lower);
    range.upper = range.upper.cwiseMax(step.upper);
  }
  range.lower.array() -= defect;
  range.upper.array() += defect;
  set_joints(arm);
  set_capsules(arm);
  set_reach(arm, range);
}

template <int N>
typename ArmMotion<N>::Range ArmMotion<N>::step_range(const Trajectory<Arm<N>>& trajectory,
                                                      int t) SOPT_RT {
  const Config q0 = trajectory.states[t].template head<N>();
  const Config q1 = trajectory.states[t + 1].template head<N>();
  Range range{q0.cwiseMin(q1), q0.cwiseMax(q1)};
  for (int j = 0; j < N; ++j) {
    const double omega = trajectory.states[t][N + j];
    const double alpha = trajectory.inputs[t][j];
    const double turn_s = -omega / alpha;  // where the joint turns back
    if (!(turn_s > 0.0 && turn_s < trajectory.dt_s)) continue;
    const double extremum = q0[j] + 0.5 * omega * turn_s;
    range.lower[j] = std::min(range.lower[j], extremum);
    range.upper[j] = std::max(range.upper[j], extremum);
  }
  return range;
}

template <int N>
void ArmMotion<N>::set_joints(const Arm<N>& arm) noexcept {
  for (int i = 0; i < N; ++i) {
    const ArmJoint& described = arm.joint(i);
    const Mat3& R_PJ = described.origin.rotation;
    const Vec3 a = described.axis.normalized();
    Mat3 cross;
    cross << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
    const Mat3 outer = a * a.transpose();
    Joint& joint = joints_[at(i)];
    joint.turns = described.kind != JointKind::kPrismatic;
    joint.in_plane = R_PJ * (Mat3::Identity() - outer);
    joint.turned = R_PJ * cross;
    joint.along = R_PJ * outer;
    joint.position = described.origin.position;
    joint.slide = joint.turns ? Vec3(Vec3::Zero()) : Vec3(R_PJ * a);
    joint.axis = a;
  }
}

// The arm has its capsules in frames of its own; turned back, whatever those are, they are as
// described.
template <int N>
void ArmMotion<N>::set_capsules(const Arm<N>& arm) noexcept {
  const typename Arm<N>::Pose identity{};
  for (int l = 0; l <= N; ++l) {
    const Mat3 R_LJ = arm.link_pose(identity, l).rotation.transpose();
    const int first = arm.first_capsule(l);
    const int last = arm.first_capsule(l + 1);
    Sphere3& sphere = spheres_[at(l)];
    sphere = {Vec3::Zero(), 0.0};
    for (int i = first; i < last; ++i) {
      const Capsule3& folded = arm.capsule_J(i);
      capsules_[at(i)] = {R_LJ * folded.p0, R_LJ * folded.p1, folded.radius_m};
      sphere.center += (capsules_[at(i)].p0 + capsules_[at(i)].p1) / (2.0 * (last - first));
    }
    for (int i = first; i < last; ++i) {
      const Capsule3& c = capsules_[at(i)];
      const double away_m = std::max((c.p0 - sphere.center).norm(), (c.p1 - sphere.center).norm());
      sphere.radius_m = std::max(sphere.radius_m, away_m + c.radius_m);
    }
  }
}

// Carries each end of a core from its link down to the base, as a ball that holds all its places
// while the joints passed move within their ranges. The middle of a link lies between the ends.
template <int N>
void ArmMotion<N>::set_reach(const Arm<N>& arm, const Range& range) noexcept {
  constexpr double kRounding = 1.0 + 1e-12;
  std::array<Pose3, N> middle;    // a joint half-way through its range
  Config swing = Config::Zero();  // of a point 1 m from the axis, away from there
  for (int j = 0; j < N; ++j) {
    const double width = range.upper[j] - range.lower[j];
    middle[at(j)] = joints_[at(j)].motion(0.5 * (range.lower[j] + range.upper[j]));
    swing[j] = !joints_[at(j)].turns ? 0.5 * width : width < 4.0 ? 2.0 * std::sin(0.25 * width) : 2;
  }
  for (int l = 0; l <= N; ++l) {
    reach_m_[at(l)].setZero();
    for (int i = arm.first_capsule(l); i < arm.first_capsule(l + 1); ++i) {
      for (const Vec3& end : {capsule_L(i).p0, capsule_L(i).p1}) {
        Ball ball{end};
        for (int j = l - 1; j >= 0; --j) {
          const Joint& joint = joints_[at(j)];
          const Vec3 on_axis = joint.axis.dot(ball.center) * joint.axis;
          const double from_axis_m = (ball.center - on_axis).norm();
          double& reach_m = reach_m_[at(l)][j];
          reach_m = joint.turns ? std::max(reach_m, (from_axis_m + ball.radius_m) * kRounding) : 1;
          if (!joint.turns) {
            ball.radius_m += swing[j];
          } else if (swing[j] < 1.0) {
            ball.radius_m += swing[j] * from_axis_m;
          } else {
            ball = {on_axis, ball.radius_m + from_axis_m};
          }
          ball.center = middle[at(j)].rotation * ball.center + middle[at(j)].position;
        }
      }
    }
  }
}

template <int N>
Pose3 ArmMotion<N>::Joint::motion(double q) const noexcept {
  if (!turns) return {in_plane + along, position + q * slide};
  return {std::cos(q) * in_plane + std::sin(q) * turned + along, position};
}

template <int N>
typename ArmMotion<N>::Config ArmMotion<N>::configuration_at(double x) const SOPT_RT {
  const int t = static_cast<int>(x);
  const double s = (x - t) * trajectory_.dt_s;
  const auto& state = trajectory_.states[t];
  if (s == 0.0) return state.template head<N>();
  return state.template head<N>() + s * state.template tail<N>() +
         (0.5 * s * s) * trajectory_.inputs[t];
}

template <int N>
void ArmMotion<N>::find_frames(double x, LinkFrames<N>& frames) const SOPT_RT {
  const Config q = configuration_at(x);
  frames.X_WL[0] = X_WB_;
  for (int j = 0; j < N; ++j) {
    const Pose3& before = frames.X_WL[at(j)];
    const Pose3 motion = joints_[at(j)].motion(q[j]);
    Pose3& after = frames.X_WL[at(j + 1)];
    after.rotation.noalias() = before.rotation * motion.rotation;
    after.position.noalias() = before.rotation * motion.position;
    after.position += before.position;
  }
}

template <int N>
typename ArmMotion<N>::Change ArmMotion<N>::change(double x0, double x1) const SOPT_RT {
  const int first = static_cast<int>(x0);
  const double width = x1 - x0;
  const double dt_s = trajectory_.dt_s;
  const Config q0 = configuration_at(x0);
  const Config slope = (configuration_at(x1) - q0) / width;  // per step
  Change change;
  change.travel = (width * slope).cwiseAbs();
  if (width <= 1.0) {
    change.stray = (0.125 * width * width * dt_s * dt_s) * trajectory_.inputs[first].cwiseAbs();
  } else {
    Config sharpest = trajectory_.inputs[first].cwiseAbs();
    for (int t = first + 1; t < first + static_cast<int>(width); ++t) {
      const Config off = trajectory_.states[t].template head<N>() - (q0 + (t - first) * slope);
      change.stray = change.stray.cwiseMax(off.cwiseAbs());
      sharpest = sharpest.cwiseMax(trajectory_.inputs[t].cwiseAbs());
    }
    change.stray += (0.125 * dt_s * dt_s) * sharpest;
  }
  change.stray.array() += defect_;
  return change;
}

template <int N>
double ArmMotion<N>::chord_error_m(const Change& change, int i_link, int i_base) const SOPT_RT {
  double error_m = 0.0;
  double turned = 0.0;  // by joints that turn, so far
  for (int j = i_base; j < i_link; ++j) {
    const double travel = change.travel[j];
    const bool turns = joints_[at(j)].turns;
    const double curved = 0.125 * travel * ((turns ? travel : 0.0) + 2.0 * turned);
    error_m += reach_m_[at(i_link)][j] * (change.stray[j] + curved);
    if (turns) turned += travel;
  }
  return error_m;
}

template class ArmMotion<4>;
template class ArmMotion<5>;
template class ArmMotion<6>;
template class ArmMotion<7>;
template class ArmMotion<8>;

}  // namespace sopt
