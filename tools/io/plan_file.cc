#include "tools/io/plan_file.h"

#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "tools/io/input_error.h"
#include "tools/io/json_fields.h"
#include "tools/io/json_text.h"

namespace sopt {
namespace {

using Json = nlohmann::ordered_json;

// Also what later versions and other robots answer.
constexpr std::array<std::string_view, 12> kStatusWords = {
    "ok",          "deadline_feasible", "no_path",   "deadline",   "bad_start", "bad_goal",
    "cannot_stop", "capacity",          "cancelled", "superseded", "no_slot",   "bad_input"};

Json to_us(std::int64_t time_ns) { return static_cast<double>(time_ns) / 1000.0; }

template <class Vector>
Json points_to_json(std::span<const Vector> points) {
  Json array = Json::array();
  for (const Vector& point : points)
    array.push_back(std::span(point.data(), point.data() + point.size()));
  return array;
}

Json history_to_json(std::span<const IterationRecord> history) {
  Json array = Json::array();
  for (const IterationRecord& record : history) {
    array.push_back({{"iteration", record.iteration},
                     {"cost", record.cost},
                     {"path_length", record.path_length},
                     {"segments", record.segments},
                     {"time_us", to_us(record.time_ns)}});
  }
  return array;
}

Json times_to_json(const StageTimes& times) {
  return {{"sample", to_us(times.sample_ns)},       {"shortcut", to_us(times.shortcut_ns)},
          {"reference", to_us(times.reference_ns)}, {"optimise", to_us(times.optimize_ns)},
          {"verify", to_us(times.verify_ns)},       {"total", to_us(times.total_ns)}};
}

Json counts_to_json(const SamplerCounts& sampler, const OptimizerCounts& optimizer) {
  return {{"nodes", sampler.nodes},
          {"edges", sampler.edges},
          {"clearance_queries", optimizer.clearance_queries},
          {"qp_solves", optimizer.qp_solves},
          {"qp_steps", optimizer.qp_steps}};
}

Json failure_to_json(const std::vector<std::string>& obstacle_ids, const PlanFailure& failure) {
  Json json = {{"stage", to_string(failure.stage)},
               {"reason", failure.reason},
               {"link", failure.i_link},
               {"obstacle", obstacle_to_json(obstacle_ids, failure.i_obstacle)},
               {"t_s", failure.t_s},
               {"amount", failure.amount}};
  if (failure.i_obstacle == kSelfObstacle) json["other_link"] = failure.i_other_link;
  if (failure.i_joint >= 0) json["joint"] = failure.i_joint;
  return json;
}

// Motion, path and figures; null or empty without a plan.
template <class Robot>
void add_plan(const PlanResult<Robot>& result, Json& plan) {
  const Trajectory<Robot>* trajectory = result.plan ? &result.plan->trajectory() : nullptr;
  const auto only_with_plan = [trajectory](double value) {
    return trajectory != nullptr ? value : std::numeric_limits<double>::quiet_NaN();
  };
  plan["dt_s"] = trajectory != nullptr ? Json(trajectory->dt_s) : Json(nullptr);
  plan["horizon"] = trajectory != nullptr ? trajectory->horizon() : 0;
  const auto all = [](const auto* owner, auto member) {
    return owner != nullptr ? points_to_json((owner->*member).span()) : Json::array();
  };
  plan["states"] = all(trajectory, &Trajectory<Robot>::states);
  plan["inputs"] = all(trajectory, &Trajectory<Robot>::inputs);
  plan["path"] = all(result.path, &Path<Robot>::vertices);
  plan["path_length"] = only_with_plan(result.path_length);
  plan["cost"] = only_with_plan(result.cost);
  plan["duration_s"] = trajectory != nullptr ? Json(trajectory->duration_s()) : Json(nullptr);
  plan["sampler_path_length"] =
      result.path != nullptr ? Json(result.sampler_path_length) : Json(nullptr);
  plan["iterations"] = result.iterations;
  plan["segments_initial"] = result.segments_initial;
  plan["segments_final"] = result.segments_final;
}

// --- reading

void check_type(const JsonField& root, const char* name, bool (*accepts)(const nlohmann::json&),
                const char* allowed) {
  const std::optional<JsonField> field = root.find(name);
  if (field && !accepts(field->value())) field->fail(allowed);
}

// Fields that verification does not use are still what the schema says.
void check_other_fields(const JsonField& root) {
  const auto is_amount = [](const nlohmann::json& v) { return v.is_number() || v.is_null(); };
  const auto is_count = [](const nlohmann::json& v) {
    return v.is_number_unsigned() || (v.is_number_integer() && v.get<std::int64_t>() >= 0);
  };
  const auto is_array = [](const nlohmann::json& v) { return v.is_array(); };
  const auto is_object = [](const nlohmann::json& v) { return v.is_object(); };
  const auto is_object_or_null = [](const nlohmann::json& v) {
    return v.is_object() || v.is_null();
  };
  for (const char* name :
       {"path_length", "cost", "duration_s", "sampler_path_length", "margin", "min_clearance"}) {
    check_type(root, name, is_amount, "a number or null");
  }
  for (const char* name : {"seed", "iterations", "segments_initial", "segments_final"}) {
    check_type(root, name, is_count, "an integer >= 0");
  }
  for (const char* name : {"path", "history"}) check_type(root, name, is_array, "an array");
  for (const char* name : {"times_us", "counts", "failure"}) {
    check_type(root, name, is_object, "an object");
  }
  check_type(root, "certificate", is_object_or_null, "an object or null");
}

int read_horizon(const JsonField& root) {
  constexpr int kMost = 1 << 20;
  constexpr const char* kAllowed = "an integer from 0 to 1048576";
  const JsonField field = root.at("horizon", kAllowed);
  if (!field.value().is_number_integer()) field.fail(kAllowed);
  return static_cast<int>(field.number({0.0, kMost, kAllowed}));
}

// Fills `points`, which has room for `num_points`.
template <class Vector>
void read_points(const JsonField& root, const char* name, int num_points,
                 const std::string& allowed, FixedVector<Vector>& points) {
  const auto size = static_cast<std::size_t>(num_points);
  const JsonField field = root.at(name, allowed);
  field.check_array(size, size, allowed);
  if (!points.try_resize(num_points)) throw HostError("no memory for the plan");
  const std::string num_words =
      (Vector::SizeAtCompileTime == 2 ? "two" : std::to_string(Vector::SizeAtCompileTime)) +
      " finite numbers";
  for (int i = 0; i < num_points; ++i) {
    const std::span numbers(points[i].data(), static_cast<std::size_t>(points[i].size()));
    field[static_cast<std::size_t>(i)].numbers(kFinite, num_words, numbers);
  }
}

template <class Robot>
void read_trajectory(const JsonField& root, ReceivedPlan<Robot>& plan) {
  const int horizon = read_horizon(root);
  Arena size = Arena::measuring();
  const Trajectory<Robot> measured(size, horizon);
  plan.memory = std::make_unique<MemoryBlock>(size.used_B());
  Arena arena(*plan.memory);
  plan.trajectory = Trajectory<Robot>(arena, horizon);
  if (horizon > 0) plan.trajectory.dt_s = root.number_at("dt_s", kPositive);
  const std::string steps = std::to_string(horizon);
  const std::string num_states = std::to_string(horizon > 0 ? horizon + 1 : 0);
  read_points(
      root, "states", horizon > 0 ? horizon + 1 : 0,
      "an array of " + num_states + " states " + state_words<Robot>() + ", horizon being " + steps,
      plan.trajectory.states);
  read_points(
      root, "inputs", horizon,
      "an array of " + steps + " inputs " + input_words<Robot>() + ", horizon being " + steps,
      plan.trajectory.inputs);
}

}  // namespace

const char* to_string(PlanStatus status) {
  switch (status) {
    case PlanStatus::kOk:
      return "ok";
    case PlanStatus::kDeadlineFeasible:
      return "deadline_feasible";
    case PlanStatus::kNoPath:
      return "no_path";
    case PlanStatus::kDeadline:
      return "deadline";
    case PlanStatus::kBadStart:
      return "bad_start";
    case PlanStatus::kBadGoal:
      return "bad_goal";
    case PlanStatus::kCapacity:
      return "capacity";
    case PlanStatus::kNoSlot:
      return "no_slot";
    case PlanStatus::kBadInput:
      return "bad_input";
  }
  return "bad_input";
}

const char* to_string(PlanStage stage) {
  switch (stage) {
    case PlanStage::kRequest:
      return "request";
    case PlanStage::kSample:
      return "sample";
    case PlanStage::kReference:
      return "reference";
    case PlanStage::kOptimize:
      return "optimise";
    case PlanStage::kVerify:
      return "verify";
  }
  return "request";
}

Json obstacle_to_json(const std::vector<std::string>& obstacle_ids, int i_obstacle) {
  if (i_obstacle == kBoundsObstacle) return "bounds";
  if (i_obstacle == kSelfObstacle) return "self";
  if (i_obstacle < 0) return nullptr;
  const std::string& id = obstacle_ids[static_cast<std::size_t>(i_obstacle)];
  return id.empty() ? Json(i_obstacle) : Json(id);
}

Json certificate_to_json(const std::vector<std::string>& obstacle_ids,
                         const Certificate& certificate) {
  return {{"min_clearance_m", certificate.min_clearance_m},
          {"where_t_s", certificate.where_t_s},
          {"link", certificate.i_link},
          {"obstacle", obstacle_to_json(obstacle_ids, certificate.i_obstacle)},
          {"worst_limit_margin", certificate.worst_limit_margin},
          {"goal_error", certificate.goal_error},
          {"dynamics_defect", certificate.dynamics_defect}};
}

template <class Robot>
std::string plan_to_text(const SceneOf<Robot>& scene, const PlanRequest<Robot>& request,
                         const PlanResult<Robot>& result, const StageTimes& times) {
  Json plan;
  plan["schema"] = kPlanSchema;
  plan["scene"] = scene.name;
  plan["robot"] = scene.robot_name;
  plan["seed"] = request.seed;
  plan["status"] = to_string(result.status);
  add_plan(result, plan);
  plan["history"] = history_to_json(result.history);
  plan["margin"] = result.plan ? Json(result.margin_m) : Json(nullptr);
  plan["min_clearance"] = request.options.min_clearance_m;
  plan["certificate"] = result.plan
                            ? certificate_to_json(scene.obstacle_ids, result.plan->certificate())
                            : Json(nullptr);
  plan["times_us"] = times_to_json(times);
  plan["counts"] = counts_to_json(result.sampler_counts, result.optimizer_counts);
  if (!result.plan) plan["failure"] = failure_to_json(scene.obstacle_ids, result.failure);
  return to_text(plan);
}

template <class Robot>
ReceivedPlan<Robot> load_plan(const std::filesystem::path& file, const std::string& robot_name) {
  const nlohmann::json json = load_json(file);
  const std::string shown = printable(file.string(), 400);
  const JsonField root(json, shown);
  root.check_fields({"schema",         "scene",
                     "robot",          "seed",
                     "status",         "dt_s",
                     "horizon",        "states",
                     "inputs",         "path",
                     "path_length",    "cost",
                     "duration_s",     "sampler_path_length",
                     "iterations",     "segments_initial",
                     "segments_final", "history",
                     "margin",         "min_clearance",
                     "certificate",    "times_us",
                     "counts",         "failure"});
  const JsonField schema = root.at("schema", "1");
  if (schema.value() != kPlanSchema) schema.fail("1, the only schema supported");
  const std::string allowed = '"' + printable(robot_name) + "\", the robot of the scene";
  const JsonField robot = root.at("robot", allowed);
  if (robot.value() != robot_name) robot.fail(allowed);

  ReceivedPlan<Robot> plan;
  plan.scene_name = root.at("scene", "a scene's name").text();
  const JsonField status = root.at("status", "a planner's status");
  plan.status = status.text();
  if (std::find(kStatusWords.begin(), kStatusWords.end(), plan.status) == kStatusWords.end()) {
    status.fail("a planner's status, such as \"ok\" or \"no_path\"");
  }
  check_other_fields(root);
  read_trajectory(root, plan);
  return plan;
}

#define SOPT_PLAN_FILE(Robot)                                                         \
  template std::string plan_to_text(const SceneOf<Robot>&, const PlanRequest<Robot>&, \
                                    const PlanResult<Robot>&, const StageTimes&);     \
  template ReceivedPlan<Robot> load_plan(const std::filesystem::path&, const std::string&);
SOPT_PLAN_FILE(Point2)
SOPT_PLAN_FILE(Arm<4>)
SOPT_PLAN_FILE(Arm<5>)
SOPT_PLAN_FILE(Arm<6>)
SOPT_PLAN_FILE(Arm<7>)
SOPT_PLAN_FILE(Arm<8>)
#undef SOPT_PLAN_FILE

}  // namespace sopt
