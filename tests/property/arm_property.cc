// Random arms of 4 to 8 joints, all joint kinds: frames and capsules against the oracle, Jacobians
// against central differences, spheres that contain, bounds on motion that hold, differences that
// wrap.
#include <algorithm>

#include "tests/support/arm_cases.h"
#include "tests/support/arm_oracle.h"
#include "tests/support/property.h"

namespace {

using namespace sopt;
using namespace sopt::oracle;

template <int N>
void check_frames(const RandomArm<N>& drawn, const typename Arm<N>::Config& q, CaseReport& report) {
  const Arm<N>& arm = drawn.arm;
  ArmPose<N> pose;
  arm.forward(q, pose);
  const std::vector<Mat4> frames = link_frames<N>(drawn.description, q);
  for (int l = 0; l <= N; ++l) {
    const Mat4 found = to_matrix(arm.link_pose(pose, l));
    report.expect_within(
        "link frame", (found - frames[static_cast<std::size_t>(l)]).cwiseAbs().maxCoeff(), 2e-13);
  }
  std::vector<LinkCapsule> sorted = drawn.capsules;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const LinkCapsule& a, const LinkCapsule& b) { return a.i_link < b.i_link; });
  for (int i = 0; i < arm.num_capsules(); ++i) {
    const LinkCapsule& source = sorted[static_cast<std::size_t>(i)];
    const Mat4& frame = frames[static_cast<std::size_t>(source.i_link)];
    const Capsule3 found = arm.capsule_W(pose, i);
    report.expect("capsule on its link", arm.capsule_link(i) == source.i_link);
    report.expect_within("capsule's first end", (found.p0 - transform(frame, source.p0)).norm(),
                         2e-13);
    report.expect_within("capsule's second end", (found.p1 - transform(frame, source.p1)).norm(),
                         2e-13);
    const Sphere3 sphere = arm.link_sphere_W(pose, source.i_link);
    for (const Vec3& end : {found.p0, found.p1}) {
      report.expect_within("sphere contains its capsules",
                           (end - sphere.center).norm() + found.radius_m - sphere.radius_m, 1e-14);
    }
  }
}

template <int N>
void check_gradient(Random& random, const Arm<N>& arm, const typename Arm<N>::Config& q,
                    CaseReport& report) {
  constexpr double kStep = 1e-5;
  const int i_link = random.index(N + 1);
  const Vec3 p_L = random_vector(random, 0.5);
  const Vec3 normal = random_axis(random);
  const auto height = [&](const typename Arm<N>::Config& at) {
    ArmPose<N> pose;
    arm.forward(at, pose);
    const Pose3 X = arm.link_pose(pose, i_link);
    return normal.dot(X.rotation * p_L + X.position);
  };
  ArmPose<N> pose;
  arm.forward(q, pose);
  const Pose3 X = arm.link_pose(pose, i_link);
  const auto gradient = arm.distance_gradient(pose, i_link, X.rotation * p_L + X.position, normal);
  for (int j = 0; j < N; ++j) {
    typename Arm<N>::Config ahead = q;
    typename Arm<N>::Config behind = q;
    ahead[j] += kStep;
    behind[j] -= kStep;
    const double slope = (height(ahead) - height(behind)) / (2.0 * kStep);
    report.expect_within("Jacobian against differences", std::abs(slope - gradient[j]), 1e-8);
  }
}

// Moves far and near, along the straight line and joint by joint.
template <int N>
void check_bound(Random& random, const Arm<N>& arm, const typename Arm<N>::Config& from,
                 CaseReport& report) {
  typename Arm<N>::Config to = random_configuration(random, arm);
  if (random.chance(0.7)) to = from + std::pow(10.0, random.uniform(-3.0, 0.0)) * (to - from);
  if (random.chance(0.3)) {
    const int j = random.index(N);
    const double moved = to[j];
    to = from;
    to[j] = moved;
  }
  const typename Arm<N>::Config moved = (to - from).cwiseAbs();
  ArmPose<N> before;
  ArmPose<N> after;
  arm.forward(from, before);
  arm.forward(to, after);
  const int i_base = random.index(N + 1);
  const Pose3 X0 = before.X_WJ[static_cast<std::size_t>(i_base)];
  const Pose3 X1 = after.X_WJ[static_cast<std::size_t>(i_base)];
  const auto check = [&](const char* what, const Vec3& p0, const Vec3& p1, double bound_m) {
    report.expect_within(what, (p1 - p0).norm() - bound_m, 1e-13);
  };
  for (int i = arm.first_capsule(i_base); i < arm.num_capsules(); ++i) {
    const Capsule3 c0 = arm.capsule_W(before, i);
    const Capsule3 c1 = arm.capsule_W(after, i);
    const int i_link = arm.capsule_link(i);
    check("bound in the world", c0.p0, c1.p0, arm.displacement_bound(i_link, moved));
    check("bound in the world", c0.p1, c1.p1, arm.displacement_bound(i_link, moved));
    check("bound against a link", X0.rotation.transpose() * (c0.p0 - X0.position),
          X1.rotation.transpose() * (c1.p0 - X1.position),
          arm.displacement_bound(i_link, moved, i_base));
  }
  for (int l = 0; l <= N; ++l) {
    check("bound of the sphere", arm.link_sphere_W(before, l).center,
          arm.link_sphere_W(after, l).center, arm.displacement_bound(l, moved));
  }
}

template <int N>
void check_metric(Random& random, const Arm<N>& arm, CaseReport& report) {
  const auto a = random_configuration(random, arm);
  const auto b = random_configuration(random, arm);
  const auto d = arm.difference(a, b);
  for (int j = 0; j < N; ++j) {
    const double turns = ((b[j] - a[j]) - d[j]) / (2.0 * std::numbers::pi);
    const bool is_continuous = arm.joint(j).kind == JointKind::kContinuous;
    report.expect_within("whole turns", std::abs(turns - std::round(turns)), 1e-14);
    report.expect("only continuous joints wrap", is_continuous || d[j] == b[j] - a[j]);
    report.expect("the short way round", !is_continuous || std::abs(d[j]) < 3.1415926535897936);
  }
  report.expect_within("distance both ways",
                       std::abs(arm.path_distance(a, b) - arm.path_distance(b, a)), 1e-13);
}

template <int N>
std::string check_arm(Random& random, CaseReport& report) {
  static RandomArm<N> drawn;
  draw_arm(random, drawn);
  const ArmStatus status = drawn.arm.reset(drawn.description);
  report.expect("a valid arm is taken", status == ArmStatus::kOk);
  if (status != ArmStatus::kOk) return "status " + std::to_string(static_cast<int>(status));
  const typename Arm<N>::Config q = random_configuration(random, drawn.arm);
  check_frames(drawn, q, report);
  check_gradient(random, drawn.arm, q, report);
  for (int i = 0; i < 4; ++i) check_bound(random, drawn.arm, q, report);
  check_metric(random, drawn.arm, report);
  return std::to_string(N) + " joints";
}

std::string check_case(Random& random, CaseReport& report) {
  return with_joints(4 + random.index(5), [&](auto n) { return check_arm<n>(random, report); });
}

}  // namespace

int main(int argc, char** argv) { return run_property("arm", argc, argv, check_case); }
