#include "tools/io/scene_file.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "tests/tools/temporary_folder.h"
#include "tools/io/input_error.h"

namespace sopt {
namespace {

class SceneFileTest : public TemporaryFolderTest {
 protected:
  void SetUp() override {
    TemporaryFolderTest::SetUp();
    json_ = nlohmann::json::parse(read_file(data_file("three_obstacles.json")));
  }
  [[nodiscard]] Scene load() const { return load_scene(write("scene.json", json_.dump())); }

  nlohmann::json json_;
};

TEST_F(SceneFileTest, ReadsShapesInTheirOrder) {
  const Scene scene = load();
  EXPECT_EQ(scene.name, "three_obstacles");
  EXPECT_EQ(scene.robot_name, "point2d");
  EXPECT_EQ(scene.robot.radius_m, 0.2);
  EXPECT_EQ(scene.start, Vec2(1, 3));
  EXPECT_EQ(scene.goal, Vec2(9, 3));
  EXPECT_EQ(scene.world->bounds().lower, Vec2(0, 0));
  EXPECT_EQ(scene.world->bounds().upper, Vec2(10, 6));
  ASSERT_EQ(scene.world->num_obstacles(), 3);
  EXPECT_EQ(scene.world->obstacle(0).num_vertices, 1);
  EXPECT_EQ(scene.world->obstacle(0).radius_m, 0.8);
  EXPECT_EQ(scene.world->obstacle(1).num_vertices, 4);
  EXPECT_EQ(scene.world->obstacle(2).num_vertices, 3);
  EXPECT_EQ(scene.world->obstacle_margin_m(0), kDefaultMargin);
  EXPECT_EQ(scene.world->obstacle_margin_m(2), 0.1);
}

TEST_F(SceneFileTest, TurnsBoxesCounterClockwise) {
  json_["obstacles"] = {
      {{"type", "box"}, {"center", {5, 3}}, {"size", {2, 1}}, {"angle", std::acos(-1.0) / 2.0}}};
  const Scene scene = load();
  const Aabb2& box = scene.world->obstacle_box(0);
  EXPECT_NEAR(box.lower.x(), 4.5, 1e-12);
  EXPECT_NEAR(box.lower.y(), 2.0, 1e-12);
  EXPECT_NEAR(box.upper.x(), 5.5, 1e-12);
  EXPECT_NEAR(box.upper.y(), 4.0, 1e-12);
}

TEST_F(SceneFileTest, LeavesTheBroadPhaseBuilt) {
  const Scene scene = load();
  EXPECT_EQ(scene.world->nearest(Vec2(5.5, 2.5), Vec2(5.5, 2.5), 10.0).i_obstacle, 1);
}

TEST_F(SceneFileTest, DefaultsHoldWhereTheSceneIsSilent) {
  const Scene scene = load();
  EXPECT_FALSE(scene.speed_mps || scene.dt_s || scene.margin_m || scene.min_clearance_m);
  EXPECT_FALSE(scene.reference_feasible_length);
  EXPECT_EQ(scene.robot.v_max_mps, std::numeric_limits<double>::infinity());
  const PlanOptions defaults;
  const PlanRequest<Point2> request = make_request(scene);
  EXPECT_EQ(request.options.dt_s, defaults.dt_s);
  EXPECT_EQ(request.options.margin_m, defaults.margin_m);
  EXPECT_EQ(request.options.min_clearance_m, defaults.min_clearance_m);
  EXPECT_EQ(request.world, scene.world.get());
  EXPECT_EQ(request.start, scene.start);
  EXPECT_EQ(request.goal, scene.goal);
}

TEST_F(SceneFileTest, OptionalFieldsReachTheRequest) {
  json_["speed"] = 0.7;
  json_["dt"] = 0.2;
  json_["margin"] = 0.03;
  json_["min_clearance"] = 0.002;
  json_["limits"]["v_max"] = 0.8;
  json_["start_velocity"] = {0.1, 0.2};
  json_["goal_velocity"] = {0, 0};
  json_["obstacles"][0]["velocity"] = {0, 0};
  const Scene scene = load();
  const PlanOptions options = make_request(scene).options;
  EXPECT_EQ(options.speed_mps, 0.7);
  EXPECT_EQ(options.dt_s, 0.2);
  EXPECT_EQ(options.margin_m, 0.03);
  EXPECT_EQ(options.min_clearance_m, 0.002);
  EXPECT_EQ(scene.robot.v_max_mps, 0.8);
}

TEST_F(SceneFileTest, DocumentationIsIgnoredWhateverItIs) {
  for (const char* name : {"source", "license", "notes", "units", "check", "num_obstacles",
                           "derived", "start_note", "tags", "reference_path", "x_anything"}) {
    json_[name] = {{"a", {1, "b", nullptr}}};
  }
  json_["reference_feasible_length"] = nullptr;
  json_["obstacles"][0]["x_note"] = "mine";
  EXPECT_FALSE(load().reference_feasible_length);
}

TEST_F(SceneFileTest, ReferenceLengthIsKeptWhenItIsANumber) {
  json_["reference_feasible_length"] = 9.25;
  EXPECT_EQ(load().reference_feasible_length.value(), 9.25);
}

TEST_F(SceneFileTest, FileNameStandsInForTheName) {
  json_.erase("name");
  EXPECT_EQ(load().name, "scene");
  EXPECT_EQ(load_scene(write("a\xff.json", json_.dump())).name, "a\xef\xbf\xbd");
}

TEST_F(SceneFileTest, NoObstaclesAndNoRadiusAreFine) {
  json_["obstacles"] = nlohmann::json::array();
  json_["radius"] = 0;
  const Scene scene = load();
  EXPECT_EQ(scene.world->num_obstacles(), 0);
  EXPECT_TRUE(scene.world->is_clear(scene.start, scene.goal, 0.0, {}));
}

TEST_F(SceneFileTest, FullWorldFits) {
  const std::size_t max_obstacles = WorldCapacity{}.max_obstacles;
  json_["obstacles"] = std::vector<nlohmann::json>(max_obstacles, json_["obstacles"][0]);
  EXPECT_EQ(load().world->num_obstacles(), static_cast<int>(max_obstacles));
}

TEST_F(SceneFileTest, NamesObstaclesByIdElseIndex) {
  const Scene scene = load();
  EXPECT_EQ(scene.obstacle_ids, (std::vector<std::string>{"", "crate", ""}));
  EXPECT_EQ(obstacle_name(scene, 0), "obstacle 0");
  EXPECT_EQ(obstacle_name(scene, 1), "obstacle \"crate\"");
  EXPECT_EQ(obstacle_name(scene, kBoundsObstacle), "the bounds");
  EXPECT_EQ(obstacle_name(scene, kNoObstacle), "nothing");
}

TEST_F(SceneFileTest, SettingsGrowWithWhatIsAsked) {
  const Scene scene = load();
  const PlannerSettings defaults;
  PlanOptions options;
  EXPECT_EQ(make_settings(scene, options).max_horizon, defaults.max_horizon);
  EXPECT_EQ(make_settings(scene, options).nodes_per_stream, defaults.nodes_per_stream);
  options.num_samples = 50000;
  options.num_streams = 7;
  options.max_window = 100;
  options.speed_mps = 0.1;
  options.dt_s = 0.1;  // one diagonal is 1167 steps
  const PlannerSettings settings = make_settings(scene, options);
  EXPECT_EQ(settings.nodes_per_stream, 50000);
  EXPECT_EQ(settings.num_streams, 7);
  EXPECT_EQ(settings.max_window, 100);
  EXPECT_GT(settings.max_horizon, 5 * 1167);
  options.dt_s = 1e-9;
  EXPECT_LE(make_settings(scene, options).max_horizon, kMaxSegments * 100);
}

TEST_F(SceneFileTest, SmallRobotsGetRoomForTheirShortSteps) {
  json_["radius"] = 0.001;  // steps of 4 mm: 2916 for one diagonal
  const Scene scene = load();
  EXPECT_GT(make_settings(scene, {}).max_horizon, 5 * 2916);
}

TEST_F(SceneFileTest, SharedPlanarScenesLoadUnchanged) {
  const std::filesystem::path shared =
      std::filesystem::path(SOPT_SOURCE_DIR) / "../shared/data/scenes";
  if (!std::filesystem::is_directory(shared)) GTEST_SKIP() << shared << " is absent";
  int num_scenes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(shared)) {
    const nlohmann::json json = nlohmann::json::parse(read_file(entry.path()));
    if (json["robot"] != "point2d") {
      EXPECT_THROW((void)load_scene(entry.path()), InputError) << entry.path();
      continue;
    }
    const Scene scene = load_scene(entry.path());
    EXPECT_EQ(scene.world->num_obstacles(), json["num_obstacles"]) << entry.path();
    EXPECT_GT(scene.reference_feasible_length.value(), (scene.goal - scene.start).norm());
    ++num_scenes;
  }
  EXPECT_EQ(num_scenes, 10);
}

}  // namespace
}  // namespace sopt
