#include "sampler/tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "models/arm/arm.h"
#include "models/plane/point2.h"
#include "tests/support/arm_oracle.h"
#include "tests/support/test_problem.h"

namespace sopt {
namespace {

using oracle::InArena;
using oracle::Random;

constexpr Point2 kRobot{};
const Aabb2 kBox = {Vec2::Zero(), Vec2::Constant(10.0)};

// Nodes at random places, each below a random earlier one.
void grow(Random& random, int size, Tree<Point2>& tree) {
  while (tree.size() < size) {
    ASSERT_NE(tree.try_add(random.point(kBox), random.index(tree.size())), kNoNode);
  }
}

double chain_cost(const Tree<Point2>& tree, int i) {
  double sum = 0.0;
  for (int steps = 0; tree.parent(i) != kNoNode; ++steps) {
    if (steps > tree.size()) return -1.0;  // a cycle
    sum += (tree.config(i) - tree.config(tree.parent(i))).norm();
    i = tree.parent(i);
  }
  return sum;
}

bool is_below(const Tree<Point2>& tree, int node, int ancestor) {
  for (int steps = 0; node != kNoNode && steps <= tree.size(); ++steps) {
    if (node == ancestor) return true;
    node = tree.parent(node);
  }
  return false;
}

TEST(Tree, PlantsARootWithoutParentAndCost) {
  InArena<Tree<Point2>> tree(8);
  tree->reset(kRobot, {1.0, 2.0});
  EXPECT_EQ(tree->size(), 1);
  EXPECT_EQ(tree->parent(0), kNoNode);
  EXPECT_EQ(tree->cost(0), 0.0);
  EXPECT_EQ(tree->config(0), Vec2(1.0, 2.0));
}

TEST(Tree, AddsUpCostsFromTheRoot) {
  InArena<Tree<Point2>> tree(8);
  tree->reset(kRobot, Vec2::Zero());
  EXPECT_EQ(tree->try_add({3.0, 4.0}, 0), 1);
  EXPECT_EQ(tree->try_add({3.0, 5.0}, 1), 2);
  EXPECT_EQ(tree->cost(1), 5.0);
  EXPECT_EQ(tree->cost(2), 6.0);
  EXPECT_EQ(tree->parent(2), 1);
}

TEST(Tree, RefusesANodeBeyondItsCapacity) {
  for (const int capacity : {1, 7, 8, 9, 16, 17}) {
    InArena<Tree<Point2>> tree(capacity);
    Random random(1);
    tree->reset(kRobot, Vec2::Zero());
    grow(random, capacity, *tree);
    EXPECT_TRUE(tree->full());
    EXPECT_EQ(tree->try_add(Vec2::Zero(), 0), kNoNode);
    EXPECT_EQ(tree->size(), capacity);
    EXPECT_FALSE(tree.exhausted());
  }
}

TEST(Tree, ForgetsEverythingAtReset) {
  InArena<Tree<Point2>> tree(32);
  Random random(2);
  tree->reset(kRobot, Vec2::Zero());
  grow(random, 32, *tree);
  tree->reset(kRobot, {50.0, 50.0});
  NearNodes near;
  tree->find_near({1.0, 1.0}, 1000.0, near);
  EXPECT_EQ(tree->size(), 1);
  EXPECT_EQ(near.nearest, 0);
  EXPECT_EQ(near.count, 1);
}

// Floats choose neighbours, so nodes at the very border of the radius may fall on either side.
void check_near(const Tree<Point2>& tree, const Vec2& q, double radius) {
  constexpr double kRounding = 1e-5;
  NearNodes near;
  tree.find_near(q, radius, near);
  std::vector<double> distance;
  for (int i = 0; i < tree.size(); ++i) distance.push_back((tree.config(i) - q).norm());
  const auto at = [&](int i) { return distance[static_cast<std::size_t>(i)]; };

  ASSERT_GE(near.nearest, 0);
  ASSERT_LT(near.nearest, tree.size());
  EXPECT_LE(at(near.nearest), *std::min_element(distance.begin(), distance.end()) + kRounding);
  ASSERT_LE(near.count, kMaxNeighbors);
  double farthest = 0.0;
  std::vector<bool> is_listed(distance.size());
  for (int k = 0; k < near.count; ++k) {
    const int i = near.index[static_cast<std::size_t>(k)];
    ASSERT_GE(i, 0);
    ASSERT_LT(i, tree.size()) << "a padding lane";
    if (k > 0 && near.count < kMaxNeighbors) {
      EXPECT_GT(i, near.index[static_cast<std::size_t>(k - 1)]);
    }
    EXPECT_LE(at(i), radius + kRounding);
    EXPECT_NEAR(near.distance2[static_cast<std::size_t>(k)], at(i) * at(i), 1e-3);
    farthest = std::max(farthest, at(i));
    EXPECT_FALSE(is_listed[static_cast<std::size_t>(i)]) << "listed twice";
    is_listed[static_cast<std::size_t>(i)] = true;
  }
  const double must_reach = near.count < kMaxNeighbors ? radius : std::min(radius, farthest);
  for (int i = 0; i < tree.size(); ++i) {
    if (!is_listed[static_cast<std::size_t>(i)]) {
      EXPECT_GE(at(i), must_reach - kRounding) << i;
    }
  }
}

TEST(Tree, FindsNeighboursAsBruteForceDoesInPartlyFilledLanes) {
  Random random(3);
  for (int size = 1; size <= 17; ++size) {
    InArena<Tree<Point2>> tree(size);
    for (int round = 0; round < 30; ++round) {
      tree->reset(kRobot, random.point(kBox));
      grow(random, size, *tree);
      check_near(*tree, random.point(kBox), random.uniform(0.0, 8.0));
      // Where padding would be if it were zeros.
      check_near(*tree, Vec2::Zero(), random.uniform(0.0, 3.0));
    }
  }
}

TEST(Tree, FindsNeighboursAsBruteForceDoesInLargeTrees) {
  Random random(4);
  InArena<Tree<Point2>> tree(3000);
  tree->reset(kRobot, random.point(kBox));
  for (const int size : {65, 500, 3000}) {
    grow(random, size, *tree);
    for (int round = 0; round < 50; ++round) {
      check_near(*tree, random.point(kBox), random.uniform(0.0, 2.0));
    }
    check_near(*tree, {5.0, 5.0}, 100.0);
  }
}

TEST(Tree, ListsNoNeighboursWithoutARadius) {
  Random random(5);
  InArena<Tree<Point2>> tree(100);
  tree->reset(kRobot, random.point(kBox));
  grow(random, 100, *tree);
  NearNodes near;
  tree->find_near({5.001, 5.002}, 0.0, near);
  EXPECT_EQ(near.count, 0);
  EXPECT_GE(near.nearest, 0);
}

TEST(Tree, LowersTheCostsOfAllDescendantsWhenRewired) {
  InArena<Tree<Point2>> tree(8);
  tree->reset(kRobot, Vec2::Zero());
  (void)tree->try_add({0.0, 5.0}, 0);  // 1: detour
  (void)tree->try_add({3.0, 0.0}, 1);  // 2
  (void)tree->try_add({4.0, 0.0}, 2);  // 3
  (void)tree->try_add({3.0, 1.0}, 2);  // 4
  (void)tree->try_add({5.0, 0.0}, 3);  // 5
  tree->rewire(2, 0);
  EXPECT_EQ(tree->parent(2), 0);
  EXPECT_DOUBLE_EQ(tree->cost(2), 3.0);
  EXPECT_DOUBLE_EQ(tree->cost(3), 4.0);
  EXPECT_DOUBLE_EQ(tree->cost(4), 4.0);
  EXPECT_DOUBLE_EQ(tree->cost(5), 5.0);
  EXPECT_DOUBLE_EQ(tree->cost(1), 5.0);
}

// Random rewirings that pay: costs stay upper bounds, exact in small trees, and no cycle appears.
void rewire_at_random(Random& random, int num_rewires, bool expect_exact, Tree<Point2>& tree) {
  int num_done = 0;
  for (int k = 0; k < 200 * num_rewires && num_done < num_rewires; ++k) {
    const int node = 1 + random.index(tree.size() - 1);
    const int parent = random.index(tree.size());
    const double edge = (tree.config(node) - tree.config(parent)).norm();
    if (tree.cost(parent) + edge >= (1.0 - 1e-9) * tree.cost(node)) continue;
    ASSERT_FALSE(is_below(tree, parent, node)) << "a lower cost must not lie below";
    tree.rewire(node, parent);
    ++num_done;
    ASSERT_EQ(tree.parent(node), parent);
    EXPECT_DOUBLE_EQ(tree.cost(node), tree.cost(parent) + edge);
  }
  EXPECT_GT(num_done, 0);
  for (int i = 1; i < tree.size(); ++i) {
    const double edge = (tree.config(i) - tree.config(tree.parent(i))).norm();
    EXPECT_GE(tree.cost(i), tree.cost(tree.parent(i)) + edge - 1e-12) << i;
    const double exact = chain_cost(tree, i);
    ASSERT_GE(exact, 0.0) << "cycle through " << i;
    EXPECT_GE(tree.cost(i), exact - 1e-9);
    if (expect_exact) {
      EXPECT_NEAR(tree.cost(i), exact, 1e-9);
    }
  }
}

TEST(Tree, KeepsCostsExactInSmallTreesUnderRandomRewiring) {
  Random random(6);
  for (int round = 0; round < 50; ++round) {
    InArena<Tree<Point2>> tree(200);
    tree->reset(kRobot, random.point(kBox));
    grow(random, 200, *tree);
    rewire_at_random(random, 100, true, *tree);
  }
}

TEST(Tree, KeepsCostsUpperBoundsWhenPropagationIsCut) {
  Random random(7);
  for (int round = 0; round < 10; ++round) {
    InArena<Tree<Point2>> tree(2000);
    tree->reset(kRobot, random.point(kBox));
    // Long chains, so that one rewiring has more descendants than one propagation visits.
    while (tree->size() < 2000) {
      (void)tree->try_add(random.point(kBox), std::max(0, tree->size() - 1 - random.index(3)));
    }
    rewire_at_random(random, 300, false, *tree);
  }
}

TEST(Tree, MeasuresJointsThatTurnWithoutEndTheShortWay) {
  Random random(9);
  for (int round = 0; round < 20; ++round) {
    oracle::RandomArm<5> drawn;
    oracle::draw_arm(random, drawn);
    ASSERT_EQ(drawn.arm.reset(drawn.description), ArmStatus::kOk);
    const auto draw = [&] { return oracle::random_configuration(random, drawn.arm); };
    InArena<Tree<Arm<5>>> tree(100);
    tree->reset(drawn.arm, draw());
    while (tree->size() < 100) ASSERT_NE(tree->try_add(draw(), 0), kNoNode);
    const auto q = draw();
    NearNodes near;
    tree->find_near(q, 1.5, near);
    double least = 1e9;
    int num_near = 0;
    for (int i = 0; i < tree->size(); ++i) {
      const double distance = drawn.arm.path_distance(tree->config(i), q);
      least = std::min(least, distance);
      num_near += distance < 1.5 ? 1 : 0;
    }
    EXPECT_NEAR(drawn.arm.path_distance(tree->config(near.nearest), q), least, 1e-5);
    EXPECT_EQ(near.count, std::min(num_near, kMaxNeighbors));
  }
}

}  // namespace
}  // namespace sopt
