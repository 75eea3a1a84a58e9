#include "models/plane/broad_phase2.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "alloc/memory_block.h"
#include "tests/support/oracle2.h"
#include "tests/support/rt_guard.h"

namespace sopt {
namespace {

constexpr std::size_t kBlock_B = 4 << 20;

std::vector<int> visited(const BroadPhase2& tree, const Vec2& p, const Vec2& q, double radius_m) {
  std::vector<int> items;
  EXPECT_TRUE(tree.for_each_near(p, q, radius_m, [&](int i) {
    items.push_back(i);
    return true;
  }));
  return items;
}

std::vector<int> sorted(std::vector<int> items) {
  std::sort(items.begin(), items.end());
  return items;
}

// A row of unit squares at x = 2 i, numbered from the left.
std::vector<Aabb2> row_of_boxes(int count) {
  std::vector<Aabb2> boxes;
  for (int i = 0; i < count; ++i) boxes.push_back({{2.0 * i, 0.0}, {2.0 * i + 1.0, 1.0}});
  return boxes;
}

class BroadPhase : public testing::Test {
 protected:
  MemoryBlock block_{kBlock_B};
  Arena arena_{block_};
};

TEST_F(BroadPhase, FindsNothingBeforeItIsBuilt) {
  const BroadPhase2 without_memory;
  EXPECT_TRUE(visited(without_memory, {0, 0}, {1, 1}, 10.0).empty());
  const BroadPhase2 not_built(arena_, 16);
  EXPECT_TRUE(visited(not_built, {0, 0}, {1, 1}, 10.0).empty());
}

TEST_F(BroadPhase, OfNoBoxesFindsNothing) {
  BroadPhase2 tree(arena_, 16);
  ASSERT_TRUE(tree.build({}));
  EXPECT_TRUE(visited(tree, {0, 0}, {1, 1}, 1e9).empty());
}

TEST_F(BroadPhase, OfOneBoxFindsIt) {
  BroadPhase2 tree(arena_, 16);
  ASSERT_TRUE(tree.build(row_of_boxes(1)));
  EXPECT_EQ(visited(tree, {0.5, 0.5}, {0.5, 0.5}, 0.0), std::vector<int>{0});
  EXPECT_EQ(visited(tree, {-1.0, 3.0}, {2.0, 3.0}, 2.0), std::vector<int>{0});
  EXPECT_TRUE(visited(tree, {-1.0, 3.0}, {2.0, 3.0}, 1.9).empty());
}

TEST_F(BroadPhase, PassesBoxesBesideADiagonal) {
  BroadPhase2 tree(arena_, 16);
  ASSERT_TRUE(tree.build(row_of_boxes(1)));
  EXPECT_TRUE(
      visited(tree, {2.0, 0.5}, {0.5, 2.0}, 0.1).empty());  // boxes overlap, diagonal does not
  EXPECT_EQ(visited(tree, {2.0, 0.5}, {0.5, 2.0}, 0.4), std::vector<int>{0});
}

TEST_F(BroadPhase, VisitsEveryBoxOnceAroundTheSizeOfANode) {
  for (const int count : {7, 8, 9, 16, 17, 63, 64, 65, 513}) {
    BroadPhase2 tree(arena_, count);
    ASSERT_TRUE(tree.build(row_of_boxes(count)));
    const std::vector<int> all = sorted(visited(tree, {0.0, 0.5}, {2.0 * count, 0.5}, 0.0));
    ASSERT_EQ(all.size(), static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
      EXPECT_EQ(all[static_cast<std::size_t>(i)], i);
      const Vec2 middle(2.0 * i + 0.5, 0.5);
      EXPECT_EQ(visited(tree, middle, middle, 0.25), std::vector<int>{i});
    }
    EXPECT_TRUE(visited(tree, {0.0, 2.0}, {2.0 * count, 2.0}, 0.5).empty());
  }
}

TEST_F(BroadPhase, FindsWhatIsNearAmongFiveThousand) {
  constexpr int kCount = 5000;
  oracle::Random random(7);
  const Aabb2 area = {{0.0, 0.0}, {100.0, 100.0}};
  std::vector<Aabb2> boxes;
  for (int i = 0; i < kCount; ++i) {
    const Vec2 lower = random.point(area);
    boxes.push_back({lower, lower + Vec2(random.uniform(0.01, 0.5), random.uniform(0.01, 0.5))});
  }
  BroadPhase2 tree(arena_, kCount);
  ASSERT_TRUE(tree.build(boxes));
  EXPECT_EQ(visited(tree, {0, 0}, {100, 100}, 200.0).size(), static_cast<std::size_t>(kCount));
  for (int i = 0; i < kCount; ++i) {
    const Aabb2& box = boxes[static_cast<std::size_t>(i)];
    const Vec2 middle = 0.5 * (box.lower + box.upper);
    const std::vector<int> items = visited(tree, middle, middle, 0.0);
    EXPECT_NE(std::find(items.begin(), items.end(), i), items.end());
    EXPECT_LT(items.size(), 50U);
  }
}

TEST_F(BroadPhase, VisitsEveryOneOfManyEqualBoxes) {
  BroadPhase2 tree(arena_, 300);
  ASSERT_TRUE(tree.build(std::vector<Aabb2>(300, Aabb2{{1.0, 1.0}, {2.0, 2.0}})));
  const std::vector<int> all = sorted(visited(tree, {1.5, 1.5}, {1.5, 1.5}, 0.0));
  ASSERT_EQ(all.size(), 300U);
  for (int i = 0; i < 300; ++i) EXPECT_EQ(all[static_cast<std::size_t>(i)], i);
}

TEST_F(BroadPhase, TouchesAtExactlyItsRadius) {
  BroadPhase2 tree(arena_, 8);
  ASSERT_TRUE(tree.build(row_of_boxes(3)));
  EXPECT_EQ(visited(tree, {-2.0, 0.5}, {-0.5, 0.5}, 0.5), std::vector<int>{0});
  EXPECT_EQ(visited(tree, {-2.0, 0.5}, {0.0, 0.5}, 0.0), std::vector<int>{0});
}

TEST_F(BroadPhase, VisitsEveryBoxOnceForAnyHugeRadius) {
  BroadPhase2 tree(arena_, 16);
  ASSERT_TRUE(tree.build(row_of_boxes(11)));
  for (const double radius_m : {1e12, 1e299, 1e300, std::numeric_limits<double>::max(),
                                std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(visited(tree, {0.0, 0.0}, {1.0, 1.0}, radius_m).size(), 11U) << radius_m;
    EXPECT_EQ(visited(tree, {0.0, 0.0}, {0.0, 0.0}, radius_m).size(), 11U) << radius_m;
  }
}

TEST_F(BroadPhase, StopsWhenAsked) {
  BroadPhase2 tree(arena_, 128);
  ASSERT_TRUE(tree.build(row_of_boxes(100)));
  int num_visits = 0;
  EXPECT_FALSE(tree.for_each_near({0, 0}, {200, 0}, 1.0, [&](int) { return ++num_visits < 5; }));
  EXPECT_EQ(num_visits, 5);
}

TEST_F(BroadPhase, RefusesMoreBoxesThanItsCapacity) {
  BroadPhase2 tree(arena_, 8);
  EXPECT_FALSE(tree.build(row_of_boxes(9)));
  EXPECT_TRUE(tree.build(row_of_boxes(8)));
  EXPECT_EQ(visited(tree, {0.0, 0.5}, {16.0, 0.5}, 0.0).size(), 8U);
}

TEST_F(BroadPhase, ForgetsTheBoxesOfTheLastBuild) {
  BroadPhase2 tree(arena_, 100);
  ASSERT_TRUE(tree.build(row_of_boxes(100)));
  ASSERT_TRUE(tree.build(row_of_boxes(3)));
  EXPECT_EQ(visited(tree, {0.0, 0.5}, {200.0, 0.5}, 0.0).size(), 3U);
  ASSERT_TRUE(tree.build({}));
  EXPECT_TRUE(visited(tree, {0.0, 0.5}, {200.0, 0.5}, 0.0).empty());
}

TEST_F(BroadPhase, VisitsInTheSameOrderAfterTheSameBuild) {
  BroadPhase2 one(arena_, 200);
  BroadPhase2 other(arena_, 1000);
  ASSERT_TRUE(one.build(row_of_boxes(200)));
  ASSERT_TRUE(other.build(row_of_boxes(50)));
  ASSERT_TRUE(other.build(row_of_boxes(200)));
  EXPECT_EQ(visited(one, {0, 0}, {400, 1}, 0.5), visited(other, {0, 0}, {400, 1}, 0.5));
}

TEST_F(BroadPhase, BuildsAndAnswersWithoutHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "the guard cannot count under sanitizers";
  const std::vector<Aabb2> boxes = row_of_boxes(500);
  BroadPhase2 tree(arena_, 500);
  int num_visits = 0;
  RtGuard guard;
  bool done = tree.build(boxes);
  done = tree.for_each_near({0, 0}, {1000, 1}, 0.5, [&](int) {
    ++num_visits;
    return true;
  }) && done;
  guard.stop();
  EXPECT_TRUE(done);
  EXPECT_EQ(num_visits, 500);
  EXPECT_EQ(guard.num_allocations(), 0);
  EXPECT_EQ(guard.num_locks(), 0);
}

}  // namespace
}  // namespace sopt
