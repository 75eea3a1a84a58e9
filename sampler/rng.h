// Counter-based random numbers: value i of a stream is a hash of (key, i), so streams are
// independent of each other, of the number of threads and of the platform. SplitMix64 [Steele, Lea,
// Flood 2014]; keys are themselves hashed, so neighbouring seeds and streams do not correlate.
#pragma once

#include <cstdint>

#include "rt/annotations.h"

namespace sopt {

class CounterRng {
 public:
  // One stream per (seed, a, b, c): for example request seed, sampler stream, batch and rung.
  explicit CounterRng(std::uint64_t seed, std::uint64_t a = 0, std::uint64_t b = 0,
                      std::uint64_t c = 0) noexcept
      : state_(mix(mix(mix(mix(seed) + a) + b) + c)) {}

  [[nodiscard]] std::uint64_t next_u64() SOPT_RT {
    state_ += kIncrement;
    return mix(state_);
  }

  // Uniform in [0, 1), 53 random bits.
  [[nodiscard]] double next_uniform() SOPT_RT {
    return static_cast<double>(next_u64() >> 11U) * 0x1.0p-53;
  }

 private:
  static constexpr std::uint64_t kIncrement = 0x9E3779B97F4A7C15ULL;

  static std::uint64_t mix(std::uint64_t z) SOPT_RT {
    z += kIncrement;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31U);
  }

  std::uint64_t state_;
};

}  // namespace sopt
