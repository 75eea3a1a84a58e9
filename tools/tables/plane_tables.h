// The cases behind `sopt tables plane`: [Leu22, Table I].
#pragma once

#include <filesystem>
#include <vector>

#include "tools/tables/table_run.h"

namespace sopt {

// Without cases.
[[nodiscard]] Tables list_plane_tables();

// Throws what load_scene and TimedPlanner throw.
[[nodiscard]] Tables run_plane_tables(const std::vector<std::filesystem::path>& scenes,
                                      int num_seeds);

}  // namespace sopt
