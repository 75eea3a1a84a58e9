#include "tools/bench/bench_statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace sopt {
namespace {

// first, first + 1, .. : the value at rank k is first + k - 1.
std::vector<double> ramp(int count, double first = 1.0) {
  std::vector<double> values(static_cast<std::size_t>(count));
  std::iota(values.begin(), values.end(), first);
  return values;
}

TEST(NearestRankTest, IsTheSmallestValueThatCoversTheShare) {
  const std::vector<double> values = {15.0, 20.0, 35.0, 40.0, 50.0};
  EXPECT_EQ(nearest_rank(values, 0.05), 15.0);
  EXPECT_EQ(nearest_rank(values, 0.2), 15.0);
  EXPECT_EQ(nearest_rank(values, 0.3), 20.0);
  EXPECT_EQ(nearest_rank(values, 0.4), 20.0);
  EXPECT_EQ(nearest_rank(values, 0.5), 35.0);
  EXPECT_EQ(nearest_rank(values, 1.0), 50.0);
}

TEST(NearestRankTest, OfOneValueIsThatValue) {
  EXPECT_EQ(nearest_rank({7.0}, 0.01), 7.0);
  EXPECT_EQ(nearest_rank({7.0}, 1.0), 7.0);
}

TEST(NearestRankTest, IsExactWhereTheShareHasNoBinaryForm) {
  for (int hundreds = 1; hundreds <= 1000; ++hundreds) {
    const std::vector<double> values = ramp(100 * hundreds);
    EXPECT_EQ(nearest_rank(values, 0.95), 95.0 * hundreds);
    EXPECT_EQ(nearest_rank(values, 0.99), 99.0 * hundreds);
  }
}

TEST(NearestRankTest, RoundsUpToTheNextRank) {
  EXPECT_EQ(nearest_rank(ramp(101), 0.95), 96.0);
  EXPECT_EQ(nearest_rank(ramp(101), 0.99), 100.0);
  EXPECT_EQ(nearest_rank(ramp(101), 0.5), 51.0);
}

TEST(SummarizeTest, OfAKnownSampleInAnyOrder) {
  std::vector<double> values = ramp(400);
  std::reverse(values.begin(), values.begin() + 150);
  std::rotate(values.begin(), values.begin() + 37, values.end());
  const Distribution d = summarize(values);
  EXPECT_EQ(d.count, 400);
  EXPECT_DOUBLE_EQ(d.mean, 200.5);
  EXPECT_EQ(d.median, 200.0);
  EXPECT_EQ(d.p95, 380.0);
  EXPECT_EQ(d.p99, 396.0);
  EXPECT_EQ(d.max, 400.0);
}

TEST(SummarizeTest, OneOutlierShowsInTheMaximumAndNotInP99) {
  std::vector<double> values(400, 1.0);
  values[3] = 1000.0;
  const Distribution d = summarize(values);
  EXPECT_EQ(d.p99, 1.0);
  EXPECT_EQ(d.max, 1000.0);
}

TEST(SummarizeTest, FewSamplesPutTheTailAtTheMaximum) {
  const Distribution d = summarize({3.0, 1.0, 2.0});
  EXPECT_EQ(d.count, 3);
  EXPECT_EQ(d.median, 2.0);
  EXPECT_EQ(d.p95, 3.0);
  EXPECT_EQ(d.p99, 3.0);
}

TEST(SummarizeTest, NegativeValuesKeepTheirOrder) {
  const Distribution d = summarize({-1.0, -5.0, -3.0});
  EXPECT_EQ(d.median, -3.0);
  EXPECT_EQ(d.max, -1.0);
  EXPECT_DOUBLE_EQ(d.mean, -3.0);
}

TEST(SummarizeTest, OfNothingIsZeroAndSaysSo) {
  const Distribution d = summarize({});
  EXPECT_EQ(d.count, 0);
  EXPECT_EQ(d.max, 0.0);
}

}  // namespace
}  // namespace sopt
