// An executor that knows how long its tasks take: serial, and with one worker per task. Tasks run
// in index order on the calling thread, so each is timed without others beside it. The cost of a
// reading of the clock is measured once and taken off. A call's critical path is its longest task;
// several calls follow one another, so theirs is the sum.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rt/clock.h"
#include "rt/executor.h"

namespace sopt {

// One call of `run`.
struct TaskCall {
  int num_tasks = 0;
  std::int64_t sum_ns = 0;
  std::int64_t longest_ns = 0;
};

// What calls took, one after the other, and what one worker per task would save of it.
struct TaskTimes {
  std::int64_t serial_ns = 0;
  std::int64_t saved_ns = 0;
};
[[nodiscard]] TaskTimes add_up(std::span<const TaskCall> calls);

// A stage that took `stage_ns`, its tasks included, with one worker per task.
[[nodiscard]] std::int64_t critical_path_ns(std::int64_t stage_ns, const TaskTimes& tasks);

class TimingExecutor final : public Executor {
 public:
  explicit TimingExecutor(Clock clock);

  [[nodiscard]] int num_workers() const noexcept override { return 1; }
  void run(Task task, int num_tasks) SOPT_RT override;

  // Forgets earlier calls; without it tasks are run as SerialExecutor does.
  void set_recording(bool is_recording);
  [[nodiscard]] std::span<const TaskCall> calls() const { return calls_; }

 private:
  Clock clock_;
  std::int64_t reading_ns_ = 0;
  bool is_recording_ = false;
  std::vector<TaskCall> calls_;
};

}  // namespace sopt
