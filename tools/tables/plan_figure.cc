#include "tools/io/plan_picture.h"
#include "tools/tables/tables_figures.h"
#include "tools/tables/timed_planner.h"

namespace sopt {

std::string draw_plan(const Scene& scene) {
  TimedPlanner<Point2> timed(scene);
  const PlanRequest<Point2> request = timed.make_request({}, 1);
  (void)timed.planner().plan(request);  // brings code and memory into the caches
  const PlanResult<Point2> result = timed.planner().plan(request);
  return draw(picture_of(scene, timed.planner(), result, result.times));
}

}  // namespace sopt
