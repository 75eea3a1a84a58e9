#include "tools/io/named_presets.h"

#include "models/arm/arm_presets.h"

namespace sopt {
namespace {

struct Preset {
  std::string_view name;
  Arm<5> (*make)() noexcept;
};

constexpr Preset kPresets[] = {{"lr_mate_200id_7l", lr_mate_200id_7l},
                               {"so101", so_101},
                               {"wx250", widowx_250},
                               {"xarm5", xarm5}};

}  // namespace

std::optional<NamedArm<5>> find_preset(std::string_view name) {
  for (const Preset& preset : kPresets) {
    if (preset.name != name) continue;
    NamedArm<5> named;
    named.arm = preset.make();
    named.link_names = {"base"};
    for (int i = 1; i <= 5; ++i) {
      named.joint_names.push_back("joint_" + std::to_string(i));
      named.link_names.push_back("link_" + std::to_string(i));
    }
    return named;
  }
  return std::nullopt;
}

}  // namespace sopt
