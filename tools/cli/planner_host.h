// A planner with the memory and the executor it lives on, for programs that plan one scene.
#pragma once

#include "alloc/arena.h"
#include "alloc/memory_block.h"
#include "opt/planner.h"
#include "rt/executor.h"
#include "tools/io/input_error.h"
#include "tools/io/plan_report.h"
#include "tools/io/robot_scene.h"

namespace sopt {

template <class Robot>
class PlannerHost {
 public:
  // Sized for requests on `scene` with `options`. Throws HostError when there is no memory.
  PlannerHost(const SceneOf<Robot>& scene, const PlanOptions& options,
              Clock clock = monotonic_clock())
      : PlannerHost(scene, options, nullptr, clock) {}
  // With the caller's executor, which outlives it.
  PlannerHost(const SceneOf<Robot>& scene, const PlanOptions& options, Executor& executor,
              Clock clock)
      : PlannerHost(scene, options, &executor, clock) {}

  [[nodiscard]] Planner<Robot>& planner() { return planner_; }

 private:
  PlannerHost(const SceneOf<Robot>& scene, const PlanOptions& options, Executor* executor,
              Clock clock)
      : settings_(make_settings(scene, options)),
        memory_(Planner<Robot>::required_bytes(settings_)),
        arena_(memory_),
        planner_(arena_, robot_of(scene), settings_,
                 executor == nullptr ? static_cast<Executor&>(serial_) : *executor, clock) {
    if (arena_.exhausted()) {
      throw HostError(
          format("the host has no %zu MiB of memory for the planner; smaller --samples "
                 "or --streams need less",
                 Planner<Robot>::required_bytes(settings_) >> 20U));
    }
  }

  PlannerSettings settings_;
  MemoryBlock memory_;
  Arena arena_;
  SerialExecutor serial_;
  Planner<Robot> planner_;
};

}  // namespace sopt
