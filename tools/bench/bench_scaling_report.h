// Tables, JSON and charts of `sopt bench scaling`.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tools/bench/bench_scaling.h"

namespace sopt {

// Medians by size, exponents below them, and a line for each target.
[[nodiscard]] std::string describe(const ScalingRun& run);

// Exponents, and all cases; null where there is no plan.
[[nodiscard]] nlohmann::ordered_json to_json(const ScalingRun& run);

// Times and counts, logarithmic, with the fitted lines: a whole SVG document.
[[nodiscard]] std::string draw(const ScalingRun& run);

}  // namespace sopt
