#include "tools/tables/timed_planner.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

namespace sopt {
namespace {

// Room for whatever a table asks for.
template <class AScene>
PlanOptions most_demanding_options(const AScene& scene) {
  PlanOptions options = make_request(scene).options;
  options.solver = WindowSolver::kDense;
  options.max_window = kLongestWindow;
  return options;
}

std::int64_t median(std::array<std::int64_t, kNumTimedCalls> times_ns) {
  const auto middle = times_ns.begin() + kNumTimedCalls / 2;
  std::nth_element(times_ns.begin(), middle, times_ns.end());
  return *middle;
}

StageTime to_stage_time(std::int64_t serial_ns, std::int64_t critical_ns) {
  return {1e-3 * static_cast<double>(serial_ns), 1e-3 * static_cast<double>(critical_ns)};
}

template <class Robot>
TableCase to_case(const PlanResult<Robot>& result) {
  TableCase c;
  c.has_plan = result.status >= PlanStatus::kOk;
  c.fell_back = result.fell_back;
  c.sampled_length = result.sampler_path_length;
  c.length = result.path_length;
  c.iterations = result.iterations;
  c.segments_initial = result.segments_initial;
  c.segments_final = result.segments_final;
  return c;
}

}  // namespace

template <class Robot>
TimedPlanner<Robot>::TimedPlanner(const SceneOf<Robot>& scene)
    : scene_(&scene),
      executor_(thread_cpu_clock()),
      host_(scene, most_demanding_options(scene), executor_, thread_cpu_clock()) {}

template <class Robot>
PlanRequest<Robot> TimedPlanner<Robot>::make_request(const AlgorithmOptions& choices,
                                                     std::uint64_t seed) const {
  PlanRequest<Robot> request = sopt::make_request(*scene_);
  request.seed = seed;
  apply(choices, request.options, paper_options<Robot>());
  return request;
}

template <class Robot>
TableCase TimedPlanner<Robot>::measure(const PlanRequest<Robot>& request) {
  executor_.set_recording(true);
  PlanResult<Robot> result = planner().plan(request);
  // The sampler's calls come first; the optimiser makes one per sweep.
  const std::span<const TaskCall> calls = executor_.calls();
  const auto num_sweeps = static_cast<std::size_t>(result.iterations);
  const TaskTimes sampling = add_up(calls.first(calls.size() - num_sweeps));
  const TaskTimes sweeps = add_up(calls.last(num_sweeps));
  executor_.set_recording(false);

  std::array<std::int64_t, kNumTimedCalls> sample_ns{}, optimize_ns{}, total_ns{};
  for (std::size_t i = 0; i < kNumTimedCalls; ++i) {
    result = PlanResult<Robot>{};  // gives the slot back
    result = planner().plan(request);
    sample_ns[i] = result.times.sample_ns + result.times.shortcut_ns;
    optimize_ns[i] = result.times.optimize_ns;
    total_ns[i] = result.times.total_ns;
  }
  TableCase c = to_case(result);
  c.sample = to_stage_time(median(sample_ns), critical_path_ns(median(sample_ns), sampling));
  c.optimize = to_stage_time(median(optimize_ns), critical_path_ns(median(optimize_ns), sweeps));
  c.total.serial_us = 1e-3 * static_cast<double>(median(total_ns));
  c.total.critical_us = c.total.serial_us - (c.sample.serial_us - c.sample.critical_us) -
                        (c.optimize.serial_us - c.optimize.critical_us);
  return c;
}

template class TimedPlanner<Point2>;
template class TimedPlanner<Arm<4>>;
template class TimedPlanner<Arm<5>>;
template class TimedPlanner<Arm<6>>;
template class TimedPlanner<Arm<7>>;
template class TimedPlanner<Arm<8>>;

}  // namespace sopt
