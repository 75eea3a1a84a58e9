#include "tools/peers/peers_run.h"

#include <algorithm>

namespace sopt {
namespace {

constexpr double kRounding_m = 1e-6;

bool all_motions_clear(const PeerProblem& problem, const std::vector<Vec2>& path, double radius_m,
                       const ClearanceRule& rule) {
  for (std::size_t i = 1; i < path.size(); ++i) {
    if (!problem.scene->world->is_clear(path[i - 1], path[i], radius_m, rule)) return false;
  }
  return true;
}

PeerCase to_case(const PeerProblem& problem, std::uint64_t seed, const PeerResult& result) {
  PeerCase c;
  c.scene = problem.scene->name;
  c.seed = seed;
  c.is_solved = result.is_solved;
  c.time_ns = result.time_ns;
  c.num_allocations = result.num_allocations;
  c.length_m = result.length_m;
  c.verdict = check_path(problem, result.path);
  c.failure = result.failure;
  return c;
}

void run_scene(const PeerProblem& problem, const PeersOptions& options,
               const std::vector<std::unique_ptr<Peer>>& peers, std::vector<PeerRun>& runs) {
  for (const auto& peer : peers) {
    peer->prepare(problem);
    if (!peer->is_slow()) (void)peer->run(1);
  }
  for (int seed = 1; seed <= options.num_seeds; ++seed) {
    for (std::size_t k = 0; k < peers.size(); ++k) {
      const std::size_t i = (k + static_cast<std::size_t>(seed)) % peers.size();
      if (peers[i]->is_slow() && seed > options.num_slow_seeds) continue;
      const auto number = static_cast<std::uint64_t>(seed);
      runs[i].cases.push_back(to_case(problem, number, peers[i]->run(number)));
    }
  }
}

}  // namespace

PathVerdict check_path(const PeerProblem& problem, const std::vector<Vec2>& path) {
  if (path.empty()) return PathVerdict::kNotChecked;
  const double radius_m = problem.scene->robot.radius_m - kRounding_m;
  if (all_motions_clear(problem, path, radius_m, problem.rule)) return PathVerdict::kKeepsMargin;
  const ClearanceRule touching = {.cap_m = 0.0};
  return all_motions_clear(problem, path, radius_m, touching) ? PathVerdict::kBelowMargin
                                                              : PathVerdict::kCollides;
}

std::vector<PeerRun> run_peers(const std::vector<std::filesystem::path>& scenes,
                               const PeersOptions& options,
                               const std::vector<std::unique_ptr<Peer>>& peers) {
  std::vector<PeerRun> runs;
  for (const auto& peer : peers) runs.push_back({peer->name(), {}});
  for (const std::filesystem::path& file : scenes) {
    const Scene scene = load_scene(file);
    run_scene(make_peer_problem(scene), options, peers, runs);
  }
  return runs;
}

}  // namespace sopt
