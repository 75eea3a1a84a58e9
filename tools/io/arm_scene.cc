#include "tools/io/arm_scene.h"

#include <algorithm>

#include "tools/io/input_error.h"
#include "tools/io/named_presets.h"
#include "tools/io/robot_file.h"
#include "tools/io/space_world.h"

namespace sopt {
namespace {

constexpr NumberRule kJointValue{-1e3, 1e3, "a number from -1000 to 1000"};

std::string robots_allowed() {
  return std::string("\"point2d\", a preset (") + kPresetNames +
         ") or any name together with robot_file";
}

// The same arm with its base at X_WB and other limits and weights of its joints.
template <int N>
Arm<N> rebuilt(const Arm<N>& arm, const Pose3& X_WB, const std::array<ArmJoint, N>& joints) {
  ArmPose<N> pose;
  arm.forward(Arm<N>::Config::Zero(), pose);
  std::vector<LinkCapsule> capsules;
  std::vector<BodyPair> pairs;
  std::vector<int> names;  // of bodies within their links
  for (int b = 0; b < arm.num_bodies(); ++b) {
    const ArmBody& body = arm.body(b);
    const bool is_next = b > 0 && arm.body(b - 1).i_link == body.i_link;
    names.push_back(is_next ? names.back() + 1 : 0);
    const Pose3 X_WL = arm.link_pose(pose, body.i_link);
    for (int i = body.first; i < body.last; ++i) {
      const Capsule3 capsule = arm.capsule_W(pose, i);
      capsules.push_back({body.i_link, X_WL.rotation.transpose() * (capsule.p0 - X_WL.position),
                          X_WL.rotation.transpose() * (capsule.p1 - X_WL.position),
                          capsule.radius_m, names.back()});
    }
  }
  for (const auto& [a, b] : arm.self_collision_pairs()) {
    pairs.push_back({arm.body(a).i_link, arm.body(b).i_link, names[static_cast<std::size_t>(a)],
                     names[static_cast<std::size_t>(b)]});
  }
  ArmDescription<N> description;
  description.X_WB = X_WB;
  description.joints = joints;
  description.capsules = capsules;
  description.pairs = pairs;
  Arm<N> moved;
  (void)moved.reset(description);  // an arm, a pose and limits that were checked
  return moved;
}

// The element of `limits` for one limit of a joint.
double read_limit(const JsonField& element, const ArmJoint& joint, double ArmJoint::*limit,
                  const std::string& name) {
  const bool is_rate = limit == &ArmJoint::v_max || limit == &ArmJoint::a_max;
  if (!is_rate && joint.kind == JointKind::kContinuous) {
    element.fail("null: joint " + field_name(name) + " turns without end");
  }
  const double lowest = is_rate ? kPositive.lowest : joint.lower;
  const double highest = limit == &ArmJoint::a_max   ? kPositive.highest
                         : limit == &ArmJoint::v_max ? joint.v_max
                                                     : joint.upper;
  const bool is_number = element.value().is_number();
  const double value = is_number ? element.value().get<double>() : 0.0;
  if (!is_number || !(value >= lowest && value <= highest)) {
    element.fail("null or a number from " + show(lowest) + " to " + show(highest) + " for joint " +
                 field_name(name));
  }
  return value;
}

template <int N>
void read_limits(const JsonField& limits, const std::vector<std::string>& names,
                 std::array<ArmJoint, N>& joints) {
  limits.check_fields({"lower", "upper", "v_max", "a_max"}, is_documentary);
  constexpr std::pair<const char*, double ArmJoint::*> kLimits[] = {{"lower", &ArmJoint::lower},
                                                                    {"upper", &ArmJoint::upper},
                                                                    {"v_max", &ArmJoint::v_max},
                                                                    {"a_max", &ArmJoint::a_max}};
  for (const auto& [name, limit] : kLimits) {
    const std::optional<JsonField> field = limits.find(name);
    if (!field) continue;
    field->check_array(N, N, "an array of " + std::to_string(N) + ", one per free joint");
    for (std::size_t j = 0; j < N; ++j) {
      const JsonField element = (*field)[j];
      if (element.value().is_null()) continue;
      joints[j].*limit = read_limit(element, joints[j], limit, names[j]);
    }
  }
}

template <int N>
void read_weights(const JsonField& weights, std::array<ArmJoint, N>& joints) {
  static constexpr const char* kAllowed = "null or a number from 0.001 to 1000";
  weights.check_array(N, N, "an array of " + std::to_string(N) + ", one per free joint");
  for (std::size_t j = 0; j < N; ++j) {
    const JsonField element = weights[j];
    if (element.value().is_null()) continue;
    joints[j].weight = element.number({kJointWeight.lowest, kJointWeight.highest, kAllowed});
  }
}

template <int N>
void read_arm(const JsonField& root, const NamedArm<N>& named, ArmScene<N>& scene) {
  scene.arm = named.arm;
  scene.joint_names = named.joint_names;
  scene.link_names = named.link_names;
  const std::optional<JsonField> base = root.find("base");
  const std::optional<JsonField> limits = root.find("limits");
  const std::optional<JsonField> weights = root.find("joint_weights");
  if (!base && !limits && !weights) return;
  Pose3 X_WB = named.arm.kinematics().X_WB;
  std::array<ArmJoint, N> joints;
  for (int j = 0; j < N; ++j) joints[static_cast<std::size_t>(j)] = named.arm.joint(j);
  if (base) {
    base->check_fields({"position", "quaternion_xyzw"}, is_documentary);
    X_WB = read_pose(*base);
    if (X_WB.position.norm() > kMaxBase_m) {
      base->at("position", "").fail("[x, y, z] at most " + show(kMaxBase_m) + " m from the origin");
    }
  }
  if (limits) read_limits<N>(*limits, named.joint_names, joints);
  if (weights) read_weights<N>(*weights, joints);
  scene.arm = rebuilt<N>(named.arm, X_WB, joints);
}

// Values within the limits of their joints.
template <int N>
typename Arm<N>::Config read_configuration(const JsonField& root, const char* name,
                                           const ArmScene<N>& scene) {
  const std::string allowed = "an array of " + std::to_string(N) + " numbers, one per free joint";
  const JsonField field = root.at(name, allowed);
  field.check_array(N, N, allowed);
  typename Arm<N>::Config q;
  for (int j = 0; j < N; ++j) {
    const JsonField element = field[static_cast<std::size_t>(j)];
    const double lower = scene.arm.lower()[j];
    const double upper = scene.arm.upper()[j];
    const double value = element.number(kJointValue);
    q[j] = std::clamp(value, lower, upper);
    if (std::abs(value - q[j]) > kLimitSlack) {
      element.fail("from " + show(lower) + " to " + show(upper) + ", the limits of joint " +
                   field_name(scene.joint_names[static_cast<std::size_t>(j)]));
    }
  }
  return q;
}

PlanOptions read_options(const JsonField& root) {
  PlanOptions options = PlanOptions::arm();
  options.speed_mps = root.find_number("speed", kPositive).value_or(options.speed_mps);
  options.dt_s = root.find_number("dt", kPositive).value_or(options.dt_s);
  options.margin_m = root.find_number("margin", kNotNegative).value_or(options.margin_m);
  options.min_clearance_m =
      root.find_number("min_clearance", kPositive).value_or(options.min_clearance_m);
  check_margins(root, options);
  return options;
}

template <int N>
ArmScene<N> read_arm_scene(const JsonField& root, const std::filesystem::path& file,
                           const std::string& robot_name, const NamedArm<N>& named) {
  ArmScene<N> scene;
  scene.file = file;
  scene.name = read_scene_name(root, file.stem().string());
  scene.robot_name = robot_name;
  read_arm(root, named, scene);
  scene.start = read_configuration(root, "start", scene);
  scene.goal = read_configuration(root, "goal", scene);
  const std::string zeros = std::to_string(N) + " zeros: arms start and stop at rest";
  check_zeros(root, "start_velocity", N, zeros);
  check_zeros(root, "goal_velocity", N, zeros);
  scene.options = read_options(root);
  SpaceWorld world = read_space_world(root);
  scene.memory = std::move(world.memory);
  scene.world = std::move(world.world);
  scene.obstacle_ids = read_ids(root.at("obstacles", ""));
  const std::optional<JsonField> reference = root.find("reference_length");
  if (reference && reference->value().is_number()) {
    scene.reference_length = reference->value().template get<double>();
  }
  return scene;
}

JointChoice read_joint_choice(const JsonField& root) {
  JointChoice choice;
  if (const std::optional<JsonField> joints = root.find("joints")) {
    joints->check_array(kMinArmJoints, kMaxArmJoints, "an array of 4 to 8 names of joints");
    for (std::size_t i = 0; i < joints->size(); ++i) {
      choice.free_joints.push_back((*joints)[i].text());
    }
  }
  if (const std::optional<JsonField> locked = root.find("locked_joints")) {
    if (!locked->value().is_object()) locked->fail("an object of a number per joint's name");
    for (const auto& item : locked->value().items()) {
      choice.locked_joints[item.key()] = locked->number_at(item.key().c_str(), kJointValue);
    }
  }
  return choice;
}

using AnyArm = std::variant<NamedArm<4>, NamedArm<5>, NamedArm<6>, NamedArm<7>, NamedArm<8>>;

AnyArm make_any_arm(const RobotModel& model, const JointChoice& choice) {
  switch (count_free_joints(model, choice)) {
    case 4:
      return make_arm<4>(model, choice);
    case 5:
      return make_arm<5>(model, choice);
    case 6:
      return make_arm<6>(model, choice);
    case 7:
      return make_arm<7>(model, choice);
    default:
      return make_arm<8>(model, choice);
  }
}

// `source` is what named the model.
AnyArm make_scene_arm(const JsonField& root, const std::filesystem::path& file, const char* source,
                      const RobotModel& model) {
  const JointChoice choice = read_joint_choice(root);
  try {
    return make_any_arm(model, choice);
  } catch (const InputError& error) {  // names the robot file; the scene may be to blame
    throw InputError(printable(file.string(), 400) + ": " + source +
                     ", joints and locked_joints do not fit: " + error.what());
  }
}

AnyArm read_robot(const JsonField& root, const std::filesystem::path& file) {
  if (const std::optional<JsonField> robot_file = root.find("robot_file")) {
    return make_scene_arm(root, file, "robot_file",
                          load_robot_file(file.parent_path() / robot_file->text()));
  }
  for (const char* name : {"joints", "locked_joints"}) {
    const std::optional<JsonField> field = root.find(name);
    if (field) field->fail_as("is given without robot_file", "absent: a preset's joints are free");
  }
  return find_preset(root.at("robot", "").text()).value();
}

// --- the robot that the command line names

void check_replacement(const std::string& robot, bool is_planar, const std::string& scene) {
  std::error_code error;
  const std::string allowed = is_planar
                                  ? "\"point2d\", as " + scene + " is of the plane"
                                  : std::string("a preset (") + kPresetNames + ") or a robot file";
  const bool is_arm = find_preset(robot) || std::filesystem::exists(robot, error);
  if (is_planar ? robot != "point2d" : !is_arm) {
    throw InputError("--robot: " + in_quotes(robot) + " is not allowed; it must be " + allowed);
  }
}

struct SceneRobot {
  std::string name;
  AnyArm arm;
};

SceneRobot read_replacement(const JsonField& root, const std::filesystem::path& file,
                            const std::string& robot) {
  if (const std::optional<NamedArm<5>> preset = find_preset(robot)) return {robot, *preset};
  const RobotModel model = load_robot_file(robot);
  return {model.name, make_scene_arm(root, file, "--robot", model)};
}

}  // namespace

AnyScene load_any_scene(const std::filesystem::path& file, const std::string& robot) {
  const nlohmann::json json = load_json(file);
  const std::string shown = printable(file.string(), 400);
  const JsonField root(json, shown);
  if (!json.is_object()) root.fail("an object");
  const JsonField own = root.at("robot", robots_allowed());
  const bool is_planar = own.value() == "point2d";
  if (!robot.empty()) check_replacement(robot, is_planar, shown);
  if (is_planar) return read_scene(root, file);
  if (!own.value().is_string() ||
      (robot.empty() && !root.find("robot_file") && !find_preset(own.value().get<std::string>()))) {
    own.fail(robots_allowed());
  }
  root.check_fields({"name", "robot", "robot_file", "joints", "locked_joints", "base", "start",
                     "goal", "obstacles", "speed", "dt", "margin", "min_clearance", "limits",
                     "joint_weights", "start_velocity", "goal_velocity"},
                    is_documentary_in_scene);
  const SceneRobot chosen = robot.empty() ? SceneRobot{own.text(), read_robot(root, file)}
                                          : read_replacement(root, file, robot);
  return std::visit(
      [&](const auto& named) { return AnyScene(read_arm_scene(root, file, chosen.name, named)); },
      chosen.arm);
}

}  // namespace sopt
