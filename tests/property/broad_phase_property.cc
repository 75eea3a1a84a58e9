// The broad phase against a scan over all boxes: every box within the radius of the segment is
// visited, each once, and none that is further away than the box corners of its three axes allow.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "alloc/memory_block.h"
#include "models/plane/broad_phase2.h"
#include "tests/support/property.h"
#include "tests/support/test_world.h"

namespace {

using namespace sopt;
using namespace sopt::oracle;

constexpr int kMaxBoxes = 3000;
constexpr double kSlack_m = 1e-9;

struct Query {
  Vec2 p, q;
  double radius_m = 0.0;
};

std::vector<Aabb2> draw_boxes(Random& random, bool on_grid, double extent) {
  static constexpr int kCounts[] = {0, 1, 2, 7, 8, 9, 16, 40, 64, 65, 200};
  int count = kCounts[random.index(11)];
  if (random.chance(0.02)) count = random.index(kMaxBoxes + 1);
  const Vec2 shift = random.chance(0.2) ? Vec2(1e4, -3e4) : Vec2(0.0, 0.0);
  std::vector<Aabb2> boxes;
  for (int i = 0; i < count; ++i) {
    Vec2 lower = random.point({Vec2::Zero(), Vec2::Constant(extent)});
    const double width = std::pow(10.0, random.uniform(-3.0, 1.0));
    Vec2 size(width, random.chance(0.5) ? width : random.uniform(0.0, 5.0));
    if (on_grid) {
      lower = lower.array().floor();
      size = size.array().ceil();
    }
    boxes.push_back({lower + shift, lower + shift + size});
  }
  return boxes;
}

Query draw_query(Random& random, const std::vector<Aabb2>& boxes, bool on_grid, double extent) {
  const Vec2 shift = boxes.empty() ? Vec2(0.0, 0.0) : Vec2(boxes[0].lower.array().floor());
  const Aabb2 area = {shift - Vec2::Constant(1.2 * extent), shift + Vec2::Constant(1.2 * extent)};
  Query query = {random.point(area), random.point(area), 0.0};
  if (random.chance(0.3)) query.q = query.p + 0.02 * (query.q - query.p);
  if (random.chance(0.8)) query.radius_m = std::pow(10.0, random.uniform(-3.0, 1.0));
  if (on_grid) {
    query.p = query.p.array().floor();
    query.q = query.q.array().floor();
    query.radius_m = std::ceil(query.radius_m);
  }
  if (random.chance(0.1)) query.q = query.p;
  return query;
}

std::string to_text(const std::vector<Aabb2>& boxes, const Query& query) {
  std::string text = "segment " + sopt::oracle::to_text(query.p) + " to " +
                     sopt::oracle::to_text(query.q) + " radius " + std::to_string(query.radius_m);
  for (const Aabb2& box : boxes) {
    text += "\n    " + sopt::oracle::to_text(box.lower) + " " + sopt::oracle::to_text(box.upper);
  }
  return text;
}

double segment_box_distance(const Aabb2& box, const Query& query) {
  const Outline outline = outline_of(box_between(box.lower, box.upper));
  return std::max(0.0, min_point_distance(outline, query.p, query.q));
}

std::string check_case(Random& random, CaseReport& report) {
  static const MemoryBlock kBlock(8 << 20);
  Arena arena(kBlock);
  BroadPhase2 tree(arena, kMaxBoxes);
  const bool on_grid = random.chance(0.4);
  const double extent = random.uniform(3.0, 100.0);
  const std::vector<Aabb2> boxes = draw_boxes(random, on_grid, extent);
  const Query query = draw_query(random, boxes, on_grid, extent);
  report.expect("memory suffices", !arena.exhausted());
  report.expect("build takes its capacity", tree.build(boxes));

  std::vector<int> num_visits(boxes.size(), 0);
  const bool is_done = tree.for_each_near(query.p, query.q, query.radius_m, [&](int i) {
    if (i < 0 || i >= static_cast<int>(boxes.size())) return false;
    ++num_visits[static_cast<std::size_t>(i)];
    return true;
  });
  report.expect("visits only boxes there are", is_done);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    report.expect("visits a box at most once", num_visits[i] <= 1);
    const double distance_m = segment_box_distance(boxes[i], query);
    if (num_visits[i] == 0) {
      report.expect("misses no box", distance_m > query.radius_m - kSlack_m);
    } else {
      report.expect_within("visits only boxes that are near",
                           distance_m - std::numbers::sqrt2 * query.radius_m, kSlack_m);
    }
  }
  return report.failed() ? to_text(boxes, query) : std::string();
}

}  // namespace

int main(int argc, char** argv) { return run_property("broad_phase", argc, argv, check_case); }
