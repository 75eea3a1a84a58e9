// Proves that a stretch of code neither touches the heap nor takes a lock. Linking this file
// interposes malloc, free, calloc, realloc, memalign, posix_memalign, aligned_alloc (and with them
// operator new and delete) and pthread_mutex_lock; every call is counted per thread and forwarded.
// A guard reports what its own thread did since it was made. Sanitizers interpose the same
// functions, so there and on other C libraries than glibc nothing is counted: ask `available()`
// and skip. The guard itself uses neither heap nor lock.
#pragma once

#include <cstdint>

namespace sopt {

struct RtCounts {
  std::int64_t num_allocations = 0;  // calls that may hand out memory; realloc is one
  std::int64_t num_releases = 0;     // free of a non-null pointer
  std::int64_t num_locks = 0;        // pthread_mutex_lock
};

class RtGuard {
 public:
  // False when this build cannot count; then every count is 0.
  [[nodiscard]] static bool available() noexcept;

  RtGuard() noexcept;
  RtGuard(const RtGuard&) = delete;
  RtGuard& operator=(const RtGuard&) = delete;
  ~RtGuard() = default;

  // Ends the guarded stretch: later calls are not counted. Without it the stretch is still open.
  void stop() noexcept;

  [[nodiscard]] std::int64_t num_allocations() const noexcept;
  [[nodiscard]] std::int64_t num_releases() const noexcept;
  [[nodiscard]] std::int64_t num_locks() const noexcept;

 private:
  [[nodiscard]] RtCounts end() const noexcept;

  RtCounts at_start_;
  RtCounts at_end_;
  bool is_stopped_ = false;
};

}  // namespace sopt
