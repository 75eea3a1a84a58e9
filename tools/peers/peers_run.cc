#include "tools/peers/peers_run.h"

#include <algorithm>
#include <cmath>

namespace sopt {
namespace {

constexpr double kRounding_m = 1e-6;

// Clear all along, but for what is forgiven.
bool is_path_clear(const Scene& scene, const std::vector<Vec2>& path, const ClearanceRule& rule) {
  const double radius_m = scene.robot.radius_m - kRounding_m;
  for (std::size_t i = 1; i < path.size(); ++i) {
    if (!scene.world->is_clear(path[i - 1], path[i], radius_m, rule)) return false;
  }
  return true;
}

template <int N>
bool is_path_clear(const ArmScene<N>& scene, const std::vector<typename Arm<N>::Config>& path,
                   ClearanceRule rule) {
  rule.margin_m -= kRounding_m;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const double length = scene.arm.path_distance(path[i - 1], path[i]);
    const int num_steps = std::max(1, static_cast<int>(std::ceil(length / kCheckStep)));
    for (int k = 0; k <= num_steps; ++k) {
      const double share = static_cast<double>(k) / num_steps;
      if (!is_clear(scene.arm, *scene.world, scene.arm.interpolate(path[i - 1], path[i], share),
                    rule)) {
        return false;
      }
    }
  }
  return true;
}

template <class SomeScene>
PathVerdict check(const SomeScene& scene, const std::vector<Eigen::VectorXd>& points) {
  const std::vector<typename RobotOf<SomeScene>::Config> path(points.begin(), points.end());
  if (is_path_clear(scene, path, make_peer_problem(scene).rule)) return PathVerdict::kKeepsMargin;
  const ClearanceRule touching = {.cap_m = 0.0};
  return is_path_clear(scene, path, touching) ? PathVerdict::kBelowMargin : PathVerdict::kCollides;
}

PeerCase to_case(const AnyScene& scene, std::uint64_t seed, const PeerResult& result) {
  PeerCase c;
  c.scene = std::visit([](const auto& some) { return some.name; }, scene);
  c.seed = seed;
  c.is_solved = result.is_solved;
  c.time_ns = result.time_ns;
  c.num_allocations = result.num_allocations;
  c.length = result.length;
  c.verdict = check_path(scene, result.path);
  c.failure = result.failure;
  return c;
}

void run_scene(const AnyScene& scene, const PeersOptions& options,
               const std::vector<std::unique_ptr<Peer>>& peers, std::vector<PeerRun>& runs) {
  std::vector<std::unique_ptr<PeerSolver>> solvers;
  for (const auto& peer : peers) {
    solvers.push_back(peer->prepare(scene));
    if (!peer->is_slow()) (void)solvers.back()->run(1);
  }
  for (int seed = 1; seed <= options.num_seeds; ++seed) {
    for (std::size_t k = 0; k < peers.size(); ++k) {
      const std::size_t i = (k + static_cast<std::size_t>(seed)) % peers.size();
      if (peers[i]->is_slow() && seed > options.num_slow_seeds) continue;
      const auto number = static_cast<std::uint64_t>(seed);
      runs[i].cases.push_back(to_case(scene, number, solvers[i]->run(number)));
    }
  }
}

}  // namespace

PathVerdict check_path(const AnyScene& scene, const std::vector<Eigen::VectorXd>& path) {
  if (path.empty()) return PathVerdict::kNotChecked;
  return std::visit([&](const auto& some) { return check(some, path); }, scene);
}

std::vector<PeerRun> run_peers(const std::vector<AnyScene>& scenes, const PeersOptions& options,
                               const std::vector<std::unique_ptr<Peer>>& peers) {
  std::vector<PeerRun> runs;
  for (const auto& peer : peers) runs.push_back({peer->name(), {}});
  for (const AnyScene& scene : scenes) run_scene(scene, options, peers, runs);
  return runs;
}

}  // namespace sopt
