#include "tools/bench/bench_scenes.h"

#include <gtest/gtest.h>

#include <string>

#include "tools/io/input_error.h"

namespace sopt {
namespace {

const std::filesystem::path kFolder(SOPT_SOURCE_DIR);
const std::filesystem::path kPlane = kFolder / "tests/data/three_obstacles.json";
const std::filesystem::path kArm = kFolder / "tools/scenes/arm/arm_2_01.json";

TEST(BenchScenesTest, AreReadInOrderAndKnowTheirUnit) {
  const BenchScenes plane = load_bench_scenes({kPlane});
  EXPECT_EQ(plane.kind, SceneKind::kPlane);
  EXPECT_STREQ(length_unit(plane.kind), "m");
  const BenchScenes arms =
      load_bench_scenes({kArm, kFolder / "tools/scenes/arm/arm_8_02.json", kArm});
  EXPECT_EQ(arms.kind, SceneKind::kArm);
  EXPECT_STREQ(length_unit(arms.kind), "rad");
  ASSERT_EQ(arms.scenes.size(), 3U);
  const auto name_of = [](const AnyScene& any) {
    return std::visit([](const auto& scene) { return scene.name; }, any);
  };
  EXPECT_EQ(name_of(arms.scenes[0]), "arm_2_01");
  EXPECT_EQ(name_of(arms.scenes[1]), "arm_8_02");
}

TEST(BenchScenesTest, OfThePlaneAndOfArmsDoNotMix) {
  for (const auto& [first, second] : {std::pair(kPlane, kArm), std::pair(kArm, kPlane)}) {
    try {
      (void)load_bench_scenes({first, second});
      ADD_FAILURE() << "accepted";
    } catch (const InputError& error) {
      const std::string line = error.what();
      EXPECT_EQ(line.rfind(second.string() + ": a scene of ", 0), 0U) << line;
      EXPECT_NE(line.find("must be measured apart"), std::string::npos) << line;
    }
  }
}

TEST(BenchScenesTest, ArmsOfDifferentJointsMix) {
  const std::filesystem::path data = kFolder / "../shared/data/scenes";
  const std::filesystem::path panda = data / "mbm_panda_box_0001.json";
  if (!std::filesystem::exists(panda)) GTEST_SKIP() << "no " << panda;
  const BenchScenes scenes = load_bench_scenes({kArm, panda});
  ASSERT_EQ(scenes.scenes.size(), 2U);
  EXPECT_NE(scenes.scenes[0].index(), scenes.scenes[1].index());
  const auto reference = [](const AnyScene& any) {
    return std::visit([](const auto& scene) { return reference_of(scene); }, any);
  };
  EXPECT_FALSE(reference(scenes.scenes[0]));
  EXPECT_EQ(reference(scenes.scenes[1]), 3.5625);
}

}  // namespace
}  // namespace sopt
