#include "tools/bench/bench_statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sopt {

double nearest_rank(const std::vector<double>& sorted, double share) {
  // The guard keeps 0.95 * 20, which is a hair above 19 in binary, at rank 19.
  const double rank = std::ceil(share * static_cast<double>(sorted.size()) - 1e-9);
  return sorted[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
}

Distribution summarize(std::vector<double> values) {
  Distribution result;
  if (values.empty()) return result;
  std::sort(values.begin(), values.end());
  result.count = static_cast<int>(values.size());
  result.mean = std::accumulate(values.begin(), values.end(), 0.0) / result.count;
  result.median = nearest_rank(values, 0.5);
  result.p95 = nearest_rank(values, 0.95);
  result.p99 = nearest_rank(values, 0.99);
  result.max = values.back();
  return result;
}

}  // namespace sopt
