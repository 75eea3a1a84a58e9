#include "tools/io/robot_model.h"

#include <algorithm>
#include <set>

#include "models/arm/arm_pairs.h"
#include "models/space/pose3.h"
#include "tools/io/input_error.h"
#include "tools/io/json_fields.h"

namespace sopt {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

[[noreturn]] void fail(const RobotModel& model, const std::string& problem) {
  throw InputError(printable(model.source, 400) + ": " + problem);
}

const ModelJoint& find_joint(const RobotModel& model, const std::string& name) {
  const auto it = std::find_if(model.joints.begin(), model.joints.end(),
                               [&](const ModelJoint& joint) { return joint.name == name; });
  if (it == model.joints.end()) {
    std::string names;
    for (const ModelJoint& joint : model.joints) {
      if (joint.kind == ModelJointKind::kFixed) continue;
      names += (names.empty() ? "" : ", ") + printable(joint.name);
    }
    fail(model, "has no joint " + in_quotes(name) + "; it must be one of " + names);
  }
  return *it;
}

// Per link: the joint that leads to it, or nullptr for the root.
std::vector<const ModelJoint*> parents_of(const RobotModel& model) {
  std::vector<const ModelJoint*> parents(model.links.size(), nullptr);
  for (const ModelJoint& joint : model.joints) parents[at(joint.i_child)] = &joint;
  return parents;
}

std::vector<std::string> free_names(const RobotModel& model, const JointChoice& choice) {
  return choice.free_joints.empty() ? model.active_joints : choice.free_joints;
}

JointKind to_arm_kind(ModelJointKind kind) {
  switch (kind) {
    case ModelJointKind::kContinuous:
      return JointKind::kContinuous;
    case ModelJointKind::kPrismatic:
      return JointKind::kPrismatic;
    case ModelJointKind::kFixed:
    case ModelJointKind::kRevolute:
      break;
  }
  return JointKind::kRevolute;
}

// Where a joint stays that is not free.
double rest_position(const ModelJoint& joint, const JointChoice& choice) {
  const auto locked = choice.locked_joints.find(joint.name);
  if (locked != choice.locked_joints.end()) return locked->second;
  return joint.lower <= 0.0 && joint.upper >= 0.0 ? 0.0 : joint.lower;
}

Pose3 pose_at(const ModelJoint& joint, double q) {
  switch (joint.kind) {
    case ModelJointKind::kFixed:
      return joint.origin;
    case ModelJointKind::kPrismatic:
      return compose(joint.origin, {Mat3::Identity(), joint.axis * q});
    case ModelJointKind::kRevolute:
    case ModelJointKind::kContinuous:
      break;
  }
  return compose(joint.origin, {rotation_about(joint.axis, q), Vec3::Zero()});
}

// A link of the model as seen from the arm.
struct Placement {
  int i_arm_link = 0;  // moves with it
  Pose3 X_AL;          // in that link's frame
};

std::vector<Placement> place_links(const RobotModel& model, const JointChoice& choice) {
  const std::vector<std::string> free = free_names(model, choice);
  const std::vector<const ModelJoint*> parents = parents_of(model);
  std::vector<Placement> placements(model.links.size());
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    std::vector<const ModelJoint*> way;  // from the link up to a free joint or the root
    const ModelJoint* joint = parents[i];
    int i_arm_link = 0;
    for (; joint != nullptr; joint = parents[at(joint->i_parent)]) {
      const auto it = std::find(free.begin(), free.end(), joint->name);
      if (it != free.end()) {
        i_arm_link = static_cast<int>(it - free.begin()) + 1;
        break;
      }
      way.push_back(joint);
    }
    placements[i].i_arm_link = i_arm_link;
    for (auto it = way.rbegin(); it != way.rend(); ++it) {
      placements[i].X_AL = compose(placements[i].X_AL, pose_at(**it, rest_position(**it, choice)));
    }
  }
  return placements;
}

// Numbers the bodies of each arm link: model links with the same partners share one.
struct Bodies {
  std::vector<int> of_link;  // per model link, within its arm link
  std::vector<BodyPair> pairs;
};

Bodies find_bodies(const RobotModel& model, const std::vector<Placement>& placements) {
  Bodies bodies{std::vector<int>(model.links.size(), 0), {}};
  if (!model.pairs) return bodies;
  std::vector<std::set<int>> partners(model.links.size());
  for (const auto& [a, b] : *model.pairs) {
    if (placements[at(a)].i_arm_link == placements[at(b)].i_arm_link) continue;
    partners[at(a)].insert(b);
    partners[at(b)].insert(a);
  }
  std::map<int, std::vector<std::set<int>>> kinds;  // per arm link, in the order of links
  for (const ModelCapsule& capsule : model.capsules) {
    const std::set<int>& mine = partners[at(capsule.i_link)];
    auto& of_arm_link = kinds[placements[at(capsule.i_link)].i_arm_link];
    const auto it = std::find(of_arm_link.begin(), of_arm_link.end(), mine);
    bodies.of_link[at(capsule.i_link)] = static_cast<int>(it - of_arm_link.begin());
    if (it == of_arm_link.end()) of_arm_link.push_back(mine);
  }
  std::set<std::array<int, 4>> known;
  for (const ModelCapsule& capsule : model.capsules) {
    const int a = capsule.i_link;
    for (const int b : partners[at(a)]) {
      const bool has_capsules =
          std::any_of(model.capsules.begin(), model.capsules.end(),
                      [b](const ModelCapsule& other) { return other.i_link == b; });
      const BodyPair pair{placements[at(a)].i_arm_link, placements[at(b)].i_arm_link,
                          bodies.of_link[at(a)], bodies.of_link[at(b)]};
      if (!has_capsules || pair.i_link_a > pair.i_link_b) continue;
      if (known.insert({pair.i_link_a, pair.i_link_b, pair.i_body_a, pair.i_body_b}).second) {
        bodies.pairs.push_back(pair);
      }
    }
  }
  return bodies;
}

std::vector<LinkCapsule> fold_capsules(const RobotModel& model,
                                       const std::vector<Placement>& placements,
                                       const Bodies& bodies) {
  std::vector<LinkCapsule> capsules;
  for (const ModelCapsule& source : model.capsules) {
    const Placement& place = placements[at(source.i_link)];
    capsules.push_back({place.i_arm_link, transform(place.X_AL, source.capsule.p0),
                        transform(place.X_AL, source.capsule.p1), source.capsule.radius_m,
                        bodies.of_link[at(source.i_link)]});
  }
  return capsules;
}

void check_locked(const RobotModel& model, const JointChoice& choice) {
  for (const auto& [name, value] : choice.locked_joints) {
    const ModelJoint& joint = find_joint(model, name);
    if (joint.kind == ModelJointKind::kFixed) {
      fail(model, "locked joint " + in_quotes(name) + " is fixed; it must be one that moves");
    }
    if (!(value >= joint.lower && value <= joint.upper)) {
      fail(model, "locked joint " + in_quotes(name) + " is at " + show(value) +
                      "; it must be within its limits, " + show(joint.lower) + " to " +
                      show(joint.upper));
    }
  }
}

void check_base(const RobotModel& model, const std::string& name, const ArmJoint& first) {
  const double base_m = first.origin.position.norm();
  if (base_m <= kMaxBase_m) return;
  fail(model, "free joint " + in_quotes(name) + " is " + show(base_m) +
                  " m from the root link; it must be at most " + show(kMaxBase_m) + " m");
}

[[noreturn]] void fail_arm(const RobotModel& model, ArmStatus status) {
  switch (status) {
    case ArmStatus::kTooManyCapsules:
      fail(model, "has " + std::to_string(model.capsules.size()) +
                      " capsules and spheres; it must have at most " +
                      std::to_string(kMaxLinkCapsules));
    case ArmStatus::kTooManyBodies:
    case ArmStatus::kBadLink:  // a body beyond the capacity; all else was checked
      fail(model, "has more groups of links with different partners in self-collision than " +
                      std::to_string(kMaxBodies) + ", the limit");
    case ArmStatus::kTooManyPairs:
      fail(model, "has more pairs of groups of links that may collide than " +
                      std::to_string(kMaxBodyPairs) + ", the limit");
    case ArmStatus::kOk:
    case ArmStatus::kNotReset:
    case ArmStatus::kNotFinite:
    case ArmStatus::kBadRotation:
    case ArmStatus::kBadAxis:
    case ArmStatus::kBadLimits:
    case ArmStatus::kBadRate:
    case ArmStatus::kBadRadius:
    case ArmStatus::kBadWeight:
      break;  // checked field by field before
  }
  fail(model, "is not an arm");
}

}  // namespace

void find_root(RobotModel& model) {
  const std::vector<const ModelJoint*> parents = parents_of(model);
  int num_roots = 0;
  std::string roots;
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    if (parents[i] != nullptr) continue;
    model.i_root = static_cast<int>(i);
    roots += (num_roots++ == 0 ? "" : ", ") + in_quotes(model.links[i]);
  }
  if (num_roots == 0) fail(model, "joints form a loop; they must be a tree with one root link");
  if (num_roots > 1) {
    fail(model, "links " + roots + " have no parent; only one link may be without, the root");
  }
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    std::size_t length = 0;
    for (const ModelJoint* joint = parents[i]; joint != nullptr;
         joint = parents[at(joint->i_parent)]) {
      if (++length > model.joints.size()) {
        fail(model, "link " + in_quotes(model.links[i]) +
                        " hangs on a loop of joints; joints must be a tree with one root link");
      }
    }
  }
}

int count_free_joints(const RobotModel& model, const JointChoice& choice) {
  const std::vector<std::string> free = free_names(model, choice);
  for (std::size_t i = 0; i < free.size(); ++i) {
    if (find_joint(model, free[i]).kind == ModelJointKind::kFixed) {
      fail(model, "free joint " + in_quotes(free[i]) + " is fixed; it must be one that moves");
    }
    if (std::find(free.begin(), free.begin() + static_cast<std::ptrdiff_t>(i), free[i]) !=
        free.begin() + static_cast<std::ptrdiff_t>(i)) {
      fail(model, "free joint " + in_quotes(free[i]) + " is named twice; it must be named once");
    }
    if (choice.locked_joints.count(free[i]) > 0) {
      fail(model, "joint " + in_quotes(free[i]) + " is free and locked; it must be one of both");
    }
  }
  const int num_joints = static_cast<int>(free.size());
  if (num_joints < kMinArmJoints || num_joints > kMaxArmJoints) {
    fail(model, "has " + std::to_string(num_joints) + " free joints; there must be " +
                    std::to_string(kMinArmJoints) + " to " + std::to_string(kMaxArmJoints) +
                    ", lock others with locked_joints");
  }
  return num_joints;
}

template <int N>
NamedArm<N> make_arm(const RobotModel& model, const JointChoice& choice) {
  if (count_free_joints(model, choice) != N) {
    fail(model, "must have " + std::to_string(N) + " free joints here");
  }
  check_locked(model, choice);
  const std::vector<Placement> placements = place_links(model, choice);
  ArmDescription<N> description;
  NamedArm<N> named;
  named.joint_names = free_names(model, choice);
  named.link_names = {model.links[at(model.i_root)]};
  for (int j = 0; j < N; ++j) {
    const ModelJoint& joint = find_joint(model, named.joint_names[at(j)]);
    const Placement& parent = placements[at(joint.i_parent)];
    if (parent.i_arm_link != j) {
      fail(model, "free joint " + in_quotes(joint.name) +
                      (j == 0 ? " is not the first of its chain"
                              : " does not follow " + in_quotes(named.joint_names[at(j - 1)])) +
                      "; free joints must lie on one chain, in its order");
    }
    description.joints[at(j)] = {compose(parent.X_AL, joint.origin),
                                 joint.axis,
                                 to_arm_kind(joint.kind),
                                 joint.lower,
                                 joint.upper,
                                 joint.v_max,
                                 joint.a_max,
                                 joint.weight};
    named.link_names.push_back(model.links[at(joint.i_child)]);
  }
  check_base(model, named.joint_names[0], description.joints[0]);
  const Bodies bodies = find_bodies(model, placements);
  const std::vector<LinkCapsule> capsules = fold_capsules(model, placements, bodies);
  description.capsules = capsules;
  description.pairs = bodies.pairs;
  ArmStatus status = named.arm.reset(description);
  if (status == ArmStatus::kOk && !model.pairs) {
    const LinkPairList apart = find_pairs_apart(named.arm);
    description.pairs = apart.view();
    status = named.arm.reset(description);
  }
  if (status != ArmStatus::kOk) fail_arm(model, status);
  return named;
}

template NamedArm<4> make_arm<4>(const RobotModel&, const JointChoice&);
template NamedArm<5> make_arm<5>(const RobotModel&, const JointChoice&);
template NamedArm<6> make_arm<6>(const RobotModel&, const JointChoice&);
template NamedArm<7> make_arm<7>(const RobotModel&, const JointChoice&);
template NamedArm<8> make_arm<8>(const RobotModel&, const JointChoice&);

}  // namespace sopt
