#include "tools/peers/peers_report.h"

#include <algorithm>
#include <functional>
#include <map>
#include <utility>

#include "tools/bench/bench_report.h"
#include "tools/bench/bench_statistics.h"
#include "tools/io/plan_report.h"
#include "tools/peers/peer_names.h"

namespace sopt {
namespace {

double time_us(const PeerCase& c) { return 1e-3 * static_cast<double>(c.time_ns); }

Distribution over_solved(const PeerRun& run, const std::function<double(const PeerCase&)>& value) {
  std::vector<double> values;
  for (const PeerCase& c : run.cases) {
    if (c.is_solved) values.push_back(value(c));
  }
  return summarize(std::move(values));
}

struct PeerSummary {
  int num_solved = 0;
  int num_cases = 0;
  Distribution time_us;
  Distribution length;
  double allocations = 0.0;  // median
  int num_checked = 0;       // paths
  int num_below_margin = 0;  // of them, those that collide included
  int num_colliding = 0;
};

PeerSummary summary_of(const PeerRun& run) {
  const auto count = [&run](PathVerdict verdict) {
    return static_cast<int>(
        std::count_if(run.cases.begin(), run.cases.end(),
                      [verdict](const PeerCase& c) { return c.verdict == verdict; }));
  };
  PeerSummary s;
  s.num_cases = static_cast<int>(run.cases.size());
  s.time_us = over_solved(run, time_us);
  s.num_solved = s.time_us.count;
  s.length = over_solved(run, [](const PeerCase& c) { return c.length; });
  s.allocations = over_solved(run, [](const PeerCase& c) {
                    return static_cast<double>(c.num_allocations);
                  }).median;
  s.num_checked = s.num_cases - count(PathVerdict::kNotChecked);
  s.num_colliding = count(PathVerdict::kCollides);
  s.num_below_margin = count(PathVerdict::kBelowMargin) + s.num_colliding;
  return s;
}

using CaseKey = std::pair<std::string, std::uint64_t>;

std::map<CaseKey, const PeerCase*> solved_cases(const std::vector<PeerRun>& runs,
                                                const std::string& peer) {
  std::map<CaseKey, const PeerCase*> cases;
  for (const PeerRun& run : runs) {
    if (run.peer != peer) continue;
    for (const PeerCase& c : run.cases) {
      if (c.is_solved) cases[{c.scene, c.seed}] = &c;
    }
  }
  return cases;
}

double figure_of(PeerFigure figure, const std::vector<const PeerCase*>& cases) {
  std::vector<double> values;
  for (const PeerCase* c : cases) {
    values.push_back(figure == PeerFigure::kMedianTime ? time_us(*c) : c->length);
  }
  const Distribution d = summarize(std::move(values));
  return figure == PeerFigure::kMedianTime ? d.median : d.mean;
}

void evaluate(const std::vector<PeerRun>& runs, PeerRatio& ratio) {
  const auto theirs_of = solved_cases(runs, ratio.theirs);
  std::vector<const PeerCase*> ours;
  std::vector<const PeerCase*> theirs;
  for (const auto& [key, our_case] : solved_cases(runs, ratio.ours)) {
    const auto found = theirs_of.find(key);
    if (found == theirs_of.end()) continue;
    ours.push_back(our_case);
    theirs.push_back(found->second);
  }
  ratio.num_cases = static_cast<int>(ours.size());
  if (!ours.empty()) ratio.value = figure_of(ratio.figure, ours) / figure_of(ratio.figure, theirs);
}

const char* to_string(PeerFigure figure) {
  return figure == PeerFigure::kMedianTime ? "median time" : "mean length";
}

const char* to_string(PathVerdict verdict) {
  switch (verdict) {
    case PathVerdict::kNotChecked:
      return "not_checked";
    case PathVerdict::kKeepsMargin:
      return "keeps_margin";
    case PathVerdict::kBelowMargin:
      return "below_margin";
    case PathVerdict::kCollides:
      return "collides";
  }
  return "unknown";
}

nlohmann::ordered_json to_json(const Distribution& d) {
  return {{"mean", d.mean}, {"median", d.median}, {"p95", d.p95}, {"p99", d.p99}, {"max", d.max}};
}

nlohmann::ordered_json to_json(const PeerRun& run) {
  const PeerSummary s = summary_of(run);
  return {{"peer", run.peer},
          {"cases", s.num_cases},
          {"solved", s.num_solved},
          {"time_us", to_json(s.time_us)},
          {"length", to_json(s.length)},
          {"allocations_median", s.allocations},
          {"paths_checked", s.num_checked},
          {"paths_below_margin", s.num_below_margin},
          {"paths_colliding", s.num_colliding}};
}

nlohmann::ordered_json to_json(const PeerRatio& ratio) {
  nlohmann::ordered_json entry = {{"figure", to_string(ratio.figure)},
                                  {"ours", ratio.ours},
                                  {"theirs", ratio.theirs},
                                  {"cases", ratio.num_cases},
                                  {"value", ratio.value}};
  if (ratio.target > 0.0 && ratio.num_cases > 0) {
    entry["target"] = ratio.target;
    entry["met"] = ratio.is_met();
  }
  return entry;
}

nlohmann::ordered_json to_json(const std::string& peer, const PeerCase& c) {
  return {{"peer", peer},
          {"scene", c.scene},
          {"seed", c.seed},
          {"solved", c.is_solved},
          {"time_us", time_us(c)},
          {"length", c.length},
          {"allocations", c.num_allocations},
          {"path", to_string(c.verdict)},
          {"failure", c.failure}};
}

// A line per scene and reason.
std::string describe_failures(const PeerRun& run) {
  std::map<std::pair<std::string, std::string>, int> counts;
  for (const PeerCase& c : run.cases) {
    if (!c.is_solved) ++counts[{c.scene, c.failure}];
  }
  std::string text;
  for (const auto& [key, count] : counts) {
    text += format("  not solved by %s: %s, %d x %s\n", run.peer.c_str(), key.first.c_str(), count,
                   key.second.c_str());
  }
  return text;
}

}  // namespace

std::vector<PeerRatio> compare(const std::vector<PeerRun>& runs, SceneKind kind) {
  constexpr PeerFigure kTime = PeerFigure::kMedianTime;
  constexpr PeerFigure kLength = PeerFigure::kMeanLength;
  const auto target = [kind](double in_plane, double of_arms) {
    return kind == SceneKind::kPlane ? in_plane : of_arms;
  };
  std::vector<PeerRatio> ratios = {
      {kSoptFirstPath, kOmplRrtStar, kTime, target(0.10, 0.0)},
      {kSoptFirstPath, kOmplRrtStarExact, kTime},
      {kSoptFirstPath, kOmplRrtConnect, kTime, target(0.0, 1.0)},
      {kSoptFirstPath, kOmplRrtConnectExact, kTime},
      {kSoptFirstPathOneStream, kOmplRrtStar, kTime},
      {kSoptFirstPathOneStream, kOmplRrtConnectExact, kTime},
      {kSoptRrtStar, kOmplRrtStar, kTime, target(0.10, 0.0)},
      {kSoptRrtStarOneStream, kOmplRrtStar, kTime},
      {kSoptRrtStarOneStream, kOmplRrtStarExact, kTime},
      {kSoptPlan, kOmplSimplified, kTime, target(1.0, 0.0)},
      {kSoptPlan, kOmplSimplifiedExact, kTime},
      {kSoptPlan, kOmplSimplified, kLength, target(0.0, 1.0)},
      {kSoptPlan, kOmplSimplifiedExact, kLength},
      {kSoptPlan, kOmplRrtStarLong, kLength, target(1.03, 0.0)},
  };
  for (PeerRatio& ratio : ratios) evaluate(runs, ratio);
  return ratios;
}

std::string describe_peers(const std::vector<PeerRun>& runs, SceneKind kind) {
  const std::string length_name = format("len [%s]", length_unit(kind));
  std::string text =
      format("%-31s %9s | %9s %9s %9s %9s | %9s %8s | %9s | %7s %7s\n", "", "solved", "t [us]",
             "p95", "p99", "max", length_name.c_str(), "mean", "allocs", "<margin", "collide");
  for (const PeerRun& run : runs) {
    const PeerSummary s = summary_of(run);
    if (s.num_cases == 0) continue;
    text += format("%-31s %4d/%-4d | %9.1f %9.1f %9.1f %9.1f | %9.2f %8.2f | %9.0f |",
                   run.peer.c_str(), s.num_solved, s.num_cases, s.time_us.median, s.time_us.p95,
                   s.time_us.p99, s.time_us.max, s.length.median, s.length.mean, s.allocations);
    text += s.num_checked > 0 ? format(" %7d %7d\n", s.num_below_margin, s.num_colliding)
                              : format(" %7s %7s\n", "-", "-");
  }
  for (const PeerRun& run : runs) text += describe_failures(run);
  return text;
}

std::string describe_ratios(const std::vector<PeerRatio>& ratios) {
  std::string text;
  for (const PeerRatio& ratio : ratios) {
    text += format("%-11s  %-31s / %-29s", to_string(ratio.figure), ratio.ours.c_str(),
                   ratio.theirs.c_str());
    if (ratio.num_cases == 0) {
      text += " no case that both solved\n";
      continue;
    }
    text += format(" %8.3f  over %4d cases", ratio.value, ratio.num_cases);
    if (ratio.target > 0.0) {
      text += format("  target %.2f %s", ratio.target, ratio.is_met() ? "met" : "MISSED");
    }
    text += '\n';
  }
  return text;
}

nlohmann::ordered_json to_json(const std::vector<PeerRun>& runs, SceneKind kind,
                               const PeersOptions& options) {
  nlohmann::ordered_json document = {{"schema", 1},
                                     {"machine", describe_machine()},
                                     {"length_unit", length_unit(kind)},
                                     {"seeds", options.num_seeds},
                                     {"long_seeds", options.num_slow_seeds},
                                     {"long_seconds", options.long_budget_s}};
  for (const PeerRun& run : runs) document["peers"].push_back(to_json(run));
  for (const PeerRatio& ratio : compare(runs, kind)) document["ratios"].push_back(to_json(ratio));
  for (const PeerRun& run : runs) {
    for (const PeerCase& c : run.cases) document["cases"].push_back(to_json(run.peer, c));
  }
  return document;
}

}  // namespace sopt
