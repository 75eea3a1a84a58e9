// The tables of a run as text and as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/tables/paper_claims.h"
#include "tools/tables/plane_tables.h"
#include "tools/tables/table_summary.h"

namespace sopt {

struct TablesSummary {
  std::vector<ModeSummary> modes;
  std::vector<RunSummary> switches;
  std::vector<Claim> claims;
};
[[nodiscard]] TablesSummary summarize(const PlaneTables& tables);

// The paper's table, ours mode by mode, both relative to N = 7, the claims, the switches.
[[nodiscard]] std::string describe(const PlaneTables& tables, const TablesSummary& summary);

// Every figure of them, with the choices of each column as command-line options.
[[nodiscard]] nlohmann::ordered_json to_json(const PlaneTables& tables,
                                             const TablesSummary& summary);

}  // namespace sopt
