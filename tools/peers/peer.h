// A planner as the comparison sees it: prepared once per scene, then run once per seed. What counts
// is the CPU time of the calling thread inside the planner's own solve call; building planner and
// problem is never timed. Every peer keeps the same clearance from the same World2.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "models/margin.h"
#include "models/trajectory.h"
#include "rt/clock.h"
#include "tools/bench/allocation_counter.h"
#include "tools/io/scene_file.h"

namespace sopt {

struct PeerProblem {
  const Scene* scene = nullptr;
  PlanRequest<Point2> request;  // its seed is not used
  ClearanceRule rule;           // the request's margin, nowhere relaxed
};

[[nodiscard]] inline PeerProblem make_peer_problem(const Scene& scene) {
  const PlanRequest<Point2> request = make_request(scene);
  return {&scene, request, {.margin_m = request.options.margin_m}};
}

// One solve.
struct PeerResult {
  bool is_solved = false;
  std::int64_t time_ns = 0;
  std::int64_t num_allocations = 0;
  double length_m = 0.0;   // of the solution; 0 without one
  std::vector<Vec2> path;  // the solution, straight between its points; empty: not known
  std::string failure;     // why it is not solved, in the peer's words
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

  // The problem's scene must stay until the next call.
  virtual void prepare(const PeerProblem& problem) = 0;
  [[nodiscard]] virtual PeerResult run(std::uint64_t seed) = 0;

 private:
  std::string name_;
  bool is_slow_;
};

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
