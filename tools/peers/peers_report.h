// What a comparison says: a row of figures per peer, and the ratios that have a target. A ratio
// counts the cases (scene and seed) that both of its peers solved. Targets in the plane and of arms
// differ.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/peers/peers_run.h"

namespace sopt {

enum class PeerFigure { kMedianTime, kMeanLength };

struct PeerRatio {
  std::string ours;
  std::string theirs;
  PeerFigure figure = PeerFigure::kMedianTime;
  double target = 0.0;  // at most; 0: none
  double value = 0.0;   // meaningful when num_cases > 0
  int num_cases = 0;    // that both solved

  [[nodiscard]] bool is_met() const { return num_cases > 0 && value <= target; }
};

// The ratios of the comparison, in the order of the report.
[[nodiscard]] std::vector<PeerRatio> compare(const std::vector<PeerRun>& runs, SceneKind kind);

[[nodiscard]] std::string describe_peers(const std::vector<PeerRun>& runs, SceneKind kind);
[[nodiscard]] std::string describe_ratios(const std::vector<PeerRatio>& ratios);

// Everything: machine, options, one entry per peer, ratios, cases.
[[nodiscard]] nlohmann::ordered_json to_json(const std::vector<PeerRun>& runs, SceneKind kind,
                                             const PeersOptions& options);

}  // namespace sopt
