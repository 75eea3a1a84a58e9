// Plan files, schema 1: what one call of `plan` answered, as JSON that re-verifies bit by bit.
// Without a usable plan the trajectory is empty, what does not exist is null, and `failure` says
// why. Reading is as strict as for scenes; what is read is data from outside until `verify` has
// passed it.
#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "alloc/memory_block.h"
#include "opt/planner.h"
#include "tools/io/robot_scene.h"

namespace sopt {

inline constexpr int kPlanSchema = 1;

[[nodiscard]] const char* to_string(PlanStatus status);
[[nodiscard]] const char* to_string(PlanStage stage);

// `times` replaces the result's own: medians over several calls.
template <class Robot>
[[nodiscard]] std::string plan_to_text(const SceneOf<Robot>& scene,
                                       const PlanRequest<Robot>& request,
                                       const PlanResult<Robot>& result, const StageTimes& times);

// Id of the obstacle if it has one, else its index; "bounds"; "self": another link; null for none.
[[nodiscard]] nlohmann::ordered_json obstacle_to_json(const std::vector<std::string>& obstacle_ids,
                                                      int i_obstacle);
[[nodiscard]] nlohmann::ordered_json certificate_to_json(
    const std::vector<std::string>& obstacle_ids, const Certificate& certificate);

template <class Robot>
struct ReceivedPlan {
  std::string scene_name;
  std::string status;                   // of the call that wrote it
  std::unique_ptr<MemoryBlock> memory;  // of the trajectory
  Trajectory<Robot> trajectory;         // horizon 0: the file holds no plan
};

// A plan for `scene`, whose robot it must name. Throws InputError, as load_scene.
template <class Robot>
[[nodiscard]] ReceivedPlan<Robot> load_plan(const std::filesystem::path& file,
                                            const std::string& robot_name);

}  // namespace sopt
