// What the sampler's effort is tuned to, per robot (docs/RESULTS.md). A check of a motion in the
// plane is cheap beside everything else; for arms it is what sampling costs.
#pragma once

#include <array>

#include "models/arm/arm.h"
#include "models/plane/point2.h"

namespace sopt {

inline constexpr int kMaxPatienceBatches = 3;

template <class Robot>
struct SamplerTuning;

template <>
struct SamplerTuning<Point2> {
  // Samples per stream and round. A round is the unit after which streams are compared: longer
  // rounds let more streams finish and compete, shorter ones stop earlier.
  static constexpr int kRoundSamples = 128;
  // Longest motion of one extension, as a share of the sampling box's diagonal.
  static constexpr double kRangeShare = 0.2;
  // Deviation: shares of its length at which an extension is tried, RRT* tries one; among narrow
  // doors long motions are nearly always blocked.
  static constexpr std::array<double, 2> kExtensionShares = {1.0, 0.25};
  // From this many blocked extensions of a tree in a row on, all shares are tried: an arm between
  // shelves has to back out of them. Before, only the first.
  static constexpr int kBlockedInARow = 0;
  // A tree that was blocked this often per node without growing is taken for shut in; four times as
  // often in the next batch, kMaxPatienceBatches times. Deviation: then the next rung of the margin
  // ladder gets its turn long before the samples are used up. 0: never.
  static constexpr int kPatience = 0;
  // Random stretches that shortening tries.
  static constexpr int kShortcutTries = 60;
};

template <int N>
struct SamplerTuning<Arm<N>> {
  static constexpr int kRoundSamples = 8;
  static constexpr double kRangeShare = 0.15;
  static constexpr std::array<double, 2> kExtensionShares = {1.0, 0.25};
  static constexpr int kBlockedInARow = 16;
  static constexpr int kPatience = 128;
  static constexpr int kShortcutTries = 20;
};

}  // namespace sopt
