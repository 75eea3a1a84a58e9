// A planner as the comparison sees it: prepared for a scene, then run once per seed. What counts is
// the CPU time of the calling thread inside the planner's own solve call; building planner and
// problem is never timed. Every peer keeps the same clearance from the same world, by the same
// robot's own checks.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "models/arm/arm_clearance.h"
#include "models/margin.h"
#include "models/trajectory.h"
#include "rt/clock.h"
#include "tools/bench/allocation_counter.h"
#include "tools/bench/bench_scenes.h"

namespace sopt {

template <class Robot>
struct PeerProblem {
  const SceneOf<Robot>* scene = nullptr;
  PlanRequest<Robot> request;  // its seed is not used
  ClearanceRule rule;          // the request's margin, nowhere relaxed
};

template <class SomeScene>
[[nodiscard]] PeerProblem<RobotOf<SomeScene>> make_peer_problem(const SomeScene& scene) {
  const auto request = make_request(scene);
  ClearanceRule rule;
  rule.margin_m = request.options.margin_m;
  rule.floor_m = request.options.min_clearance_m;
  return {&scene, request, rule};
}

// One configuration, exactly.
[[nodiscard]] inline bool is_clear(const Point2& robot, const World2& world, const Vec2& q,
                                   const ClearanceRule& rule) {
  return robot.motion_is_clear(world, rule, q, q);
}
template <int N>
[[nodiscard]] bool is_clear(const Arm<N>& arm, const World3& world,
                            const typename Arm<N>::Config& q, const ClearanceRule& rule) {
  ArmPose<N> pose;
  arm.forward(q, pose);
  return is_clear(arm, world, pose, rule, kSelfClearance_m);
}

// One solve.
struct PeerResult {
  bool is_solved = false;
  std::int64_t time_ns = 0;
  std::int64_t num_allocations = 0;
  double length = 0.0;                // of the solution, in the robot's path metric; 0 without one
  std::vector<Eigen::VectorXd> path;  // the solution, straight between its points; empty: not known
  std::string failure;                // why it is not solved, in the peer's words
};

// A planner ready for one scene.
class PeerSolver {
 public:
  PeerSolver() = default;
  PeerSolver(const PeerSolver&) = delete;
  PeerSolver& operator=(const PeerSolver&) = delete;
  virtual ~PeerSolver() = default;

  [[nodiscard]] virtual PeerResult run(std::uint64_t seed) = 0;
};

class Peer {
 public:
  // A slow peer runs with fewer seeds.
  explicit Peer(std::string name, bool is_slow = false)
      : name_(std::move(name)), is_slow_(is_slow) {}
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;
  virtual ~Peer() = default;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] bool is_slow() const { return is_slow_; }

  // The scene must outlive the solver.
  [[nodiscard]] virtual std::unique_ptr<PeerSolver> prepare(const AnyScene& scene) const = 0;

 private:
  std::string name_;
  bool is_slow_;
};

// A Solver<Robot> for whatever robot the scene has.
template <template <class> class Solver, class... Settings>
[[nodiscard]] std::unique_ptr<PeerSolver> make_solver(const AnyScene& any,
                                                      const Settings&... settings) {
  return std::visit(
      [&](const auto& scene) -> std::unique_ptr<PeerSolver> {
        using Robot = RobotOf<std::decay_t<decltype(scene)>>;
        return std::make_unique<Solver<Robot>>(make_peer_problem(scene), settings...);
      },
      any);
}

// Calls `solve` and puts what it cost into `result`.
template <class Solve>
void measure(PeerResult& result, Solve&& solve) {
  const Clock clock = thread_cpu_clock();
  const std::int64_t allocations_before = num_allocations();
  const std::int64_t begin_ns = clock.now_ns();
  solve();
  result.time_ns = clock.now_ns() - begin_ns;
  result.num_allocations = num_allocations() - allocations_before;
}

}  // namespace sopt
