#include "tests/support/test_problem.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "tests/support/test_world.h"

namespace sopt::oracle {
namespace {

double distance_to_segment(const Vec2& z, const Vec2& p, const Vec2& q) {
  const double length2 = (q - p).squaredNorm();
  if (length2 == 0.0) return (z - p).norm();
  const double s = std::clamp((z - p).dot(q - p) / length2, 0.0, 1.0);
  return (z - (p + s * (q - p))).norm();
}

}  // namespace

std::vector<Vec2> copy_of(std::span<const Vec2> points) { return {points.begin(), points.end()}; }

bool same_bytes(std::span<const Vec2> a, std::span<const Vec2> b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

std::string to_text(std::span<const Vec2> points) {
  std::string text = "[";
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0) text += ",";
    text += to_text(points[i]);
  }
  return text + "]";
}

double length_of(std::span<const Vec2> points) {
  double sum = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) sum += (points[i] - points[i - 1]).norm();
  return sum;
}

double cost_of(std::span<const Vec2> points, double ds_m) {
  double sum = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) sum += (points[i] - points[i - 1]).squaredNorm();
  return sum / ds_m;
}

MarginProfile plain_profile(double margin_m, double floor_m) {
  MarginProfile profile;
  profile.rule.margin_m = margin_m;
  profile.rule.floor_m = floor_m;
  return profile;
}

SceneOracle::SceneOracle(const Scene& scene) : bounds_(scene.bounds) {
  for (const Obstacle& obstacle : scene.obstacles) {
    Item item;
    item.outline = outline_of(obstacle.shape);
    for (const Vec2& v : item.outline.vertices) item.center += v;
    item.center /= static_cast<double>(item.outline.vertices.size());
    for (const Vec2& v : item.outline.vertices) {
      item.reach_m = std::max(item.reach_m, (v - item.center).norm() + item.outline.radius_m);
    }
    item.margin_m = obstacle.margin_m;
    items_.push_back(item);
  }
}

double SceneOracle::slack(const Vec2& p, const Vec2& q, double radius_m,
                          const ClearanceRule& rule) const {
  const double walls_m = std::min(wall_distance(bounds_, p), wall_distance(bounds_, q));
  double best_m = walls_m - radius_m - rule.required_m(kDefaultMargin);
  for (const Item& item : items_) {
    const double wanted_m = radius_m + rule.required_m(item.margin_m);
    if (distance_to_segment(item.center, p, q) - item.reach_m - wanted_m > best_m) continue;
    best_m = std::min(best_m, min_point_distance(item.outline, p, q) - wanted_m);
  }
  return best_m;
}

double SceneOracle::clearance(const Vec2& p, const Vec2& q, double radius_m) const {
  return slack(p, q, radius_m, ClearanceRule{.cap_m = 0.0});
}

double SceneOracle::path_slack(std::span<const Vec2> vertices, double radius_m,
                               const MarginProfile& profile) const {
  double best_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < vertices.size(); ++i) {
    const Vec2& a = vertices[i - 1];
    const Vec2& b = vertices[i];
    const double length = (b - a).norm();
    const double start_reach = i == 1 ? profile.start_reach() : 0.0;
    const double goal_reach = i + 1 == vertices.size() ? profile.goal_reach() : 0.0;
    const double leave = length > 0.0 ? std::min(1.0, start_reach / length) : 1.0;
    const double arrive = length > 0.0 ? std::max(leave, 1.0 - goal_reach / length) : 1.0;
    const Vec2 left = a + leave * (b - a);
    const Vec2 back = a + arrive * (b - a);
    if (start_reach > 0.0) best_m = std::min(best_m, slack(a, left, radius_m, profile.at_start()));
    if (arrive > leave) best_m = std::min(best_m, slack(left, back, radius_m, profile.rule));
    if (arrive < 1.0) best_m = std::min(best_m, slack(back, b, radius_m, profile.at_goal()));
  }
  return best_m;
}

double SceneOracle::trajectory_slack(std::span<const Vec2> states, double radius_m,
                                     const MarginProfile& profile) const {
  const int horizon = static_cast<int>(states.size()) - 1;
  double best_m = std::numeric_limits<double>::infinity();
  for (int t = 0; t < horizon; ++t) {
    const auto i = static_cast<std::size_t>(t);
    best_m =
        std::min(best_m, slack(states[i], states[i + 1], radius_m, profile.at_step(t, horizon)));
  }
  return best_m;
}

double SceneOracle::min_clearance(std::span<const Vec2> states, double radius_m) const {
  double best_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < states.size(); ++i) {
    best_m = std::min(best_m, clearance(states[i - 1], states[i], radius_m));
  }
  return best_m;
}

std::vector<Vec2> cut_into_steps(std::span<const Vec2> vertices, double step_m) {
  std::vector<Vec2> states = {vertices.front()};
  for (std::size_t i = 1; i < vertices.size(); ++i) {
    const Vec2 edge = vertices[i] - vertices[i - 1];
    int num_steps = std::max(1, static_cast<int>(std::ceil(edge.norm() / step_m)));
    if (vertices.size() == 2) num_steps = std::max(num_steps, 2);
    for (int k = 1; k < num_steps; ++k) {
      states.push_back(vertices[i - 1] + edge * (static_cast<double>(k) / num_steps));
    }
    states.push_back(vertices[i]);
  }
  return states;
}

std::vector<Vec2> random_polyline(Random& random, const Aabb2& box, int num_vertices) {
  std::vector<Vec2> points;
  for (int i = 0; i < num_vertices; ++i) points.push_back(random.point(box));
  return points;
}

Scene random_scene_around(Random& random, const Aabb2& bounds, std::span<const Vec2> polyline,
                          int num_tries, double size_m, double keep_m) {
  Scene scene;
  scene.bounds = bounds;
  for (int i = 0; i < num_tries; ++i) {
    const Obstacle obstacle = {random_shape(random, random.point(bounds), size_m), kDefaultMargin};
    const Outline outline = outline_of(obstacle.shape);
    bool is_near = false;
    for (std::size_t k = 1; k < polyline.size() && !is_near; ++k) {
      is_near = min_point_distance(outline, polyline[k - 1], polyline[k]) < keep_m;
    }
    if (!is_near) scene.obstacles.push_back(obstacle);
  }
  return scene;
}

Scene room_with_gap(double gap_m) {
  Scene scene;
  scene.bounds = {Vec2::Zero(), Vec2(10.0, 6.0)};
  const double low_m = 3.0 - 0.5 * gap_m;
  const double high_m = 3.0 + 0.5 * gap_m;
  if (gap_m <= 0.0) {
    scene.obstacles.push_back({box_between({4.9, -0.5}, {5.1, 6.5}), kDefaultMargin});
    return scene;
  }
  scene.obstacles.push_back({box_between({4.9, -0.5}, {5.1, low_m}), kDefaultMargin});
  scene.obstacles.push_back({box_between({4.9, high_m}, {5.1, 6.5}), kDefaultMargin});
  return scene;
}

Scene narrow_corridor(double width_m) {
  Scene scene;
  scene.bounds = {Vec2::Zero(), Vec2(10.0, 6.0)};
  const double low_m = 3.0 - 0.5 * width_m;
  const double high_m = 3.0 + 0.5 * width_m;
  for (int i = 1; i < 99; ++i) {
    const double x = 0.1 * i;
    const Box2 below = box_between({x, low_m - 1.0}, {x + 0.1, low_m});
    const Box2 above = box_between({x, high_m}, {x + 0.1, high_m + 1.0});
    scene.obstacles.push_back({below, kDefaultMargin});
    scene.obstacles.push_back({above, kDefaultMargin});
  }
  return scene;
}

std::vector<Vec2> zigzag_in_corridor(double step_m, double amplitude_m) {
  const int num_steps = static_cast<int>(std::lround(8.0 / step_m));
  std::vector<Vec2> states;
  for (int t = 0; t <= num_steps; ++t) {
    const bool is_end = t == 0 || t == num_steps;
    const double side = is_end ? 0.0 : t % 2 == 0 ? 1.0 : -1.0;
    states.emplace_back(1.0 + 8.0 * t / num_steps, 3.0 + side * amplitude_m);
  }
  return states;
}

}  // namespace sopt::oracle
