// A robot as files describe it: links joined to a tree, with capsules and the pairs of links that
// may collide. `make_arm` takes the chain of free joints out of it and folds everything else:
// fixed and locked joints go into the origins of the next free joint, links that hang rigidly on a
// moving link (hands, fingers) give it their capsules. Joints that are neither free nor locked stay
// at 0, or at their lower limit where 0 is outside.
// Self-collision keeps the model's own links apart as bodies (models/arm/arm.h), since links that
// are rigidly joined can have different partners; those with the same partners become one body.
// Without pairs in the model: as models/arm/arm_pairs.h says.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "models/arm/arm.h"

namespace sopt {

enum class ModelJointKind : std::int8_t { kFixed, kRevolute, kContinuous, kPrismatic };

struct ModelJoint {
  std::string name;
  ModelJointKind kind = ModelJointKind::kFixed;
  int i_parent = 0;
  int i_child = 0;
  Pose3 origin;               // in the parent link, at q = 0
  Vec3 axis = Vec3::UnitZ();  // unit
  double lower = 0.0;         // rad or m; -inf for continuous
  double upper = 0.0;
  double v_max = 0.0;  // of all but fixed joints; > 0
  double a_max = 0.0;
  double weight = 1.0;  // of the path metric (ArmJoint::weight)
};

struct ModelCapsule {
  int i_link = 0;
  Capsule3 capsule;  // link frame
};

struct RobotModel {
  std::string name;
  std::string source;  // the file, for messages
  std::vector<std::string> links;
  int i_root = 0;
  std::vector<ModelJoint> joints;  // a tree
  std::vector<ModelCapsule> capsules;
  std::optional<std::vector<std::pair<int, int>>> pairs;  // links that may collide
  std::vector<std::string> active_joints;                 // the free ones when nobody says
};

// The farthest an arm may stand from the origin, and its first free joint from the root link. The
// pads of motion checks grow with it (models/arm/arm_lanes.h): a plan takes 4 % longer at 100
// m, 1.8 times as long at 1 km, 580 times at 10 km.
inline constexpr double kMaxBase_m = 100.0;

// Which joints move, in the order of the arm's configuration, and where others are locked.
struct JointChoice {
  std::vector<std::string> free_joints;  // empty: the model's active joints
  std::map<std::string, double> locked_joints;
};

// Checks that links and joints are a tree, that parents exist once, and fills i_root; throws
// InputError: "FILE: ...".
void find_root(RobotModel& model);

// The number of free joints, kMinArmJoints..kMaxArmJoints; throws InputError otherwise and when a
// name is unknown, fixed, chosen twice or both free and locked.
[[nodiscard]] int count_free_joints(const RobotModel& model, const JointChoice& choice);

// An arm at the world's origin and what to call its parts. Throws InputError.
template <int N>
struct NamedArm {
  Arm<N> arm;
  std::vector<std::string> joint_names;  // N
  std::vector<std::string> link_names;   // N + 1: the links that the free joints move
};
template <int N>
[[nodiscard]] NamedArm<N> make_arm(const RobotModel& model, const JointChoice& choice);

extern template NamedArm<4> make_arm<4>(const RobotModel&, const JointChoice&);
extern template NamedArm<5> make_arm<5>(const RobotModel&, const JointChoice&);
extern template NamedArm<6> make_arm<6>(const RobotModel&, const JointChoice&);
extern template NamedArm<7> make_arm<7>(const RobotModel&, const JointChoice&);
extern template NamedArm<8> make_arm<8>(const RobotModel&, const JointChoice&);

}  // namespace sopt
