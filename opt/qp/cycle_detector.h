// Tells that a sequence of sets of rows runs in circles, which only rounding can make it do. A set
// is known by a key that does not depend on order; each is compared with the one kept at round
// 1, 2, 4, .. [Brent 1980], so no history is stored and a period p is seen after at most 3 p + 2
// rounds of it. A set that comes back may still have moved: only the third return counts.
#pragma once

#include <cstdint>
#include <span>

#include "rt/annotations.h"

namespace sopt {

class CycleDetector {
 public:
  void reset() SOPT_RT { *this = {}; }

  // Takes the set of this round; true when it has come back too often.
  [[nodiscard]] bool is_cycling(std::span<const int> ids) SOPT_RT {
    std::uint64_t key = 1;
    for (const int id : ids) key += scramble(static_cast<std::uint64_t>(id) + 1);
    if (key == kept_ && ++num_returns_ >= kMaxReturns) return true;
    if (++num_rounds_ == next_kept_) {
      kept_ = key;
      num_rounds_ = 0;
      next_kept_ *= 2;
    }
    return false;
  }

 private:
  static constexpr int kMaxReturns = 3;

  // Finaliser of SplitMix64.
  static std::uint64_t scramble(std::uint64_t i) SOPT_RT {
    std::uint64_t z = i * 0x9E3779B97F4A7C15ULL;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31U);
  }

  std::uint64_t kept_ = 0;
  std::int64_t num_rounds_ = 0;  // since then
  std::int64_t next_kept_ = 1;
  int num_returns_ = 0;
};

}  // namespace sopt
