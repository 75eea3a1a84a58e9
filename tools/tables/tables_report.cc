#include "tools/tables/tables_report.h"

#include <cstddef>
#include <cstdio>
#include <functional>
#include <string>

#include "tools/io/plan_report.h"

namespace sopt {
namespace {

std::string line_of(const std::string& name, const std::vector<std::string>& cells) {
  std::string line = format("  %-37s", name.c_str());
  for (const std::string& cell : cells) line += format(" %10s", cell.c_str());
  return line + '\n';
}

std::string header(const std::string& name, const PaperTable& paper) {
  std::vector<std::string> labels = {paper.rrt_star.label};
  for (const PaperColumn& column : paper.columns) labels.emplace_back(column.label);
  return name + '\n' + line_of("", labels);
}

std::string number(double value) { return format(value < 999.5 ? "%.3g" : "%.0f", value); }
std::string length(double value_m) { return value_m == 0.0 ? "-" : format("%.2f", value_m); }
std::string ratio(double value, double to) { return to > 0.0 ? format("%.2f", value / to) : "-"; }
std::string count(double value) { return value == 0.0 ? "-" : format("%.1f", value); }

// A figure of the paper's columns; RRT* alone has it or not.
std::string paper_line(const PaperTable& paper, const std::string& name,
                       const std::function<double(const PaperColumn&)>& value, const char* pattern,
                       bool has_rrt_star) {
  const auto cell = [&](const PaperColumn& column) {
    char text[32] = "";
    (void)std::snprintf(text, sizeof text, pattern, value(column));
    return std::string(text);
  };
  std::vector<std::string> cells = {has_rrt_star ? cell(paper.rrt_star) : "-"};
  for (const PaperColumn& column : paper.columns) cells.push_back(cell(column));
  return line_of(name, cells);
}

std::string paper_table(const PaperTable& paper) {
  const auto optimize_s = [&](const PaperColumn& column) { return paper.optimize_s(column); };
  return header(std::string("\n") + paper.title, paper) +
         paper_line(paper, "time in all [s]", &PaperColumn::time_s, "%.2f", true) +
         paper_line(paper, "- without RRT*: optimisation [s]", optimize_s, "%.2f", false) +
         paper_line(paper, "- its standard deviation [s]", &PaperColumn::deviation_s, "%.2f",
                    false) +
         paper_line(paper, format("cost [%s]", paper.length_unit), &PaperColumn::cost, "%.2f",
                    true) +
         paper_line(paper, "iterations", &PaperColumn::iterations, "%.1f", false) +
         paper_line(paper, "success [%]", &PaperColumn::success_percent, "%.0f", true) +
         paper_line(paper, "segments at the end", &PaperColumn::segments_final, "%.1f", false);
}

using Figure = std::function<std::string(const RunSummary&)>;

Figure mean_of(StageSpread RunSummary::*stage, Spread StageSpread::*clock) {
  return [=](const RunSummary& run) { return number(((run.*stage).*clock).mean); };
}
Figure deviation_of(StageSpread RunSummary::*stage, Spread StageSpread::*clock) {
  return [=](const RunSummary& run) { return number(((run.*stage).*clock).deviation); };
}
Figure median_of(StageSpread RunSummary::*stage, Spread StageSpread::*clock) {
  return [=](const RunSummary& run) { return number(((run.*stage).*clock).median); };
}

struct Row {
  std::string name;
  Figure figure;
  bool has_rrt_star = true;
};

void add_time_rows(const char* const (&names)[6], Spread StageSpread::*clock,
                   std::vector<Row>& rows) {
  rows.push_back({names[0], mean_of(&RunSummary::total, clock)});
  rows.push_back({names[1], median_of(&RunSummary::total, clock)});
  rows.push_back({names[2], mean_of(&RunSummary::sample, clock)});
  rows.push_back({names[3], mean_of(&RunSummary::optimize, clock), false});
  rows.push_back({names[4], deviation_of(&RunSummary::optimize, clock), false});
  rows.push_back({names[5], median_of(&RunSummary::optimize, clock), false});
}

std::vector<Row> mode_rows(const PaperTable& paper) {
  std::vector<Row> rows;
  constexpr const char* kSerial[] = {
      "serial: time in all [us], mean", "- median",  "- sampling, mean", "- optimisation, mean",
      "  - standard deviation",         "  - median"};
  constexpr const char* kCritical[] = {"a worker per window: in all, mean",
                                       "- median",
                                       "- sampling, a worker per stream",
                                       "- optimisation, mean",
                                       "  - standard deviation",
                                       "  - median"};
  add_time_rows(kSerial, &StageSpread::serial_us, rows);
  add_time_rows(kCritical, &StageSpread::critical_us, rows);
  rows.push_back({format("cost: path length [%s], successes", paper.length_unit),
                  [](const RunSummary& run) { return length(run.length.mean); }});
  rows.push_back({"- cases that every column solved",
                  [](const RunSummary& run) { return length(run.common_length.mean); }});
  rows.push_back(
      {"iterations", [](const RunSummary& run) { return count(run.iterations.mean); }, false});
  rows.push_back(
      {"success [%]", [](const RunSummary& run) { return format("%.1f", run.success_percent()); }});
  rows.push_back({"segments at the beginning",
                  [](const RunSummary& run) { return count(run.segments_initial.mean); }, false});
  rows.push_back({"segments at the end",
                  [](const RunSummary& run) { return count(run.segments_final.mean); }, false});
  return rows;
}

std::string mode_table(const PaperTable& paper, const ModeSummary& mode) {
  std::string text = header(format("\n%c: %s (%d cases, %d solved by every column)", mode.letter,
                                   mode.name.c_str(), mode.rrt_star.num_cases, mode.num_common),
                            paper);
  for (const Row& row : mode_rows(paper)) {
    std::vector<std::string> cells = {row.has_rrt_star ? row.figure(mode.rrt_star) : "-"};
    for (const RunSummary& column : mode.columns) cells.push_back(row.figure(column));
    text += line_of(row.name, cells);
  }
  return text;
}

std::string relative_table(const PaperTable& paper, const std::vector<ModeSummary>& modes) {
  std::string text = header("\noptimisation time relative to N = 7, means", paper);
  for (const ClaimFigures& figures : list_figures(paper, modes)) {
    const ClaimColumn& seven = figures.columns[paper.i_fixed(7)];
    std::vector<std::string> cells = {"-"};
    for (const ClaimColumn& column : figures.columns) {
      cells.push_back(ratio(column.optimize_time, seven.optimize_time));
    }
    text += line_of(name_of(figures.source, figures.clock), cells);
  }
  return text;
}

std::string claims_text(const char* title, const std::vector<Claim>& claims) {
  std::string text = std::string("\n") + title + '\n';
  for (const Claim& claim : claims) {
    text += "  " + claim.statement + '\n';
    for (const Evidence& evidence : claim.evidence) {
      text += format("    %-17s %-8s", name_of(evidence.source, evidence.clock).c_str(),
                     evidence.is_met ? "met" : "not met") +
              evidence.text + '\n';
    }
  }
  return text;
}

std::string switch_table(const Tables& tables, const std::vector<RunSummary>& switches) {
  std::string text = format("\none choice of the paper at a time (serial, N = auto)\n") +
                     line_of("", {"total [us]", "median", "sample", "optimise", "deviation",
                                  format("length [%s]", tables.paper->length_unit), "iterations",
                                  "success %", "fell back", "segments", "time ratio"});
  const double total_us = switches.front().total.serial_us.mean;
  for (std::size_t i = 0; i < switches.size(); ++i) {
    const RunSummary& run = switches[i];
    text += line_of(tables.switches[i].label,
                    {number(run.total.serial_us.mean), number(run.total.serial_us.median),
                     number(run.sample.serial_us.mean), number(run.optimize.serial_us.mean),
                     number(run.optimize.serial_us.deviation), length(run.common_length.mean),
                     format("%.2f", run.iterations.mean), format("%.1f", run.success_percent()),
                     format("%.1f %%", run.fell_back_percent()),
                     format("%.1f>%.1f", run.segments_initial.mean, run.segments_final.mean),
                     ratio(run.total.serial_us.mean, total_us)});
  }
  return text + format("  length: of the %d cases that all of them solved\n",
                       switches.front().common_length.count);
}

}  // namespace

TablesSummary summarize(const Tables& tables) {
  TablesSummary summary;
  for (const TableMode& mode : tables.modes) {
    summary.modes.push_back(summarize(mode, tables.rrt_star));
  }
  const std::vector<bool> is_common = common_successes(tables.switches);
  for (const TableRun& run : tables.switches) {
    summary.switches.push_back(summarize(run, is_common));
  }
  summary.claims = judge_claims(list_figures(*tables.paper, summary.modes));
  return summary;
}

std::string describe(const Tables& tables, const TablesSummary& summary) {
  const PaperTable& paper = *tables.paper;
  std::string text = paper_table(paper);
  for (const ModeSummary& mode : summary.modes) text += mode_table(paper, mode);
  return text + relative_table(paper, summary.modes) +
         claims_text("the paper's claims", summary.claims) + switch_table(tables, summary.switches);
}

FamiliesSummary summarize(const std::vector<Tables>& families) {
  FamiliesSummary summary;
  std::vector<std::vector<ClaimFigures>> figures;
  for (const Tables& tables : families) {
    summary.families.push_back(summarize(tables));
    figures.push_back(list_figures(*tables.paper, summary.families.back().modes));
  }
  if (figures.size() == 2) summary.claims = {judge_more_obstacles(figures[0], figures[1])};
  return summary;
}

std::string describe(const std::vector<Tables>& families, const FamiliesSummary& summary) {
  std::string text;
  for (std::size_t i = 0; i < families.size(); ++i) {
    text += describe(families[i], summary.families[i]);
  }
  return summary.claims.empty() ? text
                                : text + claims_text("of both families of scenes", summary.claims);
}

}  // namespace sopt
