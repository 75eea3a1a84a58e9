#include "tools/io/arm_picture.h"

#include <algorithm>
#include <cmath>

#include "models/space/clearance3.h"
#include "tools/io/arm_view.h"
#include "tools/io/json_fields.h"
#include "tools/io/picture_style.h"
#include "tools/io/plan_file.h"
#include "tools/io/plan_report.h"
#include "tools/io/space_page.h"
#include "tools/io/space_view.h"
#include "tools/io/svg.h"

namespace sopt {
namespace {

constexpr int kMaxBetween = 4;
constexpr double kWidth_px = 952.0;
constexpr double kMaxHeight_px = 700.0;
constexpr const char* kStartColor = "#009e73";
constexpr const char* kGoalColor = "#d55e00";
constexpr const char* kBetweenColor = "#0072b2";

// The color with a share of white in it.
std::string tinted(const char* color, double white) {
  const unsigned value = static_cast<unsigned>(std::stoul(color + 1, nullptr, 16));
  std::string text = "#";
  for (const unsigned shift : {16U, 8U, 0U}) {
    const double part = static_cast<double>((value >> shift) & 0xffU);
    text += format("%02x", static_cast<unsigned>(std::lround(part + white * (255.0 - part))));
  }
  return text;
}

// 0 the first .. 1 the last of the poses between.
std::string between_fill(double share) { return tinted(kBetweenColor, 0.86 - 0.5 * share); }

// --- painting

struct Look {
  std::string fill;
  std::string line;
  bool is_tool = false;
};

// Everything in space, with how it looks.
class Painting {
 public:
  Painting(const ArmPicture& picture, const SpacePage& page) : picture_(picture), page_(page) {
    for (int i = 0; i < picture.world->num_obstacles(); ++i) {
      const bool is_culprit = i == picture.i_culprit;
      add({picture.world->obstacle(i), num_groups_++, -1},
          {is_culprit ? "#e57373" : kObstacleColor, is_culprit ? kFailureColor : "#7b8794"});
    }
    num_obstacles_ = items_.size();
    const auto num_between = static_cast<int>(picture.between.size());
    for (int i = 0; i < num_between; ++i) {
      const double share = num_between > 1 ? i / (num_between - 1.0) : 0.5;
      add(picture.between[static_cast<std::size_t>(i)], i,
          {between_fill(share), tinted(kBetweenColor, 0.55 - 0.4 * share)});
    }
    add(picture.goal, num_between, {tinted(kGoalColor, 0.25), "#7d3700"});
    add(picture.start, num_between + 1, {tinted(kStartColor, 0.25), "#005c43"});
    add_tool_path(num_between + 2);
  }

  void draw(Svg& svg) const {
    const std::vector<int> order = paint_order(items_, page_.view());
    for (std::size_t first = 0; first < order.size();) {
      std::size_t last = first + 1;
      const int group = item(order[first]).group;
      while (last < order.size() && item(order[last]).group == group) ++last;
      const std::span<const int> run(&order[first], last - first);
      if (look(run[0]).is_tool) {
        draw_tool_path(run, svg);
      } else if (static_cast<std::size_t>(run[0]) < num_obstacles_) {
        draw_obstacle(run[0], svg);
      } else {
        draw_link(run, svg);
      }
      first = last;
    }
  }

 private:
  [[nodiscard]] const PaintItem& item(int i) const { return items_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] const Look& look(int i) const { return looks_[static_cast<std::size_t>(i)]; }

  void add(const PaintItem& item, const Look& look) {
    items_.push_back(item);
    looks_.push_back(look);
  }

  // What stands where the start has it is drawn once.
  void add(const std::vector<PlacedCapsule>& arm, int rank, const Look& look) {
    constexpr double kSame_m = 1e-3;
    const std::vector<PlacedCapsule>& start = picture_.start;
    const int first_group = num_groups_;
    for (std::size_t i = 0; i < arm.size(); ++i) {
      const auto& [i_link, capsule] = arm[i];
      const bool stands = &arm != &start && (capsule.p0 - start[i].capsule.p0).norm() < kSame_m &&
                          (capsule.p1 - start[i].capsule.p1).norm() < kSame_m;
      const int group = first_group + i_link;
      num_groups_ = std::max(num_groups_, group + 1);
      const bool is_base = i_link == 0;
      if (!stands && !is_inside_another(arm, i)) {
        add({to_convex(capsule), group, rank},
            is_base ? Look{tinted(kFaintInkColor, 0.4), kFaintInkColor} : look);
      }
    }
  }

  // Nobody sees it.
  static bool is_inside_another(const std::vector<PlacedCapsule>& arm, std::size_t i) {
    const Capsule3& inner = arm[i].capsule;
    return std::any_of(arm.begin(), arm.end(), [&](const PlacedCapsule& placed) {
      const Capsule3& outer = placed.capsule;
      if (outer.radius_m <= inner.radius_m) return false;
      const auto holds = [&](const Vec3& end) {
        const Capsule3 point{end, end, 0.0};
        return compute_clearance(to_convex(outer), point).distance_m < -inner.radius_m;
      };
      return holds(inner.p0) && holds(inner.p1);
    });
  }

  void add_tool_path(int rank) {
    const std::vector<Vec3>& path = picture_.tool_path;
    for (std::size_t i = 1; i < path.size(); ++i) {
      add({to_convex({path[i - 1], path[i], 0.0}), num_groups_, rank}, {"", kInkColor, true});
    }
    ++num_groups_;
  }

  void draw_obstacle(int i, Svg& svg) const {
    const SeenShape seen = see(item(i).shape, page_.view());
    const char* const color = look(i).fill.c_str();
    const auto paint = [&](const std::vector<Vec2>& outline, double light, double line_px) {
      svg.polyline(page_.at(outline), true,
                   fill(tinted(color, 0.15 + 0.65 * light)) +
                       (line_px > 0.0 ? attribute("stroke", look(i).line) +
                                            attribute("stroke-width", format("%g", line_px)) +
                                            attribute("stroke-linejoin", "round")
                                      : ""));
    };
    svg.begin_group(attribute("opacity", "0.82"));
    paint(seen.silhouette, 0.35, 1.2);
    const bool is_round = item(i).shape.is_round();
    for (const SeenFace& face : seen.faces) paint(face.outline, face.light, is_round ? 0.0 : 0.8);
    svg.end_group();
  }

  // Outlines first: what capsules of a link have in common shows no line.
  void draw_link(std::span<const int> run, Svg& svg) const {
    std::vector<std::vector<Vec2>> outlines;
    for (const int i : run) {
      outlines.push_back(page_.at(see(item(i).shape, page_.view()).silhouette));
    }
    if (outlines.size() == 1) {
      svg.polyline(outlines[0], true,
                   fill(look(run[0]).fill) + attribute("stroke", look(run[0]).line) +
                       attribute("stroke-width", "1.2"));
      return;
    }
    for (const auto& outline : outlines) {
      svg.polyline(outline, true, stroke(look(run[0]).line, 2.4));
    }
    for (const auto& outline : outlines) svg.polyline(outline, true, fill(look(run[0]).fill));
  }

  // Pieces of one run need not follow each other.
  void draw_tool_path(std::span<const int> run, Svg& svg) const {
    std::vector<Vec2> from;
    std::vector<Vec2> to;
    for (const int i : run) {
      const Capsule3 piece = to_capsule(item(i).shape);
      from.push_back(page_.at(piece.p0));
      to.push_back(page_.at(piece.p1));
    }
    svg.lines(from, to, stroke(kInkColor, 2.2));
  }

  const ArmPicture& picture_;
  const SpacePage& page_;
  std::vector<PaintItem> items_;
  std::vector<Look> looks_;
  std::size_t num_obstacles_ = 0;
  int num_groups_ = 0;
};

// --- the words

struct LegendEntry {
  std::string label;
  std::vector<std::string> fills;  // side by side; empty: the tool's path
};

std::vector<LegendEntry> legend_entries(const ArmPicture& picture) {
  const bool has_plan = !picture.tool_path.empty();
  std::vector<LegendEntry> entries;
  entries.push_back({has_plan ? "start, 0 s" : "start", {tinted(kStartColor, 0.25)}});
  entries.push_back(
      {has_plan ? format("goal, %.3g s", picture.duration_s) : "goal", {tinted(kGoalColor, 0.25)}});
  if (!picture.between.empty()) {
    LegendEntry entry{"in between, darker with time", {}};
    const std::size_t num = picture.between.size();
    for (std::size_t i = 0; i < num; ++i) {
      entry.fills.push_back(
          between_fill(num > 1 ? static_cast<double>(i) / static_cast<double>(num - 1) : 0.5));
    }
    entries.push_back(entry);
  }
  if (has_plan) entries.push_back({"tool's path and its shadow", {}});
  const int num_obstacles = picture.world->num_obstacles();
  entries.push_back({format("%d obstacle%s", num_obstacles, num_obstacles == 1 ? "" : "s"),
                     {tinted(kObstacleColor, 0.4)}});
  return entries;
}

void draw_sample(const LegendEntry& entry, const Vec2& at, Svg& svg) {
  const double width_px = LegendGrid::kSample_px;
  if (entry.fills.empty()) {
    svg.line(at, at + Vec2(width_px, 0.0), stroke(kInkColor, 2.2));
    return;
  }
  const double part_px = width_px / static_cast<double>(entry.fills.size());
  for (std::size_t i = 0; i < entry.fills.size(); ++i) {
    svg.rectangle(at + Vec2(part_px * static_cast<double>(i), -7.0), Vec2(part_px, 14.0),
                  fill(entry.fills[i]));
  }
}

}  // namespace

std::string draw(const ArmPicture& picture) {
  const Vec2 corner(kPad_px, picture.failure.empty() ? 84.0 : 110.0);
  const SpacePage page(best_view(picture), shown_boxes(picture), corner,
                       Vec2(kWidth_px, kMaxHeight_px));
  const std::vector<LegendEntry> entries = legend_entries(picture);
  double label_px = 0.0;
  for (const LegendEntry& entry : entries) {
    label_px = std::max(label_px, LegendGrid::label_px(entry.label));
  }
  const double below_px = page.corner().y() + page.size().y() + 18.0;
  LegendGrid legend(Vec2(kPad_px, below_px), kWidth_px, label_px, static_cast<int>(entries.size()));
  const double text_px =
      std::max({text_width_px(picture.title, 22, true), text_width_px(picture.details, 14),
                text_width_px(picture.failure, 17, true)});
  const Vec2 size(std::max(kWidth_px, text_px) + 2.0 * kPad_px,
                  below_px + legend.height_px() + 10.0);
  Svg svg(size.x(), size.y());
  svg.rectangle(Vec2::Zero(), size, fill("white"));
  svg.text(Vec2(kPad_px, 38.0), picture.title, font(22, kInkColor, true));
  svg.text(Vec2(kPad_px, 64.0), picture.details, font(14, kFaintInkColor));
  if (!picture.failure.empty()) {
    svg.text(Vec2(kPad_px, 92.0), picture.failure, font(17, kFailureColor, true));
  }
  svg.begin_clip(page.corner(), page.size());
  page.draw_floor(picture.tool_path, svg);
  Painting(picture, page).draw(svg);
  page.draw_scales(svg);
  if (!picture.tool_path.empty()) {
    svg.polyline(page.at(picture.tool_path), false,
                 stroke(kInkColor, 1.6) + attribute("stroke-dasharray", "1 4"));
  }
  svg.end_group();
  for (const LegendEntry& entry : entries) draw_sample(entry, legend.add(entry.label, svg), svg);
  return svg.finish();
}

template <int N>
ArmPicture picture_of(const ArmScene<N>& scene, const PlanResult<Arm<N>>& result,
                      const StageTimes& times) {
  ArmPicture picture;
  picture.world = scene.world.get();
  picture.title = printable(scene.name) + ": " + to_string(result.status);
  picture.details = describe_figures(result, times);
  picture.failure = describe_failure<Arm<N>>(scene, result);
  picture.start = place_capsules(scene.arm, scene.start);
  picture.goal = place_capsules(scene.arm, scene.goal);
  if (!result.plan) {
    picture.i_culprit = result.failure.i_obstacle;
    return picture;
  }
  const Trajectory<Arm<N>>& trajectory = result.plan->trajectory();
  picture.duration_s = trajectory.duration_s();
  const auto config = [&](int i) { return trajectory.states[i].template head<N>().eval(); };
  double length = 0.0;
  for (int i = 0; i <= trajectory.horizon(); ++i) {
    picture.tool_path.push_back(tool_point(scene.arm, config(i)));
    if (i > 0) length += (config(i) - config(i - 1)).norm();
  }
  // Evenly along the path: at rest there is nothing to see.
  double passed = 0.0;
  int num_between = 0;
  for (int i = 1; i < trajectory.horizon() && num_between < kMaxBetween; ++i) {
    passed += (config(i) - config(i - 1)).norm();
    if (passed < length * (num_between + 1) / (kMaxBetween + 1)) continue;
    picture.between.push_back(place_capsules(scene.arm, config(i)));
    ++num_between;
  }
  return picture;
}

#define SOPT_ARM_PICTURE(Robot)                                                   \
  template ArmPicture picture_of(const SceneOf<Robot>&, const PlanResult<Robot>&, \
                                 const StageTimes&);
SOPT_ARM_PICTURE(Arm<4>)
SOPT_ARM_PICTURE(Arm<5>)
SOPT_ARM_PICTURE(Arm<6>)
SOPT_ARM_PICTURE(Arm<7>)
SOPT_ARM_PICTURE(Arm<8>)
#undef SOPT_ARM_PICTURE

}  // namespace sopt
