#include "models/arm/arm_presets.h"

#include <cmath>
#include <iterator>

#include "models/arm/arm_pairs.h"
#include "models/config.h"
#include "models/space/pose3.h"

namespace sopt {
namespace {

struct JointRow {
  double xyz_m[3];
  double rpy_rad[3];
  double axis[3];
  double lower_rad, upper_rad, v_max_radps;
};

struct CapsuleRow {
  int i_link;
  double p0_m[3];
  double p1_m[3];
  double radius_m;
};

Vec3 to_vector(const double (&xyz)[3]) noexcept { return {xyz[0], xyz[1], xyz[2]}; }

template <int kNumCapsules>
Arm<5> make_arm(const JointRow (&joints)[5], const CapsuleRow (&capsules)[kNumCapsules]) noexcept {
  ArmDescription<5> description;
  for (std::size_t i = 0; i < std::size(joints); ++i) {
    const JointRow& row = joints[i];
    ArmJoint& joint = description.joints[i];
    joint.origin = {rotation_from_rpy(to_vector(row.rpy_rad)), to_vector(row.xyz_m)};
    joint.axis = to_vector(row.axis);
    joint.lower = row.lower_rad;
    joint.upper = row.upper_rad;
    joint.v_max = row.v_max_radps;
    joint.a_max = kAccelerationPerVelocity * row.v_max_radps;
  }
  LinkCapsule links[kNumCapsules];
  for (std::size_t i = 0; i < std::size(links); ++i) {
    const CapsuleRow& row = capsules[i];
    links[i] = {row.i_link, to_vector(row.p0_m), to_vector(row.p1_m), row.radius_m};
  }
  description.capsules = links;
  Arm<5> arm;
  (void)arm.reset(description);  // constants, which the tests check
  const LinkPairList apart = find_pairs_apart(arm);
  description.pairs = apart.view();
  (void)arm.reset(description);
  return arm;
}

// Denavit-Hartenberg rows (theta, d, a, alpha): (0, 0, 0.050, -pi/2), (-pi/2, 0, 0.440, pi),
// (0, 0, 0.035, -pi/2), (0, -0.420, 0, pi/2), (0, 0, 0, -pi/2). Row i is the origin of joint i + 1,
// R_z(theta) (a, 0, d) and R_z(theta) R_x(alpha); the last only turns the flange.
constexpr double kHalfPi = 1.57079632679489661923;
constexpr double kDegree = 3.14159265358979323846 / 180.0;
constexpr JointRow kLrMateJoints[5] = {
    {{0.0, 0.0, 0.0},
     {0.0, 0.0, 0.0},
     {0.0, 0.0, 1.0},
     -170.0 * kDegree,
     170.0 * kDegree,
     370.0 * kDegree},
    {{0.050, 0.0, 0.0},
     {-kHalfPi, 0.0, 0.0},
     {0.0, 0.0, 1.0},
     -100.0 * kDegree,
     145.0 * kDegree,
     310.0 * kDegree},
    {{0.0, -0.440, 0.0},
     {2.0 * kHalfPi, 0.0, -kHalfPi},
     {0.0, 0.0, 1.0},
     -72.0 * kDegree,
     240.0 * kDegree,
     410.0 * kDegree},
    {{0.035, 0.0, 0.0},
     {-kHalfPi, 0.0, 0.0},
     {0.0, 0.0, 1.0},
     -190.0 * kDegree,
     190.0 * kDegree,
     550.0 * kDegree},
    {{0.0, 0.0, -0.420},
     {kHalfPi, 0.0, 0.0},
     {0.0, 0.0, 1.0},
     -125.0 * kDegree,
     125.0 * kDegree,
     545.0 * kDegree},
};
constexpr CapsuleRow kLrMateCapsules[] = {
    {1, {0.0, 0.0, 0.0}, {0.050, 0.0, 0.0}, 0.13},    // shoulder
    {2, {0.0, 0.0, 0.0}, {0.0, -0.440, 0.0}, 0.068},  // upper arm
    {3, {0.0, 0.0, 0.0}, {0.035, 0.0, 0.0}, 0.01},    // elbow offset
    {4, {0.0, 0.0, 0.0}, {0.0, 0.0, -0.420}, 0.06},   // forearm with the wrist
};

constexpr JointRow kSo101Joints[5] = {
    {{0.038835, 0.0, 0.0624}, {3.14159, 0.0, -3.14159}, {0.0, 0.0, 1.0}, -1.91986, 1.91986, 10.0},
    {{-0.030399, -0.018278, -0.0542},
     {-1.5708, -1.5708, 0.0},
     {0.0, 0.0, 1.0},
     -1.74533,
     1.74533,
     10.0},
    {{-0.11257, -0.028, 0.0}, {0.0, 0.0, 1.5708}, {0.0, 0.0, 1.0}, -1.69, 1.69, 10.0},
    {{-0.1349, 0.0052, 0.0}, {0.0, 0.0, -1.5708}, {0.0, 0.0, 1.0}, -1.65806, 1.65806, 10.0},
    {{0.0, -0.0611, 0.0181}, {1.5708, 0.04868, 3.14159}, {0.0, 0.0, 1.0}, -2.74385, 2.84121, 10.0},
};
constexpr CapsuleRow kSo101Capsules[] = {
    {0, {0.0167, -0.0001, 0.0265}, {0.0167, -0.0001, 0.0305}, 0.0643},
    {1, {-0.0228, -0.0002, -0.0378}, {-0.0228, -0.0002, 0.0432}, 0.035},
    {2, {-0.1126, -0.0072, 0.0193}, {-0.0016, -0.0072, 0.0193}, 0.0364},
    {3, {-0.1201, 0.0, 0.0201}, {0.0, 0.0, 0.0201}, 0.033},
    {4, {-0.0004, -0.0143, 0.0167}, {0.0006, -0.0354, 0.033}, 0.0367},
    {5, {0.0086, -0.001, -0.0712}, {-0.0012, 0.0001, -0.0209}, 0.039},
};

constexpr JointRow kWidowX250Joints[5] = {
    {{0.0, 0.0, 0.072}, {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, -3.141583, 3.141583, 3.141593},
    {{0.0, 0.0, 0.03865}, {0.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, -1.884956, 1.989675, 3.141593},
    {{0.04975, 0.0, 0.25}, {0.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, -2.146755, 1.605703, 3.141593},
    {{0.25, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, -1.745329, 2.146755, 3.141593},
    {{0.065, 0.0, 0.0}, {0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, -3.141583, 3.141583, 3.141593},
};
constexpr CapsuleRow kWidowX250Capsules[] = {
    {0, {-0.0832, 0.0001, 0.013}, {0.0068, 0.0001, 0.013}, 0.0816},
    {1, {0.0, -0.0001, 0.0249}, {0.0, -0.0001, 0.0249}, 0.057},
    {2, {0.0332, 0.0, 0.2608}, {0.0104, 0.0, 0.0413}, 0.0582},
    {3, {0.0094, -0.0001, 0.0}, {0.2452, -0.0001, 0.0}, 0.0263},
    {4, {0.0486, 0.0, 0.0092}, {0.0187, 0.0, 0.0032}, 0.0336},
    {5, {0.037, -0.0001, -0.0001}, {0.0695, -0.0001, -0.0001}, 0.0519},
};

constexpr JointRow kXArm5Joints[5] = {
    {{0.0, 0.0, 0.267}, {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, -3.141583, 3.141583, 3.141593},
    {{0.0, 0.0, 0.0}, {-1.5708, 0.0, 0.0}, {0.0, 0.0, 1.0}, -2.059, 2.0944, 3.141593},
    {{0.0535, -0.2845, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, -3.927, 0.19198, 3.141593},
    {{0.0775, 0.3425, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, -1.69297, 3.141593, 3.141593},
    {{0.076, 0.097, 0.0}, {-1.5708, 0.0, 0.0}, {0.0, 0.0, 1.0}, -3.141583, 3.141583, 3.141593},
};
constexpr CapsuleRow kXArm5Capsules[] = {
    {0, {-0.0157, 0.0035, 0.0264}, {-0.0157, 0.0035, 0.1014}, 0.0831},
    {1, {0.0001, 0.0178, -0.0762}, {0.0001, 0.0178, 0.0066}, 0.0745},
    {2, {0.012, -0.0488, 0.0761}, {0.0488, -0.2766, -0.0169}, 0.0986},
    {3, {0.0418, -0.0015, 0.074}, {0.0904, 0.3341, -0.0709}, 0.0844},
    {4, {-0.0021, 0.0184, 0.0034}, {0.0754, 0.0184, 0.0034}, 0.0647},
    {5, {-0.0001, -0.0124, -0.014}, {-0.0001, 0.0006, -0.014}, 0.0398},
};

}  // namespace

Arm<5> lr_mate_200id_7l() noexcept { return make_arm(kLrMateJoints, kLrMateCapsules); }
Arm<5> so_101() noexcept { return make_arm(kSo101Joints, kSo101Capsules); }
Arm<5> widowx_250() noexcept { return make_arm(kWidowX250Joints, kWidowX250Capsules); }
Arm<5> xarm5() noexcept { return make_arm(kXArm5Joints, kXArm5Capsules); }

}  // namespace sopt
