#include "opt/splits.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/splits_model.h"
#include "tests/support/test_problem.h"

namespace sopt {
namespace {

using oracle::InArena;
using oracle::SplitsModel;

constexpr Parity kParities[] = {Parity::kOdd, Parity::kEven};

struct WindowList {
  explicit WindowList(int capacity = 1024) : memory(capacity), windows(*memory) {}
  InArena<FixedVector<Window>> memory;
  FixedVector<Window>& windows;
};

std::vector<Window> windows_of(const Splits& splits, Parity parity) {
  WindowList list;
  splits.list_windows(parity, list.windows);
  return {list.windows.begin(), list.windows.end()};
}

std::vector<int> indices_of(const Splits& splits) {
  return {splits.indices().begin(), splits.indices().end()};
}

std::vector<std::pair<int, int>> ranges_of(const Splits& splits, Parity parity) {
  std::vector<std::pair<int, int>> ranges;
  for (const Window& window : windows_of(splits, parity)) {
    ranges.emplace_back(window.first, window.last);
  }
  return ranges;
}

using Ranges = std::vector<std::pair<int, int>>;

TEST(Splits, DividesTheHorizonByTheIntegerRule) {
  InArena<Splits> splits(200);
  ASSERT_TRUE(splits->try_reset(10, 2));
  // j 10 / 4 = 0, 2.5, 5, 7.5, 10
  EXPECT_EQ(indices_of(*splits), (std::vector<int>{0, 3, 5, 8, 10}));
  EXPECT_EQ(splits->num_segments(), 2);
}

TEST(Splits, TakesOddWindowsFromTheFirstSplitAndEvenOnesFromTheSecond) {
  InArena<Splits> splits(200);
  ASSERT_TRUE(splits->try_reset(60, 3));
  EXPECT_EQ(ranges_of(*splits, Parity::kOdd), (Ranges{{0, 20}, {20, 40}, {40, 60}}));
  EXPECT_EQ(ranges_of(*splits, Parity::kEven), (Ranges{{0, 10}, {10, 30}, {30, 50}, {50, 60}}));
  const std::vector<Window> even = windows_of(*splits, Parity::kEven);
  EXPECT_FALSE(even.front().is_full);
  EXPECT_TRUE(even[1].is_full);
  EXPECT_FALSE(even.back().is_full);
  EXPECT_EQ(even[1].i_split, 1);
}

TEST(Splits, KeepsItsInvariantsForEveryHorizonAndCount) {
  InArena<Splits> splits(130);
  for (int horizon = 1; horizon <= 130; ++horizon) {
    for (const int num_segments : {1, 2, 3, 4, 5, 7, 9, 16, 40, 64, 65, 100}) {
      ASSERT_TRUE(splits->try_reset(horizon, num_segments)) << horizon << " " << num_segments;
      const SplitsModel model(horizon, num_segments);
      ASSERT_EQ(indices_of(*splits), model.w) << horizon << " " << num_segments;
      EXPECT_EQ(model.w.front(), 0);
      EXPECT_EQ(model.w.back(), horizon);
      for (const Parity parity : kParities) {
        const std::vector<Window> expected = model.windows(parity);
        const std::vector<Window> listed = windows_of(*splits, parity);
        ASSERT_EQ(listed.size(), expected.size());
        for (std::size_t i = 0; i < listed.size(); ++i) {
          EXPECT_TRUE(oracle::same(listed[i], expected[i]));
          EXPECT_EQ(listed[i].first, i == 0 ? 0 : listed[i - 1].last);
          EXPECT_GE(listed[i].num_steps(), 1);
        }
        EXPECT_EQ(listed.back().last, horizon);
      }
    }
  }
}

TEST(Splits, RefusesAHorizonBeyondItsCapacity) {
  InArena<Splits> splits(20);
  ASSERT_TRUE(splits->try_reset(20, 10));
  EXPECT_FALSE(splits->try_reset(2000, 1000));
}

TEST(Splits, MergesByTakingOutTheMidPoints) {
  InArena<Splits> splits(200);
  ASSERT_TRUE(splits->try_reset(80, 4));  // 0 10 20 .. 80
  ASSERT_TRUE(splits->try_merge(2, 60));
  EXPECT_EQ(indices_of(*splits), (std::vector<int>{0, 10, 20, 40, 60, 70, 80}));
  EXPECT_EQ(ranges_of(*splits, Parity::kOdd), (Ranges{{0, 20}, {20, 60}, {60, 80}}));
  EXPECT_EQ(ranges_of(*splits, Parity::kEven), (Ranges{{0, 10}, {10, 40}, {40, 70}, {70, 80}}));
  EXPECT_EQ(splits->num_segments(), 3);
}

TEST(Splits, MergesEvenWindowsToo) {
  InArena<Splits> splits(200);
  ASSERT_TRUE(splits->try_reset(80, 4));
  ASSERT_TRUE(splits->try_merge(1, 60));  // [10,30] and [30,50]
  EXPECT_EQ(indices_of(*splits), (std::vector<int>{0, 10, 30, 50, 60, 70, 80}));
  EXPECT_EQ(ranges_of(*splits, Parity::kEven), (Ranges{{0, 10}, {10, 50}, {50, 70}, {70, 80}}));
}

TEST(Splits, RefusesAMergeThatMakesAWindowOfEitherParityTooLong) {
  InArena<Splits> splits(200);
  ASSERT_TRUE(splits->try_reset(80, 4));
  EXPECT_FALSE(splits->try_merge(2, 39));
  ASSERT_TRUE(splits->try_merge(2, 40));
  // W = 0 10 20 40 60 70 80: joining [10,40] and [40,70] makes [0,40] and [40,80] of the others.
  EXPECT_FALSE(splits->try_merge(1, 59));
  EXPECT_TRUE(splits->try_merge(1, 60));
}

TEST(Splits, ChecksTheCapOnTheOtherParityWhenItIsTheLongerOne) {
  InArena<Splits> splits(200);
  ASSERT_TRUE(splits->try_reset(160, 8));  // 0 10 .. 160
  ASSERT_TRUE(splits->try_merge(4, 80));
  ASSERT_TRUE(splits->try_merge(6, 80));
  ASSERT_TRUE(splits->try_merge(4, 80));
  const std::vector<int> before = {0, 10, 20, 30, 40, 80, 120, 130, 140, 150, 160};
  ASSERT_EQ(indices_of(*splits), before);
  // [0,20] + [20,40] is [0,40], but the even window on its right becomes [20,80].
  EXPECT_FALSE(splits->try_merge(0, 59));
  EXPECT_EQ(indices_of(*splits), before);
  EXPECT_TRUE(splits->try_merge(0, 60));
}

TEST(Splits, RefusesToMergeWhereThereAreNoTwoFullWindows) {
  InArena<Splits> splits(200);
  ASSERT_TRUE(splits->try_reset(40, 2));  // 0 10 20 30 40
  const std::vector<int> before = indices_of(*splits);
  for (const int i : {-5, -1, 1, 2, 3, 4, 5, 100}) EXPECT_FALSE(splits->try_merge(i, 1000)) << i;
  EXPECT_EQ(indices_of(*splits), before);
  EXPECT_TRUE(splits->try_merge(0, 1000));
}

TEST(Splits, SplitsAWindowByHalvingBothSplits) {
  InArena<Splits> splits(200);
  ASSERT_TRUE(splits->try_reset(40, 2));
  ASSERT_TRUE(splits->try_split(0));
  EXPECT_EQ(indices_of(*splits), (std::vector<int>{0, 5, 10, 15, 20, 30, 40}));
  EXPECT_EQ(ranges_of(*splits, Parity::kOdd), (Ranges{{0, 10}, {10, 20}, {20, 40}}));
}

TEST(Splits, NeverMergesWhatWasSplit) {
  InArena<Splits> splits(200);
  ASSERT_TRUE(splits->try_reset(80, 4));
  ASSERT_TRUE(splits->try_split(2));  // [20,40]: 25 and 35 are new
  const std::vector<int> before = indices_of(*splits);
  EXPECT_EQ(before, (std::vector<int>{0, 10, 20, 25, 30, 35, 40, 50, 60, 70, 80}));
  EXPECT_FALSE(splits->try_merge(2, 1000));
  EXPECT_FALSE(splits->try_merge(0, 1000));  // takes 10 and 25
  EXPECT_FALSE(splits->try_merge(4, 1000));  // takes 35 and 50
  EXPECT_EQ(indices_of(*splits), before);
}

TEST(Splits, ForgetsWhatWasSplitAtReset) {
  InArena<Splits> splits(200);
  ASSERT_TRUE(splits->try_reset(80, 4));
  ASSERT_TRUE(splits->try_split(2));
  ASSERT_TRUE(splits->try_reset(80, 4));
  EXPECT_TRUE(splits->try_merge(2, 1000));
}

TEST(Splits, RefusesToSplitWhatIsTooShortOrNotAFullWindow) {
  InArena<Splits> splits(200);
  ASSERT_TRUE(splits->try_reset(6, 2));  // 0 2 3 5 6
  const std::vector<int> before = indices_of(*splits);
  for (const int i : {-1, 0, 1, 2, 3, 4, 50}) EXPECT_FALSE(splits->try_split(i)) << i;
  EXPECT_EQ(indices_of(*splits), before);
}

TEST(Splits, KeepsTheParityOfWindowsDownstream) {
  InArena<Splits> splits(200);
  ASSERT_TRUE(splits->try_reset(120, 6));
  for (int i = 0; i < 8; ++i) {
    ASSERT_TRUE(splits->try_reset(120, 6));
    const int end = splits->indices()[static_cast<std::size_t>(i) + 4];
    Ranges before[2];
    for (const Parity parity : kParities) {
      for (const auto& range : ranges_of(*splits, parity)) {
        if (range.first >= end) before[static_cast<int>(parity)].push_back(range);
      }
    }
    ASSERT_TRUE(splits->try_merge(i, 120));
    for (const Parity parity : kParities) {
      Ranges after;
      for (const auto& range : ranges_of(*splits, parity)) {
        if (range.first >= end) after.push_back(range);
      }
      EXPECT_EQ(after, before[static_cast<int>(parity)]) << i;
    }
  }
}

TEST(Splits, MergesAsPrintedByTakingOutTheSharedEnd) {
  InArena<Splits> splits(200);
  ASSERT_TRUE(splits->try_reset(80, 4));  // 0 10 20 .. 80
  ASSERT_TRUE(splits->try_merge_as_printed(2, 60));
  EXPECT_EQ(indices_of(*splits), (std::vector<int>{0, 10, 20, 30, 50, 60, 70, 80}));
  // What lay behind 40 has changed its parity.
  EXPECT_EQ(ranges_of(*splits, Parity::kOdd), (Ranges{{0, 20}, {20, 50}, {50, 70}, {70, 80}}));
  EXPECT_EQ(ranges_of(*splits, Parity::kEven), (Ranges{{0, 10}, {10, 30}, {30, 60}, {60, 80}}));
  ASSERT_TRUE(splits->try_merge_as_printed(1, 60));
  EXPECT_EQ(indices_of(*splits), (std::vector<int>{0, 10, 20, 50, 60, 70, 80}));
}

TEST(Splits, RefusesAPrintedMergeThatMakesAWindowOfEitherParityTooLong) {
  InArena<Splits> splits(200);
  ASSERT_TRUE(splits->try_reset(80, 4));
  EXPECT_FALSE(splits->try_merge_as_printed(2, 29));
  ASSERT_TRUE(splits->try_merge_as_printed(2, 30));  // 0 10 20 30 50 60 70 80
  const std::vector<int> before = indices_of(*splits);
  EXPECT_FALSE(splits->try_merge_as_printed(1, 39));  // [10,50] and [20,60]
  EXPECT_FALSE(splits->try_merge_as_printed(0, 39));  // [10,50]
  EXPECT_FALSE(splits->try_merge_as_printed(2, 39));  // [20,60]
  EXPECT_EQ(indices_of(*splits), before);
  EXPECT_TRUE(splits->try_merge_as_printed(1, 40));
}

TEST(Splits, RefusesAPrintedMergeWithoutTwoFullWindows) {
  InArena<Splits> splits(200);
  ASSERT_TRUE(splits->try_reset(40, 2));  // 0 10 20 30 40
  const std::vector<int> before = indices_of(*splits);
  for (const int i : {-5, -1, 1, 2, 3, 4, 5, 100}) {
    EXPECT_FALSE(splits->try_merge_as_printed(i, 1000)) << i;
  }
  EXPECT_EQ(indices_of(*splits), before);
  ASSERT_TRUE(splits->try_merge_as_printed(0, 1000));
  EXPECT_EQ(indices_of(*splits), (std::vector<int>{0, 10, 30, 40}));
  EXPECT_FALSE(splits->try_merge_as_printed(0, 1000));
}

TEST(Splits, NeverMergesAwayAsPrintedWhatWasSplit) {
  InArena<Splits> splits(200);
  ASSERT_TRUE(splits->try_reset(80, 4));
  ASSERT_TRUE(splits->try_split(2));  // 0 10 20 25* 30 35* 40 50 60 70 80
  EXPECT_FALSE(splits->try_merge_as_printed(1, 1000));
  EXPECT_FALSE(splits->try_merge_as_printed(3, 1000));
  EXPECT_TRUE(splits->try_merge_as_printed(2, 1000));
  EXPECT_EQ(indices_of(*splits), (std::vector<int>{0, 10, 20, 25, 35, 40, 50, 60, 70, 80}));
}

TEST(Splits, MovesToAnotherHorizonInProportion) {
  InArena<Splits> splits(200);
  ASSERT_TRUE(splits->try_reset(80, 4));
  ASSERT_TRUE(splits->try_merge(2, 60));  // 0 10 20 40 60 70 80
  ASSERT_TRUE(splits->try_rescale(60));
  // 7.5, 15, 30, 45, 52.5
  EXPECT_EQ(indices_of(*splits), (std::vector<int>{0, 8, 15, 30, 45, 53, 60}));
  ASSERT_TRUE(splits->try_rescale(200));
  EXPECT_EQ(indices_of(*splits), (std::vector<int>{0, 27, 50, 100, 150, 177, 200}));
}

TEST(Splits, JoinsPointsThatFallTogether) {
  InArena<Splits> splits(200);
  ASSERT_TRUE(splits->try_reset(100, 5));  // 0 10 .. 100
  ASSERT_TRUE(splits->try_rescale(4));
  EXPECT_EQ(indices_of(*splits), (std::vector<int>{0, 1, 2, 3, 4}));
  ASSERT_TRUE(splits->try_rescale(1));
  EXPECT_EQ(indices_of(*splits), (std::vector<int>{0, 1}));
  EXPECT_EQ(ranges_of(*splits, Parity::kOdd), (Ranges{{0, 1}}));
  EXPECT_EQ(ranges_of(*splits, Parity::kEven), (Ranges{{0, 1}}));
}

TEST(Splits, StaysValidWhateverTheNewHorizon) {
  InArena<Splits> splits(130);
  for (int horizon = 1; horizon <= 130; horizon += 3) {
    for (int to = 1; to <= 130; ++to) {
      for (const int num_segments : {1, 3, 7, 40}) {
        ASSERT_TRUE(splits->try_reset(horizon, num_segments));
        ASSERT_TRUE(splits->try_rescale(to));
        const std::vector<int> w = indices_of(*splits);
        ASSERT_EQ(w.front(), 0);
        ASSERT_EQ(w.back(), to);
        for (std::size_t i = 1; i < w.size(); ++i) ASSERT_LT(w[i - 1], w[i]);
      }
    }
  }
}

TEST(Splits, RefusesANewHorizonThatDoesNotFit) {
  InArena<Splits> splits(100);
  EXPECT_FALSE(splits->try_rescale(50)) << "there is no W yet";
  ASSERT_TRUE(splits->try_reset(80, 4));
  const std::vector<int> before = indices_of(*splits);
  for (const int horizon : {-1, 0, 101, 1 << 30}) EXPECT_FALSE(splits->try_rescale(horizon));
  EXPECT_EQ(indices_of(*splits), before);
  EXPECT_TRUE(splits->try_rescale(100));
}

TEST(Splits, RemembersWhatWasSplitAtAnotherHorizon) {
  InArena<Splits> splits(200);
  ASSERT_TRUE(splits->try_reset(80, 4));
  ASSERT_TRUE(splits->try_split(2));  // 0 10 20 25* 30 35* 40 50 60 70 80
  ASSERT_TRUE(splits->try_rescale(160));
  EXPECT_FALSE(splits->try_merge_as_printed(1, 1000));
  EXPECT_FALSE(splits->try_merge_as_printed(3, 1000));
  EXPECT_FALSE(splits->try_merge(2, 1000));
  EXPECT_TRUE(splits->try_merge_as_printed(2, 1000));
}

TEST(Splits, KeepsAPointThatWasSplitWhenAnotherFallsOnIt) {
  InArena<Splits> splits(200);
  ASSERT_TRUE(splits->try_reset(80, 4));
  ASSERT_TRUE(splits->try_split(2));    // 0 10 20 25* 30 35* 40 50 60 70 80
  ASSERT_TRUE(splits->try_rescale(4));  // 30, 35*, and 40 all fall on 2
  ASSERT_EQ(indices_of(*splits), (std::vector<int>{0, 1, 2, 3, 4}));
  EXPECT_FALSE(splits->try_merge_as_printed(0, 1000));
  EXPECT_EQ(indices_of(*splits), (std::vector<int>{0, 1, 2, 3, 4}));
}

}  // namespace
}  // namespace sopt
