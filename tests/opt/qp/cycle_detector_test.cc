#include "opt/qp/cycle_detector.h"

#include <gtest/gtest.h>

#include <vector>

namespace sopt {
namespace {

// Rounds of sets 0 .. lead - 1 once, then period sets in turns, until a cycle is seen.
int rounds_until_seen(int lead, int period, int max_rounds) {
  CycleDetector detector;
  for (int round = 0; round < max_rounds; ++round) {
    const int i = round < lead ? round : lead + (round - lead) % period;
    const std::vector<int> ids = {i, 1000 + 2 * i};
    if (detector.is_cycling(ids)) return round + 1;
  }
  return max_rounds;
}

TEST(CycleDetectorTest, SeesEveryPeriodWithinABoundedNumberOfRounds) {
  for (const int lead : {0, 1, 5, 100}) {
    for (int period = 1; period <= 64; ++period) {
      EXPECT_LE(rounds_until_seen(lead, period, 100000), 4 * (lead + period) + 3 * period + 2)
          << lead << ' ' << period;
    }
  }
}

TEST(CycleDetectorTest, LetsASetComeBackTwice) {
  CycleDetector detector;
  const std::vector<int> ids = {3, 1};
  EXPECT_FALSE(detector.is_cycling(ids));  // kept
  EXPECT_FALSE(detector.is_cycling(ids));
  EXPECT_FALSE(detector.is_cycling(ids));
  EXPECT_TRUE(detector.is_cycling(ids));
}

TEST(CycleDetectorTest, DoesNotCareAboutOrder) {
  CycleDetector detector;
  const std::vector<int> sets[] = {{1, 2, 3}, {3, 1, 2}, {2, 3, 1}, {1, 3, 2}};
  int num_seen = 0;
  for (const auto& ids : sets) num_seen += detector.is_cycling(ids) ? 1 : 0;
  EXPECT_EQ(num_seen, 1);
}

TEST(CycleDetectorTest, DoesNotMistakeGrowingSetsForACycle) {
  CycleDetector detector;
  std::vector<int> ids;
  for (int round = 0; round < 2000; ++round) {
    ids.push_back(round);
    EXPECT_FALSE(detector.is_cycling(ids));
  }
}

TEST(CycleDetectorTest, ForgetsOnReset) {
  CycleDetector detector;
  const std::vector<int> ids = {7};
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(detector.is_cycling(ids));
  detector.reset();
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(detector.is_cycling(ids));
}

}  // namespace
}  // namespace sopt
