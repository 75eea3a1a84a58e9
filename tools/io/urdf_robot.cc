#include "tools/io/urdf_robot.h"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "models/config.h"
#include "models/space/pose3.h"
#include "tools/io/input_error.h"
#include "tools/io/input_text.h"
#include "tools/io/json_fields.h"
#include "tools/io/mesh_file.h"

namespace sopt {
namespace {

namespace fs = std::filesystem;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kFarthest = 1e6;

// The parser reports through a global log: first the reason, then the element it is in. What it
// cannot read of a link it leaves out and goes on.
class ParserErrors final : public console_bridge::OutputHandler {
 public:
  ParserErrors() { console_bridge::useOutputHandler(this); }
  ParserErrors(const ParserErrors&) = delete;
  ParserErrors& operator=(const ParserErrors&) = delete;
  ~ParserErrors() override { console_bridge::restorePreviousOutputHandler(); }

  void log(const std::string& text, console_bridge::LogLevel level, const char* /*file*/,
           int /*line*/) override {
    if (level < console_bridge::CONSOLE_BRIDGE_LOG_ERROR) return;
    if (num_errors_ < 2) text_ += (num_errors_ == 0 ? "" : "; ") + text;
    ++num_errors_;
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
  int num_errors_ = 0;
};

// The XML parser below calls itself for every level of elements.
bool is_nested_too_deep(const std::string& xml) {
  constexpr int kMaxDepth = 100;
  int depth = 0;
  for (std::size_t i = xml.find('<'); i != std::string::npos; i = xml.find('<', i + 1)) {
    if (xml.compare(i, 4, "<!--") == 0) {
      i = std::min(xml.find("-->", i), xml.size());
      continue;
    }
    const std::size_t end = xml.find('>', i);
    if (end == std::string::npos) return false;  // the parser says where
    if (xml[i + 1] == '?' || xml[i + 1] == '!' || xml[end - 1] == '/') continue;
    depth += xml[i + 1] == '/' ? -1 : 1;
    if (depth > kMaxDepth) return true;
  }
  return false;
}

// In a loop of joints the parser's links own each other; they are told to let go.
class LinksRelease {
 public:
  explicit LinksRelease(const urdf::ModelInterface& urdf) : urdf_(urdf) {}
  LinksRelease(const LinksRelease&) = delete;
  LinksRelease& operator=(const LinksRelease&) = delete;
  ~LinksRelease() {
    for (const auto& [name, link] : urdf_.links_) {
      link->child_links.clear();
      link->child_joints.clear();
    }
  }

 private:
  const urdf::ModelInterface& urdf_;
};

class UrdfReader {
 public:
  explicit UrdfReader(const fs::path& file) : file_(file), shown_(printable(file.string(), 400)) {}

  UrdfRobot read() {
    const urdf::ModelInterfaceSharedPtr urdf = parse();
    const LinksRelease release(*urdf);
    robot_.model.name = valid_utf8(urdf->getName());
    robot_.model.source = file_.string();
    read_tree(*urdf);
    if (robot_.model.joints.empty()) fail("has no joints; it must have at least one");
    find_root(robot_.model);
    choose_chain();
    return std::move(robot_);
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const {
    throw InputError(shown_ + ": " + problem);
  }

  urdf::ModelInterfaceSharedPtr parse() const {
    const std::string xml = read_input(file_, "a URDF file");
    if (is_nested_too_deep(xml)) fail("nests elements deeper than 100 levels, the limit");
    const ParserErrors errors;
    urdf::ModelInterfaceSharedPtr model;
    std::string thrown;
    try {
      model = urdf::parseURDF(xml);
    } catch (const std::exception& error) {
      thrown = error.what();
    }
    if (model && errors.text().empty()) return model;
    const std::string& reason = errors.text().empty() ? thrown : errors.text();
    fail("not a valid URDF: " + printable(reason, 200));
  }

  [[nodiscard]] double checked(double value, const std::string& where) const {
    if (!(std::abs(value) <= kFarthest)) {
      fail(where + " is " + show(value) + "; it must be a number from -1e6 to 1e6");
    }
    return value;
  }
  [[nodiscard]] Vec3 checked(const urdf::Vector3& v, const std::string& where) const {
    return {checked(v.x, where), checked(v.y, where), checked(v.z, where)};
  }
  [[nodiscard]] Pose3 checked(const urdf::Pose& pose, const std::string& where) const {
    const urdf::Rotation& r = pose.rotation;
    const Eigen::Quaterniond q(checked(r.w, where), checked(r.x, where), checked(r.y, where),
                               checked(r.z, where));
    return {q.normalized().toRotationMatrix(), checked(pose.position, where)};
  }

  // Links and joints from the root down, parents before children.
  void read_tree(const urdf::ModelInterface& urdf) {
    std::vector<urdf::LinkConstSharedPtr> todo = {urdf.getRoot()};
    while (!todo.empty()) {
      const urdf::LinkConstSharedPtr link = todo.back();
      todo.pop_back();
      const auto i_link = static_cast<int>(robot_.model.links.size());
      robot_.model.links.push_back(link->name);
      if (link->parent_joint) read_joint(*link->parent_joint, i_link);
      read_shapes(*link, i_link);
      for (auto it = link->child_joints.rbegin(); it != link->child_joints.rend(); ++it) {
        if (todo.size() + robot_.model.links.size() > urdf.links_.size()) {
          fail("joint " + in_quotes((*it)->name) + " leads to a link that another joint leads to");
        }
        todo.push_back(urdf.getLink((*it)->child_link_name));
      }
    }
    if (robot_.model.links.size() != urdf.links_.size()) {
      fail("has links that do not hang on the root link " + in_quotes(urdf.getRoot()->name) +
           "; joints must be a tree with one root link");
    }
    if (robot_.model.joints.size() != urdf.joints_.size()) {
      fail("has two joints that lead to one link; joints must be a tree with one root link");
    }
  }

  ModelJointKind read_kind(const urdf::Joint& joint) const {
    const std::string what = "joint " + in_quotes(joint.name) + " is ";
    constexpr const char* kSupported =
        "; supported are revolute, continuous, prismatic and fixed joints that mimic no other";
    if (joint.mimic) {
      fail(what + "a mimic of " + in_quotes(joint.mimic->joint_name) + kSupported);
    }
    switch (joint.type) {
      case urdf::Joint::REVOLUTE:
        return ModelJointKind::kRevolute;
      case urdf::Joint::CONTINUOUS:
        return ModelJointKind::kContinuous;
      case urdf::Joint::PRISMATIC:
        return ModelJointKind::kPrismatic;
      case urdf::Joint::FIXED:
        return ModelJointKind::kFixed;
      case urdf::Joint::FLOATING:
        fail(what + "floating" + kSupported);
      case urdf::Joint::PLANAR:
        fail(what + "planar" + kSupported);
      case urdf::Joint::UNKNOWN:
        break;
    }
    fail(what + "of an unknown type" + kSupported);
  }

  void read_joint(const urdf::Joint& source, int i_child) {
    const std::string what = "joint " + in_quotes(source.name) + ": ";
    ModelJoint joint;
    joint.name = source.name;
    joint.kind = read_kind(source);
    const auto& links = robot_.model.links;
    joint.i_parent = static_cast<int>(
        std::find(links.begin(), links.end(), source.parent_link_name) - links.begin());
    joint.i_child = i_child;
    joint.origin = checked(source.parent_to_joint_origin_transform, what + "origin");
    if (joint.kind != ModelJointKind::kFixed) read_motion(source, what, joint);
    robot_.model.joints.push_back(joint);
  }

  void read_motion(const urdf::Joint& source, const std::string& what, ModelJoint& joint) const {
    constexpr double kShortest = 1e-6;
    joint.axis = checked(source.axis, what + "axis");
    if (joint.axis.norm() < kShortest) fail(what + "axis is zero; it must have a direction");
    joint.axis.normalize();
    if (!source.limits) fail(what + "limit is missing; it must give a velocity > 0");
    joint.lower = -kInfinity;
    joint.upper = kInfinity;
    if (joint.kind != ModelJointKind::kContinuous) {
      joint.lower = checked(source.limits->lower, what + "lower");
      joint.upper = checked(source.limits->upper, what + "upper");
      if (joint.lower > joint.upper) {
        fail(what + "lower is " + show(joint.lower) + "; it must be at most upper, " +
             show(joint.upper));
      }
    }
    joint.v_max = checked(source.limits->velocity, what + "velocity");
    if (!(joint.v_max >= 1e-9)) {
      fail(what + "velocity is " + show(joint.v_max) + "; it must be > 0, from 1e-9 to 1e6");
    }
    joint.a_max = kAccelerationPerVelocity * joint.v_max;
  }

  void read_shapes(const urdf::Link& link, int i_link) {
    const bool is_visual = link.collision_array.empty();
    for (const urdf::CollisionSharedPtr& shape : link.collision_array) {
      add_shape(link.name, i_link, shape->origin, shape->geometry.get(), is_visual);
    }
    if (!is_visual) return;
    for (const urdf::VisualSharedPtr& shape : link.visual_array) {
      add_shape(link.name, i_link, shape->origin, shape->geometry.get(), is_visual);
    }
  }

  void add_shape(const std::string& link, int i_link, const urdf::Pose& origin,
                 const urdf::Geometry* geometry, bool is_visual) {
    if (geometry == nullptr) return;
    const std::string where = "link " + in_quotes(link) + ": ";
    CapsuleApproximation result = wrap(*geometry, where);
    const Pose3 pose = checked(origin, where + "origin");
    result.capsule.p0 = transform(pose, result.capsule.p0);
    result.capsule.p1 = transform(pose, result.capsule.p1);
    result.link = link;
    result.is_visual = is_visual;
    robot_.model.capsules.push_back({i_link, result.capsule});
    robot_.approximations.push_back(result);
  }

  [[nodiscard]] double size(double value, const std::string& where) const {
    if (!(value >= 1e-9) || value > kFarthest) {
      fail(where + " is " + show(value) + "; it must be > 0, from 1e-9 to 1e6");
    }
    return value;
  }

  // In the shape's own frame.
  CapsuleApproximation wrap(const urdf::Geometry& geometry, const std::string& where) const {
    switch (geometry.type) {
      case urdf::Geometry::SPHERE:
        return wrap_sphere(
            size(static_cast<const urdf::Sphere&>(geometry).radius, where + "sphere radius"));
      case urdf::Geometry::BOX: {
        const urdf::Vector3& dim = static_cast<const urdf::Box&>(geometry).dim;
        return wrap_box({size(dim.x, where + "box size"), size(dim.y, where + "box size"),
                         size(dim.z, where + "box size")});
      }
      case urdf::Geometry::CYLINDER: {
        const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
        return wrap_cylinder(size(cylinder.radius, where + "cylinder radius"),
                             size(cylinder.length, where + "cylinder length"));
      }
      case urdf::Geometry::MESH:
        break;
    }
    return wrap_mesh(static_cast<const urdf::Mesh&>(geometry), where);
  }

  CapsuleApproximation wrap_mesh(const urdf::Mesh& source, const std::string& where) const {
    Mesh mesh = load_mesh(find_mesh(source.filename, where));
    const Vec3 scale = checked(source.scale, where + "mesh scale");
    if (scale.prod() == 0.0) fail(where + "mesh scale has a 0; it must have none");
    for (Vec3& v : mesh.vertices) v = v.cwiseProduct(scale);
    CapsuleApproximation result = wrap_points(mesh.vertices, mesh_volume_m3(mesh));
    result.geometry = "mesh " + printable(fs::path(source.filename).filename().string()) + ", " +
                      std::to_string(mesh.vertices.size()) + " vertices";
    return result;
  }

  fs::path find_mesh(const std::string& name, const std::string& where) const {
    constexpr std::string_view kPackage = "package://";
    constexpr std::string_view kFile = "file://";
    constexpr int kNumAncestors = 4;
    const bool in_package = name.starts_with(kPackage);
    std::string path = name;
    if (in_package) path = name.substr(kPackage.size());
    if (name.starts_with(kFile)) path = name.substr(kFile.size());
    std::error_code error;
    fs::path folder = fs::absolute(file_, error).parent_path();
    for (int i = 0; i <= (in_package ? kNumAncestors : 0); ++i) {
      if (fs::is_regular_file(folder / path, error)) return folder / path;
      const std::size_t slash = path.find('/');
      const std::string inside = slash == std::string::npos ? path : path.substr(slash + 1);
      if (in_package && fs::is_regular_file(folder / inside, error)) return folder / inside;
      folder = folder.parent_path();
    }
    fail(where + "mesh " + in_quotes(name) +
         " is not found; it must lie beside the URDF file or in the package around it");
  }

  void choose_chain() {
    const RobotModel& model = robot_.model;
    std::vector<int> num_moving(model.links.size(), 0);  // on the longest way down from a link
    const auto through = [&](const ModelJoint& joint) {
      return num_moving[static_cast<std::size_t>(joint.i_child)] +
             (joint.kind == ModelJointKind::kFixed ? 0 : 1);
    };
    for (auto it = model.joints.rbegin(); it != model.joints.rend(); ++it) {
      int& below = num_moving[static_cast<std::size_t>(it->i_parent)];
      below = std::max(below, through(*it));
    }
    int i_link = model.i_root;
    while (num_moving[static_cast<std::size_t>(i_link)] > 0) {
      const ModelJoint* longest = nullptr;
      int num_longest = 0;
      for (const ModelJoint& joint : model.joints) {
        const bool is_long = joint.i_parent == i_link &&
                             through(joint) == num_moving[static_cast<std::size_t>(i_link)];
        if (!is_long) continue;
        longest = &joint;
        ++num_longest;
      }
      if (num_longest != 1) return;
      if (longest->kind != ModelJointKind::kFixed) {
        robot_.model.active_joints.push_back(longest->name);
      }
      i_link = longest->i_child;
    }
  }

  fs::path file_;
  std::string shown_;
  UrdfRobot robot_;
};

}  // namespace

UrdfRobot load_urdf(const fs::path& file) { return UrdfReader(file).read(); }

}  // namespace sopt
