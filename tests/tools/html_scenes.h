// Two plans for pages: an arm of two capsules that swings among one obstacle of every kind, and a
// disc in the plane.
#pragma once

#include <cmath>

#include "tools/io/html_page.h"

namespace sopt {

inline HtmlPlot swing_plot(int num_frames) {
  HtmlPlot plot{"velocity", "rad/s", {{"joint_1", {}, -1.5, 1.5}}, {}};
  for (int i = 0; i < num_frames; ++i) plot.series[0].values.push_back(std::sin(0.1 * i));
  return plot;
}

// Every obstacle once.
inline HtmlScene swinging_arm() {
  constexpr int kNumFrames = 21;
  HtmlScene scene;
  scene.title = "swing";
  scene.facts = "21 frames";
  scene.obstacles.resize(4);
  scene.obstacles[0].pose.position = {0.6, 0.6, 0.3};
  scene.obstacles[0].size_m = {0.2, 0.2, 0.2};
  scene.obstacles[1].kind = HtmlObstacle::Kind::kCylinder;
  scene.obstacles[1].pose.position = {-0.6, 0.6, 0.3};
  scene.obstacles[1].radius_m = 0.1;
  scene.obstacles[1].height_m = 0.4;
  scene.obstacles[2] = scene.obstacles[1];
  scene.obstacles[2].kind = HtmlObstacle::Kind::kCapsule;
  scene.obstacles[2].pose.position.y() = -0.6;
  scene.obstacles[3].kind = HtmlObstacle::Kind::kHull;
  scene.obstacles[3].vertices = {{0.5, -0.6, 0}, {0.8, -0.6, 0}, {0.5, -0.3, 0}, {0.5, -0.6, 0.3}};
  scene.capsules = {{1, 0.08}, {2, 0.05}};
  for (int i = 0; i < kNumFrames; ++i) {
    const double turn_rad = 0.1 * i;
    const Vec3 elbow(0.0, 0.0, 0.5);
    const Vec3 tip = elbow + 0.5 * Vec3(std::cos(turn_rad), std::sin(turn_rad), 0.0);
    scene.times_s.push_back(0.05 * i);
    scene.frames.push_back({{Vec3::Zero(), elbow}, {elbow, tip}});
    scene.tool_path.push_back(tip);
  }
  scene.start = scene.frames.front();
  scene.goal = scene.frames.back();
  scene.plots = {swing_plot(kNumFrames), swing_plot(kNumFrames - 1)};
  scene.plots[1].title = "acceleration";
  scene.plots[1].levels = {{"margin", 0.02}};
  return scene;
}

// The same scene when no plan was found: the robot at start and goal.
inline HtmlScene arm_without_plan() {
  HtmlScene scene = swinging_arm();
  scene.failure = "goal is too close: obstacle 2";
  scene.obstacles[2].is_culprit = true;
  scene.times_s.clear();
  scene.frames.clear();
  scene.plots.clear();
  scene.tool_path.clear();
  return scene;
}

inline HtmlScene moving_disc() {
  HtmlScene scene;
  scene.title = "disc";
  scene.is_flat = true;
  scene.bounds = Aabb2{{0.0, 0.0}, {4.0, 3.0}};
  scene.obstacles.resize(1);
  scene.obstacles[0].kind = HtmlObstacle::Kind::kCylinder;
  scene.obstacles[0].pose.position = {2.0, 1.5, 0.0};
  scene.obstacles[0].radius_m = 0.5;
  scene.obstacles[0].height_m = 0.1;
  scene.capsules = {{0, 0.2}};
  for (int i = 0; i <= 10; ++i) {
    const Vec3 center(0.5 + 0.3 * i, 0.5, 0.0);
    scene.times_s.push_back(0.1 * i);
    scene.frames.push_back({{center, center}});
    scene.tool_path.push_back(center);
  }
  scene.start = scene.frames.front();
  scene.goal = scene.frames.back();
  return scene;
}

}  // namespace sopt
