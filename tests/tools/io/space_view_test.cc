#include "tools/io/space_view.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>

#include "models/space/clearance3.h"

namespace sopt {
namespace {

template <class Shape>
Convex3 convex(const Shape& shape) {
  Convex3 result;
  EXPECT_EQ(try_make_convex(shape, result), WorldStatus::kOk);
  return result;
}

Convex3 box(const Vec3& center, const Vec3& size_m) {
  return convex(Box3{{Mat3::Identity(), center}, size_m});
}

double area(const std::vector<Vec2>& outline) {
  double twice = 0.0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec2& a = outline[i];
    const Vec2& b = outline[(i + 1) % outline.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return std::abs(0.5 * twice);
}

double area(const std::vector<SeenFace>& faces) {
  double sum = 0.0;
  for (const SeenFace& face : faces) sum += area(face.outline);
  return sum;
}

TEST(SpaceViewTest, AxesAreShortenedAlikeAndZPointsUp) {
  for (int i = 0; i < SpaceView::kNumCorners; ++i) {
    const SpaceView view(i);
    for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}) {
      EXPECT_NEAR(view.at(Vec3(axis)).norm(), std::sqrt(2.0 / 3.0), 1e-12);
    }
    EXPECT_NEAR(view.at(Vec3(Vec3::UnitZ())).x(), 0.0, 1e-12);
    EXPECT_LT(view.at(Vec3(Vec3::UnitZ())).y(), 0.0);
    EXPECT_GT(view.toward_viewer().z(), 0.0);
    // Not mirrored: right, up and towards the viewer are right-handed.
    EXPECT_NEAR(view.right().cross(view.up()).dot(view.toward_viewer()), 1.0, 1e-12);
  }
  EXPECT_GT(SpaceView(3).toward_viewer().x(), 0.0);
  EXPECT_LT(SpaceView(3).toward_viewer().y(), 0.0);
}

TEST(SpaceViewTest, ThreeFacesOfABoxFillItsSilhouette) {
  const Mat3 turn = Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const SeenShape seen = see(convex(Box3{{turn, {1, 2, 3}}, {0.3, 0.5, 0.8}}), SpaceView(1));
  EXPECT_EQ(seen.silhouette.size(), 6U);
  EXPECT_EQ(seen.faces.size(), 3U);
  EXPECT_NEAR(area(seen.faces), area(seen.silhouette), 1e-12);
}

TEST(SpaceViewTest, FacesOfAHullTowardsTheViewerFillItsSilhouette) {
  const std::vector<Vec3> vertices = {
      {0, 0, 0}, {1, 0, 0.1}, {0, 1, 0}, {0.2, 0.3, 0.9}, {1, 1, 0}};
  HullData data;
  Convex3 hull;
  ASSERT_EQ(try_make_convex(Hull3{vertices}, data, hull), WorldStatus::kOk);
  for (int i = 0; i < SpaceView::kNumCorners; ++i) {
    const SeenShape seen = see(hull, SpaceView(i));
    EXPECT_NEAR(area(seen.faces), area(seen.silhouette), 1e-9);
  }
}

TEST(SpaceViewTest, RoundShapesHaveTheirArea) {
  const double disc = std::numbers::pi * 0.25 * 0.25;
  const SpaceView view(0);
  const SeenShape sphere = see(convex(Sphere3{{1, 1, 1}, 0.25}), view);
  EXPECT_NEAR(area(sphere.silhouette), disc, 0.01 * disc);
  const Vec3 along = 0.8 * view.right();
  const SeenShape across = see(convex(Capsule3{Vec3::Zero(), along, 0.25}), view);
  EXPECT_NEAR(area(across.silhouette), disc + 0.8 * 0.5, 0.01);
  const Vec3 away = 0.8 * view.toward_viewer();
  const SeenShape end_on = see(convex(Capsule3{Vec3::Zero(), away, 0.25}), view);
  EXPECT_NEAR(area(end_on.silhouette), disc, 0.01 * disc);
}

TEST(SpaceViewTest, ACylinderShowsItsNearEnd) {
  const SeenShape seen =
      see(convex(Cylinder3{{Mat3::Identity(), {0, 0, 1}}, 0.5, 2.0}), SpaceView(0));
  ASSERT_EQ(seen.faces.size(), 1U);
  const double end = std::numbers::pi * 0.25 / std::numbers::sqrt3;  // as steep as the view
  EXPECT_NEAR(area(seen.faces), end, 0.01 * end);
  const Vec2 top = SpaceView(0).at(Vec3(0, 0, 2));
  Vec2 middle = Vec2::Zero();
  for (const Vec2& p : seen.faces[0].outline) middle += p;
  middle /= static_cast<double>(seen.faces[0].outline.size());
  EXPECT_NEAR((middle - top).norm(), 0.0, 1e-9);
}

TEST(SpaceViewTest, OutlinesHaveNoPointWithinOrOnAnEdge) {
  const std::vector<Vec2> square = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  std::vector<Vec2> points = square;
  points.insert(points.end(), {{0.5, 0.5}, {0.5, 0.0}, {1.0, 0.25}, {0.0, 0.0}});
  EXPECT_EQ(convex_outline(points).size(), 4U);
  EXPECT_EQ(area(convex_outline(points)), 1.0);
  EXPECT_LE(convex_outline({{1, 1}, {1, 1}}).size(), 2U);
  EXPECT_TRUE(convex_outline({}).empty());
}

TEST(PaintOrderTest, ARoofHidesWhatIsBelowThoughItsMiddleIsFarther) {
  const SpaceView view(0);
  const std::vector<PaintItem> items = {{box({-2.0, -2.0, 1.0}, {6.0, 6.0, 0.1}), 0, 0},
                                        {convex(Sphere3{{0.5, 0.5, 0.5}, 0.2}), 1, 0}};
  ASSERT_LT(view.nearness(items[0].shape.center), view.nearness(items[1].shape.center));
  EXPECT_EQ(paint_order(items, view), (std::vector<int>{1, 0}));
}

TEST(PaintOrderTest, OfShapesThatOverlapTheHigherRankIsOnTop) {
  const SpaceView view(0);
  std::vector<PaintItem> items = {{convex(Sphere3{{0, 0, 0}, 0.5}), 0, 1},
                                  {convex(Sphere3{{0.1, 0.1, 0.1}, 0.5}), 1, 0}};
  EXPECT_EQ(paint_order(items, view), (std::vector<int>{1, 0}));
  items[1].rank = 2;
  EXPECT_EQ(paint_order(items, view), (std::vector<int>{0, 1}));
}

TEST(PaintOrderTest, AGroupIsPaintedTogetherWhereNothingForbidsIt) {
  const SpaceView view(0);
  std::vector<PaintItem> items;
  for (int i = 0; i < 6; ++i) {  // side by side, nearness by turns
    const Vec3 center = 2.0 * i * view.right() + (i % 2 == 0 ? 1.0 : 0.0) * view.toward_viewer() +
                        0.01 * i * view.toward_viewer();
    items.push_back({convex(Sphere3{center, 0.5}), i / 3, 0});
  }
  const std::vector<int> order = paint_order(items, view);
  ASSERT_EQ(order.size(), 6U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(order[i] / 3, order[0] / 3);
    EXPECT_EQ(order[3 + i] / 3, order[3] / 3);
  }
}

// Where the sight from far away along the view through p first meets the shape, as nearness.
std::optional<double> first_met(const Convex3& shape, const Vec3& p, const SpaceView& view) {
  const Vec3& v = view.toward_viewer();
  if (shape.kind == CoreKind::kPoint) {
    const Vec3 to_center = shape.center - p;
    const double along = to_center.dot(v);
    const double aside2 = to_center.squaredNorm() - along * along;
    const double rest = shape.radius_m * shape.radius_m - aside2;
    if (rest <= 0.0) return std::nullopt;
    return view.nearness(p) + along + std::sqrt(rest);
  }
  double enter = -std::numeric_limits<double>::infinity();
  double leave = -enter;
  for (int k = 0; k < 3; ++k) {
    const double slope = shape.axes.col(k).dot(v);
    const double offset = shape.axes.col(k).dot(p - shape.center);
    const double a = (-shape.half_m[k] - offset) / slope;
    const double b = (shape.half_m[k] - offset) / slope;
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  if (enter >= leave) return std::nullopt;
  return view.nearness(p) + leave;
}

TEST(PaintOrderTest, WhatIsPaintedLastIsWhatTheViewerMeetsFirst) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int num_hidden = 0;
  for (int i_scene = 0; i_scene < 100; ++i_scene) {
    const SpaceView view(i_scene % 4);
    std::vector<PaintItem> items;
    while (items.size() < 10) {
      const Vec3 center(unit(random), unit(random), unit(random));
      const Vec3 size = Vec3(0.6, 0.6, 0.6) + 0.5 * Vec3(unit(random), unit(random), unit(random));
      const Mat3 turn = Eigen::Quaterniond(unit(random), unit(random), unit(random), unit(random))
                            .normalized()
                            .toRotationMatrix();
      const Convex3 shape = items.size() % 2 == 0 ? convex(Box3{{turn, center}, size})
                                                  : convex(Sphere3{center, 0.4 * size.x()});
      const bool is_free = std::none_of(items.begin(), items.end(), [&](const PaintItem& item) {
        return is_within(item.shape, shape, 1e-3);
      });
      if (is_free) items.push_back({shape, static_cast<int>(items.size()), 0});
    }
    const std::vector<int> order = paint_order(items, view);
    ASSERT_EQ(order.size(), items.size());
    for (int i_ray = 0; i_ray < 200; ++i_ray) {
      const Vec3 p = 1.5 * (unit(random) * view.right() + unit(random) * view.up());
      double nearest = -std::numeric_limits<double>::infinity();
      double last_painted = nearest;
      int num_met = 0;
      for (const int i : order) {
        const auto met = first_met(items[static_cast<std::size_t>(i)].shape, p, view);
        if (!met) continue;
        ++num_met;
        nearest = std::max(nearest, *met);
        last_painted = *met;
      }
      if (num_met > 1) ++num_hidden;
      ASSERT_EQ(last_painted, nearest) << "scene " << i_scene << ", ray " << i_ray;
    }
  }
  EXPECT_GT(num_hidden, 500);
}

}  // namespace
}  // namespace sopt
