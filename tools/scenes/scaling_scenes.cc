#include "tools/scenes/scaling_scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "sampler/rng.h"
#include "tools/io/input_error.h"

namespace sopt {
namespace {

constexpr double kDt_s = 0.1;

using Shape = std::variant<Disc, Box2, Polygon2>;

double uniform(CounterRng& rng, double lower, double upper) {
  return lower + (upper - lower) * rng.next_uniform();
}

// What a scene is made from.
struct Draft {
  Vec2 size_m = Vec2::Zero();
  Vec2 start = Vec2::Zero();
  Vec2 goal = Vec2::Zero();
  double radius_m = 0.0;
  double margin_m = 0.0;
  double step_m = 0.0;
  std::vector<Shape> shapes;
  std::vector<Vec2> way;
};

// --- corridor

constexpr double kRoom_m = 8.0;            // between walls
constexpr double kRoomHeight_m = 10.0;     // of the strip
constexpr double kGap_m = 1.6;             // left by a wall
constexpr double kWall_m = 0.6;            // thickness
constexpr double kBesideWall_m = 1.1;      // the known way, from the middle of a wall
constexpr double kStepsPerRoom = 31.0;     // of a plan, measured
constexpr double kCorridorRadius_m = 0.2;  // of the robot, in the maze too

Draft draft_corridor(int num_steps, CounterRng& rng) {
  const int num_walls = std::max(1, static_cast<int>(std::lround(num_steps / kStepsPerRoom)));
  Draft draft;
  draft.size_m = {kRoom_m * (num_walls + 1), kRoomHeight_m};
  draft.start = {0.5 * kRoom_m, 0.5 * kRoomHeight_m};
  draft.goal = draft.size_m - draft.start;
  draft.radius_m = kCorridorRadius_m;
  draft.margin_m = PlanOptions{}.margin_m;
  draft.step_m = kScalingStep_m;
  draft.way = {draft.start, {kBesideWall_m, draft.start.y()}};
  for (int i = 1; i <= num_walls; ++i) {
    const double x = kRoom_m * i + uniform(rng, -0.5, 0.5);
    const double half_gap_m = i % 2 == 0 ? 0.5 * kGap_m : -0.5 * kGap_m;
    const Vec2 center(x, 0.5 * kRoomHeight_m + half_gap_m);
    draft.shapes.emplace_back(Box2{center, {kWall_m, kRoomHeight_m - kGap_m}});
    const double gap_y = i % 2 == 0 ? 0.5 * kGap_m : kRoomHeight_m - 0.5 * kGap_m;
    draft.way.emplace_back(draft.way.back().x(), gap_y);
    draft.way.emplace_back(x + kBesideWall_m, gap_y);
  }
  draft.way.emplace_back(draft.way.back().x(), draft.goal.y());
  draft.way.push_back(draft.goal);
  for (int i = 0; i <= num_walls; ++i) {
    for (const double y : {0.3, 0.7}) {  // beside start and goal, far from walls and gaps
      const Vec2 center(kRoom_m * (i + 0.5) + uniform(rng, -1.0, 1.0), y * kRoomHeight_m);
      draft.shapes.emplace_back(Disc{center, uniform(rng, 0.3, 0.8)});
    }
  }
  return draft;
}

// --- maze

constexpr double kMazeWall_m = 0.3;
constexpr double kStepsPerCell = 5.6;  // of a plan, measured: corners are cut

using Cell = std::array<int, 2>;

Vec2 center_of(const Cell& cell) { return kMazeCell_m * Vec2(cell[0] + 0.5, cell[1] + 0.5); }

class Maze {
 public:
  // Carved depth first.
  Maze(int side, CounterRng& rng)
      : side_(side),
        is_open_(static_cast<std::size_t>(2 * side * side)),
        distance_(is_open_.size() / 2, -1),
        previous_(is_open_.size() / 2) {
    std::vector<Cell> way{{0, 0}};
    distance_[0] = 0;
    while (!way.empty()) {
      const Cell at = way.back();
      std::vector<Cell> next;
      for (const Cell step : {Cell{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        const Cell cell{at[0] + step[0], at[1] + step[1]};
        const bool is_inside = std::min(cell[0], cell[1]) >= 0 && std::max(cell[0], cell[1]) < side;
        if (is_inside && distance_[index(cell)] < 0) next.push_back(cell);
      }
      if (next.empty()) {
        way.pop_back();
        continue;
      }
      way.push_back(next[rng.next_u64() % next.size()]);
      distance_[index(way.back())] = distance_[index(at)] + 1;
      previous_[index(way.back())] = at;
      is_open_[passage(at, way.back())] = true;
    }
  }

  // A cell that many cells from {0, 0}; of several, the first. {0, 0} when there is none.
  [[nodiscard]] Cell cell_at_distance(int distance) const {
    const auto found = std::find(distance_.begin(), distance_.end(), distance);
    const int i = found == distance_.end() ? 0 : static_cast<int>(found - distance_.begin());
    return {i % side_, i / side_};
  }

  // Centers of the cells from {0, 0} to `last`.
  [[nodiscard]] std::vector<Vec2> way_to(Cell last) const {
    std::vector<Vec2> way;
    for (; last != Cell{0, 0}; last = previous_[index(last)]) way.push_back(center_of(last));
    way.push_back(center_of(last));
    std::reverse(way.begin(), way.end());
    return way;
  }

  // Walls as long as they are straight.
  void add_walls(std::vector<Shape>& shapes) const {
    for (std::size_t axis = 0; axis < 2; ++axis) {
      for (int line = 0; line + 1 < side_; ++line) {
        for (int first = 0, last = 0; first < side_; first = last + 1) {
          for (last = first; last < side_ && !is_open_[wall(axis, line, last)];) ++last;
          if (last > first) shapes.emplace_back(wall_box(axis, line, first, last));
        }
      }
    }
  }

 private:
  [[nodiscard]] std::size_t index(const Cell& cell) const {
    return static_cast<std::size_t>(cell[1] * side_ + cell[0]);
  }
  // Between neighbours; each cell owns the passages towards larger coordinates.
  [[nodiscard]] std::size_t passage(const Cell& a, const Cell& b) const {
    return 2 * index(std::min(a, b)) + (a[0] == b[0] ? 1 : 0);
  }
  // Across the axis, after cell `line` along it, at cell `at` of the other axis.
  [[nodiscard]] std::size_t wall(std::size_t axis, int line, int at) const {
    return 2 * index(axis == 0 ? Cell{line, at} : Cell{at, line}) + axis;
  }
  [[nodiscard]] static Box2 wall_box(std::size_t axis, int line, int first, int last) {
    const auto along = static_cast<Eigen::Index>(1 - axis);
    const auto across = static_cast<Eigen::Index>(axis);
    Box2 box;
    box.center[across] = kMazeCell_m * (line + 1);
    box.center[along] = 0.5 * kMazeCell_m * (first + last);
    box.size_m[across] = kMazeWall_m;
    box.size_m[along] = kMazeCell_m * (last - first) + kMazeWall_m;
    return box;
  }

  int side_;
  std::vector<bool> is_open_;
  std::vector<int> distance_;   // in cells, from {0, 0}
  std::vector<Cell> previous_;  // on the way there
};

// As small as holds a way that long, from a third of its cells on the way.
Draft draft_maze(int num_steps, CounterRng& rng) {
  const int distance = std::max(1, static_cast<int>(std::lround(num_steps / kStepsPerCell)));
  Draft draft;
  draft.radius_m = kCorridorRadius_m;
  draft.margin_m = PlanOptions{}.margin_m;
  draft.step_m = kScalingStep_m;
  draft.start = center_of({0, 0});
  for (int side = static_cast<int>(std::ceil(std::sqrt(3.0 * distance)));; ++side) {
    const Maze maze(side, rng);  // ends: a way can be as long as half of the cells
    const Cell goal = maze.cell_at_distance(distance);
    if (goal == Cell{0, 0}) continue;
    draft.size_m = Vec2::Constant(kMazeCell_m * side);
    draft.goal = center_of(goal);
    draft.way = maze.way_to(goal);
    maze.add_walls(draft.shapes);
    return draft;
  }
}

// --- field

// Small against the smallest obstacles, so that what the robot cannot enter stays about constant.
constexpr double kFieldRadius_m = 0.01;
constexpr double kFieldMargin_m = 0.005;
constexpr double kFieldGap_m = 0.05;  // between circles around obstacles, at least
constexpr double kFieldEnd_m = 1.0;   // start and goal, from the corners
constexpr double kFieldSteps = 200.0;

struct RoundedShape {
  Shape shape;
  double reach_m = 0.0;  // from its center
};

// A disc, a box or a regular polygon.
RoundedShape draw_shape(const Vec2& center, double area_m2, CounterRng& rng) {
  const auto kind = rng.next_u64() % 3;
  const double turn_rad = uniform(rng, 0.0, 2.0 * std::numbers::pi);
  if (kind == 0) {
    const double radius_m = std::sqrt(area_m2 / std::numbers::pi);
    return {Disc{center, radius_m}, radius_m};
  }
  if (kind == 1) {
    const double width_m = std::sqrt(area_m2 * uniform(rng, 1.0, 2.0));
    const Vec2 size_m(width_m, area_m2 / width_m);
    return {Box2{center, size_m, turn_rad}, 0.5 * size_m.norm()};
  }
  Polygon2 polygon;
  polygon.num_vertices = 3 + static_cast<int>(rng.next_u64() % 6);
  const double angle_rad = 2.0 * std::numbers::pi / polygon.num_vertices;
  const double reach_m = std::sqrt(2.0 * area_m2 / (polygon.num_vertices * std::sin(angle_rad)));
  for (int i = 0; i < polygon.num_vertices; ++i) {
    const double at_rad = turn_rad + i * angle_rad;
    polygon.vertices[static_cast<std::size_t>(i)] =
        center + reach_m * Vec2(std::cos(at_rad), std::sin(at_rad));
  }
  return {polygon, reach_m};
}

// Areas from half to one and a half of the mean, in pairs that add up to two means.
Draft draft_field(int num_obstacles, CounterRng& rng) {
  Draft draft;
  draft.size_m = Vec2::Constant(kFieldSide_m);
  draft.start = Vec2::Constant(kFieldEnd_m);
  draft.goal = draft.size_m - draft.start;
  draft.radius_m = kFieldRadius_m;
  draft.margin_m = kFieldMargin_m;
  draft.step_m = (draft.goal - draft.start).norm() / kFieldSteps;
  const double mean_m2 = kFieldCover * kFieldSide_m * kFieldSide_m / num_obstacles;
  struct Taken {
    Vec2 center;
    double reach_m;
  };
  std::vector<Taken> taken{{draft.start, 0.0}, {draft.goal, 0.0}};
  double share = 0.0;
  for (int i = 0; i < num_obstacles; ++i) {
    const bool is_last = i % 2 == 0 && i + 1 == num_obstacles;
    share = i % 2 == 1 ? 2.0 - share : (is_last ? 1.0 : uniform(rng, 0.5, 1.5));
    for (;;) {  // ends: little of the square is taken
      // The first one blocks the straight line.
      const Vec2 center(i == 0 ? 0.5 * kFieldSide_m : uniform(rng, 0.0, kFieldSide_m),
                        i == 0 ? 0.5 * kFieldSide_m : uniform(rng, 0.0, kFieldSide_m));
      const RoundedShape drawn = draw_shape(center, share * mean_m2, rng);
      const double to_bounds_m =
          std::min(center.minCoeff(), kFieldSide_m - center.maxCoeff()) - drawn.reach_m;
      const bool is_free =
          to_bounds_m >= kFieldGap_m &&
          std::all_of(taken.begin(), taken.end(), [&](const Taken& other) {
            return (other.center - center).norm() >= other.reach_m + drawn.reach_m + kFieldGap_m;
          });
      if (!is_free) continue;
      taken.push_back({center, drawn.reach_m});
      draft.shapes.push_back(drawn.shape);
      break;
    }
  }
  return draft;
}

// --- all

Draft make_draft(ScalingFamily family, int size, std::uint64_t seed) {
  CounterRng rng(seed, static_cast<std::uint64_t>(family), static_cast<std::uint64_t>(size));
  switch (family) {
    case ScalingFamily::kCorridor:
      return draft_corridor(size, rng);
    case ScalingFamily::kMaze:
      return draft_maze(size, rng);
    case ScalingFamily::kField:
      return draft_field(size, rng);
  }
  return {};
}

void fill(const Draft& draft, Scene& scene) {
  WorldCapacity capacity;
  capacity.max_obstacles = static_cast<int>(draft.shapes.size());
  capacity.max_vertices = 8 * capacity.max_obstacles;
  scene.memory = std::make_unique<MemoryBlock>(World2::required_bytes(capacity));
  Arena arena(*scene.memory);
  scene.world = std::make_unique<World2>(arena, capacity);
  if (arena.exhausted()) throw HostError("no memory for the obstacles of " + scene.name);
  bool ok = scene.world->reset({Vec2::Zero(), draft.size_m}) == WorldStatus::kOk;
  for (const Shape& shape : draft.shapes) {
    const auto add = [&](const auto& s) { return scene.world->try_add(s) == WorldStatus::kOk; };
    ok = std::visit(add, shape) && ok;
  }
  if (!ok) throw std::logic_error(scene.name + ": an obstacle was refused");
  scene.world->build();
}

}  // namespace

const char* to_string(ScalingFamily family) {
  switch (family) {
    case ScalingFamily::kCorridor:
      return "corridor";
    case ScalingFamily::kMaze:
      return "maze";
    case ScalingFamily::kField:
      return "field";
  }
  return "unknown";
}

std::span<const int> scaling_sizes(ScalingFamily family) {
  static constexpr std::array kSteps = {50, 100, 200, 400, 800, 1600, 3000};
  static constexpr std::array kObstacles = {20, 50, 100, 200, 500, 1000, 2000, 5000};
  if (family == ScalingFamily::kField) return kObstacles;
  return kSteps;
}

ScalingScene make_scaling_scene(ScalingFamily family, int size, std::uint64_t seed) {
  const Draft draft = make_draft(family, size, seed);
  ScalingScene result;
  Scene& scene = result.scene;
  scene.name =
      std::string(to_string(family)) + '_' + std::to_string(size) + '_' + std::to_string(seed);
  scene.robot_name = "point2d";
  scene.robot.radius_m = draft.radius_m;
  scene.start = draft.start;
  scene.goal = draft.goal;
  scene.speed_mps = draft.step_m / kDt_s;
  scene.dt_s = kDt_s;
  scene.margin_m = draft.margin_m;
  scene.obstacle_ids.resize(draft.shapes.size());
  fill(draft, scene);
  result.way = draft.way;
  return result;
}

}  // namespace sopt
