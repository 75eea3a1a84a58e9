// The arms of models/arm/arm_presets.h by the names that files and the command line use.
#pragma once

#include <optional>
#include <string_view>

#include "tools/io/robot_model.h"

namespace sopt {

inline constexpr const char* kPresetNames = "lr_mate_200id_7l, so101, wx250, xarm5";

// Joints joint_1 .. joint_5, links base, link_1 .. link_5.
[[nodiscard]] std::optional<NamedArm<5>> find_preset(std::string_view name);

}  // namespace sopt
