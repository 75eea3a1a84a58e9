// Makes the shipped scenes of the LR Mate 200iD/7L among obstacles, in the style of
// [Leu22, Table II], and the factory scene of its first figure: the arm reaches through the side of
// a car. Deterministic on recorded seeds, values rounded to 1e-4. Ends and obstacles are drawn
// until the ends are clear by 0.03 m, the tip travels more than 0.6 m and the straight joint motion
// is blocked; what is drawn is then dropped only when the RRT-Connect of arm_scene_check.h finds no
// path with the default margin, never for what a planner does with it.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "models/arm/arm.h"

namespace sopt {

struct GeneratedArmScene {
  std::string name;
  std::string file;  // path in the folder of scenes
  std::uint64_t seed = 0;
  int num_dropped = 0;  // unsolvable candidates before this one
  Arm<5>::Config start = Arm<5>::Config::Zero();
  Arm<5>::Config goal = Arm<5>::Config::Zero();
  nlohmann::ordered_json obstacles;  // as in the file
};

// arm_2_01 .. arm_2_20 with 2 obstacles, arm_8_01 .. arm_8_20 with 7 to 9, then factory.
[[nodiscard]] std::vector<GeneratedArmScene> generate_arm_scenes();

// The bytes of the scene file.
[[nodiscard]] std::string to_json_text(const GeneratedArmScene& scene);

}  // namespace sopt
