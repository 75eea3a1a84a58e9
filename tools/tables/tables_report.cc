#include "tools/tables/tables_report.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <utility>

#include "tools/io/plan_report.h"

namespace sopt {
namespace {

constexpr std::size_t kSeven = 3;  // in kPaperColumns

std::string line_of(const std::string& name, const std::vector<std::string>& cells) {
  std::string line = format("  %-37s", name.c_str());
  for (const std::string& cell : cells) line += format(" %10s", cell.c_str());
  return line + '\n';
}

std::string header(const std::string& name) {
  std::vector<std::string> labels = {kPaperRrtStar.label};
  for (const PaperColumn& column : kPaperColumns) labels.emplace_back(column.label);
  return name + '\n' + line_of("", labels);
}

std::string number(double value) { return format(value < 999.5 ? "%.3g" : "%.0f", value); }
std::string length(double value_m) { return value_m == 0.0 ? "-" : format("%.2f", value_m); }
std::string ratio(double value, double to) { return to > 0.0 ? format("%.2f", value / to) : "-"; }
std::string count(double value) { return value == 0.0 ? "-" : format("%.1f", value); }

// A figure of the paper's columns; RRT* alone has it or not.
std::string paper_line(const char* name, const std::function<double(const PaperColumn&)>& value,
                       const char* pattern, bool has_rrt_star) {
  const auto cell = [&](const PaperColumn& column) {
    char text[32] = "";
    (void)std::snprintf(text, sizeof text, pattern, value(column));
    return std::string(text);
  };
  std::vector<std::string> cells = {has_rrt_star ? cell(kPaperRrtStar) : "-"};
  for (const PaperColumn& column : kPaperColumns) cells.push_back(cell(column));
  return line_of(name, cells);
}

std::string paper_table() {
  return header("\nTable I of the paper: 25 trials, Matlab, 3.7 GHz Core i9-10900K") +
         paper_line("time in all [s]", &PaperColumn::time_s, "%.2f", true) +
         paper_line("- without RRT*: optimisation [s]", paper_optimize_s, "%.2f", false) +
         paper_line("- its standard deviation [s]", &PaperColumn::deviation_s, "%.2f", false) +
         paper_line("cost [m]", &PaperColumn::cost, "%.2f", true) +
         paper_line("iterations", &PaperColumn::iterations, "%.1f", false) +
         paper_line("success [%]", &PaperColumn::success_percent, "%.0f", true) +
         paper_line("segments at the end", &PaperColumn::segments_final, "%.1f", false);
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
  const char* name;
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

std::vector<Row> mode_rows() {
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
  rows.push_back({"cost: path length [m], successes",
                  [](const RunSummary& run) { return length(run.length_m.mean); }});
  rows.push_back({"- cases that every column solved",
                  [](const RunSummary& run) { return length(run.common_length_m.mean); }});
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

std::string mode_table(const ModeSummary& mode) {
  std::string text = header(format("\n%c: %s (%d cases, %d solved by every column)", mode.letter,
                                   mode.name.c_str(), mode.rrt_star.num_cases, mode.num_common));
  for (const Row& row : mode_rows()) {
    std::vector<std::string> cells = {row.has_rrt_star ? row.figure(mode.rrt_star) : "-"};
    for (const RunSummary& column : mode.columns) cells.push_back(row.figure(column));
    text += line_of(row.name, cells);
  }
  return text;
}

std::vector<ClaimFigures> list_claim_figures(const std::vector<ModeSummary>& modes) {
  std::vector<ClaimFigures> figures = {figures_of_paper()};
  for (const ModeSummary& mode : modes) {
    figures.push_back(figures_of(mode, false));
    figures.push_back(figures_of(mode, true));
  }
  return figures;
}

std::string name_of(const std::string& source, const std::string& clock) {
  return clock.empty() ? source : source + ", " + clock;
}

std::string relative_table(const std::vector<ModeSummary>& modes) {
  std::string text = header("\noptimisation time relative to N = 7, means");
  for (const ClaimFigures& figures : list_claim_figures(modes)) {
    std::vector<std::string> cells = {"-"};
    for (const ClaimColumn& column : figures.columns) {
      cells.push_back(ratio(column.optimize_time, figures.columns[kSeven].optimize_time));
    }
    text += line_of(name_of(figures.source, figures.clock), cells);
  }
  return text;
}

std::string claims_text(const std::vector<Claim>& claims) {
  std::string text = "\nthe paper's claims\n";
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

std::string switch_table(const PlaneTables& tables, const std::vector<RunSummary>& switches) {
  std::string text =
      format("\none choice of the paper at a time (serial, N = auto)\n") +
      line_of("", {"total [us]", "median", "sample", "optimise", "deviation", "length [m]",
                   "iterations", "success %", "fell back", "segments", "time ratio"});
  const double total_us = switches.front().total.serial_us.mean;
  for (std::size_t i = 0; i < switches.size(); ++i) {
    const RunSummary& run = switches[i];
    text += line_of(tables.switches[i].label,
                    {number(run.total.serial_us.mean), number(run.total.serial_us.median),
                     number(run.sample.serial_us.mean), number(run.optimize.serial_us.mean),
                     number(run.optimize.serial_us.deviation), length(run.common_length_m.mean),
                     format("%.2f", run.iterations.mean), format("%.1f", run.success_percent()),
                     format("%.1f %%", run.fell_back_percent()),
                     format("%.1f>%.1f", run.segments_initial.mean, run.segments_final.mean),
                     ratio(run.total.serial_us.mean, total_us)});
  }
  return text + format("  length: of the %d cases that all of them solved\n",
                       switches.front().common_length_m.count);
}

nlohmann::ordered_json to_json(const Spread& spread) {
  if (spread.count == 0) return nullptr;
  return {{"count", spread.count},
          {"mean", spread.mean},
          {"deviation", spread.deviation},
          {"median", spread.median}};
}

nlohmann::ordered_json to_json(const StageSpread& stage) {
  return {{"serial_us", to_json(stage.serial_us)}, {"critical_us", to_json(stage.critical_us)}};
}

nlohmann::ordered_json to_json(const TableRun& run, const RunSummary& summary) {
  return {{"label", run.label},
          {"options", to_json(run.choices)},
          {"cases", summary.num_cases},
          {"succeeded", summary.num_succeeded},
          {"fell_back", summary.num_fell_back},
          {"sample", to_json(summary.sample)},
          {"optimise", to_json(summary.optimize)},
          {"total", to_json(summary.total)},
          {"path_length_m", to_json(summary.length_m)},
          {"common_path_length_m", to_json(summary.common_length_m)},
          {"iterations", to_json(summary.iterations)},
          {"segments_initial", to_json(summary.segments_initial)},
          {"segments_final", to_json(summary.segments_final)}};
}

nlohmann::ordered_json to_json(const PaperColumn& column) {
  return {{"label", column.label},
          {"time_s", column.time_s},
          {"optimise_deviation_s", column.deviation_s},
          {"cost", column.cost},
          {"iterations", column.iterations},
          {"success_percent", column.success_percent},
          {"segments_final", column.segments_final}};
}

nlohmann::ordered_json paper_json() {
  nlohmann::ordered_json paper = {
      {"rrt_star", {{"time_s", kPaperRrtStar.time_s}, {"cost", kPaperRrtStar.cost}}}};
  for (const PaperColumn& column : kPaperColumns) paper["columns"].push_back(to_json(column));
  return paper;
}

nlohmann::ordered_json to_json(const Claim& claim) {
  nlohmann::ordered_json object = {{"statement", claim.statement}};
  for (const Evidence& evidence : claim.evidence) {
    object["evidence"].push_back({{"source", name_of(evidence.source, evidence.clock)},
                                  {"is_met", evidence.is_met},
                                  {"text", evidence.text}});
  }
  return object;
}

nlohmann::ordered_json to_json(const TableMode& mode, const ModeSummary& summary,
                               const TableRun& rrt_star) {
  nlohmann::ordered_json object = {{"mode", std::string(1, mode.letter)},
                                   {"name", mode.name},
                                   {"common_cases", summary.num_common},
                                   {"rrt_star", to_json(rrt_star, summary.rrt_star)}};
  for (std::size_t i = 0; i < kNumTableColumns; ++i) {
    object["columns"].push_back(to_json(mode.columns[i], summary.columns[i]));
  }
  return object;
}

}  // namespace

TablesSummary summarize(const PlaneTables& tables) {
  TablesSummary summary;
  for (const TableMode& mode : tables.modes) {
    summary.modes.push_back(summarize(mode, tables.rrt_star));
  }
  const std::vector<bool> is_common = common_successes(tables.switches);
  for (const TableRun& run : tables.switches) {
    summary.switches.push_back(summarize(run, is_common));
  }
  summary.claims = judge_claims(list_claim_figures(summary.modes));
  return summary;
}

std::string describe(const PlaneTables& tables, const TablesSummary& summary) {
  std::string text = paper_table();
  for (const ModeSummary& mode : summary.modes) text += mode_table(mode);
  return text + relative_table(summary.modes) + claims_text(summary.claims) +
         switch_table(tables, summary.switches);
}

nlohmann::ordered_json to_json(const PlaneTables& tables, const TablesSummary& summary) {
  nlohmann::ordered_json document = {{"scenes", tables.num_scenes},
                                     {"seeds", tables.num_seeds},
                                     {"clock", "cpu"},
                                     {"timed_calls", kNumTimedCalls},
                                     {"cases_unplanned", num_unplanned(tables)},
                                     {"paper", paper_json()}};
  for (std::size_t i = 0; i < tables.modes.size(); ++i) {
    document["modes"].push_back(to_json(tables.modes[i], summary.modes[i], tables.rrt_star));
  }
  for (const Claim& claim : summary.claims) document["claims"].push_back(to_json(claim));
  for (std::size_t i = 0; i < tables.switches.size(); ++i) {
    document["switches"].push_back(to_json(tables.switches[i], summary.switches[i]));
  }
  return document;
}

}  // namespace sopt
