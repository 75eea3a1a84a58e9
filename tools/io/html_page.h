// One plan as one HTML file that needs no network: the scene in 3-D, the robot as capsules that
// play, pause and scrub, the tool's path, plots over time. tools/io/viewer draws it; here its data
// becomes JSON in the page, escaped so that no name can end the script. Works for robots in space
// and, with is_flat, in the plane (z = 0, seen from above). World coordinates in m, z up. Values
// that are not finite leave gaps. Without frames the page shows the scene alone.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/plane/convex2.h"
#include "models/space/shape3.h"

namespace sopt {

struct HtmlObstacle {
  enum class Kind : std::int8_t { kBox, kCylinder, kCapsule, kHull };

  Kind kind = Kind::kBox;
  Pose3 pose;                  // of the middle; axes of cylinder and capsule along z
  Vec3 size_m = Vec3::Zero();  // box
  double radius_m = 0.0;       // cylinder, capsule
  double height_m = 0.0;       // cylinder; of a capsule's core
  std::vector<Vec3> vertices;  // hull, world
  bool is_culprit = false;     // red: the failure names it
};

struct HtmlCapsule {
  int i_link = 0;  // neighbours differ in colour
  double radius_m = 0.0;
};

struct HtmlSegment {
  Vec3 p0 = Vec3::Zero();
  Vec3 p1 = Vec3::Zero();
};

struct HtmlSeries {
  std::string name;
  std::vector<double> values;  // one per time, or one per step between them
  std::optional<double> lower;
  std::optional<double> upper;
};

struct HtmlLevel {
  std::string name;
  double value = 0.0;
};

struct HtmlPlot {
  std::string title;
  std::string unit;
  std::vector<HtmlSeries> series;
  std::vector<HtmlLevel> levels;  // lines across, as the margin
};

struct HtmlScene {
  std::string title;
  std::string facts;    // beside the title
  std::string failure;  // below, red
  bool is_flat = false;
  std::optional<Aabb2> bounds;
  std::vector<HtmlObstacle> obstacles;
  std::vector<double> times_s;                   // increasing
  std::vector<HtmlCapsule> capsules;             // of the robot
  std::vector<HtmlSegment> start, goal;          // per capsule; green and red
  std::vector<std::vector<HtmlSegment>> frames;  // per time, per capsule
  std::vector<Vec3> tool_path;
  std::vector<HtmlPlot> plots;
};

[[nodiscard]] HtmlObstacle make_html_obstacle(const Convex3& shape);
// A prism or cylinder around z = 0 of that height.
[[nodiscard]] HtmlObstacle make_html_obstacle(const ConvexView& shape, double height_m);

// The whole file. Throws std::invalid_argument when the sizes of frames or series do not fit.
[[nodiscard]] std::string html_page(const HtmlScene& scene);

}  // namespace sopt
