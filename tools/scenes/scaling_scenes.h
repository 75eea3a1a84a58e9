// Families of planar scenes that grow, for measuring how planning time grows with them:
// - corridor: a strip with a wall every 8 m that leaves a gap of 1.6 m, in turns at the top and at
//   the bottom, and two small discs in every room; obstacles per metre and step length are constant
// - maze: a perfect grid maze (one way between any two cells, so every seed of the planner plans
//   the same one) with the goal at a given number of cells from the start
// - field: a square of one size under obstacles that get smaller as they get more: a tenth of it is
//   covered, every gap can be passed. A straight line then meets about sqrt(n) of n obstacles,
//   which is the growth to expect of a planner that looks only at what is near. (With more
//   obstacles of one size elsewhere it would have nothing more to do, and show the broad phase
//   alone.)
// Deterministic from family, size and seed. Lengths in m. Setup code.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tools/io/scene_file.h"

namespace sopt {

enum class ScalingFamily : std::int8_t { kCorridor, kMaze, kField };

[[nodiscard]] const char* to_string(ScalingFamily family);

// Steps of the plan, about; of the field, obstacles. Increasing.
[[nodiscard]] std::span<const int> scaling_sizes(ScalingFamily family);

inline constexpr double kScalingStep_m = 0.4;  // nominal, in the corridor and the maze
inline constexpr double kMazeCell_m = 3.0;
inline constexpr double kFieldSide_m = 40.0;
inline constexpr double kFieldCover = 0.1;  // share of the field's area

struct ScalingScene {
  Scene scene;
  std::vector<Vec2> way;  // clear with the margin, from start to goal; empty in the field
};

// `size` >= 50 in the corridor and the maze, from 1 to 8192 in the field. Throws HostError when
// there is no memory.
[[nodiscard]] ScalingScene make_scaling_scene(ScalingFamily family, int size, std::uint64_t seed);

}  // namespace sopt
