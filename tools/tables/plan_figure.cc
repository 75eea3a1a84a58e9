#include "tools/io/json_fields.h"
#include "tools/io/plan_file.h"
#include "tools/io/plan_picture.h"
#include "tools/io/plan_report.h"
#include "tools/tables/tables_figures.h"
#include "tools/tables/timed_planner.h"

namespace sopt {

std::string draw_plan(const Scene& scene) {
  TimedPlanner timed(scene);
  const PlanRequest<Point2> request = timed.make_request({}, 1);
  (void)timed.planner().plan(request);  // brings code and memory into the caches
  const PlanResult<Point2> result = timed.planner().plan(request);
  PlanPicture picture;
  picture.scene = &scene;
  picture.title = printable(scene.name) + ": " + to_string(result.status);
  picture.details = describe_figures(result, result.times);
  picture.failure = describe_failure(scene, result);
  for (int i = 0; i < timed.planner().num_streams(); ++i) {
    const SamplerStream<Point2>& stream = timed.planner().stream(i);
    for (int node = 0; node < stream.num_nodes(); ++node) {
      if (stream.parent(node) < 0) continue;
      picture.tree_from.push_back(stream.node(stream.parent(node)));
      picture.tree_to.push_back(stream.node(node));
    }
  }
  if (result.path != nullptr) {
    picture.path.assign(result.path->vertices.begin(), result.path->vertices.end());
  }
  if (!result.plan) return draw(picture);
  const Trajectory<Point2>& trajectory = result.plan->trajectory();
  picture.waypoints.assign(trajectory.states.begin(), trajectory.states.end());
  picture.segment_ends = segment_ends(result.splits, trajectory.horizon());
  return draw(picture);
}

}  // namespace sopt
