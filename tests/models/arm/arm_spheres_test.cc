#include "models/arm/arm_spheres.h"

#include <gtest/gtest.h>

#include <vector>

#include "models/arm/arm.h"
#include "tests/support/arm_oracle.h"
#include "tests/support/oracle3.h"

namespace sopt {
namespace {

using oracle::Random;

// Bodies of 1 to 20 random capsules on links 0, 2, 2 and 5.
struct Shapes {
  explicit Shapes(std::uint64_t seed) : random(seed) {
    for (const int i_link : {0, 2, 2, 5}) {
      ArmBody body{i_link, static_cast<int>(capsules.size()), 0, {}};
      const int num = 1 + random.index(20);
      for (int i = 0; i < num; ++i) {
        const Vec3 p0 = oracle::random_vector(random, 2.0);
        const Vec3 p1 = random.chance(0.3) ? p0 : oracle::random_vector(random, 2.0);
        capsules.push_back({p0, p1, random.uniform(0.0, 0.2)});
      }
      body.last = static_cast<int>(capsules.size());
      bodies.push_back(body);
    }
    spheres.build(capsules, bodies);
  }

  Random random;
  std::vector<Capsule3> capsules;
  std::vector<ArmBody> bodies;
  ArmSpheres spheres;
};

int num_in(std::span<const SphereBatch> batches, int first) {
  int next = first;
  for (const SphereBatch& batch : batches) {
    EXPECT_EQ(batch.first, next);
    EXPECT_GE(batch.num, 1);
    EXPECT_LE(batch.num, kLanesFloat);
    next += batch.num;
  }
  return next - first;
}

TEST(ArmSpheres, HaveEveryCapsuleOfABodyAndOfALinkOnce) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Shapes s(seed);
    for (int b = 0; b < 4; ++b) {
      const ArmBody& body = s.bodies[std::size_t(b)];
      EXPECT_EQ(num_in(s.spheres.of_body(b), body.first), body.last - body.first);
    }
    EXPECT_EQ(num_in(s.spheres.of_link(2), s.bodies[1].first),
              s.bodies[2].last - s.bodies[1].first);
    EXPECT_EQ(num_in(s.spheres.of_link(0), 0), s.bodies[0].last);
    for (const int i_link : {1, 3, 4, 6, 8}) EXPECT_TRUE(s.spheres.of_link(i_link).empty());
  }
}

// The pad for the distance from the world's origin is in the padded radius.
TEST(ArmSpheres, InTheWorldContainTheCapsulesAndHardlyMore) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Shapes s(seed);
    const Pose3 X = oracle::random_pose(s.random, 10.0);
    for (int b = 0; b < 4; ++b) {
      for (const SphereBatch& batch : s.spheres.of_body(b)) {
        const PaddedLanes lanes = to_world(X, batch);
        for (int i = 0; i < batch.num; ++i) {
          const Capsule3& c = s.capsules[std::size_t(batch.first + i)];
          const Vec3 center =
              Eigen::Vector3f(lanes.spheres.x[i], lanes.spheres.y[i], lanes.spheres.z[i])
                  .cast<double>();
          const double radius_m = static_cast<double>(lanes.padded_radius_m[i]);
          for (const Vec3& end : {c.p0, c.p1}) {
            const double reach_m = (X.rotation * end + X.position - center).norm() + c.radius_m;
            ASSERT_LE(reach_m, radius_m);
            ASSERT_GE(reach_m, radius_m - 2e-4);
          }
        }
      }
    }
  }
}

TEST(ArmSpheres, LanesWithoutACapsuleAreNearNothing) {
  const Capsule3 capsule{Vec3::Zero(), Vec3::Zero(), 0.1};
  const ArmBody body{1, 0, 1, {}};
  ArmSpheres spheres;
  spheres.build({&capsule, 1}, {&body, 1});
  const PaddedLanes lanes = to_world({Mat3::Identity(), Vec3::Zero()}, spheres.of_body(0)[0]);
  const V8f bound_m = distance_bounds(lanes, lanes, 0);
  EXPECT_LT(bound_m[0], 0.0F);
  for (int i = 1; i < kLanesFloat; ++i) EXPECT_GT(bound_m[i], 1e30F);
}

}  // namespace
}  // namespace sopt
