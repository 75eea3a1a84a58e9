#include "tools/io/scene_picture.h"

#include <gtest/gtest.h>

#include <array>

namespace sopt {
namespace {

TEST(SceneMap, FillsTheRoomWithoutDistortion) {
  const SceneMap map({Vec2(-1, 2), Vec2(9, 7)}, Vec2(20, 30), Vec2(400, 400));
  EXPECT_EQ(map.size(), Vec2(400, 200));
  EXPECT_EQ(map.at(Vec2(-1, 7)), Vec2(20, 30));  // y up
  EXPECT_EQ(map.at(Vec2(9, 2)), Vec2(420, 230));
  EXPECT_EQ(map.px(2.0), 80.0);
}

TEST(SceneMap, MovesWhatLiesBeyondOntoTheFrame) {
  const SceneMap map({Vec2(0, 0), Vec2(10, 10)}, Vec2(0, 0), Vec2(100, 100));
  EXPECT_TRUE(map.is_beyond(Vec2(11, 5)));
  EXPECT_FALSE(map.is_beyond(Vec2(10, 5)));
  EXPECT_EQ(map.at_or_on_frame(Vec2(1e6, 5)), Vec2(100, 50));
}

TEST(SceneView, GrowsALittleForEndsOutOfBounds) {
  Scene scene =
      load_scene(std::filesystem::path(SOPT_SOURCE_DIR) / "tests/data/three_obstacles.json");
  const Aabb2& bounds = scene.world->bounds();
  EXPECT_EQ(view_of(scene).upper, bounds.upper);
  const Vec2 extent = bounds.upper - bounds.lower;
  scene.goal = bounds.upper + 0.1 * extent;
  EXPECT_TRUE((view_of(scene).upper.array() >= scene.goal.array()).all());
  scene.goal = bounds.upper + 1e6 * extent;
  EXPECT_TRUE(view_of(scene).upper.isApprox(bounds.upper + 0.25 * extent));
  EXPECT_EQ(view_of(scene).lower, bounds.lower);
  scene.start = bounds.lower - 1e6 * extent;
  EXPECT_TRUE(view_of(scene).lower.isApprox(bounds.lower - 0.25 * extent));
}

}  // namespace
}  // namespace sopt
