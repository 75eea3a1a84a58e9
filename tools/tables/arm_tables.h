// The cases behind `sopt tables arm`: [Leu22, Table II], one family of scenes above and one below.
// Beside the plane's modes a fourth one, the defaults without their window check: what a single
// segment fails at.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/tables/table_run.h"

namespace sopt {

inline constexpr const char* kArmScenes = "tools/scenes/arm";

// Without cases; `paper` is the family's half of Table II.
[[nodiscard]] Tables list_arm_tables(const PaperTable& paper);

// Scene files of the arguments (list_files), or those shipped for Table II: not the factory. Throws
// InputError when there are none.
[[nodiscard]] std::vector<std::filesystem::path> list_arm_scenes(
    const std::vector<std::string>& arguments);

struct ArmFamily {
  const PaperTable* paper = nullptr;
  std::vector<std::filesystem::path> scenes;
};
// By their number of obstacles, those with 2 before those with 7 to 9; a family without scenes is
// left out. Throws what load_any_scene throws, and InputError for scenes of no family.
[[nodiscard]] std::vector<ArmFamily> group_arm_scenes(
    const std::vector<std::filesystem::path>& scenes);

// One per family. Throws what load_any_scene and TimedPlanner throw.
[[nodiscard]] std::vector<Tables> run_arm_tables(const std::vector<ArmFamily>& families,
                                                 int num_seeds);

}  // namespace sopt
