// What the scene files of all robots share: documentary fields, ids, margins, obstacles that do not
// move, vectors of space.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "models/config.h"
#include "models/space/shape3.h"
#include "tools/io/json_fields.h"

namespace sopt {

inline constexpr const char* kPoint3Allowed = "[x, y, z], three numbers from -1e6 to 1e6";

// Ignored everywhere: reference_* and x_*.
[[nodiscard]] bool is_documentary(std::string_view name);
// Ignored at the top of a scene: these, source, license, notes and their like.
[[nodiscard]] bool is_documentary_in_scene(std::string_view name);

// The scene's `name`, else the file's stem.
[[nodiscard]] std::string read_scene_name(const JsonField& root, const std::string& stem);

// One per obstacle, empty where it has none; throws when two are equal.
[[nodiscard]] std::vector<std::string> read_ids(const JsonField& obstacles);

// kDefaultMargin when the obstacle has none of its own.
[[nodiscard]] double read_margin(const JsonField& obstacle);

// Throws unless the field is absent or an array of `size` zeros.
void check_zeros(const JsonField& object, const char* name, std::size_t size,
                 std::string_view allowed);

// Throws when `options`, the scene's values over the defaults, want less margin than is hard.
void check_margins(const JsonField& root, const PlanOptions& options);

[[nodiscard]] Vec3 read_three(const JsonField& field, const NumberRule& rule,
                              std::string_view allowed);

// "obstacle 7", "obstacle \"pillar\"", "the bounds" or "nothing".
[[nodiscard]] std::string obstacle_name(const std::vector<std::string>& ids, int i_obstacle);

}  // namespace sopt
