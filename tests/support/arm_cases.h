// How a case of a property program picks its arm: 4 to 8 joints with equal chance, or a preset.
#pragma once

#include <string>
#include <type_traits>

#include "models/arm/arm_presets.h"
#include "tests/support/arm_oracle.h"
#include "tests/support/property.h"

namespace sopt::oracle {

// check(n) where n is a constant, for 4 <= num_joints <= 8.
template <class Check>
std::string with_joints(int num_joints, Check&& check) {
  switch (num_joints) {
    case 4:
      return check(std::integral_constant<int, 4>());
    case 5:
      return check(std::integral_constant<int, 5>());
    case 6:
      return check(std::integral_constant<int, 6>());
    case 7:
      return check(std::integral_constant<int, 7>());
    default:
      return check(std::integral_constant<int, 8>());
  }
}

[[nodiscard]] inline const Arm<5>& random_preset(Random& random) {
  static const Arm<5> kPresets[] = {lr_mate_200id_7l(), so_101(), widowx_250(), xarm5()};
  return kPresets[random.index(4)];
}

// In memory that the next chain of N joints takes over.
template <int N>
[[nodiscard]] const RandomArm<N>& random_chain(Random& random, CaseReport& report) {
  static RandomArm<N> drawn;
  report.expect("a valid chain is taken", draw_chain(random, drawn));
  return drawn;
}

// check(arm) on a chain or, in `preset_share` of 5 + preset_share cases, on a preset.
template <class Check>
std::string with_chain_or_preset(Random& random, CaseReport& report, int preset_share,
                                 Check&& check) {
  const int kind = random.index(5 + preset_share);
  if (kind >= 5) return check(random_preset(random));
  return with_joints(4 + kind, [&](auto n) { return check(random_chain<n>(random, report).arm); });
}

}  // namespace sopt::oracle
