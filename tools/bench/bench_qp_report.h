// Tables and JSON of `sopt bench qp`.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/bench/bench_qp.h"

namespace sopt {

// A table per family.
[[nodiscard]] std::string describe(const BenchQpFamily& family);
[[nodiscard]] nlohmann::ordered_json to_json(const BenchQpFamily& family);
// Exact step counts alone, which any change of the method shows in:
// {family: {solver: {"cold": total, "warm": total}}}.
[[nodiscard]] nlohmann::ordered_json counts_json(const std::vector<BenchQpFamily>& families);

}  // namespace sopt
