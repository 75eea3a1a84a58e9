// The tables of a run as text and as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/tables/paper_claims.h"
#include "tools/tables/table_run.h"
#include "tools/tables/table_summary.h"

namespace sopt {

struct TablesSummary {
  std::vector<ModeSummary> modes;
  std::vector<RunSummary> switches;
  std::vector<Claim> claims;
};
[[nodiscard]] TablesSummary summarize(const Tables& tables);

// The paper's table, ours mode by mode, both relative to N = 7, the claims, the switches.
[[nodiscard]] std::string describe(const Tables& tables, const TablesSummary& summary);

// Every figure of them, with the choices of each column as command-line options.
[[nodiscard]] nlohmann::ordered_json to_json(const Tables& tables, const TablesSummary& summary);

// Families of scenes of one table one after the other, then, when there are two, what is said about
// both.
struct FamiliesSummary {
  std::vector<TablesSummary> families;
  std::vector<Claim> claims;
};
[[nodiscard]] FamiliesSummary summarize(const std::vector<Tables>& families);
[[nodiscard]] std::string describe(const std::vector<Tables>& families,
                                   const FamiliesSummary& summary);
[[nodiscard]] nlohmann::ordered_json to_json(const std::vector<Tables>& families,
                                             const FamiliesSummary& summary);

}  // namespace sopt
