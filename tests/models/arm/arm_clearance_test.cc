#include "models/arm/arm_clearance.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/rt_guard.h"
#include "tests/support/test_arm.h"

namespace sopt {
namespace {

using oracle::Random;
using oracle::RandomArm;
using oracle::TestWorld3;

constexpr double kTol_m = 1e-9;

// A random arm with pairs of links that may collide, among random obstacles.
template <int N>
struct Setting {
  explicit Setting(std::uint64_t seed) : random(seed) {
    oracle::draw_arm(random, drawn);
    for (int i = 0; i < 4; ++i) {
      const int link = random.index(N);
      pairs.push_back({link, link + 1 + random.index(N - link)});
    }
    drawn.description.pairs = pairs;
    EXPECT_EQ(drawn.arm.reset(drawn.description), ArmStatus::kOk);
    for (int i = 0; i < 6; ++i) {
      const Vec3 center = oracle::random_vector(random, 1.5);
      EXPECT_EQ(add_to(world.world, oracle::random_obstacle(random, center),
                       random.chance(0.5) ? kDefaultMargin : random.uniform(0.0, 0.1)),
                WorldStatus::kOk);
    }
    world.world.build();
    move();
  }
  void move() {
    q = oracle::random_configuration(random, drawn.arm);
    drawn.arm.forward(q, pose);
  }

  Random random;
  RandomArm<N> drawn;
  std::vector<BodyPair> pairs;
  TestWorld3 world;
  typename Arm<N>::Config q;
  ArmPose<N> pose;
};

// Nearest capsule of a link to an obstacle, by looking at all.
template <int N>
double link_distance(const Setting<N>& s, int i_link, int i_obstacle) {
  double least_m = 1e300;
  for (int k = 0; k < s.drawn.arm.num_capsules(); ++k) {
    if (s.drawn.arm.capsule_link(k) != i_link) continue;
    const Clearance3 c =
        compute_clearance(s.world.world.obstacle(i_obstacle), s.drawn.arm.capsule_W(s.pose, k));
    least_m = std::min(least_m, c.distance_m);
  }
  return least_m;
}

TEST(ArmClearance, FindsEveryContactWithinTheRadiusAndNoOther) {
  int num_found = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Setting<5> s(seed);
    const double radius_m = s.random.uniform(0.0, 0.3);
    std::vector<std::vector<bool>> seen(6, std::vector<bool>(6, false));
    int last_link = 0;
    EXPECT_TRUE(
        for_each_contact(s.drawn.arm, s.world.world, s.pose, radius_m, [&](const ArmContact& c) {
          EXPECT_GE(c.i_link, last_link);
          last_link = c.i_link;
          EXPECT_EQ(c.i_other_link, kNoLink);
          EXPECT_NEAR(c.clearance.distance_m, link_distance(s, c.i_link, c.i_obstacle), kTol_m);
          seen.at(std::size_t(c.i_link)).at(std::size_t(c.i_obstacle)) = true;
          ++num_found;
          return true;
        }));
    for (int l = 0; l <= 5; ++l) {
      for (int i = 0; i < 6; ++i) {
        const double gap_m = link_distance(s, l, i) - radius_m;
        if (std::abs(gap_m) < kTol_m) continue;
        EXPECT_EQ(seen[std::size_t(l)][std::size_t(i)], gap_m < 0.0) << seed;
      }
    }
  }
  EXPECT_GT(num_found, 50);
}

// More capsules on a link than are looked at together.
TEST(ArmClearance, FindsTheNearestOfManyCapsules) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Setting<4> s(seed);
    auto& capsules = s.drawn.capsules;
    for (int i = 0; i < 60; ++i) {
      const Vec3 p0 = oracle::random_vector(s.random, 0.4);
      const Vec3 p1 = s.random.chance(0.5) ? p0 : oracle::random_vector(s.random, 0.4);
      capsules.push_back({s.random.index(5), p0, p1, s.random.uniform(0.0, 0.05)});
    }
    s.drawn.description.capsules = capsules;
    ASSERT_EQ(s.drawn.arm.reset(s.drawn.description), ArmStatus::kOk);
    s.move();
    EXPECT_TRUE(for_each_contact(s.drawn.arm, s.world.world, s.pose, 2.0, [&](const ArmContact& c) {
      EXPECT_NEAR(c.clearance.distance_m, link_distance(s, c.i_link, c.i_obstacle), kTol_m);
      return true;
    }));
    const double expected_m = oracle::least_self_distance(s.drawn.arm, s.q);
    const ArmContact nearest = nearest_link_pair(s.drawn.arm, s.pose, 5.0);
    EXPECT_NEAR(nearest.clearance.distance_m, expected_m, kTol_m);
  }
}

TEST(ArmClearance, StopsWhenTheVisitorSaysSo) {
  Setting<5> s(3);
  int num_visits = 0;
  const auto stop = [&](const ArmContact&) { return ++num_visits < 2; };
  EXPECT_FALSE(for_each_contact(s.drawn.arm, s.world.world, s.pose, 10.0, stop));
  EXPECT_EQ(num_visits, 2);
  num_visits = 0;
  EXPECT_FALSE(for_each_self_contact(s.drawn.arm, s.pose, 10.0, stop));
  EXPECT_EQ(num_visits, 2);
}

TEST(ArmClearance, FindsPairsOfLinksWithTheLowerOneAsTheOther) {
  int num_found = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Setting<6> s(seed);
    double least_m = 1e300;
    EXPECT_TRUE(for_each_self_contact(s.drawn.arm, s.pose, 0.2, [&](const ArmContact& c) {
      EXPECT_EQ(c.i_obstacle, kSelfObstacle);
      EXPECT_LT(c.i_other_link, c.i_link);
      EXPECT_LE(c.clearance.distance_m, 0.2);
      least_m = std::min(least_m, c.clearance.distance_m);
      ++num_found;
      return true;
    }));
    const double expected_m = oracle::least_self_distance(s.drawn.arm, s.q);
    if (expected_m < 0.2 - kTol_m) {
      EXPECT_NEAR(least_m, expected_m, kTol_m);
    }
    const ArmContact nearest = nearest_link_pair(s.drawn.arm, s.pose, 0.2);
    EXPECT_NEAR(nearest.clearance.distance_m, std::min(expected_m, 0.2), kTol_m);
    EXPECT_EQ(nearest.i_obstacle, expected_m < 0.2 ? kSelfObstacle : kNoObstacle);
  }
  EXPECT_GT(num_found, 30);
}

TEST(ArmClearance, NearestObstacleIsTheNearestOfAll) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Setting<7> s(seed);
    const ClearanceRule touch{0.0, 0.0, 0.0};
    const double expected_m = oracle::least_excess(s.drawn.arm, s.world.world, s.q, touch);
    const double limit_m = s.random.uniform(-0.1, 0.5);
    const ArmContact nearest = nearest_obstacle(s.drawn.arm, s.world.world, s.pose, limit_m);
    EXPECT_NEAR(nearest.clearance.distance_m, std::min(expected_m, limit_m), kTol_m) << seed;
    EXPECT_EQ(nearest.i_obstacle == kNoObstacle, expected_m >= limit_m) << seed;
    if (nearest.i_obstacle == kNoObstacle) continue;
    EXPECT_NEAR(link_distance(s, nearest.i_link, nearest.i_obstacle), expected_m, kTol_m);
  }
}

TEST(ArmClearance, IsClearExactlyWhenEveryCapsuleKeepsItsClearance) {
  int num_clear = 0;
  constexpr int kCases = 4000;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Setting<5> s(seed);
    for (int i = 0; i < kCases / 40; ++i) {
      s.move();
      const ClearanceRule rule{s.random.uniform(0.0, 0.05), 1.0, 1e-4};
      const double self_m = s.random.uniform(0.0, 0.02);
      const double excess_m = oracle::least_excess(s.drawn.arm, s.world.world, s.q, rule);
      const double self_excess_m = oracle::least_self_distance(s.drawn.arm, s.q) - self_m;
      if (std::min(std::abs(excess_m), std::abs(self_excess_m)) < kTol_m) continue;
      const bool expected = excess_m > 0.0 && self_excess_m > 0.0;
      EXPECT_EQ(is_clear(s.drawn.arm, s.world.world, s.pose, rule, self_m), expected)
          << seed << ' ' << i << ' ' << excess_m << ' ' << self_excess_m;
      num_clear += expected ? 1 : 0;
    }
  }
  EXPECT_GT(num_clear, kCases / 50);
  EXPECT_LT(num_clear, kCases - kCases / 50);
}

TEST(ArmClearance, GradientsAgreeWithFiniteDifferences) {
  constexpr double kStep = 1e-6;
  int num_checked = 0;
  int num_off = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Setting<6> s(seed);
    const auto& arm = s.drawn.arm;
    const auto check = [&](const ArmContact& contact, auto&& distance) {
      const auto gradient = contact_gradient(arm, s.pose, contact);
      for (int j = 0; j < 6; ++j) {
        const Eigen::Matrix<double, 6, 1> dq = kStep * Eigen::Matrix<double, 6, 1>::Unit(j).eval();
        ArmPose<6> ahead;
        ArmPose<6> behind;
        arm.forward(s.q + dq, ahead);
        arm.forward(s.q - dq, behind);
        const double slope = (distance(ahead) - distance(behind)) / (2.0 * kStep);
        ++num_checked;
        // The nearest feature changes within the step in a few cases.
        num_off += std::abs(gradient[j] - slope) > 1e-4 ? 1 : 0;
      }
    };
    const ArmContact near = nearest_obstacle(arm, s.world.world, s.pose, 1.0);
    if (near.i_obstacle >= 0 && near.clearance.distance_m > 1e-3) {
      check(near, [&](const ArmPose<6>& pose) {
        return nearest_obstacle(arm, s.world.world, pose, 2.0).clearance.distance_m;
      });
    }
    const ArmContact pair = nearest_link_pair(arm, s.pose, 1.0);
    if (pair.i_obstacle == kSelfObstacle && pair.clearance.distance_m > 1e-3) {
      check(pair, [&](const ArmPose<6>& pose) {
        return nearest_link_pair(arm, pose, 2.0).clearance.distance_m;
      });
    }
  }
  EXPECT_GT(num_checked, 200);
  EXPECT_LE(num_off, num_checked / 50);
}

TEST(ArmClearance, OfTheArmTellsPairsThatTouchFromObstacles) {
  bool saw_pair = false;
  bool saw_obstacle = false;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Setting<6> s(seed);
    const ArmContact c = s.drawn.arm.clearance(s.world.world, s.q, 1.0);
    const double self_m = oracle::least_self_distance(s.drawn.arm, s.q);
    EXPECT_EQ(c.i_obstacle == kSelfObstacle, self_m < kSelfClearance_m) << seed;
    saw_pair = saw_pair || c.i_obstacle == kSelfObstacle;
    saw_obstacle = saw_obstacle || c.i_obstacle >= 0;
  }
  EXPECT_TRUE(saw_pair);
  EXPECT_TRUE(saw_obstacle);
}

TEST(ArmClearance, TakesWhatIsNotANumberForACollision) {
  Setting<5> s(1);
  s.q[2] = std::numeric_limits<double>::quiet_NaN();
  s.drawn.arm.forward(s.q, s.pose);
  EXPECT_FALSE(is_clear(s.drawn.arm, s.world.world, s.pose, {}, 0.0));
}

TEST(ArmClearance, IsNotClearWhereAJointIsNotFiniteWhateverHangsOnIt) {
  TestWorld3 test;
  test.world.build();
  const Arm<5> arm = lr_mate_200id_7l();  // its last link has no capsules
  ArmPose<5> pose;
  arm.forward(Arm<5>::Config::Zero(), pose);
  EXPECT_TRUE(is_clear(arm, test.world, pose, {}, 0.0));
  for (int j = 0; j < 5; ++j) {
    Arm<5>::Config q = Arm<5>::Config::Zero();
    q[j] = std::numeric_limits<double>::quiet_NaN();
    arm.forward(q, pose);
    EXPECT_FALSE(is_clear(arm, test.world, pose, {}, 0.0)) << j;
  }
}

TEST(ArmClearance, TouchesNoHeap) {
  if (!RtGuard::available()) GTEST_SKIP() << "this build cannot count allocations";
  Setting<5> s(2);
  RtGuard guard;
  const bool clear = is_clear(s.drawn.arm, s.world.world, s.pose, {0.02}, 0.0);
  const ArmContact near = s.drawn.arm.clearance(s.world.world, s.q, 0.5);
  const auto gradient = contact_gradient(s.drawn.arm, s.pose, near);
  guard.stop();
  EXPECT_TRUE(clear || near.clearance.distance_m < 0.1);
  EXPECT_TRUE(gradient.allFinite());
  EXPECT_EQ(guard.num_allocations() + guard.num_releases() + guard.num_locks(), 0);
}

}  // namespace
}  // namespace sopt
