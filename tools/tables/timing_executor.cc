#include "tools/tables/timing_executor.h"

#include <algorithm>
#include <cstddef>

namespace sopt {

TaskTimes add_up(std::span<const TaskCall> calls) {
  TaskTimes times;
  for (const TaskCall& call : calls) {
    times.serial_ns += call.sum_ns;
    times.saved_ns += call.sum_ns - call.longest_ns;
  }
  return times;
}

// Tasks and stage may come from two runs of the same work: the answer is at least the tasks' own
// critical path and at most the stage.
std::int64_t critical_path_ns(std::int64_t stage_ns, const TaskTimes& tasks) {
  const std::int64_t least_ns = tasks.serial_ns - tasks.saved_ns;
  return std::min(stage_ns, std::max(stage_ns - tasks.saved_ns, least_ns));
}

TimingExecutor::TimingExecutor(Clock clock) : clock_(clock) {
  constexpr std::size_t kNumReadings = 101;
  std::vector<std::int64_t> readings_ns(kNumReadings);
  for (std::int64_t& reading_ns : readings_ns) {
    const std::int64_t begin_ns = clock_.now_ns();
    reading_ns = clock_.now_ns() - begin_ns;
  }
  const auto middle = readings_ns.begin() + kNumReadings / 2;
  std::nth_element(readings_ns.begin(), middle, readings_ns.end());
  reading_ns_ = *middle;
}

void TimingExecutor::set_recording(bool is_recording) {
  is_recording_ = is_recording;
  calls_.clear();
}

void TimingExecutor::run(Task task, int num_tasks) SOPT_RT {
  if (!is_recording_) {
    for (int i = 0; i < num_tasks; ++i) task(0, i);
    return;
  }
  TaskCall call{num_tasks, 0, 0};
  for (int i = 0; i < num_tasks; ++i) {
    const std::int64_t begin_ns = clock_.now_ns();
    task(0, i);
    const std::int64_t task_ns =
        std::max<std::int64_t>(clock_.now_ns() - begin_ns - reading_ns_, 0);
    call.sum_ns += task_ns;
    call.longest_ns = std::max(call.longest_ns, task_ns);
  }
  calls_.push_back(call);
}

}  // namespace sopt
