#include "models/space/sphere_lanes3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "alloc/memory_block.h"
#include "tests/support/oracle3.h"
#include "tests/support/rt_guard.h"

namespace sopt {
namespace {

using oracle::Solid;
using oracle::SolidKind;

constexpr World3Capacity kCapacity{64, 64};
constexpr unsigned kAll = 0xFF;

// Eight spheres as a caller has them, in double.
struct Spheres {
  Vec3 center[kLanesFloat];
  double radius_m[kLanesFloat];
};

SphereLanes to_lanes(const Spheres& s) {
  SphereLanes lanes;
  for (int i = 0; i < kLanesFloat; ++i) {
    lanes.x[i] = static_cast<float>(s.center[i].x());
    lanes.y[i] = static_cast<float>(s.center[i].y());
    lanes.z[i] = static_cast<float>(s.center[i].z());
    const auto nearest = static_cast<float>(s.radius_m[i]);
    lanes.radius_m[i] =
        static_cast<double>(nearest) < s.radius_m[i] ? std::nextafter(nearest, 1e9F) : nearest;
  }
  return lanes;
}

class SphereLanesTest : public testing::Test {
 protected:
  WorldStatus add(const Solid& solid, double margin_m = kDefaultMargin) {
    return add_to(world_, solid, margin_m);
  }
  void build() { world_.build(); }
  [[nodiscard]] double slack_of(const Spheres& s, int lane, const ClearanceRule& rule) const {
    double slack = 1e300;
    for (int i = 0; i < world_.num_obstacles(); ++i) {
      const Capsule3 ball{s.center[lane], s.center[lane], s.radius_m[lane]};
      slack = std::min(slack, compute_clearance(world_.obstacle(i), ball).distance_m -
                                  world_.required_m(i, rule));
    }
    return slack;
  }
  // Never clear when the exact answer is not; clear when the slack is more than the pad explains.
  void expect_strict(const Spheres& s, const ClearanceRule& rule, double pad_m) {
    const unsigned near = world_.lanes_near(to_lanes(s), rule);
    for (int i = 0; i < kLanesFloat; ++i) {
      const double slack_m = slack_of(s, i, rule);
      const bool is_near = ((near >> i) & 1U) != 0;
      ASSERT_TRUE(is_near || slack_m >= 0.0) << "slack " << slack_m;
      ASSERT_TRUE(!is_near || slack_m <= pad_m) << "slack " << slack_m;
      num_close_ += std::abs(slack_m) < 1e-5 ? 1 : 0;
      num_near_ += is_near ? 1 : 0;
      ++num_all_;
    }
    for (int i = 0; i < world_.num_obstacles(); ++i) {
      expect_strict_nested(i, s, rule);
      expect_strict_bounds(i, s, pad_m);
    }
  }
  // Distances are never overrated, and underrated by no more than the pad explains.
  void expect_strict_bounds(int i_obstacle, const Spheres& s, double pad_m) {
    const V8f bound_m = world_.distance_bounds(i_obstacle, PaddedLanes(to_lanes(s)));
    for (int i = 0; i < kLanesFloat; ++i) {
      const Capsule3 ball{s.center[i], s.center[i], s.radius_m[i]};
      const double distance_m = compute_clearance(world_.obstacle(i_obstacle), ball).distance_m;
      const double found_m = static_cast<double>(bound_m[i]);
      ASSERT_LE(found_m, std::max(distance_m, -s.radius_m[i]));
      ASSERT_TRUE(distance_m < 0.0 || found_m >= distance_m - pad_m)
          << found_m << " of " << distance_m;
    }
  }
  // The wide sphere and the sphere are never clear when they are not, the inner one never near.
  void expect_strict_nested(int i_obstacle, const Spheres& s, const ClearanceRule& rule) {
    constexpr double kWider_m = 0.03;
    const SphereLanes lanes = to_lanes(s);
    const float radius_m = lanes.radius_m[0];
    const float inner_m = 0.75F * radius_m;
    const V8f wider_m = lanes.radius_m - radius_m + static_cast<float>(kWider_m);
    const NestedNear near = world_.lanes_near(
        i_obstacle, {lanes.x, lanes.y, lanes.z, radius_m, wider_m, inner_m}, rule);
    for (int i = 0; i < kLanesFloat; ++i) {
      const Capsule3 point{s.center[i], s.center[i], 0.0};
      const double gap_m = compute_clearance(world_.obstacle(i_obstacle), point).distance_m -
                           world_.required_m(i_obstacle, rule);
      const auto has = [i](unsigned bits) { return ((bits >> i) & 1U) != 0; };
      ASSERT_TRUE(has(near.wide) || gap_m >= s.radius_m[i] + kWider_m) << gap_m;
      ASSERT_TRUE(has(near.sphere) || gap_m >= static_cast<double>(radius_m)) << gap_m;
      ASSERT_TRUE(!has(near.inner) || gap_m < static_cast<double>(inner_m)) << gap_m;
      num_inner_ += has(near.inner) ? 1 : 0;
    }
  }

  MemoryBlock block_{World3::required_bytes(kCapacity)};
  Arena arena_{block_};
  World3 world_{arena_, kCapacity};
  int num_close_ = 0;
  int num_near_ = 0;
  int num_all_ = 0;
  int num_inner_ = 0;
};

// Moves the spheres so that some just touch what they must keep from obstacle 0.
void move_to_the_limit(oracle::Random& random, const World3& world, const ClearanceRule& rule,
                       Spheres& s) {
  for (int i = 0; i < kLanesFloat; ++i) {
    const Clearance3 c =
        compute_clearance(world.obstacle(0), Capsule3{s.center[i], s.center[i], s.radius_m[i]});
    const double step = world.required_m(0, rule) - c.distance_m + random.uniform(-1e-6, 1e-6);
    if (random.chance(0.7)) s.center[i] += step * c.normal;
  }
}

TEST_F(SphereLanesTest, SaysWhichSpheresAreNear) {
  ASSERT_EQ(world_.try_add(Box3{{}, {2, 2, 2}}), WorldStatus::kOk);
  build();
  Spheres s;
  for (int i = 0; i < kLanesFloat; ++i) {
    s.center[i] = {i % 2 == 0 ? 1.6 : 1.8, 0, 0};  // 0.6 and 0.8 away
    s.radius_m[i] = 0.5;
  }
  EXPECT_EQ(world_.lanes_near(to_lanes(s), {0.2}), 0x55U);
  EXPECT_EQ(world_.lanes_near(to_lanes(s), {0.05}), 0U);
  EXPECT_EQ(world_.lanes_near(to_lanes(s), {0.4}), kAll);
}

TEST_F(SphereLanesTest, KeepsEveryObstaclesOwnMargin) {
  ASSERT_EQ(world_.try_add(Sphere3{{0, 0, 0}, 1.0}, 0.5), WorldStatus::kOk);
  build();
  Spheres s;
  for (int i = 0; i < kLanesFloat; ++i) {
    s.center[i] = {0, 1.5 + 0.1 * i, 0};  // 0.4, 0.5, .. away
    s.radius_m[i] = 0.1;
  }
  EXPECT_EQ(world_.lanes_near(to_lanes(s), {0.0}) & 0x5U, 0x1U);
}

TEST_F(SphereLanesTest, OfAnEmptyWorldAreClear) {
  build();
  Spheres s;
  for (int i = 0; i < kLanesFloat; ++i) s.radius_m[i] = 1.0;
  for (Vec3& center : s.center) center.setZero();
  EXPECT_EQ(world_.lanes_near(to_lanes(s), {1.0}), 0U);
}

TEST_F(SphereLanesTest, ThatAreNotFiniteAreNear) {
  ASSERT_EQ(world_.try_add(Sphere3{{0, 0, 0}, 1.0}), WorldStatus::kOk);
  build();
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), 1e300}) {
    Spheres s;
    for (int i = 0; i < kLanesFloat; ++i) {
      s.center[i] = {50, 0, 0};
      s.radius_m[i] = 0.1;
    }
    EXPECT_EQ(world_.lanes_near(to_lanes(s), {0.0}), 0U);
    s.center[3].y() = bad;
    EXPECT_EQ(world_.lanes_near(to_lanes(s), {0.0}) & 0x8U, 0x8U);
  }
}

TEST_F(SphereLanesTest, AreNeverClearWhenTheExactAnswerIsNot) {
  oracle::Random random(17);
  for (int round = 0; round < 3000; ++round) {
    const SolidKind kind = static_cast<SolidKind>(round % oracle::kNumSolidKinds);
    const double reach_m = random.chance(0.2) ? 50.0 : 2.0;
    world_.reset();
    const ClearanceRule rule{random.uniform(0.0, 0.1)};
    if (add(oracle::random_solid(random, kind, reach_m, random.chance(0.3)),
            random.chance(0.3) ? 0.07 : kDefaultMargin) != WorldStatus::kOk) {
      continue;
    }
    build();
    Spheres s;
    for (int i = 0; i < kLanesFloat; ++i) {
      s.center[i] = oracle::random_vector(random, 2.0) + world_.obstacle(0).center;
      s.radius_m[i] = random.uniform(0.0, 0.3);
    }
    move_to_the_limit(random, world_, rule, s);
    // A hull's planes bound its distance only from below.
    const bool is_hull = kind == SolidKind::kHull;
    ASSERT_NO_FATAL_FAILURE(expect_strict(s, rule, is_hull ? 1e300 : 1e-5 * (4.0 + 3 * reach_m)));
  }
  EXPECT_GT(num_close_, num_all_ / 3);
  EXPECT_GT(num_near_, num_all_ / 5);
  EXPECT_LT(num_near_, num_all_ * 9 / 10);
}

TEST_F(SphereLanesTest, OfManyObstaclesAreNeverClearWhenTheExactAnswerIsNot) {
  oracle::Random random(19);
  for (const int count : {9, 16, 17, 60}) {
    world_.reset();
    while (world_.num_obstacles() < count) {
      const SolidKind kind = static_cast<SolidKind>(random.index(4));  // no hull
      ASSERT_EQ(add(oracle::random_solid(random, kind, 6.0, false),
                    random.chance(0.3) ? 0.2 : kDefaultMargin),
                WorldStatus::kOk);
    }
    build();
    for (int round = 0; round < 200; ++round) {
      Spheres s;
      const Vec3 middle = oracle::random_vector(random, 6.0);
      for (int i = 0; i < kLanesFloat; ++i) {
        s.center[i] = middle + oracle::random_vector(random, 0.5);
        s.radius_m[i] = random.uniform(0.0, 0.2);
      }
      const ClearanceRule rule{0.05};
      if (random.chance(0.5)) move_to_the_limit(random, world_, rule, s);
      ASSERT_NO_FATAL_FAILURE(expect_strict(s, rule, 3e-4));
    }
  }
  EXPECT_GT(num_near_, num_all_ / 10);
  EXPECT_LT(num_near_, num_all_ * 9 / 10);
  EXPECT_GT(num_inner_, num_all_ / 20);
}

TEST_F(SphereLanesTest, QueryWithoutTheHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "the guard cannot count under sanitizers";
  ASSERT_EQ(world_.try_add(Box3{{}, {2, 2, 2}}), WorldStatus::kOk);
  build();
  Spheres s;
  for (Vec3& center : s.center) center.setZero();
  for (double& radius_m : s.radius_m) radius_m = 0.1;
  const SphereLanes lanes = to_lanes(s);
  RtGuard guard;
  const unsigned near = world_.lanes_near(lanes, {0.2});
  guard.stop();
  EXPECT_EQ(near, kAll);
  EXPECT_EQ(guard.num_allocations(), 0);
  EXPECT_EQ(guard.num_locks(), 0);
}

}  // namespace
}  // namespace sopt
