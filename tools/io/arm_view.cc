#include "tools/io/arm_view.h"

#include <algorithm>
#include <limits>

#include "models/space/clearance3.h"
#include "tools/io/space_page.h"

namespace sopt {
namespace {

// Share of the arm at its ends and of the tool's path that is hidden, and of the path's length that
// is lost because it leads to or from the viewer.
double cost_of(const ArmPicture& picture, const SpaceView& view) {
  constexpr double kFar_m = 100.0;
  int num_points = 0;
  int num_hidden = 0;
  const auto sight_from = [&](const Vec3& p) {
    ++num_points;
    return Capsule3{p, p + kFar_m * view.toward_viewer(), 0.0};
  };
  const auto is_behind_obstacle = [&](const Capsule3& sight) {
    return picture.world->nearest(sight, 0.0).i_obstacle != kNoObstacle;
  };
  // Not by the last links, which hold the tool.
  const auto is_behind_arm = [&](const Capsule3& sight) {
    for (const auto* arm : {&picture.start, &picture.goal}) {
      const int i_last = arm->empty() ? 0 : arm->back().i_link;
      for (const auto& [i_link, capsule] : *arm) {
        if (i_link < i_last - 2 && is_within(to_convex(sight), capsule, 0.0)) return true;
      }
    }
    return false;
  };
  for (const auto* arm : {&picture.start, &picture.goal}) {
    for (const auto& [i_link, capsule] : *arm) {
      if (is_behind_obstacle(sight_from(0.5 * (capsule.p0 + capsule.p1)))) ++num_hidden;
    }
  }
  double length_m = 1e-9;
  double seen_m = 0.0;
  for (std::size_t i = 0; i < picture.tool_path.size(); ++i) {
    const Capsule3 sight = sight_from(picture.tool_path[i]);
    if (is_behind_obstacle(sight) || is_behind_arm(sight)) ++num_hidden;
    if (i == 0) continue;
    const Vec3 piece = picture.tool_path[i] - picture.tool_path[i - 1];
    length_m += piece.norm();
    seen_m += view.at(piece).norm();
  }
  return static_cast<double>(num_hidden) / std::max(1, num_points) + 1.0 - seen_m / length_m;
}

}  // namespace

std::vector<Aabb3> shown_boxes(const ArmPicture& picture) {
  std::vector<Aabb3> boxes;
  const auto include = [&](const std::vector<PlacedCapsule>& arm) {
    for (const PlacedCapsule& placed : arm) boxes.push_back(bounding_box(placed.capsule));
  };
  include(picture.start);
  include(picture.goal);
  for (const auto& arm : picture.between) include(arm);
  for (const Vec3& p : picture.tool_path) boxes.push_back({p, p});
  if (boxes.empty()) boxes.push_back({Vec3::Constant(-0.5), Vec3::Constant(0.5)});
  Aabb3 limit = boxes.front();
  for (const Aabb3& box : boxes) limit = joined(limit, box);
  const Vec3 more = Vec3::Constant((limit.upper - limit.lower).maxCoeff());
  limit = {limit.lower - more, limit.upper + more};
  for (int i = 0; i < picture.world->num_obstacles(); ++i) {
    const Aabb3& box = picture.world->obstacle_box(i);
    const Aabb3 part = {box.lower.cwiseMax(limit.lower), box.upper.cwiseMin(limit.upper)};
    if ((part.lower.array() <= part.upper.array()).all()) boxes.push_back(part);
  }
  return boxes;
}

SpaceView best_view(const ArmPicture& picture) {
  int i_best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (const int i_corner : {3, 0, 1, 2}) {
    const double cost = cost_of(picture, SpaceView(i_corner));
    if (cost >= least) continue;
    least = cost;
    i_best = i_corner;
  }
  return SpaceView(i_best);
}

}  // namespace sopt
