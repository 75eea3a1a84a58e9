#include "tools/bench/bench_scaling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "opt/reference.h"
#include "opt/time_scaling.h"
#include "sampler/shortcut.h"
#include "tools/bench/bench_statistics.h"
#include "tools/cli/planner_host.h"

namespace sopt {
namespace {

constexpr double kHorizonLimit = 1.1;    // linear, and logarithms
constexpr double kObstaclesLimit = 1.0;  // sub-linear

constexpr std::array kStages = {&StageTimes::sample_ns,    &StageTimes::shortcut_ns,
                                &StageTimes::reference_ns, &StageTimes::optimize_ns,
                                &StageTimes::verify_ns,    &StageTimes::total_ns};

// Runs `plan` once to warm up, then `num_repeats` times if that succeeded.
template <class Plan>
ScalingPlan measure(int num_repeats, Plan&& plan) {
  ScalingPlan result = plan();
  std::array<std::vector<double>, kStages.size()> times;
  for (int i = 0; i < num_repeats && result.is_planned; ++i) {
    const ScalingPlan repeated = plan();
    for (std::size_t k = 0; k < kStages.size(); ++k) {
      times[k].push_back(static_cast<double>(repeated.times.*kStages[k]));
    }
  }
  for (std::size_t k = 0; k < kStages.size() && result.is_planned; ++k) {
    result.times.*kStages[k] = std::llround(summarize(times[k]).median);
  }
  return result;
}

ScalingPlan to_plan(const PlanResult<Point2>& result) {
  ScalingPlan plan;
  plan.is_planned = result.status >= PlanStatus::kOk;
  plan.times = result.times;
  plan.horizon = result.plan ? result.plan->trajectory().horizon() : 0;
  plan.iterations = result.iterations;
  plan.sampler_counts = result.sampler_counts;
  plan.optimizer_counts = result.optimizer_counts;
  return plan;
}

// What Planner::plan does behind the sampler, from a given path.
class KnownWayPlanner {
 public:
  KnownWayPlanner(const Scene& scene, const PlanRequest<Point2>& request, Clock clock)
      : scene_(&scene),
        request_(&request),
        clock_(clock),
        settings_(make_settings(scene, request.options)),
        memory_(required_bytes(settings_)),
        arena_(memory_),
        parts_(arena_, settings_, executor_, clock) {
    if (arena_.exhausted()) throw HostError("the host has no memory for the optimiser");
  }

  ScalingPlan plan(const std::vector<Vec2>& way) {
    const PlanOptions& options = request_->options;
    parts_.path.vertices.clear();
    for (const Vec2& vertex : way) (void)parts_.path.vertices.try_push_back(vertex);
    MarginProfile profile;
    profile.rule = {options.margin_m, 1.0, options.min_clearance_m};
    profile.step_length = options.speed_mps * options.dt_s;

    ScalingPlan result;
    const std::int64_t begin_ns = clock_.now_ns();
    MotionChecker<Point2> checker(scene_->robot, *scene_->world, profile);
    CounterRng rng(request_->seed);
    shortcut_path(checker, rng, Deadline(), parts_.path);
    const std::int64_t reference_ns = clock_.now_ns();
    result.is_planned = make_reference(scene_->robot, parts_.path, profile.step_length,
                                       options.dt_s, parts_.trajectory);
    const std::int64_t optimize_ns = clock_.now_ns();
    const OptimizerResult<Point2> optimized = parts_.optimizer.optimize(
        {&scene_->robot, scene_->world.get(), profile, profile.step_length, &options},
        parts_.trajectory, Deadline());
    result.is_planned = result.is_planned && fill_inputs(parts_.trajectory);
    const std::int64_t verify_ns = clock_.now_ns();
    const VerifyResult<Point2> verified =
        verify(scene_->robot, parts_.trajectory,
               {request_->start, request_->goal, request_->world, options.min_clearance_m});
    const std::int64_t end_ns = clock_.now_ns();

    result.is_planned = result.is_planned && verified.plan.has_value();
    result.times.shortcut_ns = reference_ns - begin_ns;
    result.times.reference_ns = optimize_ns - reference_ns;
    result.times.optimize_ns = verify_ns - optimize_ns;
    result.times.verify_ns = end_ns - verify_ns;
    result.times.total_ns = end_ns - begin_ns;
    result.horizon = parts_.trajectory.horizon();
    result.iterations = optimized.iterations;
    result.sampler_counts.edges = checker.num_checks();
    result.optimizer_counts = optimized.counts;
    return result;
  }

 private:
  struct Parts {
    Parts(Arena& arena, const PlannerSettings& settings, Executor& executor, Clock clock)
        : path(arena, settings.max_path_vertices),
          trajectory(arena, settings.max_horizon),
          optimizer(arena, settings, executor, clock) {}
    Path<Point2> path;
    Trajectory<Point2> trajectory;
    SegmentedOptimizer<Point2> optimizer;
  };

  static std::size_t required_bytes(const PlannerSettings& settings) {
    Arena arena = Arena::measuring();
    SerialExecutor executor;
    const Parts parts(arena, settings, executor, Clock{});
    return arena.used_B();
  }

  const Scene* scene_;
  const PlanRequest<Point2>* request_;
  Clock clock_;
  PlannerSettings settings_;
  MemoryBlock memory_;
  Arena arena_;
  SerialExecutor executor_;
  Parts parts_;
};

ScalingCase run_case(ScalingFamily family, int size, std::uint64_t seed,
                     const BenchScalingOptions& options) {
  const ScalingScene made = make_scaling_scene(family, size, seed);
  PlanRequest<Point2> request = make_request(made.scene);
  request.seed = seed;
  request.options.num_samples = options.num_samples.value_or(request.options.num_samples);
  ScalingCase result;
  result.size = size;
  result.seed = seed;
  result.num_obstacles = made.scene.world->num_obstacles();
  const auto host =
      std::make_unique<PlannerHost<Point2>>(made.scene, request.options, options.clock);
  result.plan =
      measure(options.num_repeats, [&] { return to_plan(host->planner().plan(request)); });
  if (made.way.empty()) return result;
  const auto planner = std::make_unique<KnownWayPlanner>(made.scene, request, options.clock);
  result.known_way = measure(options.num_repeats, [&] { return planner->plan(made.way); });
  return result;
}

double us(std::int64_t time_ns) { return 1e-3 * static_cast<double>(time_ns); }
double count(std::int64_t number) { return static_cast<double>(number); }

}  // namespace

std::vector<ScalingRun> run_bench_scaling(const BenchScalingOptions& options) {
  std::vector<ScalingRun> runs;
  for (const ScalingFamily family : options.families) {
    ScalingRun& run = runs.emplace_back();
    run.family = family;
    for (const int size : scaling_sizes(family)) {
      for (int seed = 1; seed <= options.num_seeds && size <= options.max_size; ++seed) {
        run.cases.push_back(run_case(family, size, static_cast<std::uint64_t>(seed), options));
      }
    }
  }
  return runs;
}

std::optional<PowerFit> fit_power(std::span<const Vec2> points) {
  std::vector<Vec2> logs;
  Vec2 mean = Vec2::Zero();
  for (const Vec2& point : points) {
    if (!(point.minCoeff() > 0.0)) continue;
    logs.emplace_back(point.array().log());
    mean += logs.back();
  }
  mean /= static_cast<double>(std::max<std::size_t>(logs.size(), 1));
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (const Vec2& point : logs) {
    const Vec2 d = point - mean;
    xx += d.x() * d.x();
    xy += d.x() * d.y();
    yy += d.y() * d.y();
  }
  if (!(xx > 1e-12)) return std::nullopt;
  PowerFit fit;
  fit.num_points = static_cast<int>(logs.size());
  fit.exponent = xy / xx;
  fit.scale = std::exp(mean.y() - fit.exponent * mean.x());
  const double residual = std::max(0.0, yy - fit.exponent * xy);
  if (fit.num_points > 2) fit.standard_error = std::sqrt(residual / (fit.num_points - 2) / xx);
  return fit;
}

std::span<const ScalingFigure> scaling_figures() {
  using Plan = const ScalingPlan&;
  constexpr auto kFirstPath = [](Plan p) { return us(p.times.sample_ns + p.times.shortcut_ns); };
  constexpr auto kSample = [](Plan p) { return us(p.times.sample_ns); };
  constexpr auto kShortcut = [](Plan p) { return us(p.times.shortcut_ns); };
  constexpr auto kReference = [](Plan p) { return us(p.times.reference_ns); };
  constexpr auto kOptimize = [](Plan p) { return us(p.times.optimize_ns); };
  constexpr auto kVerify = [](Plan p) { return us(p.times.verify_ns); };
  constexpr auto kTotal = [](Plan p) { return us(p.times.total_ns); };
  constexpr auto kNodes = [](Plan p) { return count(p.sampler_counts.nodes); };
  constexpr auto kEdges = [](Plan p) { return count(p.sampler_counts.edges); };
  constexpr auto kRounds = [](Plan p) { return count(p.sampler_counts.rounds); };
  constexpr auto kQueries = [](Plan p) { return count(p.optimizer_counts.clearance_queries); };
  constexpr auto kQpSolves = [](Plan p) { return count(p.optimizer_counts.qp_solves); };
  constexpr auto kQpSteps = [](Plan p) { return count(p.optimizer_counts.qp_steps); };
  constexpr auto kIterations = [](Plan p) { return count(p.iterations); };
  static constexpr std::array<ScalingFigure, 21> kFigures = {{
      {"first path", "us", false, true, true, kFirstPath},
      {"sample", "us", false, false, false, kSample},
      {"shortcut", "us", false, false, false, kShortcut},
      {"reference", "us", false, false, false, kReference},
      {"optimise", "us", false, true, true, kOptimize},
      {"verify", "us", false, false, true, kVerify},
      {"total", "us", false, true, false, kTotal},
      {"nodes", "", false, false, true, kNodes},
      {"edges", "", false, false, true, kEdges},
      {"rounds", "", false, false, false, kRounds},
      {"queries", "", false, false, true, kQueries},
      {"qp_solves", "", false, false, false, kQpSolves},
      {"qp_steps", "", false, false, true, kQpSteps},
      {"iterations", "", false, false, false, kIterations},
      {"shortcut", "us", true, false, true, kShortcut},
      {"reference", "us", true, false, false, kReference},
      {"optimise", "us", true, true, true, kOptimize},
      {"verify", "us", true, false, true, kVerify},
      {"queries", "", true, false, true, kQueries},
      {"qp_steps", "", true, false, true, kQpSteps},
      {"iterations", "", true, false, false, kIterations},
  }};
  return kFigures;
}

std::vector<Vec2> points_of(const ScalingRun& run, const ScalingFigure& figure) {
  std::vector<Vec2> points;
  for (const ScalingCase& c : run.cases) {
    const ScalingPlan& plan = figure.is_of_known_way ? c.known_way : c.plan;
    if (!plan.is_planned) continue;
    const int n = run.family == ScalingFamily::kField ? c.num_obstacles : plan.horizon;
    points.emplace_back(n, figure.value(plan));
  }
  return points;
}

ScalingExponent exponent_of(const ScalingRun& run, const ScalingFigure& figure) {
  std::vector<Vec2> points = points_of(run, figure);
  ScalingExponent result;
  result.limit = run.family == ScalingFamily::kField ? kObstaclesLimit : kHorizonLimit;
  result.num_failed = static_cast<int>(run.cases.size() - points.size());
  result.fit = fit_power(points);
  if (!result.fit) return result;
  const auto less = [](const Vec2& a, const Vec2& b) { return a.x() < b.x(); };
  const auto [least, largest] = std::minmax_element(points.begin(), points.end(), less);
  const double middle = std::sqrt(least->x() * largest->x());
  std::erase_if(points, [middle](const Vec2& point) { return point.x() < middle; });
  result.upper_half = fit_power(points);
  return result;
}

int num_failures(std::span<const ScalingRun> runs) {
  int failures = 0;
  for (const ScalingRun& run : runs) {
    failures +=
        static_cast<int>(std::count_if(run.cases.begin(), run.cases.end(),
                                       [](const ScalingCase& c) { return !c.plan.is_planned; }));
  }
  return failures;
}

}  // namespace sopt
