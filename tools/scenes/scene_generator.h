// Makes the shipped planar benchmark scenes: convex obstacles between two far corners, straight
// line blocked, in the style of [Leu22, Table I]. Deterministic: splitmix64 on recorded seeds, no
// std:: distribution (they differ between standard libraries), coordinates rounded to 1e-4 m. The
// geometry is drawn until the straight line is blocked; what is drawn is dropped only by the grid
// flood of tools/generated_scene.h, never for what a planner does with it.
#pragma once

#include <vector>

#include "tools/scenes/generated_scene.h"

namespace sopt {

// plane_01 .. plane_25 with 5 to 20 obstacles, then plane_long, a slalom around walls.
[[nodiscard]] std::vector<GeneratedScene> generate_scenes();

}  // namespace sopt
