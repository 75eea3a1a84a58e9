// What people read about plans: a few aligned lines for stdout, and the lines above a picture.
#pragma once

#include <string>

#include "opt/planner.h"
#include "tools/io/robot_scene.h"

namespace sopt {

// "name: verified plan in 0.28 ms" and what it is like, or what failed and why. `times` replaces
// the result's own: medians over `num_calls`.
template <class Robot>
[[nodiscard]] std::string describe_plan(const SceneOf<Robot>& scene,
                                        const PlanResult<Robot>& result, const StageTimes& times,
                                        int num_calls);

// The figures of a plan, or of a search without one, in one line.
template <class Robot>
[[nodiscard]] std::string describe_figures(const PlanResult<Robot>& result,
                                           const StageTimes& times);

// Why there is no plan, in one line; empty when there is one.
template <class Robot>
[[nodiscard]] std::string describe_failure(const SceneOf<Robot>& scene,
                                           const PlanResult<Robot>& result);

template <class Robot>
[[nodiscard]] std::string describe_certificate(const SceneOf<Robot>& scene,
                                               const Certificate& certificate);

[[nodiscard]] const char* to_string(ViolationKind kind);
template <class Robot>
[[nodiscard]] std::string describe_violation(const SceneOf<Robot>& scene,
                                             const Violation& violation, double min_clearance_m);

// printf into a string.
[[nodiscard]] [[gnu::format(printf, 1, 2)]] std::string format(const char* pattern, ...);

}  // namespace sopt
