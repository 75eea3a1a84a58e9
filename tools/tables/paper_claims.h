// What [Leu22] concludes from its Table I, as statements that figures decide: the paper's own and
// each of ours go through the same conditions. Differences below kMaterial count as none.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tools/tables/paper_table.h"
#include "tools/tables/table_summary.h"

namespace sopt {

inline constexpr double kMaterial = 0.05;
// Costs this close, relative, are equal; iterations up to this are few.
inline constexpr double kEqualCosts = 0.02;
inline constexpr double kFewIterations = 8.0;

// One column as the statements see it; any unit of time and length.
struct ClaimColumn {
  double optimize_time = 0.0;       // mean
  double optimize_deviation = 0.0;  // standard
  double length = 0.0;              // mean
  double iterations = 0.0;
  double success_percent = 0.0;
};

struct ClaimFigures {
  std::string source;  // "A"
  std::string clock;   // "serial"; empty: the only one
  const char* time_unit = "us";
  double rrt_star_length = 0.0;                       // 0: no case to compare
  std::array<ClaimColumn, kNumTableColumns> columns;  // as kPaperColumns
};

[[nodiscard]] ClaimFigures figures_of_paper();
// Of the mode's serial times, or of its critical paths.
[[nodiscard]] ClaimFigures figures_of(const ModeSummary& mode, bool is_critical_path);

struct Evidence {
  std::string source, clock;
  bool is_met = false;
  std::string text;
};

struct Claim {
  std::string statement;
  std::vector<Evidence> evidence;
};

// Every statement with what each of `figures` says to it; to a statement that is not about time,
// only the first of neighbours with one source.
[[nodiscard]] std::vector<Claim> judge_claims(const std::vector<ClaimFigures>& figures);

}  // namespace sopt
