#include "tools/io/html_page.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <regex>
#include <stdexcept>
#include <vector>

#include "alloc/memory_block.h"
#include "models/plane/world2.h"
#include "models/space/world3.h"
#include "tests/tools/html_scenes.h"

namespace sopt {
namespace {

using nlohmann::json;

// What a browser takes for the data.
json data_of(const std::string& page) {
  const std::string open = R"(<script type="application/json" id="data">)";
  const std::size_t begin = page.find(open) + open.size();
  return json::parse(page.substr(begin, page.find("</script", begin) - begin));
}

int count(const std::string& text, const std::string& part) {
  int number = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++number;
  return number;
}

// The page without what stands in scripts and styles.
std::string markup_of(const std::string& page) {
  std::string markup;
  std::size_t at = 0;
  for (;;) {
    const std::size_t begin = std::min(page.find("<script", at), page.find("<style", at));
    if (begin == std::string::npos) return markup + page.substr(at);
    const std::size_t content = page.find('>', begin) + 1;
    markup += page.substr(at, content - at);
    at = page.find(page[begin + 2] == 'c' ? "</script>" : "</style>", content);
  }
}

TEST(HtmlPageTest, DataArrivesAsItWas) {
  const HtmlScene scene = swinging_arm();
  const json data = data_of(html_page(scene));
  EXPECT_EQ(data["title"], "swing");
  EXPECT_EQ(data["facts"], "21 frames");
  EXPECT_EQ(data["is_flat"], false);
  EXPECT_EQ(data["bounds"], nullptr);
  EXPECT_EQ(data["times_s"].get<std::vector<double>>(), scene.times_s);
  ASSERT_EQ(data["frames"].size(), 21U);
  EXPECT_EQ(data["frames"][0], json({0.0, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.5, 0.5, 0.0, 0.5}));
  EXPECT_EQ(data["capsules"][1], json({{"link", 2}, {"radius", 0.05}}));
  EXPECT_EQ(data["start"], data["frames"][0]);
  EXPECT_EQ(data["goal"], data["frames"][20]);
  EXPECT_EQ(data["failure"], "");
  EXPECT_EQ(data["obstacles"][0]["culprit"], false);
  EXPECT_EQ(data["obstacles"][0]["size"], json({0.2, 0.2, 0.2}));
  EXPECT_EQ(data["obstacles"][0]["quaternion_xyzw"], json({0.0, 0.0, 0.0, 1.0}));
  EXPECT_EQ(data["obstacles"][1]["type"], "cylinder");
  EXPECT_EQ(data["obstacles"][2]["type"], "capsule");
  EXPECT_EQ(data["obstacles"][3]["vertices"].size(), 4U);
  EXPECT_EQ(data["tool_path"].size(), 21U);
  EXPECT_EQ(data["plots"][0]["series"][0]["upper"], 1.5);
  EXPECT_EQ(data["plots"][1]["levels"][0], json({{"name", "margin"}, {"value", 0.02}}));
}

TEST(HtmlPageTest, FlatScenesHaveBounds) {
  const json data = data_of(html_page(moving_disc()));
  EXPECT_EQ(data["is_flat"], true);
  EXPECT_EQ(data["bounds"], json({0.0, 0.0, 4.0, 3.0}));
}

TEST(HtmlPageTest, TagsAreBalanced) {
  const std::string markup = markup_of(html_page(swinging_arm()));
  std::vector<std::string> open;
  const std::regex tag("<(/?)([a-z0-9]+)[^>]*>");
  int num_tags = 0;
  for (std::sregex_iterator it(markup.begin(), markup.end(), tag), end; it != end; ++it) {
    const std::string name = (*it)[2];
    ++num_tags;
    if (name == "meta" || name == "input") continue;
    if ((*it)[1] == "") {
      open.push_back(name);
      continue;
    }
    ASSERT_FALSE(open.empty()) << name;
    EXPECT_EQ(open.back(), name);
    open.pop_back();
  }
  EXPECT_TRUE(open.empty());
  EXPECT_GT(num_tags, 30);
}

TEST(HtmlPageTest, NothingIsLoadedFromElsewhere) {
  const std::string page = html_page(swinging_arm());
  const std::string markup = markup_of(page);
  for (const char* loader : {"src=", "href=", "url(", "@import", "<link", "<iframe"}) {
    EXPECT_EQ(count(markup, loader), 0) << loader;
  }
  // Namespaces are names; nobody loads them.
  const std::regex address("https?://[^\"'` )]*");
  for (std::sregex_iterator it(page.begin(), page.end(), address), end; it != end; ++it) {
    EXPECT_TRUE(it->str() == "http://www.w3.org/1999/xhtml" ||
                it->str() == "http://www.w3.org/2000/svg")
        << it->str();
  }
}

TEST(HtmlPageTest, NoPlaceholderIsLeft) {
  const std::string page = html_page(swinging_arm());
  for (const char* name : {"@DATA@", "@THREE@", "@VIEWER@"}) EXPECT_EQ(count(page, name), 0);
  EXPECT_EQ(count(page, "Copyright \xC2\xA9 2010-2026 three.js authors"), 1);
}

TEST(HtmlPageTest, NoNameEndsTheScript) {
  const int num_ends = count(html_page(swinging_arm()), "</script");
  EXPECT_EQ(num_ends, 3);
  HtmlScene scene = swinging_arm();
  const std::string hostile = "</script><script>alert(1)</script><!-- @THREE@ \"\\\n";
  scene.title = scene.facts = scene.failure = hostile;
  scene.plots[0].title = scene.plots[0].unit = scene.plots[0].series[0].name = hostile;
  scene.plots[1].levels[0].name = hostile;
  const std::string page = html_page(scene);
  EXPECT_EQ(count(page, "</script"), num_ends);
  EXPECT_EQ(count(page, "<!--"), 0);
  const json data = data_of(page);
  EXPECT_EQ(data["title"], hostile);
  EXPECT_EQ(data["plots"][0]["series"][0]["name"], hostile);
  EXPECT_EQ(data["plots"][1]["levels"][0]["name"], hostile);
  EXPECT_EQ(count(page, "var THREE="), 1);
}

TEST(HtmlPageTest, TextThatIsNotUtf8IsReplaced) {
  HtmlScene scene = moving_disc();
  scene.title = "a\xff";
  EXPECT_EQ(data_of(html_page(scene))["title"], "a\xef\xbf\xbd");
}

TEST(HtmlPageTest, WhatIsNotFiniteIsNull) {
  HtmlScene scene = swinging_arm();
  scene.plots[0].series[0].values[2] = std::numeric_limits<double>::quiet_NaN();
  scene.plots[0].series[0].lower = -std::numeric_limits<double>::infinity();
  const json series = data_of(html_page(scene))["plots"][0]["series"][0];
  EXPECT_EQ(series["values"][2], nullptr);
  EXPECT_EQ(series["lower"], nullptr);
}

TEST(HtmlPageTest, SizesThatDoNotFitAreRefused) {
  HtmlScene scene = swinging_arm();
  scene.frames.pop_back();
  EXPECT_THROW((void)html_page(scene), std::invalid_argument);
  scene = swinging_arm();
  scene.frames[3].pop_back();
  EXPECT_THROW((void)html_page(scene), std::invalid_argument);
  for (auto* end : {&scene.start, &scene.goal}) {
    scene = swinging_arm();
    end->pop_back();
    EXPECT_THROW((void)html_page(scene), std::invalid_argument);
  }
  scene = swinging_arm();
  scene.plots[0].series[0].values.push_back(0.0);
  EXPECT_THROW((void)html_page(scene), std::invalid_argument);
}

TEST(HtmlPageTest, ASceneWithoutAPlanIsAPage) {
  const json data = data_of(html_page(arm_without_plan()));
  EXPECT_EQ(data["frames"].size(), 0U);
  EXPECT_EQ(data["start"].size(), 12U);
  EXPECT_EQ(data["failure"], "goal is too close: obstacle 2");
  EXPECT_EQ(data["obstacles"][2]["culprit"], true);
  EXPECT_EQ(data["obstacles"][3]["culprit"], false);
}

class HtmlObstacleTest : public ::testing::Test {
 protected:
  // The same shape as an HtmlObstacle.
  template <class Shape>
  HtmlObstacle converted(const Shape& shape) {
    EXPECT_EQ(world_.try_add(shape), WorldStatus::kOk);
    return make_html_obstacle(world_.obstacle(world_.num_obstacles() - 1));
  }
  void SetUp() override { world_.reset(); }

  MemoryBlock memory_{World3::required_bytes({8, 2})};
  Arena arena_{memory_};
  World3 world_{arena_, {8, 2}};
  const Pose3 pose_{Eigen::AngleAxisd(0.5, Vec3::UnitX()).toRotationMatrix(), {1, 2, 3}};
};

TEST_F(HtmlObstacleTest, BoxesKeepPoseAndSize) {
  const HtmlObstacle box = converted(Box3{pose_, {0.1, 0.2, 0.3}});
  EXPECT_EQ(box.kind, HtmlObstacle::Kind::kBox);
  EXPECT_TRUE(box.pose.rotation.isApprox(pose_.rotation, 1e-12));
  EXPECT_EQ(box.pose.position, pose_.position);
  EXPECT_EQ(box.size_m, Vec3(0.1, 0.2, 0.3));
}

TEST_F(HtmlObstacleTest, CylindersKeepRadiusAndHeight) {
  const HtmlObstacle cylinder = converted(Cylinder3{pose_, 0.1, 0.4});
  EXPECT_EQ(cylinder.kind, HtmlObstacle::Kind::kCylinder);
  EXPECT_EQ(cylinder.radius_m, 0.1);
  EXPECT_EQ(cylinder.height_m, 0.4);
}

TEST_F(HtmlObstacleTest, CapsulesLieAlongTheirZ) {
  const Vec3 p0(1, 0, 0);
  const Vec3 p1(1, 3, 4);
  const HtmlObstacle capsule = converted(Capsule3{p0, p1, 0.1});
  EXPECT_EQ(capsule.kind, HtmlObstacle::Kind::kCapsule);
  EXPECT_NEAR(capsule.height_m, 5.0, 1e-12);
  EXPECT_NEAR(capsule.pose.rotation.determinant(), 1.0, 1e-12);
  const Vec3 half = 0.5 * capsule.height_m * capsule.pose.rotation.col(2);
  EXPECT_NEAR((capsule.pose.position + half - p1).norm(), 0.0, 1e-12);
  const HtmlObstacle sphere = converted(Sphere3{p0, 0.2});
  EXPECT_EQ(sphere.kind, HtmlObstacle::Kind::kCapsule);
  EXPECT_EQ(sphere.height_m, 0.0);
  EXPECT_EQ(sphere.radius_m, 0.2);
}

TEST_F(HtmlObstacleTest, HullsKeepTheirVertices) {
  const std::vector<Vec3> vertices = {{1, 0, 0}, {2, 0, 0}, {1, 1, 0}, {1, 0, 1}};
  const HtmlObstacle hull = converted(Hull3{vertices});
  EXPECT_EQ(hull.kind, HtmlObstacle::Kind::kHull);
  ASSERT_EQ(hull.vertices.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(hull.vertices[i], vertices[i]);
}

TEST(HtmlFlatObstacleTest, DiscsBecomeCylindersAndPolygonsPrisms) {
  const WorldCapacity capacity{.max_obstacles = 2, .max_vertices = 32};
  MemoryBlock memory(World2::required_bytes(capacity));
  Arena arena(memory);
  World2 world(arena, capacity);
  ASSERT_EQ(world.reset({{0, 0}, {4, 4}}), WorldStatus::kOk);
  ASSERT_EQ(world.try_add(Disc{{1, 2}, 0.5}), WorldStatus::kOk);
  ASSERT_EQ(world.try_add(Box2{{3, 3}, {1, 0.5}, 0.0}), WorldStatus::kOk);
  const HtmlObstacle disc = make_html_obstacle(world.obstacle(0), 0.2);
  EXPECT_EQ(disc.kind, HtmlObstacle::Kind::kCylinder);
  EXPECT_EQ(disc.pose.position, Vec3(1, 2, 0));
  EXPECT_EQ(disc.radius_m, 0.5);
  EXPECT_EQ(disc.height_m, 0.2);
  const HtmlObstacle prism = make_html_obstacle(world.obstacle(1), 0.2);
  EXPECT_EQ(prism.kind, HtmlObstacle::Kind::kHull);
  ASSERT_EQ(prism.vertices.size(), 8U);
  EXPECT_EQ(prism.vertices[0].z(), -0.1);
  EXPECT_EQ(prism.vertices[1].z(), 0.1);
}

}  // namespace
}  // namespace sopt
