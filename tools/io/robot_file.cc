#include "tools/io/robot_file.h"

#include <algorithm>

#include "models/config.h"
#include "models/space/pose3.h"
#include "tools/io/input_error.h"
#include "tools/io/scene_fields.h"

namespace sopt {
namespace {

constexpr std::size_t kMaxJoints = 256;
constexpr std::size_t kMaxShapes = 4096;
constexpr std::size_t kMaxPairs = 65536;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr NumberRule kAngle{-1e3, 1e3, "a number from -1000 to 1000, in rad"};
constexpr const char* kLinkAllowed = "a link that a joint names as parent or child";

bool is_documentary_in_robot(std::string_view name) {
  constexpr std::string_view kIgnored[] = {"source",
                                           "license",
                                           "notes",
                                           "convention",
                                           "capsule_note",
                                           "tool_frame",
                                           "base",
                                           "base_mount",
                                           "units",
                                           "approximated",
                                           "limits_used_by_vamp",
                                           "real_world_velocity_note"};
  return is_documentary(name) ||
         std::find(std::begin(kIgnored), std::end(kIgnored), name) != std::end(kIgnored);
}

Vec3 read_point(const JsonField& object, const char* name) {
  return read_three(object.at(name, kPoint3Allowed), kCoordinate, kPoint3Allowed);
}

// Of one field in either spelling; zero when neither is there.
Vec3 read_origin(const JsonField& joint, const char* name, const char* long_name,
                 const NumberRule& rule, std::string_view allowed) {
  const std::optional<JsonField> field = joint.find(name);
  const std::optional<JsonField> long_field = joint.find(long_name);
  if (field && long_field) {
    long_field->fail_as("is given besides " + std::string(name), "given in one spelling");
  }
  if (field) return read_three(*field, rule, allowed);
  return long_field ? read_three(*long_field, rule, allowed) : Vec3(Vec3::Zero());
}

ModelJointKind read_kind(const JsonField& joint) {
  constexpr const char* kKinds = "\"revolute\", \"continuous\", \"prismatic\" or \"fixed\"";
  const JsonField type = joint.at("type", kKinds);
  if (type.value() == "revolute") return ModelJointKind::kRevolute;
  if (type.value() == "continuous") return ModelJointKind::kContinuous;
  if (type.value() == "prismatic") return ModelJointKind::kPrismatic;
  if (type.value() != "fixed") type.fail(kKinds);
  return ModelJointKind::kFixed;
}

void check_joint_fields(const JsonField& field, ModelJointKind kind) {
  const std::initializer_list<std::string_view> kFixed = {
      "name", "type", "parent", "child", "xyz", "rpy", "origin_xyz", "origin_rpy"};
  const std::initializer_list<std::string_view> kContinuous = {
      "name",       "type", "parent",   "child",        "xyz",    "rpy",   "origin_xyz",
      "origin_rpy", "axis", "velocity", "acceleration", "effort", "weight"};
  const std::initializer_list<std::string_view> kLimited = {
      "name", "type",  "parent", "child",    "xyz",          "rpy",    "origin_xyz", "origin_rpy",
      "axis", "lower", "upper",  "velocity", "acceleration", "effort", "weight"};
  const bool is_fixed = kind == ModelJointKind::kFixed;
  const bool is_continuous = kind == ModelJointKind::kContinuous;
  field.check_fields(is_fixed        ? kFixed
                     : is_continuous ? kContinuous
                                     : kLimited,
                     is_documentary_in_robot);
}

void read_motion(const JsonField& field, ModelJoint& joint) {
  constexpr const char* kAxis = "[x, y, z], three numbers, not all 0";
  constexpr double kShortest = 1e-6;
  const JsonField axis = field.at("axis", kAxis);
  joint.axis = read_three(axis, kCoordinate, kAxis);
  if (joint.axis.norm() < kShortest) axis.fail(kAxis);
  // Axes that are unit but for their last digit stay as they are.
  if (std::abs(joint.axis.norm() - 1.0) > 1e-15) joint.axis.normalize();
  joint.lower = -kInfinity;
  joint.upper = kInfinity;
  if (joint.kind != ModelJointKind::kContinuous) {
    const NumberRule& rule = joint.kind == ModelJointKind::kRevolute ? kAngle : kCoordinate;
    joint.lower = field.number_at("lower", rule);
    joint.upper = field.number_at("upper", rule);
    if (joint.lower > joint.upper) {
      field.at("lower", "").fail("at most upper, " + show(joint.upper));
    }
  }
  joint.v_max = field.number_at("velocity", kPositive);
  joint.a_max =
      field.find_number("acceleration", kPositive).value_or(kAccelerationPerVelocity * joint.v_max);
  joint.weight = field.find_number("weight", kJointWeight).value_or(joint.weight);
}

// Index of a link's name, which is added when `may_add`.
int find_link(const JsonField& field, RobotModel& model, bool may_add) {
  const std::string name = field.text();
  const auto it = std::find(model.links.begin(), model.links.end(), name);
  const auto index = static_cast<int>(it - model.links.begin());
  if (it != model.links.end()) return index;
  if (!may_add) field.fail(kLinkAllowed);
  model.links.push_back(name);
  return index;
}

ModelJoint read_joint(const JsonField& field, RobotModel& model) {
  ModelJoint joint;
  if (!field.value().is_object()) field.fail("an object");
  joint.kind = read_kind(field);
  check_joint_fields(field, joint.kind);
  constexpr const char* kName = "a string that is not empty";
  const JsonField name = field.at("name", kName);
  joint.name = name.text();
  for (const ModelJoint& other : model.joints) {
    if (other.name == joint.name) name.fail("unique among the joints");
  }
  joint.i_parent = find_link(field.at("parent", kName), model, true);
  const JsonField child = field.at("child", kName);
  joint.i_child = find_link(child, model, true);
  if (joint.i_child == joint.i_parent) child.fail("another link than the joint's parent");
  for (const ModelJoint& other : model.joints) {
    if (other.i_child == joint.i_child) {
      child.fail("the child of one joint, " + field_name(other.name) + " has it already");
    }
  }
  joint.origin.position = read_origin(field, "xyz", "origin_xyz", kCoordinate, kPoint3Allowed);
  joint.origin.rotation = rotation_from_rpy(
      read_origin(field, "rpy", "origin_rpy", kAngle, "[roll, pitch, yaw], three numbers in rad"));
  if (joint.kind != ModelJointKind::kFixed) read_motion(field, joint);
  return joint;
}

void read_shapes(const JsonField& root, RobotModel& model) {
  constexpr const char* kAllowed = "an array of at most 4096 shapes";
  if (const std::optional<JsonField> capsules = root.find("capsules")) {
    capsules->check_array(0, kMaxShapes, kAllowed);
    for (std::size_t i = 0; i < capsules->size(); ++i) {
      const JsonField field = (*capsules)[i];
      field.check_fields({"link", "p0", "p1", "radius", "aabb_min", "aabb_max"},
                         is_documentary_in_robot);
      model.capsules.push_back({find_link(field.at("link", kLinkAllowed), model, false),
                                {read_point(field, "p0"), read_point(field, "p1"),
                                 field.number_at("radius", kNotNegative)}});
    }
  }
  if (const std::optional<JsonField> spheres = root.find("spheres")) {
    spheres->check_array(0, kMaxShapes, kAllowed);
    for (std::size_t i = 0; i < spheres->size(); ++i) {
      const JsonField field = (*spheres)[i];
      field.check_fields({"link", "center", "radius"}, is_documentary_in_robot);
      const Vec3 center = read_point(field, "center");
      model.capsules.push_back({find_link(field.at("link", kLinkAllowed), model, false),
                                {center, center, field.number_at("radius", kNotNegative)}});
    }
  }
}

void read_pairs(const JsonField& root, RobotModel& model) {
  const std::optional<JsonField> pairs = root.find("self_collision_link_pairs");
  if (!pairs) return;
  pairs->check_array(0, kMaxPairs, "an array of at most 65536 [link, link]");
  model.pairs.emplace();
  for (std::size_t i = 0; i < pairs->size(); ++i) {
    const JsonField pair = (*pairs)[i];
    constexpr const char* kAllowed = "[link, link], the names of two different links";
    pair.check_array(2, 2, kAllowed);
    const int a = find_link(pair[0], model, false);
    const int b = find_link(pair[1], model, false);
    if (a == b) pair.fail(kAllowed);
    model.pairs->emplace_back(a, b);
  }
}

void read_active(const JsonField& root, RobotModel& model) {
  const std::optional<JsonField> active = root.find("active_joints");
  if (!active) {
    for (const ModelJoint& joint : model.joints) {
      if (joint.kind != ModelJointKind::kFixed) model.active_joints.push_back(joint.name);
    }
    return;
  }
  active->check_array(1, kMaxJoints, "an array of names of joints that move");
  for (std::size_t i = 0; i < active->size(); ++i) {
    const std::string name = (*active)[i].text();
    const bool moves =
        std::any_of(model.joints.begin(), model.joints.end(), [&](const ModelJoint& joint) {
          return joint.name == name && joint.kind != ModelJointKind::kFixed;
        });
    if (!moves) (*active)[i].fail("the name of a joint that moves");
    const auto& known = model.active_joints;
    if (std::find(known.begin(), known.end(), name) != known.end()) {
      (*active)[i].fail("named once");
    }
    model.active_joints.push_back(name);
  }
}

void check_root(const JsonField& root, const RobotModel& model) {
  for (const char* name : {"base_link", "root_link"}) {
    const std::optional<JsonField> field = root.find(name);
    const std::string& expected = model.links[static_cast<std::size_t>(model.i_root)];
    if (field && field->text() != expected) {
      field->fail("the link without a parent, " + field_name(expected));
    }
  }
}

// Adding 0 turns -0 into 0.
nlohmann::ordered_json to_array(const Vec3& v) { return {v.x() + 0.0, v.y() + 0.0, v.z() + 0.0}; }

nlohmann::ordered_json joint_to_json(const ModelJoint& joint, const RobotModel& model) {
  constexpr const char* kKinds[] = {"fixed", "revolute", "continuous", "prismatic"};
  nlohmann::ordered_json json;
  json["name"] = joint.name;
  json["type"] = kKinds[static_cast<std::size_t>(joint.kind)];
  json["parent"] = model.links[static_cast<std::size_t>(joint.i_parent)];
  json["child"] = model.links[static_cast<std::size_t>(joint.i_child)];
  json["xyz"] = to_array(joint.origin.position);
  json["rpy"] = to_array(rpy_from_rotation(joint.origin.rotation));
  if (joint.kind == ModelJointKind::kFixed) return json;
  json["axis"] = to_array(joint.axis);
  if (joint.kind != ModelJointKind::kContinuous) {
    json["lower"] = joint.lower;
    json["upper"] = joint.upper;
  }
  json["velocity"] = joint.v_max;
  json["acceleration"] = joint.a_max;
  if (joint.weight != 1.0) json["weight"] = joint.weight;
  return json;
}

}  // namespace

RobotModel load_robot_file(const std::filesystem::path& file) {
  const nlohmann::json json = load_json(file);
  const std::string shown = printable(file.string(), 400);
  const JsonField root(json, shown);
  root.check_fields({"name", "base_link", "root_link", "joints", "capsules", "spheres",
                     "active_joints", "self_collision_link_pairs"},
                    is_documentary_in_robot);
  RobotModel model;
  model.source = file.string();
  const std::optional<JsonField> name = root.find("name");
  model.name = name ? name->text() : valid_utf8(file.stem().string());
  constexpr const char* kJoints = "an array of 1 to 256 joints";
  const JsonField joints = root.at("joints", kJoints);
  joints.check_array(1, kMaxJoints, kJoints);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    model.joints.push_back(read_joint(joints[i], model));
  }
  find_root(model);
  check_root(root, model);
  read_shapes(root, model);
  read_pairs(root, model);
  read_active(root, model);
  return model;
}

nlohmann::ordered_json robot_to_json(const RobotModel& model) {
  const auto link = [&](int i) { return model.links[static_cast<std::size_t>(i)]; };
  nlohmann::ordered_json json;
  json["name"] = model.name;
  json["base_link"] = link(model.i_root);
  json["convention"] =
      "from a joint's parent to its child: shift by xyz, turn by rpy about the parent's x, then y, "
      "then z, then the joint's own motion along or about axis; m, rad, s";
  if (!model.active_joints.empty()) json["active_joints"] = model.active_joints;
  json["joints"] = nlohmann::ordered_json::array();
  for (const ModelJoint& joint : model.joints)
    json["joints"].push_back(joint_to_json(joint, model));
  json["capsules"] = nlohmann::ordered_json::array();
  for (const ModelCapsule& capsule : model.capsules) {
    json["capsules"].push_back({{"link", link(capsule.i_link)},
                                {"p0", to_array(capsule.capsule.p0)},
                                {"p1", to_array(capsule.capsule.p1)},
                                {"radius", capsule.capsule.radius_m}});
  }
  if (model.pairs) {
    json["self_collision_link_pairs"] = nlohmann::ordered_json::array();
    for (const auto& [a, b] : *model.pairs) {
      json["self_collision_link_pairs"].push_back({link(a), link(b)});
    }
  }
  return json;
}

}  // namespace sopt
