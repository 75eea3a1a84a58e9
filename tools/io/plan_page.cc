#include "tools/io/plan_page.h"

#include <cmath>
#include <limits>

#include "models/arm/arm_clearance.h"
#include "tools/io/arm_shape.h"
#include "tools/io/json_fields.h"
#include "tools/io/plan_file.h"
#include "tools/io/plan_report.h"

namespace sopt {
namespace {

constexpr double kFar_m = 1e3;
constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr double kUnlimited = std::numeric_limits<double>::infinity();

// What every robot's page says.
template <class Robot>
HtmlScene header(const SceneOf<Robot>& scene, const PlanResult<Robot>& result,
                 const StageTimes& times) {
  HtmlScene page;
  page.title = printable(scene.name) + ": " + to_string(result.status);
  page.facts = describe_figures(result, times);
  page.failure = describe_failure<Robot>(scene, result);
  if (!result.plan) return page;
  const Trajectory<Robot>& trajectory = result.plan->trajectory();
  for (int i = 0; i <= trajectory.horizon(); ++i) page.times_s.push_back(i * trajectory.dt_s);
  return page;
}

template <class Robot>
bool is_culprit(const PlanResult<Robot>& result, int i_obstacle) {
  return !result.plan && result.failure.i_obstacle == i_obstacle;
}

HtmlPlot clearance_plot(std::vector<HtmlSeries> series, const PlanOptions& options) {
  HtmlPlot plot{"clearance", "m", {}, {}};
  for (HtmlSeries& one : series) {
    bool has_values = false;
    for (const double value : one.values) has_values = has_values || !std::isnan(value);
    if (has_values) plot.series.push_back(std::move(one));
  }
  plot.levels = {{"margin", options.margin_m}, {"least allowed", options.min_clearance_m}};
  return plot;
}

void add(HtmlPlot plot, std::vector<HtmlPlot>& plots) {
  if (!plot.series.empty()) plots.push_back(std::move(plot));
}

// --- plane

Vec3 lifted(const Vec2& p, double height_m) { return {p.x(), p.y(), height_m}; }

void add_motion(const Scene& scene, const Trajectory<Point2>& trajectory,
                const PlanOptions& options, double height_m, HtmlScene& page) {
  HtmlSeries x{"x", {}, {}, {}};
  HtmlSeries y{"y", {}, {}, {}};
  HtmlSeries clearance{"obstacles and bounds", {}, {}, {}};
  for (const Vec2& state : trajectory.states) {
    page.frames.push_back({{lifted(state, 0.0), lifted(state, 0.0)}});
    page.tool_path.push_back(lifted(state, height_m));
    x.values.push_back(state.x());
    y.values.push_back(state.y());
    const NearestObstacle nearest = scene.robot.clearance(*scene.world, state, kFar_m);
    const bool is_near = nearest.i_obstacle != kNoObstacle;
    clearance.values.push_back(is_near ? nearest.distance_m : kNothing);
  }
  HtmlSeries vx{"vx", {}, {}, {}};
  HtmlSeries vy{"vy", {}, {}, {}};
  HtmlSeries speed{"speed", {}, {}, {}};
  if (scene.robot.v_max_mps < kUnlimited) speed.upper = scene.robot.v_max_mps;
  for (const Vec2& input : trajectory.inputs) {
    vx.values.push_back(input.x());
    vy.values.push_back(input.y());
    speed.values.push_back(input.norm());
  }
  add({"position", "m", {x, y}, {}}, page.plots);
  add({"velocity", "m/s", {vx, vy, speed}, {}}, page.plots);
  add(clearance_plot({clearance}, options), page.plots);
}

// --- arms

std::vector<HtmlSegment> segments_of(const std::vector<PlacedCapsule>& arm) {
  std::vector<HtmlSegment> segments;
  for (const auto& [i_link, capsule] : arm) segments.push_back({capsule.p0, capsule.p1});
  return segments;
}

// One plot for joints that turn and one for those that slide.
template <int N, class Value>
void add_joint_plots(const ArmScene<N>& scene, const char* title, const char* per, int num_values,
                     const Value& value, const typename Arm<N>::Config& lower,
                     const typename Arm<N>::Config& upper, std::vector<HtmlPlot>& plots) {
  for (const bool slides : {false, true}) {
    HtmlPlot plot{title, std::string(slides ? "m" : "rad") + per, {}, {}};
    for (int j = 0; j < N; ++j) {
      if ((scene.arm.joint(j).kind == JointKind::kPrismatic) != slides) continue;
      HtmlSeries series{printable(scene.joint_names[static_cast<std::size_t>(j)]), {}, {}, {}};
      if (lower[j] > -kUnlimited) series.lower = lower[j];
      if (upper[j] < kUnlimited) series.upper = upper[j];
      for (int i = 0; i < num_values; ++i) series.values.push_back(value(i)[j]);
      plot.series.push_back(std::move(series));
    }
    add(std::move(plot), plots);
  }
}

template <int N>
HtmlPlot arm_clearance_plot(const ArmScene<N>& scene, const Trajectory<Arm<N>>& trajectory,
                            const PlanOptions& options) {
  HtmlSeries obstacles{"obstacles", {}, {}, {}};
  HtmlSeries links{"own links", {}, {}, {}};
  for (const auto& state : trajectory.states) {
    ArmPose<N> pose;
    scene.arm.forward(state.template head<N>(), pose);
    const ArmContact nearest = nearest_obstacle(scene.arm, *scene.world, pose, kFar_m);
    const bool is_near = nearest.i_obstacle != kNoObstacle;
    obstacles.values.push_back(is_near ? nearest.clearance.distance_m : kNothing);
    const ArmContact pair = nearest_link_pair(scene.arm, pose, kFar_m);
    const bool has_pair = pair.i_obstacle == kSelfObstacle;
    links.values.push_back(has_pair ? pair.clearance.distance_m : kNothing);
  }
  return clearance_plot({obstacles, links}, options);
}

template <int N>
void add_motion(const ArmScene<N>& scene, const Trajectory<Arm<N>>& trajectory,
                const PlanOptions& options, HtmlScene& page) {
  const Arm<N>& arm = scene.arm;
  for (const auto& state : trajectory.states) {
    page.frames.push_back(segments_of(place_capsules(arm, state.template head<N>())));
    page.tool_path.push_back(tool_point(arm, state.template head<N>()));
  }
  const auto& states = trajectory.states;
  const auto position = [&](int i) { return states[i].template head<N>(); };
  const auto velocity = [&](int i) { return states[i].template tail<N>(); };
  const auto input = [&](int i) -> const auto& { return trajectory.inputs[i]; };
  add_joint_plots(scene, "position", "", states.size(), position, arm.lower(), arm.upper(),
                  page.plots);
  add_joint_plots(scene, "velocity", "/s", states.size(), velocity, -arm.v_max(), arm.v_max(),
                  page.plots);
  add_joint_plots(scene, "acceleration", "/s\u00b2", trajectory.horizon(), input, -arm.a_max(),
                  arm.a_max(), page.plots);
  add(arm_clearance_plot(scene, trajectory, options), page.plots);
}

}  // namespace

HtmlScene page_of(const Scene& scene, const PlanRequest<Point2>& request,
                  const PlanResult<Point2>& result, const StageTimes& times) {
  HtmlScene page = header(scene, result, times);
  page.is_flat = true;
  page.bounds = scene.world->bounds();
  const double height_m = 0.01 * (page.bounds->upper - page.bounds->lower).norm();
  for (int i = 0; i < scene.world->num_obstacles(); ++i) {
    page.obstacles.push_back(make_html_obstacle(scene.world->obstacle(i), height_m));
    page.obstacles.back().is_culprit = is_culprit(result, i);
  }
  page.capsules = {{0, scene.robot.radius_m}};
  page.start = {{lifted(scene.start, 0.0), lifted(scene.start, 0.0)}};
  page.goal = {{lifted(scene.goal, 0.0), lifted(scene.goal, 0.0)}};
  if (result.plan) {
    add_motion(scene, result.plan->trajectory(), request.options, height_m, page);
  }
  return page;
}

template <int N>
HtmlScene page_of(const ArmScene<N>& scene, const PlanRequest<Arm<N>>& request,
                  const PlanResult<Arm<N>>& result, const StageTimes& times) {
  HtmlScene page = header(scene, result, times);
  for (int i = 0; i < scene.world->num_obstacles(); ++i) {
    page.obstacles.push_back(make_html_obstacle(scene.world->obstacle(i)));
    page.obstacles.back().is_culprit = is_culprit(result, i);
  }
  const std::vector<PlacedCapsule> start = place_capsules(scene.arm, scene.start);
  for (const auto& [i_link, capsule] : start) page.capsules.push_back({i_link, capsule.radius_m});
  page.start = segments_of(start);
  page.goal = segments_of(place_capsules(scene.arm, scene.goal));
  if (result.plan) add_motion(scene, result.plan->trajectory(), request.options, page);
  return page;
}

#define SOPT_PLAN_PAGE(Robot)                                                  \
  template HtmlScene page_of(const SceneOf<Robot>&, const PlanRequest<Robot>&, \
                             const PlanResult<Robot>&, const StageTimes&);
SOPT_PLAN_PAGE(Arm<4>)
SOPT_PLAN_PAGE(Arm<5>)
SOPT_PLAN_PAGE(Arm<6>)
SOPT_PLAN_PAGE(Arm<7>)
SOPT_PLAN_PAGE(Arm<8>)
#undef SOPT_PLAN_PAGE

}  // namespace sopt
