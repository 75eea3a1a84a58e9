#include "tools/scenes/scaling_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

namespace sopt {
namespace {

constexpr std::array kFamilies = {ScalingFamily::kCorridor, ScalingFamily::kMaze,
                                  ScalingFamily::kField};
constexpr std::array kLongFamilies = {ScalingFamily::kCorridor, ScalingFamily::kMaze};

double length_of(const std::vector<Vec2>& way) {
  double length = 0.0;
  for (std::size_t i = 1; i < way.size(); ++i) length += (way[i] - way[i - 1]).norm();
  return length;
}

ClearanceRule wanted(const Scene& scene) { return {*scene.margin_m, 1.0, 1e-4}; }

bool is_clear(const Scene& scene, const Vec2& a, const Vec2& b) {
  return scene.robot.motion_is_clear(*scene.world, wanted(scene), a, b);
}

// All vertices, in order.
std::vector<double> coordinates_of(const Scene& scene) {
  std::vector<double> result;
  for (int i = 0; i < scene.world->num_obstacles(); ++i) {
    const ConvexView view = scene.world->obstacle(i);
    result.insert(result.end(), view.x, view.x + view.num_vertices);
    result.insert(result.end(), view.y, view.y + view.num_vertices);
    result.push_back(view.radius_m);
  }
  return result;
}

TEST(ScalingScenesTest, SeedsTellScenesApartAndNothingElseDoes) {
  for (const ScalingFamily family : kFamilies) {
    const std::vector<double> first = coordinates_of(make_scaling_scene(family, 200, 1).scene);
    EXPECT_EQ(coordinates_of(make_scaling_scene(family, 200, 1).scene), first);
    EXPECT_NE(coordinates_of(make_scaling_scene(family, 200, 2).scene), first);
  }
}

TEST(ScalingScenesTest, SizesRunFrom50To3000StepsAndFrom20To5000Obstacles) {
  for (const ScalingFamily family : kFamilies) {
    const auto sizes = scaling_sizes(family);
    EXPECT_TRUE(std::is_sorted(sizes.begin(), sizes.end()));
    EXPECT_EQ(sizes.front(), family == ScalingFamily::kField ? 20 : 50);
    EXPECT_EQ(sizes.back(), family == ScalingFamily::kField ? 5000 : 3000);
  }
}

TEST(ScalingScenesTest, TheKnownWayKeepsTheMarginFromStartToGoal) {
  for (const ScalingFamily family : kLongFamilies) {
    for (const int size : scaling_sizes(family)) {
      for (const std::uint64_t seed : {1, 2, 3}) {
        const ScalingScene made = make_scaling_scene(family, size, seed);
        ASSERT_GE(made.way.size(), 3U);
        EXPECT_EQ(made.way.front(), made.scene.start);
        EXPECT_EQ(made.way.back(), made.scene.goal);
        for (std::size_t i = 1; i < made.way.size(); ++i) {
          EXPECT_TRUE(is_clear(made.scene, made.way[i - 1], made.way[i]))
              << made.scene.name << " motion " << i;
        }
      }
    }
  }
}

TEST(ScalingScenesTest, TheKnownWayIsAsManyStepsPerSizeAtEverySize) {
  for (const ScalingFamily family : kLongFamilies) {
    for (const int size : scaling_sizes(family)) {
      const ScalingScene made = make_scaling_scene(family, size, 1);
      EXPECT_DOUBLE_EQ(*made.scene.speed_mps * *made.scene.dt_s, kScalingStep_m);
      const double steps = length_of(made.way) / kScalingStep_m;
      // It keeps to the middle; short ones are mostly ends.
      EXPECT_NEAR(steps / size, 1.4, size < 400 ? 0.6 : 0.1) << made.scene.name;
    }
  }
}

TEST(ScalingScenesTest, TheStraightLineIsBlocked) {
  for (const ScalingFamily family : kFamilies) {
    for (const int size : scaling_sizes(family)) {
      const ScalingScene made = make_scaling_scene(family, size, 3);
      EXPECT_FALSE(is_clear(made.scene, made.scene.start, made.scene.goal)) << made.scene.name;
    }
  }
}

TEST(ScalingScenesTest, ACorridorHasAsManyObstaclesPerMetreAtEverySize) {
  for (const int size : scaling_sizes(ScalingFamily::kCorridor)) {
    const Scene scene = make_scaling_scene(ScalingFamily::kCorridor, size, 1).scene;
    const double length_m = scene.world->bounds().upper.x();
    EXPECT_EQ(scene.world->num_obstacles(), std::lround(3.0 * length_m / 8.0) - 1);
  }
}

TEST(ScalingScenesTest, AMazeJoinsEveryCellToEveryOtherInOneWay) {
  const Scene scene = make_scaling_scene(ScalingFamily::kMaze, 800, 1).scene;
  const int side = static_cast<int>(std::lround(scene.world->bounds().upper.x() / kMazeCell_m));
  const auto center = [](int i, int j) { return Vec2(kMazeCell_m * Vec2(i + 0.5, j + 0.5)); };
  int num_passages = 0;
  std::set<std::pair<int, int>> reached{{0, 0}};
  std::vector<std::pair<int, int>> open{{0, 0}};
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    for (const auto& [di, dj] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      if (!is_clear(scene, center(i, j), center(i + di, j + dj))) continue;
      ++num_passages;  // seen from both sides
      if (reached.insert({i + di, j + dj}).second) open.emplace_back(i + di, j + dj);
    }
  }
  EXPECT_EQ(reached.size(), static_cast<std::size_t>(side * side));
  EXPECT_EQ(num_passages, 2 * (side * side - 1));
}

TEST(ScalingScenesTest, AFieldHasThatManyObstaclesWhichCoverATenth) {
  for (const int size : scaling_sizes(ScalingFamily::kField)) {
    const ScalingScene made = make_scaling_scene(ScalingFamily::kField, size, 1);
    EXPECT_EQ(made.scene.world->num_obstacles(), size);
    EXPECT_TRUE(made.way.empty());
    constexpr int kGrid = 400;
    int num_covered = 0;
    for (int i = 0; i < kGrid * kGrid; ++i) {
      const Vec2 point = kFieldSide_m / kGrid * Vec2(i % kGrid + 0.5, i / kGrid + 0.5);
      num_covered += made.scene.world->nearest(point, point, 0.01).distance_m < 0.0 ? 1 : 0;
    }
    EXPECT_NEAR(num_covered / (1.0 * kGrid * kGrid), kFieldCover, 0.003) << size;
  }
}

TEST(ScalingScenesTest, EveryGapInAFieldCanBePassed) {
  const Scene scene = make_scaling_scene(ScalingFamily::kField, 500, 2).scene;
  const double needed_m = 2.0 * (scene.robot.radius_m + *scene.margin_m);
  for (int i = 0; i < scene.world->num_obstacles(); ++i) {
    const ConvexView view = scene.world->obstacle(i);
    for (int k = 0; k < view.num_vertices; ++k) {
      const Vec2 p(view.x[k], view.y[k]);
      const Vec2 q = p + Vec2(view.edge_x[k], view.edge_y[k]);
      (void)scene.world->for_each_near(p, q, view.radius_m + needed_m, [&](int other) {
        Clearance2 c;
        const double limit_m = view.radius_m + needed_m;
        EXPECT_FALSE(other != i &&
                     compute_clearance_within(scene.world->obstacle(other), p, q, limit_m, c) &&
                     c.distance_m < limit_m)
            << i << " and " << other;
        return true;
      });
    }
  }
}

}  // namespace
}  // namespace sopt
