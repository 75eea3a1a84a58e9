// Robot files: a tree of links and joints as JSON, read strictly in two dialects that may be mixed:
// origins `xyz`, `rpy` or `origin_xyz`, `origin_rpy`; shapes `capsules` or `spheres`. Fields:
//   name, base_link or root_link, joints [{name, type (revolute, continuous, prismatic, fixed),
//   parent, child, xyz, rpy, axis, lower, upper, velocity, acceleration, weight}], capsules [{link,
//   p0, p1, radius}], spheres [{link, center, radius}], active_joints [names],
//   self_collision_link_pairs [[link, link]].
// T_child = T_parent Trans(xyz) R_z(yaw) R_y(pitch) R_x(roll) Rot(axis, q). An origin that is
// absent is 0; axes are made unit; acceleration defaults to kAccelerationPerVelocity x velocity,
// weight (ArmJoint::weight) to 1.
// Every joint that moves is active unless active_joints says otherwise. Documentary fields are
// ignored, unknown ones are errors.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tools/io/json_fields.h"
#include "tools/io/robot_model.h"

namespace sopt {

inline constexpr NumberRule kJointWeight{1.0 / kMaxJointWeight, kMaxJointWeight,
                                         "a number from 0.001 to 1000"};

// Throws InputError; its what() is one line: file, field, value, what is allowed.
[[nodiscard]] RobotModel load_robot_file(const std::filesystem::path& file);

// The model in the `capsules` dialect, for to_text.
[[nodiscard]] nlohmann::ordered_json robot_to_json(const RobotModel& model);

}  // namespace sopt
