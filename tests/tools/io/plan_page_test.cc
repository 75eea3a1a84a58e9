#include "tools/io/plan_page.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "tools/cli/planner_host.h"

namespace sopt {
namespace {

std::filesystem::path source_file(const char* name) {
  return std::filesystem::path(SOPT_SOURCE_DIR) / name;
}

// A plan, kept alive, and its page.
template <class Robot>
struct Planned {
  explicit Planned(const SceneOf<Robot>& scene)
      : request(make_request(scene)),
        host(scene, request.options),
        result(host.planner().plan(request)),
        page(page_of(scene, request, result, result.times)) {}

  PlanRequest<Robot> request;
  PlannerHost<Robot> host;
  PlanResult<Robot> result;
  HtmlScene page;
};

const HtmlPlot& plot(const HtmlScene& page, const std::string& title) {
  const auto found = std::find_if(page.plots.begin(), page.plots.end(),
                                  [&](const HtmlPlot& one) { return one.title == title; });
  EXPECT_NE(found, page.plots.end()) << title;
  return *found;
}

double least(const HtmlSeries& series) {
  return *std::min_element(series.values.begin(), series.values.end());
}

class PlanPageTest : public ::testing::Test {
 protected:
  Scene plane_ = load_scene(source_file("tests/data/three_obstacles.json"));
  ArmScene<5> factory_ =
      std::get<ArmScene<5>>(load_any_scene(source_file("tools/scenes/arm/factory.json")));
};

TEST_F(PlanPageTest, InThePlaneItShowsWaypointsVelocityAndClearance) {
  plane_.robot.v_max_mps = 3.0;
  const Planned<Point2> planned(plane_);
  ASSERT_TRUE(planned.result.plan);
  const Trajectory<Point2>& trajectory = planned.result.plan->trajectory();
  const HtmlScene& page = planned.page;
  const auto num_times = static_cast<std::size_t>(trajectory.horizon()) + 1;
  EXPECT_TRUE(page.is_flat);
  EXPECT_EQ(page.title, "three_obstacles: ok");
  EXPECT_EQ(page.failure, "");
  EXPECT_EQ(page.bounds->upper, Vec2(10, 6));
  EXPECT_EQ(page.obstacles.size(), 3U);
  ASSERT_EQ(page.times_s.size(), num_times);
  EXPECT_NEAR(page.times_s.back(), trajectory.duration_s(), 1e-12);
  EXPECT_EQ(page.start[0].p0, Vec3(1, 3, 0));
  EXPECT_EQ(page.goal[0].p1, Vec3(9, 3, 0));
  EXPECT_EQ(page.capsules[0].radius_m, 0.2);
  EXPECT_EQ(page.frames[5][0].p0.head<2>(), trajectory.states[5]);
  EXPECT_EQ(plot(page, "position").series[1].values[5], trajectory.states[5].y());
  const HtmlPlot& velocity = plot(page, "velocity");
  EXPECT_EQ(velocity.unit, "m/s");
  EXPECT_EQ(velocity.series[0].values[5], trajectory.inputs[5].x());
  EXPECT_EQ(velocity.series[2].values[5], trajectory.inputs[5].norm());
  EXPECT_EQ(velocity.series[2].upper, 3.0);
  // The least clearance is between waypoints, but not far from them.
  const double certified_m = planned.result.plan->certificate().min_clearance_m;
  const double least_m = least(plot(page, "clearance").series[0]);
  EXPECT_GE(least_m, certified_m - 1e-9);
  EXPECT_LE(least_m, certified_m + 0.02);
  EXPECT_EQ(plot(page, "clearance").levels[0].value, planned.request.options.margin_m);
  EXPECT_GT(html_page(page).size(), 100000U);
}

TEST_F(PlanPageTest, ThereIsNoSpeedLimitWhereTheRobotHasNone) {
  const Planned<Point2> planned(plane_);
  EXPECT_EQ(plot(planned.page, "velocity").series[2].upper, std::nullopt);
}

TEST_F(PlanPageTest, OfAnArmItShowsJointsAgainstTheirLimits) {
  const Planned<Arm<5>> planned(factory_);
  ASSERT_TRUE(planned.result.plan);
  const Trajectory<Arm<5>>& trajectory = planned.result.plan->trajectory();
  const HtmlScene& page = planned.page;
  const auto num_steps = static_cast<std::size_t>(trajectory.horizon());
  EXPECT_FALSE(page.is_flat);
  EXPECT_FALSE(page.bounds.has_value());
  EXPECT_EQ(page.obstacles.size(), 8U);
  EXPECT_EQ(page.capsules.size(), static_cast<std::size_t>(factory_.arm.num_capsules()));
  ASSERT_EQ(page.frames.size(), num_steps + 1);
  EXPECT_EQ(page.tool_path.size(), num_steps + 1);
  ASSERT_EQ(page.plots.size(), 4U);
  const char* const units[] = {"rad", "rad/s", "rad/s\u00b2", "m"};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(page.plots[i].unit, units[i]);
  const HtmlSeries& position = plot(page, "position").series[2];
  EXPECT_EQ(position.name, factory_.joint_names[2]);
  EXPECT_EQ(position.values[7], trajectory.states[7][2]);
  EXPECT_EQ(position.lower, factory_.arm.lower()[2]);
  const HtmlSeries& velocity = plot(page, "velocity").series[2];
  EXPECT_EQ(velocity.values[7], trajectory.states[7][5 + 2]);
  EXPECT_EQ(velocity.upper, factory_.arm.v_max()[2]);
  EXPECT_EQ(velocity.lower, -factory_.arm.v_max()[2]);
  const HtmlSeries& acceleration = plot(page, "acceleration").series[2];
  EXPECT_EQ(acceleration.values.size(), num_steps);
  EXPECT_EQ(acceleration.values[7], trajectory.inputs[7][2]);
  EXPECT_EQ(acceleration.upper, factory_.arm.a_max()[2]);
  const Certificate& certificate = planned.result.plan->certificate();
  const HtmlPlot& clearance = plot(page, "clearance");
  for (const auto& [i, certified_m] : {std::pair{0U, certificate.min_clearance_m},
                                       std::pair{1U, certificate.min_self_clearance_m}}) {
    EXPECT_GE(least(clearance.series[i]), certified_m - 1e-9);
    EXPECT_LE(least(clearance.series[i]), certified_m + 0.01);
  }
}

TEST_F(PlanPageTest, WithoutAPlanItShowsTheEndsAndTheCulprit) {
  factory_.goal = factory_.start;
  factory_.goal[0] = -0.5;  // in the front pillar
  const Planned<Arm<5>> planned(factory_);
  const HtmlScene& page = planned.page;
  EXPECT_EQ(page.title, "factory: bad_goal");
  EXPECT_NE(page.failure.find("front_pillar"), std::string::npos);
  EXPECT_TRUE(page.frames.empty());
  EXPECT_TRUE(page.plots.empty());
  EXPECT_EQ(page.start.size(), page.capsules.size());
  EXPECT_NE(page.start.back().p1, page.goal.back().p1);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(page.obstacles[i].is_culprit, i == 1);
  EXPECT_GT(html_page(page).size(), 100000U);
}

TEST_F(PlanPageTest, JointsThatSlideHavePlotsOfTheirOwn) {
  const auto file = source_file("../shared/data/scenes/mbm_fetch_cage_0001.json");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
  auto scene = std::get<ArmScene<8>>(load_any_scene(file));
  scene.goal = scene.start;  // quickly planned
  const Planned<Arm<8>> planned(scene);
  ASSERT_TRUE(planned.result.plan);
  std::vector<std::string> units;
  for (const HtmlPlot& one : planned.page.plots) units.push_back(one.unit);
  EXPECT_EQ(units, (std::vector<std::string>{"rad", "m", "rad/s", "m/s", "rad/s\u00b2", "m/s\u00b2",
                                             "m"}));
  EXPECT_EQ(planned.page.plots[1].series.size(), 1U);
  EXPECT_EQ(planned.page.plots[0].series.size(), 7U);
}

}  // namespace
}  // namespace sopt
