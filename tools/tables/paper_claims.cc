#include "tools/tables/paper_claims.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>

#include "tools/io/plan_report.h"

namespace sopt {
namespace {

constexpr std::size_t kOne = 0;  // the column of one segment

using Columns = std::span<const ClaimColumn>;
using Member = double ClaimColumn::*;

// More than one segment, merging or not.
Columns split(const ClaimFigures& figures) { return Columns(figures.columns).subspan(1); }
Columns split_and_fixed(const ClaimFigures& figures) {
  return Columns(figures.columns).subspan(1, figures.table->num_fixed() - 1);
}
Columns merging(const ClaimFigures& figures) {
  return Columns(figures.columns).subspan(figures.table->num_fixed());
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
                 f.table->columns[static_cast<std::size_t>(i_best) + 1].label,
                 time_text(one, f).c_str(), time_text(best, f).c_str())};
}

Evidence judge_seven(const ClaimFigures& f) {
  const std::size_t i_seven = f.table->i_fixed(7);
  const ClaimColumn& seven = f.columns[i_seven];
  double next_time = 0.0, next_iterations = 0.0;  // relative to those of 7, the least of the others
  for (std::size_t i = 0; i < f.table->num_fixed(); ++i) {
    if (i == i_seven) continue;
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
  double most = 0.0;
  std::string text;
  for (std::size_t i = f.table->num_fixed(); i < f.columns.size(); ++i) {
    const int num_segments = f.table->columns[i].num_segments;
    const double share =
        f.columns[i].optimize_time / f.columns[f.table->i_fixed(num_segments)].optimize_time;
    most = std::max(most, share);
    text += text.empty() ? format("%.3g x the time of %d that stay", share, num_segments)
                         : format(", %.3g x that of %d", share, num_segments);
  }
  return {"", "", most < 1.0 - kMaterial, text};
}

Evidence judge_merging_best(const ClaimFigures& f) {
  const double best =
      smallest(Columns(f.columns).first(f.table->num_fixed()), &ClaimColumn::optimize_time);
  const double share = smallest(merging(f), &ClaimColumn::optimize_time) / best;
  return {"", "", share < 1.0 - kMaterial, format("%.3g x the time of the best that stay", share)};
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

Evidence judge_costs_of(const ClaimFigures& f, Columns columns) {
  if (!has_lengths(f)) return kNothingToCompare;
  const double least = smallest(columns, &ClaimColumn::length);
  const double most = largest(columns, &ClaimColumn::length);
  return {"", "", most <= (1.0 + kEqualCosts) * least,
          format("%.2f to %.2f %s, %.2g %% apart", least, most, f.table->length_unit,
                 100.0 * (most / least - 1.0))};
}
Evidence judge_costs(const ClaimFigures& f) { return judge_costs_of(f, f.columns); }
Evidence judge_split_costs(const ClaimFigures& f) { return judge_costs_of(f, split(f)); }

Evidence judge_gain_of(const ClaimFigures& f, Columns columns) {
  if (!has_lengths(f)) return kNothingToCompare;
  const double least = smallest(columns, &ClaimColumn::length) / f.rrt_star_length;
  const double most = largest(columns, &ClaimColumn::length) / f.rrt_star_length;
  return {"", "", most < 1.0 - kMaterial,
          format("%.3f to %.3f of RRT*'s %.2f %s", least, most, f.rrt_star_length,
                 f.table->length_unit)};
}
Evidence judge_gain(const ClaimFigures& f) { return judge_gain_of(f, f.columns); }
Evidence judge_split_gain(const ClaimFigures& f) { return judge_gain_of(f, split(f)); }

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

std::string percent_text(double least, double most) {
  return least == most ? format("%.3g %%", least) : format("%.3g to %.3g %%", least, most);
}

Evidence judge_success_of(Columns columns) {
  const double least = smallest(columns, &ClaimColumn::success_percent);
  const double most = largest(columns, &ClaimColumn::success_percent);
  return {"", "", least >= 100.0, percent_text(least, most)};
}
Evidence judge_success(const ClaimFigures& f) { return judge_success_of(f.columns); }
Evidence judge_split_success(const ClaimFigures& f) { return judge_success_of(split(f)); }

Evidence judge_one_segment(const ClaimFigures& f) {
  const double one = f.columns[kOne].success_percent;
  const double least = smallest(split(f), &ClaimColumn::success_percent);
  const double most = largest(split(f), &ClaimColumn::success_percent);
  return {"", "", one < (1.0 - kMaterial) * least,
          format("%.3g %% at N = 1, %s at N >= 3", one, percent_text(least, most).c_str())};
}

Evidence judge_obstacles(const ClaimFigures& few, const ClaimFigures& many) {
  if (!has_times(few) || !has_times(many)) return kNothingTimed;
  const auto ratio = [&](std::size_t i) {
    return many.columns[i].optimize_time / few.columns[i].optimize_time;
  };
  double least = ratio(1);
  double most = ratio(1);
  for (std::size_t i = 2; i < few.columns.size(); ++i) {
    least = std::min(least, ratio(i));
    most = std::max(most, ratio(i));
  }
  return {"", "", most < (1.0 - kMaterial) * ratio(kOne),
          format("%.3g x the time at N = 1, %.3g to %.3g x at N >= 3", ratio(kOne), least, most)};
}

enum class Said { kOfPlane, kOfArm, kOfBoth };

bool is_said_of(Said said, const PaperTable& table) {
  return said == Said::kOfBoth || (said == Said::kOfArm) == table.is_arm;
}

struct Statement {
  const char* text;
  Said said;
  bool is_about_time;
  Evidence (*judge)(const ClaimFigures& figures);
};

constexpr Statement kStatements[] = {
    {"splitting cuts the optimisation time", Said::kOfBoth, true, judge_splitting},
    {"7 segments are fastest and need the fewest iterations", Said::kOfPlane, true, judge_seven},
    {"merging cuts it further", Said::kOfBoth, true, judge_merging},
    {"merging cuts it below that of any number of segments that stay", Said::kOfArm, true,
     judge_merging_best},
    {"splitting makes it vary less (standard deviation)", Said::kOfBoth, true, judge_deviation},
    {"the costs are equal whatever the number of segments (within 2 %)", Said::kOfPlane, false,
     judge_costs},
    {"they are noticeably below those of RRT*", Said::kOfPlane, false, judge_gain},
    {"with N >= 3 the costs are equal (within 2 %)", Said::kOfArm, false, judge_split_costs},
    {"they are noticeably below those of RRT*", Said::kOfArm, false, judge_split_gain},
    {"with N >= 3 few iterations are enough (at most 8)", Said::kOfBoth, false,
     judge_few_iterations},
    {"splitting needs fewer iterations than one segment", Said::kOfPlane, false,
     judge_fewer_iterations},
    {"every case succeeds", Said::kOfPlane, false, judge_success},
    {"with N >= 3 every case succeeds", Said::kOfArm, false, judge_split_success},
    {"one segment alone succeeds less often (without a window check: paper, A, B, D)", Said::kOfArm,
     false, judge_one_segment},
};

}  // namespace

std::string name_of(const std::string& source, const std::string& clock) {
  return clock.empty() ? source : source + ", " + clock;
}

ClaimFigures figures_of(const PaperTable& table) {
  ClaimFigures figures{"paper", "", "s", &table, table.rrt_star.cost, {}};
  for (const PaperColumn& column : table.columns) {
    figures.columns.push_back({table.optimize_s(column), column.deviation_s, column.cost,
                               column.iterations, column.success_percent});
  }
  return figures;
}

ClaimFigures figures_of(const PaperTable& table, const ModeSummary& mode, bool is_critical_path) {
  ClaimFigures figures{std::string(1, mode.letter),
                       is_critical_path ? "critical path" : "serial",
                       "us",
                       &table,
                       mode.rrt_star.common_length.mean,
                       {}};
  for (const RunSummary& column : mode.columns) {
    const Spread& time = is_critical_path ? column.optimize.critical_us : column.optimize.serial_us;
    figures.columns.push_back({time.mean, time.deviation, column.common_length.mean,
                               column.iterations.mean, column.success_percent()});
  }
  return figures;
}

std::vector<ClaimFigures> list_figures(const PaperTable& table,
                                       const std::vector<ModeSummary>& modes) {
  std::vector<ClaimFigures> figures = {figures_of(table)};
  for (const ModeSummary& mode : modes) {
    figures.push_back(figures_of(table, mode, false));
    figures.push_back(figures_of(table, mode, true));
  }
  return figures;
}

std::vector<Claim> judge_claims(const std::vector<ClaimFigures>& figures) {
  std::vector<Claim> claims;
  for (const Statement& statement : kStatements) {
    if (!is_said_of(statement.said, *figures.front().table)) continue;
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

Claim judge_more_obstacles(const std::vector<ClaimFigures>& few,
                           const std::vector<ClaimFigures>& many) {
  Claim claim{"with N >= 3 more obstacles cost relatively less than with N = 1", {}};
  for (std::size_t i = 0; i < few.size(); ++i) {
    Evidence evidence = judge_obstacles(few[i], many[i]);
    evidence.source = few[i].source;
    evidence.clock = few[i].clock;
    claim.evidence.push_back(evidence);
  }
  return claim;
}

}  // namespace sopt
