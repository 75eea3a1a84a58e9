#include "tools/scenes/generated_scene.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>

namespace sopt {
namespace {

using Point = std::array<double, 2>;

constexpr double kCell_m = 0.05;
constexpr double kFloodMargin_m = 0.05;

std::array<Point, 2> bounding_box(const GeneratedObstacle& obstacle) {
  const double r = obstacle.radius_m;
  Point lower{obstacle.center_m[0] - r, obstacle.center_m[1] - r};
  Point upper{obstacle.center_m[0] + r, obstacle.center_m[1] + r};
  if (!obstacle.outline_m.empty()) lower = upper = obstacle.outline_m.front();
  for (const Point& vertex : obstacle.outline_m) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
      lower[axis] = std::min(lower[axis], vertex[axis]);
      upper[axis] = std::max(upper[axis], vertex[axis]);
    }
  }
  return {lower, upper};
}

// Occupancy of the cells with centres ((i + 1/2) cell, (j + 1/2) cell).
class Grid {
 public:
  explicit Grid(const GeneratedScene& scene)
      : num_x_(static_cast<int>(std::lround(scene.size_m[0] / kCell_m))),
        num_y_(static_cast<int>(std::lround(scene.size_m[1] / kCell_m))),
        is_blocked_(static_cast<std::size_t>(num_x_) * static_cast<std::size_t>(num_y_)) {
    const double inflation_m =
        scene.radius_m + kFloodMargin_m + 0.5 * std::numbers::sqrt2 * kCell_m;
    for (int j = 0; j < num_y_; ++j) {
      for (int i = 0; i < num_x_; ++i) {
        const double x = center(i);
        const double y = center(j);
        is_blocked_[index(i, j)] =
            std::min({x, y, scene.size_m[0] - x, scene.size_m[1] - y}) < inflation_m;
      }
    }
    for (const GeneratedObstacle& obstacle : scene.obstacles) block_near(obstacle, inflation_m);
  }

  // 4-connected flood; marks what it reaches as blocked.
  bool flood_joins(const Point& from, const Point& to) {
    const std::array<int, 2> goal{cell(to[0]), cell(to[1])};
    std::vector<std::array<int, 2>> open{{cell(from[0]), cell(from[1])}};
    while (!open.empty()) {
      const auto [i, j] = open.back();
      open.pop_back();
      if (i < 0 || j < 0 || i >= num_x_ || j >= num_y_ || is_blocked_[index(i, j)]) continue;
      if (i == goal[0] && j == goal[1]) return true;
      is_blocked_[index(i, j)] = true;
      open.insert(open.end(), {{i - 1, j}, {i + 1, j}, {i, j - 1}, {i, j + 1}});
    }
    return false;
  }

 private:
  static double center(int i) { return (i + 0.5) * kCell_m; }
  static int cell(double coordinate_m) { return static_cast<int>(coordinate_m / kCell_m); }
  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(num_x_) +
           static_cast<std::size_t>(i);
  }
  void block_near(const GeneratedObstacle& obstacle, double limit_m) {
    const auto [lower, upper] = bounding_box(obstacle);
    const int last_i = std::min(cell(std::max(upper[0] + limit_m, 0.0)), num_x_ - 1);
    const int last_j = std::min(cell(std::max(upper[1] + limit_m, 0.0)), num_y_ - 1);
    for (int j = cell(std::max(lower[1] - limit_m, 0.0)); j <= last_j; ++j) {
      for (int i = cell(std::max(lower[0] - limit_m, 0.0)); i <= last_i; ++i) {
        if (signed_distance_m(obstacle, center(i), center(j)) < limit_m) {
          is_blocked_[index(i, j)] = true;
        }
      }
    }
  }

  int num_x_;
  int num_y_;
  std::vector<bool> is_blocked_;
};

void append(std::string& text, double value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  text.append(digits.data(), end);
}

void append(std::string& text, const Point& point) {
  text += '[';
  append(text, point[0]);
  text += ", ";
  append(text, point[1]);
  text += ']';
}

void append(std::string& text, const GeneratedObstacle& obstacle) {
  switch (obstacle.kind) {
    case GeneratedObstacle::Kind::kDisc:
      text += R"({"type": "disc", "center": )";
      append(text, obstacle.center_m);
      text += R"(, "radius": )";
      append(text, obstacle.radius_m);
      break;
    case GeneratedObstacle::Kind::kBox:
      text += R"({"type": "box", "center": )";
      append(text, obstacle.center_m);
      text += R"(, "size": )";
      append(text, obstacle.size_m);
      text += R"(, "angle": )";
      append(text, obstacle.angle_rad);
      break;
    case GeneratedObstacle::Kind::kPolygon:
      text += R"({"type": "polygon", "vertices": [)";
      for (std::size_t i = 0; i < obstacle.outline_m.size(); ++i) {
        if (i > 0) text += ", ";
        append(text, obstacle.outline_m[i]);
      }
      text += ']';
      break;
  }
  text += '}';
}

}  // namespace

double signed_distance_m(const GeneratedObstacle& obstacle, double x_m, double y_m) {
  if (obstacle.kind == GeneratedObstacle::Kind::kDisc) {
    return std::hypot(x_m - obstacle.center_m[0], y_m - obstacle.center_m[1]) - obstacle.radius_m;
  }
  double nearest_m = std::numeric_limits<double>::infinity();
  bool is_inside = true;
  for (std::size_t i = 0; i < obstacle.outline_m.size(); ++i) {
    const Point& a = obstacle.outline_m[i];
    const Point& b = obstacle.outline_m[(i + 1) % obstacle.outline_m.size()];
    const double edge_x = b[0] - a[0];
    const double edge_y = b[1] - a[1];
    const double to_x = x_m - a[0];
    const double to_y = y_m - a[1];
    if (edge_x * to_y - edge_y * to_x < 0.0) is_inside = false;
    const double share =
        std::clamp((edge_x * to_x + edge_y * to_y) / (edge_x * edge_x + edge_y * edge_y), 0.0, 1.0);
    nearest_m = std::min(nearest_m, std::hypot(to_x - share * edge_x, to_y - share * edge_y));
  }
  return is_inside ? -nearest_m : nearest_m;
}

bool is_solvable(const GeneratedScene& scene) {
  return Grid(scene).flood_joins(scene.start_m, scene.goal_m);
}

std::string to_json_text(const GeneratedScene& scene) {
  std::string text = "{\n  \"name\": \"" + scene.name + '"';
  text += ",\n  \"x_generator\": \"sopt_make_scenes\"";
  text += ",\n  \"x_seed\": " + std::to_string(scene.seed);
  text += ",\n  \"x_unsolvable_candidates_dropped\": " + std::to_string(scene.num_dropped);
  text += ",\n  \"num_obstacles\": " + std::to_string(scene.obstacles.size());
  text += ",\n  \"robot\": \"point2d\",\n  \"radius\": ";
  append(text, scene.radius_m);
  text += ",\n  \"bounds\": [0, 0, ";
  append(text, scene.size_m[0]);
  text += ", ";
  append(text, scene.size_m[1]);
  text += "],\n  \"start\": ";
  append(text, scene.start_m);
  text += ",\n  \"goal\": ";
  append(text, scene.goal_m);
  text += ",\n  \"obstacles\": [";
  for (std::size_t i = 0; i < scene.obstacles.size(); ++i) {
    text += i == 0 ? "\n    " : ",\n    ";
    append(text, scene.obstacles[i]);
  }
  text += "\n  ]\n}\n";
  return text;
}

}  // namespace sopt
