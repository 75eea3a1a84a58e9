#include "opt/plane/obstacle_rows.h"

#include <algorithm>
#include <array>

namespace sopt {
namespace {

// Rows of one edge, before they are given to its two waypoints. More obstacles than this near one
// edge means that the trust radius is too large for the clutter: reported as "does not fit".
struct EdgeRows {
  static constexpr std::size_t kCapacity = 64;

  std::array<Vec2, kCapacity> normal{};
  std::array<double, kCapacity> bound{};
  std::size_t count = 0;

  [[nodiscard]] bool try_add(const Vec2& n, double b) noexcept {
    if (count == kCapacity) return false;
    normal[count] = n;
    bound[count++] = b;
    return true;
  }
};

bool add_bounds(const Point2& robot, const World2& world, const ClearanceRule& rule, const Vec2& p,
                const Vec2& q, double trust_m, EdgeRows& out) noexcept {
  const double inset = robot.radius_m + world.required_m(kBoundsObstacle, rule);
  if (world.bounds_distance(p, q) >= inset + trust_m) return true;
  for (int axis = 0; axis < 2; ++axis) {
    const Vec2 inwards = axis == 0 ? Vec2::UnitX() : Vec2::UnitY();
    const double lower = world.bounds().lower[axis] + inset;
    const double upper = world.bounds().upper[axis] - inset;
    if (std::min(p[axis], q[axis]) - lower < trust_m && !out.try_add(inwards, lower)) return false;
    if (upper - std::max(p[axis], q[axis]) < trust_m && !out.try_add(-inwards, -upper)) {
      return false;
    }
  }
  return true;
}

bool find_edge_rows(const Point2& robot, const World2& world, const ClearanceRule& rule,
                    const Vec2& p, const Vec2& q, double trust_m, EdgeRows& out,
                    std::int64_t& num_queries) noexcept {
  const double reach = robot.radius_m + world.max_required_m(rule) + trust_m;
  out.count = 0;
  if (!add_bounds(robot, world, rule, p, q, trust_m, out)) return false;
  return world.for_each_near(p, q, reach, [&](int i) {
    const double inset = robot.radius_m + world.required_m(i, rule);
    Clearance2 c;
    ++num_queries;
    if (!compute_clearance_within(world.obstacle(i), p, q, inset + trust_m, c)) return true;
    return out.try_add(c.normal, c.normal.dot(c.on_obstacle) + inset);
  });
}

bool give(const EdgeRows& edge, int t, PointRows& rows) noexcept {
  for (std::size_t i = 0; i < edge.count; ++i) {
    if (!rows.try_add(t, edge.normal[i], edge.bound[i])) return false;
  }
  return true;
}

}  // namespace

bool make_obstacle_rows(const Point2& robot, const World2& world, const MarginProfile& profile,
                        std::span<const Vec2> states, const Window& window, double trust_m,
                        PointRows& rows, std::int64_t& num_queries) SOPT_RT {
  const auto state = [&](int t) -> const Vec2& {
    return states[static_cast<std::size_t>(window.first + t)];
  };
  const int horizon = static_cast<int>(states.size()) - 1;
  const int n = window.num_steps();
  rows.reset(n, state(0), state(n));
  std::array<EdgeRows, 2> edge;  // of edges (t - 1, t) and (t, t + 1), in turns
  for (int t = 0; t < n; ++t) {
    EdgeRows& after = edge[static_cast<std::size_t>(t % 2)];
    const EdgeRows& before = edge[static_cast<std::size_t>((t + 1) % 2)];
    const ClearanceRule rule = profile.at_step(window.first + t, horizon);
    if (!find_edge_rows(robot, world, rule, state(t), state(t + 1), trust_m, after, num_queries)) {
      return false;
    }
    if (t > 0 && !(give(before, t, rows) && give(after, t, rows))) return false;
  }
  return true;
}

}  // namespace sopt
