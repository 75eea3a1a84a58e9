#include "models/space/broad_phase3.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "alloc/memory_block.h"
#include "tests/support/oracle3.h"
#include "tests/support/rt_guard.h"

namespace sopt {
namespace {

constexpr std::size_t kBlock_B = 4 << 20;
const Aabb3 kEverything{Vec3::Constant(-std::numeric_limits<double>::infinity()),
                        Vec3::Constant(std::numeric_limits<double>::infinity())};

std::vector<int> visited(const BroadPhase3& tree, const Aabb3& area) {
  std::vector<int> items;
  EXPECT_TRUE(tree.for_each_near(area, [&](int i) {
    items.push_back(i);
    return true;
  }));
  std::sort(items.begin(), items.end());
  return items;
}

// A row of unit cubes at z = 2 i, numbered from below.
std::vector<Aabb3> row_of_boxes(int count) {
  std::vector<Aabb3> boxes;
  for (int i = 0; i < count; ++i) boxes.push_back({{0, 0, 2.0 * i}, {1, 1, 2.0 * i + 1}});
  return boxes;
}

class BoxTree : public testing::Test {
 protected:
  MemoryBlock block_{kBlock_B};
  Arena arena_{block_};
};

TEST_F(BoxTree, FindsNothingBeforeItIsBuiltOrOfNoBoxes) {
  EXPECT_TRUE(visited(BroadPhase3(), kEverything).empty());
  BroadPhase3 tree(arena_, 16);
  EXPECT_TRUE(visited(tree, kEverything).empty());
  ASSERT_TRUE(tree.build({}));
  EXPECT_TRUE(visited(tree, kEverything).empty());
}

TEST_F(BoxTree, FindsABoxThatTouchesAndNotOneBeside) {
  BroadPhase3 tree(arena_, 16);
  ASSERT_TRUE(tree.build(row_of_boxes(1)));
  EXPECT_EQ(visited(tree, {{1, 1, 1}, {2, 2, 2}}), std::vector<int>{0});
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {1.1, -1.1}) {
      const Vec3 step = side * Vec3::Unit(axis);
      EXPECT_TRUE(visited(tree, {step, Vec3::Constant(1.0) + step}).empty()) << axis;
    }
  }
}

TEST_F(BoxTree, VisitsEveryBoxOnceAroundTheSizeOfANode) {
  for (const int count : {7, 8, 9, 16, 17, 63, 64, 65, 513}) {
    BroadPhase3 tree(arena_, count);
    ASSERT_TRUE(tree.build(row_of_boxes(count)));
    const std::vector<int> all = visited(tree, kEverything);
    ASSERT_EQ(all.size(), static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) EXPECT_EQ(all[static_cast<std::size_t>(i)], i);
  }
}

TEST_F(BoxTree, StopsWhenTheVisitorSaysSo) {
  BroadPhase3 tree(arena_, 64);
  ASSERT_TRUE(tree.build(row_of_boxes(40)));
  int num_visits = 0;
  EXPECT_FALSE(tree.for_each_near(kEverything, [&](int) { return ++num_visits < 3; }));
  EXPECT_EQ(num_visits, 3);
}

TEST_F(BoxTree, RefusesMoreBoxesThanItHasRoomFor) {
  BroadPhase3 tree(arena_, 8);
  EXPECT_FALSE(tree.build(row_of_boxes(9)));
  EXPECT_TRUE(visited(tree, kEverything).empty());
  EXPECT_TRUE(tree.build(row_of_boxes(8)));
}

TEST_F(BoxTree, FindsWhatAPlainScanFinds) {
  oracle::Random random(3);
  for (const int count : {5, 60, 900}) {
    std::vector<Aabb3> boxes;
    for (int i = 0; i < count; ++i) {
      const Vec3 lower = oracle::random_vector(random, 5.0);
      boxes.push_back({lower, lower + oracle::random_vector(random, 1.0).cwiseAbs()});
    }
    BroadPhase3 tree(arena_, count);
    ASSERT_TRUE(tree.build(boxes));
    for (int round = 0; round < 200; ++round) {
      const Vec3 lower = oracle::random_vector(random, 5.0);
      const Aabb3 area{lower, lower + oracle::random_vector(random, 2.0).cwiseAbs()};
      std::vector<int> expected;
      for (int i = 0; i < count; ++i) {
        const Aabb3& box = boxes[static_cast<std::size_t>(i)];
        if ((box.lower.array() <= area.upper.array()).all() &&
            (area.lower.array() <= box.upper.array()).all()) {
          expected.push_back(i);
        }
      }
      ASSERT_EQ(visited(tree, area), expected);
    }
  }
}

TEST_F(BoxTree, QueriesWithoutTheHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "the guard cannot count under sanitizers";
  BroadPhase3 tree(arena_, 64);
  ASSERT_TRUE(tree.build(row_of_boxes(40)));
  int num_visits = 0;
  RtGuard guard;
  const bool done = tree.for_each_near(kEverything, [&](int) { return ++num_visits > 0; });
  guard.stop();
  EXPECT_TRUE(done);
  EXPECT_EQ(num_visits, 40);
  EXPECT_EQ(guard.num_allocations(), 0);
}

}  // namespace
}  // namespace sopt
