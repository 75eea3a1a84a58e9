// The split points W of a trajectory and the windows they define [Leu22, III-B]. 2N splits of a
// horizon give 2N + 1 indices w_j = round(j H / 2N), j = 0..2N, strictly increasing after removal
// of duplicates. A window covers two splits; odd sweeps take [w0,w2],[w2,w4],.., even sweeps
// [w0,w1],[w1,w3],.., so what is fixed in one sweep is free in the next.
// Deviation: merging a pair of windows removes the two mid points, not the shared end as printed:
// that would shift the parity of all windows downstream, which then repeat themselves and stall.
#pragma once

#include <cstdint>

#include "alloc/fixed_vector.h"
#include "rt/annotations.h"

namespace sopt {

enum class Parity : std::int8_t { kOdd, kEven };

// Waypoints first..last of a trajectory; both ends stay fixed.
struct Window {
  int first = 0;
  int last = 0;
  int i_split = 0;      // first == w[i_split]
  bool is_full = true;  // two splits; false for single splits at head and tail

  [[nodiscard]] int num_steps() const SOPT_RT { return last - first; }
};

class Splits {
 public:
  Splits() noexcept = default;
  Splits(Arena& arena, int max_horizon) noexcept;

  // 2 num_segments splits of `horizon` >= 1 steps; fewer where the horizon has not enough steps.
  // False when W does not fit.
  [[nodiscard]] bool try_reset(int horizon, int num_segments) SOPT_RT;

  // Windows of one parity, in order; they cover the horizon without overlap.
  void list_windows(Parity parity, FixedVector<Window>& windows) const SOPT_RT;

  // Joins the windows that begin at w[i] and w[i + 2] into one. Refused (false, no change) when
  // there are no such two full windows, when a window of either parity would become longer than
  // `max_window` steps, or when a split point made by `try_split` would go.
  [[nodiscard]] bool try_merge(int i, int max_window) SOPT_RT;

  // As printed in the paper: the end that those two windows share goes, W loses one point and the
  // windows behind it change parity. Refused without such windows, beyond max_window, or when that
  // point was made by `try_split`.
  [[nodiscard]] bool try_merge_as_printed(int i, int max_window) SOPT_RT;

  // Moves W to another horizon, in proportion [Leu22, Alg. 1 l.17]; points that fall together
  // become one. False, and nothing changes, when `horizon` is below 1 or does not fit.
  [[nodiscard]] bool try_rescale(int horizon) SOPT_RT;

  // Cuts the full window that begins at w[i] into two, halving both of its splits. Refused when a
  // split has fewer than 2 steps, or W is full.
  [[nodiscard]] bool try_split(int i) SOPT_RT;

  // Windows of the odd parity.
  [[nodiscard]] int num_segments() const SOPT_RT { return indices_.size() / 2; }
  [[nodiscard]] std::span<const int> indices() const SOPT_RT { return indices_.span(); }

 private:
  [[nodiscard]] bool is_full_window(int i) const SOPT_RT {
    return i >= 0 && i + 2 < indices_.size();
  }
  [[nodiscard]] bool try_insert(int position, int index) SOPT_RT;
  void erase(int position) SOPT_RT;

  FixedVector<int> indices_;
  FixedVector<bool> is_pinned_;  // made by try_split: never merged away
};

}  // namespace sopt
