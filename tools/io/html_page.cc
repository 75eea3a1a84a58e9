#include "tools/io/html_page.h"

#include <Eigen/Geometry>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>

#include "tools/io/viewer/viewer_resources.h"

namespace sopt {
namespace {

using nlohmann::ordered_json;

// 0.01 mm is finer than a pixel; it keeps the file small.
double rounded(double value) { return std::round(value * 1e5) / 1e5; }
ordered_json to_json(const Vec3& v) { return {rounded(v.x()), rounded(v.y()), rounded(v.z())}; }

ordered_json to_json(const std::vector<Vec3>& points) {
  ordered_json json = ordered_json::array();
  for (const Vec3& point : points) json.push_back(to_json(point));
  return json;
}

ordered_json to_json(const HtmlObstacle& obstacle) {
  if (obstacle.kind == HtmlObstacle::Kind::kHull) {
    return {{"type", "hull"},
            {"culprit", obstacle.is_culprit},
            {"vertices", to_json(obstacle.vertices)}};
  }
  const Eigen::Quaterniond q(obstacle.pose.rotation);
  ordered_json json = {{"type", "box"},
                       {"culprit", obstacle.is_culprit},
                       {"position", to_json(obstacle.pose.position)},
                       {"quaternion_xyzw", {q.x(), q.y(), q.z(), q.w()}}};
  if (obstacle.kind == HtmlObstacle::Kind::kBox) {
    json["size"] = to_json(obstacle.size_m);
    return json;
  }
  json["type"] = obstacle.kind == HtmlObstacle::Kind::kCylinder ? "cylinder" : "capsule";
  json["radius"] = obstacle.radius_m;
  json["height"] = obstacle.height_m;
  return json;
}

// Six numbers per capsule.
ordered_json to_json(const std::vector<HtmlSegment>& frame) {
  ordered_json json = ordered_json::array();
  for (const HtmlSegment& segment : frame) {
    for (const Vec3& p : {segment.p0, segment.p1}) {
      for (int axis = 0; axis < 3; ++axis) json.push_back(rounded(p[axis]));
    }
  }
  return json;
}

ordered_json to_json(const std::optional<double>& value) {
  return value ? ordered_json(*value) : ordered_json();
}

ordered_json to_json(const HtmlPlot& plot) {
  ordered_json json = {{"title", plot.title}, {"unit", plot.unit}};
  json["series"] = ordered_json::array();
  for (const HtmlSeries& series : plot.series) {
    ordered_json values = ordered_json::array();
    for (const double value : series.values) values.push_back(rounded(value));
    json["series"].push_back({{"name", series.name},
                              {"values", std::move(values)},
                              {"lower", to_json(series.lower)},
                              {"upper", to_json(series.upper)}});
  }
  json["levels"] = ordered_json::array();
  for (const HtmlLevel& level : plot.levels) {
    json["levels"].push_back({{"name", level.name}, {"value", level.value}});
  }
  return json;
}

void check_sizes(const HtmlScene& scene) {
  const std::size_t num_times = scene.times_s.size();
  const std::size_t num_capsules = scene.capsules.size();
  bool fits = scene.frames.size() == num_times && scene.start.size() == num_capsules &&
              scene.goal.size() == num_capsules;
  for (const auto& frame : scene.frames) fits = fits && frame.size() == num_capsules;
  for (const HtmlPlot& plot : scene.plots) {
    for (const HtmlSeries& series : plot.series) {
      const std::size_t num_values = series.values.size();
      fits = fits && (num_values == num_times || num_values + 1 == num_times);
    }
  }
  if (!fits) throw std::invalid_argument("html_page: frames or series do not fit the times");
}

ordered_json to_json(const HtmlScene& scene) {
  ordered_json json = {{"title", scene.title},
                       {"facts", scene.facts},
                       {"failure", scene.failure},
                       {"is_flat", scene.is_flat}};
  json["bounds"] = nullptr;
  if (scene.bounds) {
    json["bounds"] = {scene.bounds->lower.x(), scene.bounds->lower.y(), scene.bounds->upper.x(),
                      scene.bounds->upper.y()};
  }
  for (const char* name : {"obstacles", "capsules", "frames", "plots"}) {
    json[name] = ordered_json::array();
  }
  for (const HtmlObstacle& obstacle : scene.obstacles) {
    json["obstacles"].push_back(to_json(obstacle));
  }
  for (const HtmlCapsule& capsule : scene.capsules) {
    json["capsules"].push_back({{"link", capsule.i_link}, {"radius", capsule.radius_m}});
  }
  json["start"] = to_json(scene.start);
  json["goal"] = to_json(scene.goal);
  for (const auto& frame : scene.frames) json["frames"].push_back(to_json(frame));
  for (const HtmlPlot& plot : scene.plots) json["plots"].push_back(to_json(plot));
  json["times_s"] = scene.times_s;
  json["tool_path"] = to_json(scene.tool_path);
  return json;
}

// In JSON "<" occurs in strings only; without it no string can end or open a script.
std::string to_script_text(const ordered_json& json) {
  const std::string text = json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
  std::string escaped;
  escaped.reserve(text.size());
  for (const char c : text) {
    if (c == '<') {
      escaped += "\\u003c";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

}  // namespace

HtmlObstacle make_html_obstacle(const Convex3& shape) {
  HtmlObstacle obstacle;
  obstacle.pose = {shape.axes, shape.center};
  obstacle.radius_m = shape.radius_m;
  switch (shape.kind) {
    case CoreKind::kPoint:
      obstacle.kind = HtmlObstacle::Kind::kCapsule;
      break;
    case CoreKind::kSegment: {
      obstacle.kind = HtmlObstacle::Kind::kCapsule;
      obstacle.height_m = 2.0 * shape.half_m.z();
      // Only the third axis is set.
      const auto turn = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), shape.axes.col(2));
      obstacle.pose.rotation = turn.toRotationMatrix();
      break;
    }
    case CoreKind::kBox:
      obstacle.size_m = 2.0 * shape.half_m;
      break;
    case CoreKind::kCylinder:
      obstacle.kind = HtmlObstacle::Kind::kCylinder;
      obstacle.radius_m = shape.half_m.x();
      obstacle.height_m = 2.0 * shape.half_m.z();
      break;
    case CoreKind::kHull:
      obstacle.kind = HtmlObstacle::Kind::kHull;
      for (int i = 0; i < shape.hull->num_vertices; ++i) {
        const HullData& hull = *shape.hull;
        obstacle.vertices.push_back(shape.center + Vec3(hull.x[i], hull.y[i], hull.z[i]));
      }
      break;
  }
  return obstacle;
}

HtmlObstacle make_html_obstacle(const ConvexView& shape, double height_m) {
  HtmlObstacle obstacle;
  if (shape.num_vertices == 1) {
    obstacle.kind = HtmlObstacle::Kind::kCylinder;
    obstacle.pose.position = {shape.x[0], shape.y[0], 0.0};
    obstacle.radius_m = shape.radius_m;
    obstacle.height_m = height_m;
    return obstacle;
  }
  obstacle.kind = HtmlObstacle::Kind::kHull;
  for (int i = 0; i < shape.num_vertices; ++i) {
    for (const double z : {-0.5 * height_m, 0.5 * height_m}) {
      obstacle.vertices.emplace_back(shape.x[i], shape.y[i], z);
    }
  }
  return obstacle;
}

std::string html_page(const HtmlScene& scene) {
  check_sizes(scene);
  constexpr std::string_view kData = "@DATA@";
  constexpr std::string_view kThree = "@THREE@";
  constexpr std::string_view kViewer = "@VIEWER@";
  const std::size_t i_data = kViewerPage.find(kData);
  const std::size_t i_three = kViewerPage.find(kThree);
  const std::size_t i_viewer = kViewerPage.find(kViewer);
  std::string page(kViewerPage.substr(0, i_data));
  page += to_script_text(to_json(scene));
  page += kViewerPage.substr(i_data + kData.size(), i_three - i_data - kData.size());
  page += kThreeScript;
  page += kViewerPage.substr(i_three + kThree.size(), i_viewer - i_three - kThree.size());
  page += kViewerScript;
  page += kViewerPage.substr(i_viewer + kViewer.size());
  return page;
}

}  // namespace sopt
