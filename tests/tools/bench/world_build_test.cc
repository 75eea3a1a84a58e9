#include "tools/bench/world_build.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "alloc/arena.h"
#include "alloc/memory_block.h"
#include "models/config.h"
#include "tools/io/arm_scene.h"

namespace sopt {
namespace {

TEST(WorldBuildTest, TimesOneOfTwoBuildsInThePlane) {
  const Scene scene =
      load_scene(std::filesystem::path(SOPT_SOURCE_DIR) / "tests/data/three_obstacles.json");
  ManualClock stepping(3000);
  EXPECT_DOUBLE_EQ(measure_world_build_us(*scene.world, stepping.clock()), 3.0);
  EXPECT_EQ(stepping.num_reads(), 2);
}

// A shape that the copy refuses is an error.
TEST(WorldBuildTest, KnowsEveryShapeOfSpace) {
  const World3Capacity capacity;
  const MemoryBlock memory(World3::required_bytes(capacity));
  Arena arena(memory);
  World3 world(arena, capacity);
  world.reset();
  Pose3 turned;
  turned.rotation = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  turned.position = {1, 2, 3};
  const Vec3 vertices[] = {{5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {5, 0, 1}};
  ASSERT_EQ(world.try_add(Sphere3{{0, 0, 1}, 0.5}), WorldStatus::kOk);
  ASSERT_EQ(world.try_add(Capsule3{{0, 0, 0}, {0, 1, 0}, 0.1}), WorldStatus::kOk);
  ASSERT_EQ(world.try_add(Box3{turned, {1, 2, 3}}), WorldStatus::kOk);
  ASSERT_EQ(world.try_add(Cylinder3{turned, 0.2, 2.0}), WorldStatus::kOk);
  ASSERT_EQ(world.try_add(Hull3{vertices}), WorldStatus::kOk);
  world.build();
  ManualClock stepping(3000);
  EXPECT_DOUBLE_EQ(measure_world_build_us(world, stepping.clock()), 3.0);
}

}  // namespace
}  // namespace sopt
