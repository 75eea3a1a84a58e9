// Arms with five joints whose numbers are public. Positions, angles, limits and radii are restated
// and rounded as their sources give them. No source publishes acceleration limits: they are
// kAccelerationPerVelocity times the velocity limit. Links are checked against each other as
// models/arm/arm_pairs.h says. The base stands at the world's origin.
#pragma once

#include "models/arm/arm.h"

namespace sopt {

// FANUC LR Mate 200iD/7L, the first five of its six joints. Denavit-Hartenberg rows, limits and the
// radii of four capsules: earlier public code of the authors of [Leu22]. Joint speeds: the maker's
// maxima as in ros-industrial/fanuc at 1263166, lrmate200id7l_macro.xacro. Our choice: capsules run
// from joint origin to joint origin (shoulder, upper arm, elbow offset, forearm with the wrist);
// link 5 only turns about its end and has none, and neither has the base.
[[nodiscard]] Arm<5> lr_mate_200id_7l() noexcept;

// SO-101, gripper as a part of the last link. TheRobotStudio/SO-ARM100 at fda892c,
// so101_new_calib.urdf; each capsule encloses the collision meshes of its link. The file's speed of
// 10 rad/s is a placeholder: the servos are slower.
[[nodiscard]] Arm<5> so_101() noexcept;

// WidowX-250 with fingers half open. Interbotix/interbotix_ros_manipulators at 0bb2b0e,
// wx250.urdf.xacro; capsules as above.
[[nodiscard]] Arm<5> widowx_250() noexcept;

// UFactory xArm5 without a gripper. Interbotix/interbotix_ros_manipulators at 0bb2b0e,
// uxarm5.urdf.xacro; capsules as above.
[[nodiscard]] Arm<5> xarm5() noexcept;

}  // namespace sopt
