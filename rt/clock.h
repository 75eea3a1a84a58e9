// Time as a value that can be replaced: every part that polls time holds a `Clock`, so tests drive
// deadlines with a hand-moved clock and the process uses CLOCK_MONOTONIC. Readings are nanoseconds
// from an arbitrary origin; only differences mean anything. Reading costs one vDSO call.
#pragma once

#include <cstdint>

#include "rt/annotations.h"

namespace sopt {

struct Clock {
  std::int64_t (*read)(void* context) noexcept = nullptr;
  void* context = nullptr;

  [[nodiscard]] std::int64_t now_ns() const SOPT_RT { return read(context); }
};

// Wall-independent elapsed time; what deadlines of the process count in.
[[nodiscard]] Clock monotonic_clock() noexcept;

// CPU time of the calling thread; what overshoot is measured in, because a shared machine can take
// the CPU away for tens of milliseconds. Meaningful only on the thread that reads it.
[[nodiscard]] Clock thread_cpu_clock() noexcept;

// A clock that moves only when told to, and by `step_ns` at each reading (0: never by itself).
// It must outlive every Clock made from it. Not thread safe.
class ManualClock {
 public:
  explicit ManualClock(std::int64_t step_ns = 0) noexcept : step_ns_(step_ns) {}

  void advance(std::int64_t by_ns) noexcept { now_ns_ += by_ns; }
  [[nodiscard]] std::int64_t num_reads() const noexcept { return num_reads_; }
  [[nodiscard]] Clock clock() noexcept;

 private:
  static std::int64_t read(void* self) noexcept;

  std::int64_t now_ns_ = 0;
  std::int64_t step_ns_ = 0;
  std::int64_t num_reads_ = 0;
};

}  // namespace sopt
