#include "tools/qp/recorded_qps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "alloc/arena.h"
#include "alloc/fixed_vector.h"
#include "alloc/memory_block.h"
#include "opt/plane/obstacle_rows.h"
#include "opt/plane/point_window.h"
#include "opt/reference.h"
#include "opt/segmented_optimizer.h"
#include "tools/cli/planner_host.h"
#include "tools/io/input_error.h"
#include "tools/io/json_fields.h"
#include "tools/io/plan_report.h"

namespace sopt {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr int kNumSweeps = 4;  // two of each parity
constexpr double kSameNormal_rad = 0.2;

// A plan that stops at its reference, and what its windows keep clear.
struct Plan0 {
  std::vector<Vec2> states;
  MarginProfile profile;
  double ds_m = 0.0;
};

Plan0 make_plan_0(const Scene& scene, std::uint64_t seed) {
  PlanRequest<Point2> request = make_request(scene);
  request.seed = seed;
  PlanOptions& options = request.options;
  options.max_iterations = 0;
  options.resampling = Resampling::kOff;
  const auto host = std::make_unique<PlannerHost<Point2>>(scene, options);
  const PlanResult<Point2> result = host->planner().plan(request);
  if (!result.plan) {
    throw InputError(printable(scene.file.string(), 400) + ": no plan with seed " +
                     std::to_string(seed) + ", " + result.failure.reason);
  }
  const auto& states = result.plan->trajectory().states;
  Plan0 plan;
  plan.states.assign(states.begin(), states.end());
  const double rung = options.margin_m > 0.0 ? result.margin_m / options.margin_m : 1.0;
  plan.profile.rule = {options.margin_m, rung, options.min_clearance_m};
  plan.ds_m = choose_step_length(scene.robot, *scene.world, options);
  return plan;
}

SegmentQp to_segment_qp(const PointRows& rows, const std::vector<Vec2>& reference) {
  SegmentQp problem;
  KernelPart<double>& part = problem.arm;
  part.order = 1;
  part.weights = {0.0, 1.0, 0.0};
  part.num_steps = rows.num_steps();
  part.num_joints = 2;
  part.first_position.assign(reference.front().begin(), reference.front().end());
  part.last_position.assign(reference.back().begin(), reference.back().end());
  for (int id = 0; id < rows.num_ids(); ++id) {
    if (!rows.is_free(id)) continue;
    const PointRows::Row row = rows.row(id);
    part.rows.push_back({Quantity::kPosition, row.t, {row.normal.x(), row.normal.y()}, row.bound});
  }
  return problem;
}

bool holds(const KernelPart<double>& part, const std::vector<Vec2>& points) {
  return std::all_of(part.rows.begin(), part.rows.end(), [&](const KernelRow<double>& row) {
    const Vec2& point = points[static_cast<std::size_t>(row.t)];
    return Vec2(row.direction.data()).dot(point) >=
           row.bound - WindowOptimizer<Point2>::kRowTolerance_m;
  });
}

// Scratch memory of the optimiser.
struct Workspace {
  Splits splits;
  FixedVector<Window> windows;
  PointRows rows;
  WindowOptimizer<Point2> optimizer;

  Workspace(Arena& arena, const PlannerSettings& settings)
      : splits(arena, settings.max_horizon),
        windows(arena, settings.max_horizon / 2 + 2),
        rows(arena, settings.max_window, settings.rows_per_window),
        optimizer(arena, settings) {}

  [[nodiscard]] static std::size_t required_bytes(const PlannerSettings& settings) {
    Arena arena = Arena::measuring();
    const Workspace measured(arena, settings);
    return arena.used_B();
  }
};

class Recorder {
 public:
  Recorder(const Scene& scene, Plan0 plan, const PlannerSettings& settings)
      : plan_(std::move(plan)),
        memory_(Workspace::required_bytes(settings)),
        arena_(memory_),
        workspace_(arena_, settings) {
    if (arena_.exhausted()) throw HostError("no memory for the windows of a plan");
    sweep_ = {&scene.robot, scene.world.get(), plan_.profile, first_trust_m(plan_.ds_m),
              plan_.ds_m,   plan_.states};
  }

  std::vector<RecordedQp> run() {
    const int horizon = static_cast<int>(plan_.states.size()) - 1;
    const int num_segments =
        choose_num_segments(PlanOptions(), horizon, PlannerSettings().max_window);
    if (!workspace_.splits.try_reset(horizon, num_segments)) return {};
    for (int k = 1; k <= kNumSweeps; ++k) run_sweep(k);
    return std::move(recorded_);
  }

 private:
  void run_sweep(int k) {
    workspace_.splits.list_windows(k % 2 == 1 ? Parity::kOdd : Parity::kEven, workspace_.windows);
    SweepSummary summary;
    for (const Window& window : workspace_.windows) {
      if (window.num_steps() < 2) continue;
      record(k, window);
      const WindowResult result = workspace_.optimizer.optimize(sweep_, window, Deadline());
      summary.displacement_m = std::max(summary.displacement_m, result.displacement_m);
      summary.was_shortened = summary.was_shortened || result.was_shortened;
    }
    sweep_.trust_m = next_trust_m(summary, sweep_.trust_m, plan_.ds_m);
  }

  void record(int k, const Window& window) {
    if (!make_rows(window)) return;
    RecordedQp qp = {k, window, {}, {}};
    const auto first = plan_.states.begin() + window.first;
    qp.reference.assign(first, first + window.num_steps() + 1);
    qp.problem = to_segment_qp(workspace_.rows, qp.reference);
    if (qp.problem.arm.rows.empty() || !holds(qp.problem.arm, qp.reference)) return;
    recorded_.push_back(std::move(qp));
  }

  bool make_rows(const Window& window) {
    double trust_m = sweep_.trust_m;
    std::int64_t num_queries = 0;
    for (int halvings = 0; halvings <= WindowOptimizer<Point2>::kMaxTrustHalvings; ++halvings) {
      if (make_obstacle_rows(*sweep_.robot, *sweep_.world, sweep_.profile, sweep_.states, window,
                             trust_m, workspace_.rows, num_queries)) {
        return true;
      }
      trust_m *= 0.5;
    }
    return false;
  }

  Plan0 plan_;
  MemoryBlock memory_;
  Arena arena_;
  Workspace workspace_;
  SweepProblem<Point2> sweep_;  // states: those of plan_
  std::vector<RecordedQp> recorded_;
};

// The row of `part` nearest to `row` in direction, then in bound; -1: none is near.
int find_nearest(const KernelRow<double>& row, const KernelPart<double>& part) {
  static const double kMaxChord = 2.0 * std::sin(0.5 * kSameNormal_rad);
  int best = -1;
  std::pair<double, double> least = {kMaxChord, kInfinity};
  for (std::size_t i = 0; i < part.rows.size(); ++i) {
    const KernelRow<double>& other = part.rows[i];
    if (other.t != row.t) continue;
    const double chord = (Vec2(other.direction.data()) - Vec2(row.direction.data())).norm();
    const std::pair<double, double> distance = {chord, std::abs(other.bound - row.bound)};
    if (distance >= least) continue;
    least = distance;
    best = static_cast<int>(i);
  }
  return best;
}

bool are_same_window(const RecordedQp& a, const RecordedQp& b) {
  return a.window.first == b.window.first && a.window.last == b.window.last;
}

}  // namespace

std::vector<RecordedQp> record_qps(const Scene& scene, std::uint64_t seed) {
  const PlannerSettings settings = make_settings(scene, make_request(scene).options);
  return Recorder(scene, make_plan_0(scene, seed), settings).run();
}

std::vector<int> match_rows(const KernelPart<double>& cold, const KernelPart<double>& warm) {
  std::vector<int> warm_row_of;
  for (std::size_t i = 0; i < cold.rows.size(); ++i) {
    const int nearest = find_nearest(cold.rows[i], warm);
    const bool is_mutual =
        nearest >= 0 &&
        find_nearest(warm.rows[static_cast<std::size_t>(nearest)], cold) == static_cast<int>(i);
    warm_row_of.push_back(is_mutual ? nearest : -1);
  }
  return warm_row_of;
}

QpFamily make_recorded_family(const std::vector<std::filesystem::path>& scenes,
                              std::uint64_t seed) {
  QpFamily family = {std::string(1, kRecordedFamily), "windows of plans in the plane", {}};
  for (const std::filesystem::path& file : scenes) {
    const Scene scene = load_scene(file);
    const std::vector<RecordedQp> recorded = record_qps(scene, seed);
    for (const RecordedQp& cold : recorded) {
      const auto warm = std::find_if(recorded.begin(), recorded.end(), [&](const RecordedQp& qp) {
        return qp.sweep == cold.sweep + 2 && are_same_window(qp, cold);
      });
      if (warm == recorded.end()) continue;
      const std::string name = format("%s, sweep %d, steps %d .. %d", printable(scene.name).c_str(),
                                      cold.sweep, cold.window.first, cold.window.last);
      family.pairs.push_back(
          {name, cold.problem, warm->problem, match_rows(cold.problem.arm, warm->problem.arm)});
    }
  }
  return family;
}

}  // namespace sopt
