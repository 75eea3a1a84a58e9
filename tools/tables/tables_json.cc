#include "tools/tables/tables_report.h"

namespace sopt {
namespace {

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

nlohmann::ordered_json to_json(const Tables& tables, const TableRun& run,
                               const RunSummary& summary) {
  const std::string length_name = std::string("path_length_") + tables.paper->length_unit;
  return {{"label", run.label},
          {"options", to_json(run.choices, tables.defaults, tables.paper_choices)},
          {"cases", summary.num_cases},
          {"succeeded", summary.num_succeeded},
          {"fell_back", summary.num_fell_back},
          {"sample", to_json(summary.sample)},
          {"optimise", to_json(summary.optimize)},
          {"total", to_json(summary.total)},
          {length_name, to_json(summary.length)},
          {"common_" + length_name, to_json(summary.common_length)},
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

nlohmann::ordered_json to_json(const PaperTable& paper) {
  nlohmann::ordered_json object = {
      {"rrt_star", {{"time_s", paper.rrt_star.time_s}, {"cost", paper.rrt_star.cost}}}};
  for (const PaperColumn& column : paper.columns) object["columns"].push_back(to_json(column));
  return object;
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

nlohmann::ordered_json to_json(const Tables& tables, const TableMode& mode,
                               const ModeSummary& summary) {
  nlohmann::ordered_json object = {
      {"mode", std::string(1, mode.letter)},
      {"name", mode.name},
      {"common_cases", summary.num_common},
      {"rrt_star", to_json(tables, tables.rrt_star, summary.rrt_star)}};
  for (std::size_t i = 0; i < mode.columns.size(); ++i) {
    object["columns"].push_back(to_json(tables, mode.columns[i], summary.columns[i]));
  }
  return object;
}

}  // namespace

nlohmann::ordered_json to_json(const Tables& tables, const TablesSummary& summary) {
  nlohmann::ordered_json document = {{"scenes", tables.num_scenes},
                                     {"seeds", tables.num_seeds},
                                     {"clock", "cpu"},
                                     {"timed_calls", kNumTimedCalls},
                                     {"cases_unplanned", num_unplanned(tables)},
                                     {"paper", to_json(*tables.paper)}};
  for (std::size_t i = 0; i < tables.modes.size(); ++i) {
    document["modes"].push_back(to_json(tables, tables.modes[i], summary.modes[i]));
  }
  for (const Claim& claim : summary.claims) document["claims"].push_back(to_json(claim));
  for (std::size_t i = 0; i < tables.switches.size(); ++i) {
    document["switches"].push_back(to_json(tables, tables.switches[i], summary.switches[i]));
  }
  return document;
}

nlohmann::ordered_json to_json(const std::vector<Tables>& families,
                               const FamiliesSummary& summary) {
  nlohmann::ordered_json document;
  for (std::size_t i = 0; i < families.size(); ++i) {
    document["families"].push_back(to_json(families[i], summary.families[i]));
  }
  for (const Claim& claim : summary.claims) document["claims"].push_back(to_json(claim));
  return document;
}

}  // namespace sopt
