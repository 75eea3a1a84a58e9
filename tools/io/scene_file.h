// Scene files: one planning problem as JSON, read strictly. Every field is checked for presence,
// type, size, range and finiteness, unknown fields are errors that name them, and so is what the
// program cannot plan (robots other than point2d, moving obstacles). Fields that only document the
// scene (name, source, license, notes, units, check, num_obstacles, derived, start_note, tags, and
// everything that begins with reference_ or x_) are ignored. A start or goal out of bounds or in
// collision is not an error of the file: the planner answers it with a status.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "alloc/memory_block.h"
#include "models/config.h"
#include "models/plane/point2.h"
#include "models/plane/world2.h"
#include "models/trajectory.h"

namespace sopt {

class JsonField;

struct Scene {
  std::filesystem::path file;
  std::string name;                     // the file's stem when the scene has none
  std::string robot_name;               // "point2d"
  Point2 robot;                         // radius, and limits.v_max when given
  std::unique_ptr<MemoryBlock> memory;  // of the world
  std::unique_ptr<World2> world;        // built
  Vec2 start = Vec2::Zero();
  Vec2 goal = Vec2::Zero();
  // Where the scene says nothing, the defaults of PlanOptions hold.
  std::optional<double> speed_mps;
  std::optional<double> dt_s;
  std::optional<double> margin_m;
  std::optional<double> min_clearance_m;
  std::vector<std::string> obstacle_ids;            // one per obstacle; empty string: it has none
  std::optional<double> reference_feasible_length;  // of a known path, m; for benchmarks
};

// Throws InputError; its what() is one line: file, field, value, what is allowed.
[[nodiscard]] Scene load_scene(const std::filesystem::path& file);
// The same of what was parsed already.
[[nodiscard]] Scene read_scene(const JsonField& root, const std::filesystem::path& file);

// The scene's problem with the scene's options, seed 1, no deadline. Points into `scene`.
[[nodiscard]] PlanRequest<Point2> make_request(const Scene& scene);

// Memory for requests on `scene` with `options`: the default sizes, raised where the options or the
// scene's steps ask for more.
[[nodiscard]] PlannerSettings make_settings(const Scene& scene, const PlanOptions& options);

// "obstacle 7", "obstacle \"pillar\"" or "the bounds".
[[nodiscard]] std::string obstacle_name(const Scene& scene, int i_obstacle);

}  // namespace sopt
