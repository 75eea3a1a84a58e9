#include "tools/tables/paper_claims.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>

#include "tools/io/plan_report.h"

namespace sopt {
namespace {

// Positions in kPaperColumns.
constexpr std::size_t kOne = 0;
constexpr std::size_t kSeven = 3;
constexpr std::size_t kNine = 4;
constexpr std::size_t kNumFixed = 5;
constexpr std::size_t kSevenMerging = 5;
constexpr std::size_t kNineMerging = 6;

using Columns = std::span<const ClaimColumn>;
using Member = double ClaimColumn::*;

// More than one segment, merging or not.
Columns split(const ClaimFigures& figures) { return Columns(figures.columns).subspan(1); }
Columns split_and_fixed(const ClaimFigures& figures) {
  return Columns(figures.columns).subspan(1, kNumFixed - 1);
}

template <class Value>
double largest(Columns columns, Value value) {
  double result = std::invoke(value, columns.front());
  for (const ClaimColumn& column : columns) result = std::max(result, std::invoke(value, column));
  return result;
}

double smallest(Columns columns, Member member) {
  return -largest(columns, [=](const ClaimColumn& column) { return -(column.*member); });
}

std::string time_text(double time, const ClaimFigures& figures) {
  return format(time < 999.5 ? "%.3g %s" : "%.0f %s", time, figures.time_unit);
}

Evidence judge_splitting(const ClaimFigures& f) {
  const Columns fixed = split_and_fixed(f);
  const double best = smallest(fixed, &ClaimColumn::optimize_time);
  const double one = f.columns[kOne].optimize_time;
  const auto i_best =
      std::find_if(fixed.begin(), fixed.end(),
                   [best](const ClaimColumn& column) { return column.optimize_time == best; }) -
      fixed.begin();
  return {"", "", one > (1.0 + kMaterial) * best,
          format("N = 1 takes %.3g x the best, %s (%s against %s)", one / best,
                 kPaperColumns[static_cast<std::size_t>(i_best) + 1].label,
                 time_text(one, f).c_str(), time_text(best, f).c_str())};
}

Evidence judge_seven(const ClaimFigures& f) {
  const ClaimColumn& seven = f.columns[kSeven];
  double next_time = 0.0, next_iterations = 0.0;  // relative to those of 7, the least of the others
  for (std::size_t i = 0; i < kNumFixed; ++i) {
    if (i == kSeven) continue;
    const double time = f.columns[i].optimize_time / seven.optimize_time;
    const double iterations = f.columns[i].iterations / seven.iterations;
    next_time = next_time == 0.0 ? time : std::min(next_time, time);
    next_iterations = next_iterations == 0.0 ? iterations : std::min(next_iterations, iterations);
  }
  return {"", "", std::min(next_time, next_iterations) > 1.0 + kMaterial,
          format("the best other N takes %.3g x its time and %.3g x its iterations", next_time,
                 next_iterations)};
}

Evidence judge_merging(const ClaimFigures& f) {
  const double seven = f.columns[kSevenMerging].optimize_time / f.columns[kSeven].optimize_time;
  const double nine = f.columns[kNineMerging].optimize_time / f.columns[kNine].optimize_time;
  return {"", "", std::max(seven, nine) < 1.0 - kMaterial,
          format("%.3g x the time of 7 that stay, %.3g x that of 9", seven, nine)};
}

Evidence judge_deviation(const ClaimFigures& f) {
  const double one = f.columns[kOne].optimize_deviation;
  const double others = largest(split(f), &ClaimColumn::optimize_deviation);
  const auto relative = [](const ClaimColumn& column) {
    return column.optimize_deviation / column.optimize_time;
  };
  return {"", "", others < (1.0 - kMaterial) * one,
          format("%s at N = 1, at most %s at N >= 3; over the mean: %.2f, at most %.2f",
                 time_text(one, f).c_str(), time_text(others, f).c_str(), relative(f.columns[kOne]),
                 largest(split(f), relative))};
}

bool has_times(const ClaimFigures& f) {
  return smallest(f.columns, &ClaimColumn::optimize_time) > 0.0;
}

bool has_lengths(const ClaimFigures& f) {
  return f.rrt_star_length > 0.0 && smallest(f.columns, &ClaimColumn::length) > 0.0;
}

const Evidence kNothingTimed = {"", "", false, "a column in which nothing was optimised"};
const Evidence kNothingToCompare = {"", "", false, "no case that every column solved"};

Evidence judge_costs(const ClaimFigures& f) {
  if (!has_lengths(f)) return kNothingToCompare;
  const double least = smallest(f.columns, &ClaimColumn::length);
  const double most = largest(f.columns, &ClaimColumn::length);
  return {"", "", most <= (1.0 + kEqualCosts) * least,
          format("%.2f to %.2f m, %.2g %% apart", least, most, 100.0 * (most / least - 1.0))};
}

Evidence judge_gain(const ClaimFigures& f) {
  if (!has_lengths(f)) return kNothingToCompare;
  const double least = smallest(f.columns, &ClaimColumn::length) / f.rrt_star_length;
  const double most = largest(f.columns, &ClaimColumn::length) / f.rrt_star_length;
  return {"", "", most < 1.0 - kMaterial,
          format("%.3f to %.3f of RRT*'s %.2f m", least, most, f.rrt_star_length)};
}

Evidence judge_few_iterations(const ClaimFigures& f) {
  const double least = smallest(split(f), &ClaimColumn::iterations);
  const double most = largest(split(f), &ClaimColumn::iterations);
  return {"", "", most <= kFewIterations, format("%.1f to %.1f", least, most)};
}

Evidence judge_fewer_iterations(const ClaimFigures& f) {
  const double one = f.columns[kOne].iterations;
  const double most = largest(split(f), &ClaimColumn::iterations);
  return {"", "", most < (1.0 - kMaterial) * one,
          format("%.1f at N = 1, at most %.1f at N >= 3", one, most)};
}

Evidence judge_success(const ClaimFigures& f) {
  const double least = smallest(f.columns, &ClaimColumn::success_percent);
  const double most = largest(f.columns, &ClaimColumn::success_percent);
  return {"", "", least >= 100.0,
          least == most ? format("%.3g %%", least) : format("%.3g to %.3g %%", least, most)};
}

struct Statement {
  const char* text;
  bool is_about_time;
  Evidence (*judge)(const ClaimFigures& figures);
};

constexpr Statement kStatements[] = {
    {"splitting cuts the optimisation time", true, judge_splitting},
    {"7 segments are fastest and need the fewest iterations", true, judge_seven},
    {"merging cuts it further", true, judge_merging},
    {"splitting makes it vary less (standard deviation)", true, judge_deviation},
    {"the costs are equal whatever the number of segments (within 2 %)", false, judge_costs},
    {"they are noticeably below those of RRT*", false, judge_gain},
    {"with N >= 3 few iterations are enough (at most 8)", false, judge_few_iterations},
    {"splitting needs fewer iterations than one segment", false, judge_fewer_iterations},
    {"every case succeeds", false, judge_success},
};

}  // namespace

ClaimFigures figures_of_paper() {
  ClaimFigures figures{"paper", "", "s", kPaperRrtStar.cost, {}};
  for (std::size_t i = 0; i < kNumTableColumns; ++i) {
    const PaperColumn& column = kPaperColumns[i];
    figures.columns[i] = {paper_optimize_s(column), column.deviation_s, column.cost,
                          column.iterations, column.success_percent};
  }
  return figures;
}

ClaimFigures figures_of(const ModeSummary& mode, bool is_critical_path) {
  ClaimFigures figures{std::string(1, mode.letter),
                       is_critical_path ? "critical path" : "serial",
                       "us",
                       mode.rrt_star.common_length_m.mean,
                       {}};
  for (std::size_t i = 0; i < kNumTableColumns; ++i) {
    const RunSummary& column = mode.columns[i];
    const Spread& time = is_critical_path ? column.optimize.critical_us : column.optimize.serial_us;
    figures.columns[i] = {time.mean, time.deviation, column.common_length_m.mean,
                          column.iterations.mean, column.success_percent()};
  }
  return figures;
}

std::vector<Claim> judge_claims(const std::vector<ClaimFigures>& figures) {
  std::vector<Claim> claims;
  for (const Statement& statement : kStatements) {
    Claim& claim = claims.emplace_back(Claim{statement.text, {}});
    for (const ClaimFigures& f : figures) {
      const bool is_said = !claim.evidence.empty() && claim.evidence.back().source == f.source;
      if (!statement.is_about_time && is_said) continue;
      Evidence evidence = statement.judge(f);
      if (statement.is_about_time && !has_times(f)) evidence = kNothingTimed;
      evidence.source = f.source;
      evidence.clock = statement.is_about_time ? f.clock : "";
      claim.evidence.push_back(evidence);
    }
  }
  return claims;
}

}  // namespace sopt
