// What [Leu22] concludes from its Tables I and II, as statements that figures decide: the paper's
// own and each of ours go through the same conditions, those of both tables through the same for
// both. Differences below kMaterial count as none.
#pragma once

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
  const PaperTable* table = nullptr;
  double rrt_star_length = 0.0;      // 0: no case to compare
  std::vector<ClaimColumn> columns;  // as the table's
};

[[nodiscard]] ClaimFigures figures_of(const PaperTable& table);
// Of the mode's serial times, or of its critical paths.
[[nodiscard]] ClaimFigures figures_of(const PaperTable& table, const ModeSummary& mode,
                                      bool is_critical_path);
// The paper's, then both of every mode.
[[nodiscard]] std::vector<ClaimFigures> list_figures(const PaperTable& table,
                                                     const std::vector<ModeSummary>& modes);

struct Evidence {
  std::string source, clock;
  bool is_met = false;
  std::string text;
};

// "A, serial"
[[nodiscard]] std::string name_of(const std::string& source, const std::string& clock);

struct Claim {
  std::string statement;
  std::vector<Evidence> evidence;
};

// Every statement about the figures' table, which is one, with what each of `figures` says to it;
// to a statement that is not about time, only the first of neighbours with one source.
[[nodiscard]] std::vector<Claim> judge_claims(const std::vector<ClaimFigures>& figures);

// What is said about two tables, of few obstacles and of many; their figures have the same sources.
[[nodiscard]] Claim judge_more_obstacles(const std::vector<ClaimFigures>& few,
                                         const std::vector<ClaimFigures>& many);

}  // namespace sopt
