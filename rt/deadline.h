// A point in time on an injectable clock. Work that must be bounded in time polls `expired()` at
// every work unit; a deadline that never expires costs one comparison and reads no clock.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "rt/clock.h"

namespace sopt {

class Deadline {
 public:
  // Never expires.
  Deadline() noexcept = default;

  // Expires `duration_s` seconds after `start_ns`, a reading of `clock`. An infinite duration, or
  // one beyond the range of the clock (292 years), never expires; a negative one has expired.
  Deadline(Clock clock, std::int64_t start_ns, double duration_s) noexcept : clock_(clock) {
    const double at_ns = static_cast<double>(start_ns) + std::max(duration_s, 0.0) * 1e9;
    if (at_ns < static_cast<double>(kNever)) at_ns_ = static_cast<std::int64_t>(at_ns);
  }

  [[nodiscard]] bool expired() const SOPT_RT {
    return at_ns_ != kNever && clock_.now_ns() >= at_ns_;
  }

  // Whichever of two on the same clock expires first.
  [[nodiscard]] static Deadline earliest(const Deadline& a, const Deadline& b) SOPT_RT {
    return a.at_ns_ <= b.at_ns_ ? a : b;
  }

  // The same deadline, `reserve_s` seconds earlier: what is left for a stage that must finish
  // before another one of known length.
  [[nodiscard]] Deadline earlier_by(double reserve_s) const SOPT_RT {
    Deadline result = *this;
    if (at_ns_ != kNever) result.at_ns_ -= static_cast<std::int64_t>(reserve_s * 1e9);
    return result;
  }

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

  Clock clock_{};
  std::int64_t at_ns_ = kNever;
};

}  // namespace sopt
