#include "rt/clock.h"

#include <ctime>

namespace sopt {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;

std::int64_t read_posix_clock(clockid_t id) noexcept {
  timespec now{};
  clock_gettime(id, &now);
  return static_cast<std::int64_t>(now.tv_sec) * kNsPerSecond + now.tv_nsec;
}

std::int64_t read_monotonic(void* /*context*/) noexcept {
  return read_posix_clock(CLOCK_MONOTONIC);
}

std::int64_t read_thread_cpu(void* /*context*/) noexcept {
  return read_posix_clock(CLOCK_THREAD_CPUTIME_ID);
}

}  // namespace

Clock monotonic_clock() noexcept { return {&read_monotonic, nullptr}; }

Clock thread_cpu_clock() noexcept { return {&read_thread_cpu, nullptr}; }

Clock ManualClock::clock() noexcept { return {&ManualClock::read, this}; }

std::int64_t ManualClock::read(void* self) noexcept {
  auto* clock = static_cast<ManualClock*>(self);
  ++clock->num_reads_;
  clock->now_ns_ += clock->step_ns_;
  return clock->now_ns_;
}

}  // namespace sopt
