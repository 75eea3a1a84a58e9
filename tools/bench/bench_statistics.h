// What a set of measurements says: mean, nearest-rank percentiles, extremes, and how many there
// are.
#pragma once

#include <vector>

namespace sopt {

struct Distribution {
  int count = 0;
  double mean = 0.0;
  double median = 0.0;
  double p95 = 0.0;
  double p99 = 0.0;
  double max = 0.0;
};

// Value at nearest rank ceil(share n), share in (0, 1], of sorted values; there is at least one.
[[nodiscard]] double nearest_rank(const std::vector<double>& sorted, double share);

// All zero for no values.
[[nodiscard]] Distribution summarize(std::vector<double> values);

}  // namespace sopt
