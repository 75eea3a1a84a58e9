// One generated planar scene: its data, the bytes of its file, and the solvability check that is
// the only reason to drop a candidate: a grid flood with its own point distances, which shares no
// code with the library. Lengths in m, angles in rad, the world is (0, 0) .. size_m. Setup code.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace sopt {

struct GeneratedObstacle {
  enum class Kind : std::int8_t { kDisc, kBox, kPolygon };

  Kind kind = Kind::kDisc;
  std::array<double, 2> center_m{};              // disc, box
  double radius_m = 0.0;                         // disc
  std::array<double, 2> size_m{};                // box, full extents
  double angle_rad = 0.0;                        // box
  std::vector<std::array<double, 2>> outline_m;  // convex, counter-clockwise; a box's corners
};

struct GeneratedScene {
  std::string name;
  std::string file;  // path in the folder of scenes
  std::uint64_t seed = 0;
  int num_dropped = 0;  // unsolvable candidates before this one
  std::array<double, 2> size_m{};
  double radius_m = 0.0;  // of the robot
  std::array<double, 2> start_m{};
  std::array<double, 2> goal_m{};
  std::vector<GeneratedObstacle> obstacles;
};

// Negative inside.
[[nodiscard]] double signed_distance_m(const GeneratedObstacle& obstacle, double x_m, double y_m);

// True when a flood over the centres of 0.05 m cells joins start and goal, cells being free at
// radius + 0.05 m + half a cell diagonal from everything: a path with 0.05 m clearance exists.
[[nodiscard]] bool is_solvable(const GeneratedScene& scene);

// The bytes of the scene file.
[[nodiscard]] std::string to_json_text(const GeneratedScene& scene);

}  // namespace sopt
