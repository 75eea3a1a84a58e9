// One scene's planner for any choices, and what one case costs on it. Times are thread CPU time,
// medians over kNumTimedCalls calls; the tasks behind the critical path come from one more call
// before them, which also brings the choices' code and memory into the caches.
#pragma once

#include <cstdint>

#include "opt/planner.h"
#include "tools/cli/algorithm_options.h"
#include "tools/cli/planner_host.h"
#include "tools/io/robot_scene.h"
#include "tools/tables/timing_executor.h"

namespace sopt {

inline constexpr int kNumTimedCalls = 3;

struct StageTime {
  double serial_us = 0.0;
  double critical_us = 0.0;  // one worker per stream or window
};

// One plan; lengths in the robot's path metric.
struct TableCase {
  bool has_plan = false;
  bool fell_back = false;  // the optimiser's trajectory did not pass verify
  StageTime sample;        // with shortcutting
  StageTime optimize;
  StageTime total;              // verify and the rest too
  double sampled_length = 0.0;  // as the sampler found it
  double length = 0.0;          // of the plan
  int iterations = 0;
  int segments_initial = 0;
  int segments_final = 0;

  [[nodiscard]] bool succeeded() const { return has_plan && !fell_back; }
};

template <class Robot>
class TimedPlanner {
 public:
  // Throws HostError when there is no memory. `scene` must outlive it.
  explicit TimedPlanner(const SceneOf<Robot>& scene);

  // The scene's request with `choices` over the scene's options.
  [[nodiscard]] PlanRequest<Robot> make_request(const AlgorithmOptions& choices,
                                                std::uint64_t seed) const;
  [[nodiscard]] TableCase measure(const PlanRequest<Robot>& request);

  [[nodiscard]] Planner<Robot>& planner() { return host_.planner(); }

 private:
  const SceneOf<Robot>* scene_;
  TimingExecutor executor_;
  PlannerHost<Robot> host_;
};

extern template class TimedPlanner<Point2>;
extern template class TimedPlanner<Arm<4>>;
extern template class TimedPlanner<Arm<5>>;
extern template class TimedPlanner<Arm<6>>;
extern template class TimedPlanner<Arm<7>>;
extern template class TimedPlanner<Arm<8>>;

}  // namespace sopt
