// The comparison itself: every peer on every scene with every seed. For one scene and seed all
// peers follow each other, beginning with another one for each seed, so that a machine that gets
// slower does so for all of them. Each path is then checked: in the plane by the exact segment
// test, of an arm by the exact test of configurations at most kCheckStep apart.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tools/peers/peer.h"

namespace sopt {

struct PeersOptions {
  int num_seeds = 16;          // 1..num_seeds
  int num_slow_seeds = 2;      // of slow peers; at most num_seeds
  double long_budget_s = 1.0;  // CPU time of RRT* with its whole budget
};

inline constexpr double kCheckStep = 1e-3;  // rad; a tip 1 m away moves by a millimetre

enum class PathVerdict {
  kNotChecked,   // no solution, or its path is not known
  kKeepsMargin,  // along every motion
  kBelowMargin,  // somewhere, but nothing is touched
  kCollides,     // the robot meets an obstacle or itself, or leaves the bounds
};

// Rounding below a micrometre is not held against anybody.
[[nodiscard]] PathVerdict check_path(const AnyScene& scene,
                                     const std::vector<Eigen::VectorXd>& path);

struct PeerCase {
  std::string scene;
  std::uint64_t seed = 0;
  bool is_solved = false;
  std::int64_t time_ns = 0;
  std::int64_t num_allocations = 0;
  double length = 0.0;  // in the path metric
  PathVerdict verdict = PathVerdict::kNotChecked;
  std::string failure;  // as in PeerResult
};

struct PeerRun {
  std::string peer;
  std::vector<PeerCase> cases;
};

// One entry per peer, in their order. A run with the first seed warms up each peer that is not
// slow and does not count. Throws what the peers throw.
[[nodiscard]] std::vector<PeerRun> run_peers(const std::vector<AnyScene>& scenes,
                                             const PeersOptions& options,
                                             const std::vector<std::unique_ptr<Peer>>& peers);

}  // namespace sopt
