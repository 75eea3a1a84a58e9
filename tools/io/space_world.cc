#include "tools/io/space_world.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "tools/io/input_error.h"
#include "tools/io/scene_fields.h"

namespace sopt {
namespace {

constexpr const char* kHullAllowed = "an array of 4 to 32 [x, y, z] whose hull has a volume";

[[noreturn]] void fail_shape(const JsonField& field, WorldStatus status) {
  switch (status) {
    case WorldStatus::kDegenerate:
      field.fail_as("encloses no volume", kHullAllowed);
    case WorldStatus::kTooManyVertices:
      field.fail_as("is one too many",
                    "among at most " + std::to_string(World3Capacity{}.max_hulls) + " hulls");
    case WorldStatus::kNotReset:
    case WorldStatus::kNotFinite:
    case WorldStatus::kBadBounds:
    case WorldStatus::kBadSize:
    case WorldStatus::kBadVertexCount:
    case WorldStatus::kNotConvex:
    case WorldStatus::kClockwise:
    case WorldStatus::kTooManyObstacles:
    case WorldStatus::kBadRotation:
    case WorldStatus::kOk:
      break;  // checked field by field before
  }
  field.fail("a shape with an extent");
}

// `field` is what is to blame.
template <class Shape>
void add(const JsonField& obstacle, const JsonField& field, const Shape& shape, World3& world) {
  const WorldStatus status = world.try_add(shape, read_margin(obstacle));
  if (status != WorldStatus::kOk) fail_shape(field, status);
}

void add_box(const JsonField& obstacle, World3& world) {
  obstacle.check_fields({"type", "position", "quaternion_xyzw", "size", "id", "margin", "velocity"},
                        is_documentary);
  constexpr const char* kAllowed = "[x, y, z], three numbers > 0, from 1e-9 to 1e6";
  const JsonField size = obstacle.at("size", kAllowed);
  add(obstacle, size, Box3{read_pose(obstacle), read_three(size, kPositive, kAllowed)}, world);
}

void add_cylinder(const JsonField& obstacle, World3& world) {
  obstacle.check_fields(
      {"type", "position", "quaternion_xyzw", "radius", "height", "id", "margin", "velocity"},
      is_documentary);
  const double radius_m = obstacle.number_at("radius", kPositive);
  const double height_m = obstacle.number_at("height", kPositive);
  add(obstacle, obstacle, Cylinder3{read_pose(obstacle), radius_m, height_m}, world);
}

void add_sphere(const JsonField& obstacle, World3& world) {
  obstacle.check_fields(
      {"type", "position", "quaternion_xyzw", "radius", "id", "margin", "velocity"},
      is_documentary);
  const double radius_m = obstacle.number_at("radius", kPositive);
  add(obstacle, obstacle, Sphere3{read_pose(obstacle).position, radius_m}, world);
}

void add_capsule(const JsonField& obstacle, World3& world) {
  obstacle.check_fields({"type", "p0", "p1", "radius", "id", "margin", "velocity"}, is_documentary);
  const Vec3 p0 = read_three(obstacle.at("p0", kPoint3Allowed), kCoordinate, kPoint3Allowed);
  const Vec3 p1 = read_three(obstacle.at("p1", kPoint3Allowed), kCoordinate, kPoint3Allowed);
  add(obstacle, obstacle, Capsule3{p0, p1, obstacle.number_at("radius", kPositive)}, world);
}

void add_hull(const JsonField& obstacle, World3& world) {
  obstacle.check_fields({"type", "vertices", "id", "margin", "velocity"}, is_documentary);
  const JsonField field = obstacle.at("vertices", kHullAllowed);
  field.check_array(kMinHullVertices, kMaxHullVertices, kHullAllowed);
  std::vector<Vec3> vertices;
  for (std::size_t i = 0; i < field.size(); ++i) {
    vertices.push_back(read_three(field[i], kCoordinate, kPoint3Allowed));
  }
  add(obstacle, field, Hull3{vertices}, world);
}

struct Reader {
  const char* type;
  void (*add)(const JsonField& obstacle, World3& world);
};
constexpr Reader kReaders[] = {{"box", add_box},
                               {"cylinder", add_cylinder},
                               {"sphere", add_sphere},
                               {"capsule", add_capsule},
                               {"hull", add_hull}};

void add_obstacle(const JsonField& obstacle, World3& world) {
  constexpr const char* kTypes = "\"box\", \"cylinder\", \"sphere\", \"capsule\" or \"hull\"";
  if (!obstacle.value().is_object()) obstacle.fail("an object");
  const JsonField type = obstacle.at("type", kTypes);
  const auto* const reader =
      std::find_if(std::begin(kReaders), std::end(kReaders),
                   [&](const Reader& candidate) { return type.value() == candidate.type; });
  if (reader == std::end(kReaders)) type.fail(kTypes);
  reader->add(obstacle, world);
  check_zeros(obstacle, "velocity", 3, "[0, 0, 0]: moving obstacles are not supported");
}

}  // namespace

Pose3 read_pose(const JsonField& object) {
  constexpr const char* kAllowed = "[x, y, z, w], four numbers from -1e6 to 1e6 of norm 1 +- 1e-3";
  constexpr double kNormTolerance = 1e-3;
  Pose3 pose;
  pose.position = read_three(object.at("position", kPoint3Allowed), kCoordinate, kPoint3Allowed);
  const std::optional<JsonField> field = object.find("quaternion_xyzw");
  if (!field) return pose;
  field->check_array(4, 4, kAllowed);
  Eigen::Vector4d xyzw;
  for (int i = 0; i < 4; ++i) {
    xyzw[i] = (*field)[static_cast<std::size_t>(i)].number(kCoordinate);
  }
  if (!(std::abs(xyzw.norm() - 1.0) <= kNormTolerance)) field->fail(kAllowed);
  pose.rotation = Eigen::Quaterniond(xyzw).normalized().toRotationMatrix();
  return pose;
}

SpaceWorld read_space_world(const JsonField& root) {
  World3Capacity capacity;
  const auto max_obstacles = static_cast<std::size_t>(capacity.max_obstacles);
  const std::string allowed = "an array of at most " + std::to_string(max_obstacles) + " obstacles";
  const JsonField obstacles = root.at("obstacles", allowed);
  obstacles.check_array(0, max_obstacles, allowed);
  capacity.max_obstacles = std::max(1, static_cast<int>(obstacles.size()));
  capacity.max_hulls = std::min(capacity.max_hulls, capacity.max_obstacles);
  SpaceWorld result;
  result.memory = std::make_unique<MemoryBlock>(World3::required_bytes(capacity));
  Arena arena(*result.memory);
  result.world = std::make_unique<World3>(arena, capacity);
  if (arena.exhausted()) throw HostError("no memory for the obstacles");
  result.world->reset();
  for (std::size_t i = 0; i < obstacles.size(); ++i) add_obstacle(obstacles[i], *result.world);
  result.world->build();
  return result;
}

}  // namespace sopt
