#include "tools/io/scene_file.h"

#include <algorithm>
#include <cmath>

#include "opt/reference.h"
#include "tools/io/input_error.h"
#include "tools/io/json_fields.h"
#include "tools/io/scene_fields.h"

namespace sopt {
namespace {

constexpr NumberRule kAngle{-1e3, 1e3, "a number from -1000 to 1000, in rad"};

double diagonal_m(const Scene& scene) {
  return (scene.world->bounds().upper - scene.world->bounds().lower).norm();
}

// The scene's values over the defaults.
PlanOptions make_options(const Scene& scene) {
  PlanOptions options;
  options.speed_mps = scene.speed_mps.value_or(options.speed_mps);
  options.dt_s = scene.dt_s.value_or(options.dt_s);
  options.margin_m = scene.margin_m.value_or(options.margin_m);
  options.min_clearance_m = scene.min_clearance_m.value_or(options.min_clearance_m);
  return options;
}

[[noreturn]] void fail_world(const JsonField& shape, WorldStatus status) {
  constexpr const char* kPolygon =
      "an array of 3 to 16 [x, y] that is convex, counter-clockwise and encloses an area";
  switch (status) {
    case WorldStatus::kBadVertexCount:
      shape.fail_as("has " + std::to_string(shape.size()) + " vertices", kPolygon);
    case WorldStatus::kNotConvex:
      shape.fail_as("is not convex", kPolygon);
    case WorldStatus::kClockwise:
      shape.fail_as("is clockwise", kPolygon);
    case WorldStatus::kDegenerate:
      shape.fail_as("encloses no area or repeats a vertex", kPolygon);
    case WorldStatus::kTooManyObstacles:
    case WorldStatus::kTooManyVertices:
      shape.fail_as("is one too many",
                    "among at most " + std::to_string(WorldCapacity{}.max_vertices) +
                        " vertices, every obstacle's rounded up to a multiple of 4");
    case WorldStatus::kBadSize:
    case WorldStatus::kBadRotation:
    case WorldStatus::kNotFinite:
    case WorldStatus::kBadBounds:
    case WorldStatus::kNotReset:
    case WorldStatus::kOk:
      break;  // checked field by field before
  }
  shape.fail("a shape with an extent");
}

Aabb2 read_bounds(const JsonField& scene) {
  constexpr const char* kAllowed =
      "[xmin, ymin, xmax, ymax] with xmin < xmax and ymin < ymax, from -1e6 to 1e6";
  const JsonField field = scene.at("bounds", kAllowed);
  field.check_array(4, 4, kAllowed);
  double b[4];
  for (std::size_t i = 0; i < 4; ++i) b[i] = field[i].number(kCoordinate);
  if (!(b[0] < b[2]) || !(b[1] < b[3])) field.fail(kAllowed);
  return {Vec2(b[0], b[1]), Vec2(b[2], b[3])};
}

Vec2 read_point(const JsonField& object, const char* name) {
  return object.at(name, kPointAllowed).point();
}

Polygon2 read_polygon(const JsonField& vertices) {
  Polygon2 polygon;
  vertices.check_array(3, kMaxPolygonVertices, "an array of 3 to 16 [x, y]");
  for (std::size_t i = 0; i < vertices.size(); ++i) polygon.vertices[i] = vertices[i].point();
  polygon.num_vertices = static_cast<int>(vertices.size());
  return polygon;
}

void add_disc(const JsonField& obstacle, World2& world) {
  obstacle.check_fields({"type", "center", "radius", "id", "margin", "velocity"}, is_documentary);
  const Disc disc{read_point(obstacle, "center"), obstacle.number_at("radius", kPositive)};
  const WorldStatus status = world.try_add(disc, read_margin(obstacle));
  if (status != WorldStatus::kOk) fail_world(obstacle, status);
}

void add_box(const JsonField& obstacle, World2& world) {
  obstacle.check_fields({"type", "center", "size", "angle", "id", "margin", "velocity"},
                        is_documentary);
  constexpr const char* kAllowed = "[width, height], two numbers > 0, from 1e-9 to 1e6";
  const JsonField size = obstacle.at("size", kAllowed);
  const Box2 box{read_point(obstacle, "center"), size.pair(kPositive, kAllowed),
                 obstacle.find_number("angle", kAngle).value_or(0.0)};
  const WorldStatus status = world.try_add(box, read_margin(obstacle));
  if (status == WorldStatus::kDegenerate || status == WorldStatus::kNotConvex) {
    size.fail("large enough to be more than a line at the box's center");
  }
  if (status != WorldStatus::kOk) fail_world(obstacle, status);
}

void add_polygon(const JsonField& obstacle, World2& world) {
  obstacle.check_fields({"type", "vertices", "id", "margin", "velocity"}, is_documentary);
  const JsonField vertices = obstacle.at("vertices", "an array of 3 to 16 [x, y]");
  const WorldStatus status = world.try_add(read_polygon(vertices), read_margin(obstacle));
  if (status != WorldStatus::kOk) fail_world(vertices, status);
}

void add_obstacle(const JsonField& obstacle, World2& world) {
  constexpr const char* kTypes = "\"disc\", \"box\" or \"polygon\"";
  if (!obstacle.value().is_object()) obstacle.fail("an object");
  const JsonField type_field = obstacle.at("type", kTypes);
  const nlohmann::json& type = type_field.value();
  if (type == "disc") {
    add_disc(obstacle, world);
  } else if (type == "box") {
    add_box(obstacle, world);
  } else if (type == "polygon") {
    add_polygon(obstacle, world);
  } else {
    type_field.fail(kTypes);
  }
  check_zeros(obstacle, "velocity", 2, "[0, 0]: moving obstacles are not supported");
}

void read_world(const JsonField& root, Scene& scene) {
  WorldCapacity capacity;
  const auto max_obstacles = static_cast<std::size_t>(capacity.max_obstacles);
  const std::string allowed = "an array of at most " + std::to_string(max_obstacles) + " obstacles";
  const Aabb2 bounds = read_bounds(root);
  const JsonField obstacles = root.at("obstacles", allowed);
  obstacles.check_array(0, max_obstacles, allowed);
  capacity.max_obstacles = std::max(1, static_cast<int>(obstacles.size()));
  capacity.max_vertices =
      std::min(capacity.max_vertices, kMaxPolygonVertices * capacity.max_obstacles);

  scene.memory = std::make_unique<MemoryBlock>(World2::required_bytes(capacity));
  Arena arena(*scene.memory);
  scene.world = std::make_unique<World2>(arena, capacity);
  if (arena.exhausted()) throw HostError("no memory for the obstacles of " + scene.file.string());
  if (scene.world->reset(bounds) != WorldStatus::kOk) root.at("bounds", "").fail("a rectangle");

  for (std::size_t i = 0; i < obstacles.size(); ++i) add_obstacle(obstacles[i], *scene.world);
  scene.obstacle_ids = read_ids(obstacles);
  scene.world->build();
}

void check_velocity(const JsonField& root, const char* name, double v_max_mps) {
  const std::optional<JsonField> velocity = root.find(name);
  if (!velocity) return;
  constexpr const char* kAllowed = "[vx, vy], two numbers from -1e6 to 1e6";
  if (velocity->pair(kCoordinate, kAllowed).norm() > v_max_mps) {
    velocity->fail("at most as fast as limits.v_max, " + show(v_max_mps) + " m/s");
  }
}

void read_motion(const JsonField& root, Scene& scene) {
  if (const std::optional<JsonField> limits = root.find("limits")) {
    limits->check_fields({"v_max"});
    const std::optional<double> v_max_mps = limits->find_number("v_max", kPositive);
    if (v_max_mps) scene.robot.v_max_mps = *v_max_mps;
  }
  check_velocity(root, "start_velocity", scene.robot.v_max_mps);
  check_velocity(root, "goal_velocity", scene.robot.v_max_mps);
  scene.speed_mps = root.find_number("speed", kPositive);
  if (scene.speed_mps && *scene.speed_mps > scene.robot.v_max_mps) {
    root.find("speed")->fail("at most limits.v_max, " + show(scene.robot.v_max_mps));
  }
  scene.dt_s = root.find_number("dt", kPositive);
  scene.margin_m = root.find_number("margin", kNotNegative);
  scene.min_clearance_m = root.find_number("min_clearance", kPositive);
  check_margins(root, make_options(scene));
}

}  // namespace

Scene load_scene(const std::filesystem::path& file) {
  const nlohmann::json json = load_json(file);
  const std::string shown = printable(file.string(), 400);
  return read_scene(JsonField(json, shown), file);
}

Scene read_scene(const JsonField& root, const std::filesystem::path& file) {
  constexpr const char* kRobots = "\"point2d\", the only robot supported";
  if (!root.value().is_object()) root.fail("an object");
  Scene scene;
  scene.file = file;
  const JsonField robot = root.at("robot", kRobots);
  if (robot.value() != "point2d") robot.fail(kRobots);
  scene.robot_name = "point2d";
  root.check_fields({"name", "robot", "radius", "bounds", "start", "goal", "obstacles", "speed",
                     "dt", "margin", "min_clearance", "limits", "start_velocity", "goal_velocity"},
                    is_documentary_in_scene);
  scene.name = read_scene_name(root, file.stem().string());
  scene.robot.radius_m = root.number_at("radius", kNotNegative);
  scene.start = read_point(root, "start");
  scene.goal = read_point(root, "goal");
  read_motion(root, scene);
  read_world(root, scene);
  const std::optional<JsonField> reference = root.find("reference_feasible_length");
  if (reference && reference->value().is_number()) {
    scene.reference_feasible_length = reference->value().get<double>();
  }
  return scene;
}

PlanRequest<Point2> make_request(const Scene& scene) {
  PlanRequest<Point2> request;
  request.start = scene.start;
  request.goal = scene.goal;
  request.world = scene.world.get();
  request.options = make_options(scene);
  return request;
}

PlannerSettings make_settings(const Scene& scene, const PlanOptions& options) {
  // A path through clutter is rarely longer than 6 diagonals; windows bound what can be optimised.
  constexpr double kLongestPathInDiagonals = 6.0;
  PlannerSettings settings;
  settings.nodes_per_stream = std::max(settings.nodes_per_stream, options.num_samples);
  settings.max_window = std::max(settings.max_window, options.max_window);
  // Rows grow with the window; the default room is for the default window.
  settings.rows_per_window *= std::max(1, settings.max_window / PlannerSettings().max_window);
  settings.dense_solver = options.solver == WindowSolver::kDense;
  if (options.num_streams > 0) settings.num_streams = options.num_streams;
  const double step_m = choose_step_length(scene.robot, *scene.world, options);
  const double num_steps = kLongestPathInDiagonals * diagonal_m(scene) / step_m;
  const double most = kMaxSegments * settings.max_window;
  settings.max_horizon =
      std::max(settings.max_horizon, static_cast<int>(std::min(num_steps, most)));
  return settings;
}

std::string obstacle_name(const Scene& scene, int i_obstacle) {
  return obstacle_name(scene.obstacle_ids, i_obstacle);
}

}  // namespace sopt
