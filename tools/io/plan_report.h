// What people read about plans: a few aligned lines for stdout, and the lines above a picture.
#pragma once

#include <string>

#include "opt/planner.h"
#include "tools/io/scene_file.h"

namespace sopt {

// "name: verified plan in 0.28 ms" and what it is like, or what failed and why. `times` replaces
// the result's own: medians over `num_calls`.
[[nodiscard]] std::string describe_plan(const Scene& scene, const PlanResult<Point2>& result,
                                        const StageTimes& times, int num_calls);

// The figures of a plan, or of a search without one, in one line.
[[nodiscard]] std::string describe_figures(const PlanResult<Point2>& result,
                                           const StageTimes& times);

// Why there is no plan, in one line; empty when there is one.
[[nodiscard]] std::string describe_failure(const Scene& scene, const PlanResult<Point2>& result);

[[nodiscard]] std::string describe_certificate(const Scene& scene, const Certificate& certificate);

[[nodiscard]] const char* to_string(ViolationKind kind);
[[nodiscard]] std::string describe_violation(const Scene& scene, const Violation& violation,
                                             double min_clearance_m);

// printf into a string.
[[nodiscard]] [[gnu::format(printf, 1, 2)]] std::string format(const char* pattern, ...);

}  // namespace sopt
