// URDF robots: links, joints and limits as liburdfdom reads them, every collision shape (or visual
// shape, of a link that has no collision shapes) wrapped by one capsule. Meshes, STL and OBJ, are
// looked up beside the URDF file: PATH of package://NAME/PATH in NAME below, or in itself, the
// file's folder and the four folders above it. Not supported, an error that names the joint: mimic,
// floating and planar joints. Active joints: the chain from the root that follows, at forks, the
// branch with more moving joints and ends where branches tie, as at the fingers of a hand.
// No acceleration limits in URDF: kAccelerationPerVelocity x velocity.
#pragma once

#include <filesystem>
#include <vector>

#include "tools/io/capsule_wrap.h"
#include "tools/io/robot_model.h"

namespace sopt {

struct UrdfRobot {
  RobotModel model;
  std::vector<CapsuleApproximation> approximations;  // capsules in link frames
};

// Throws InputError.
[[nodiscard]] UrdfRobot load_urdf(const std::filesystem::path& file);

}  // namespace sopt
