#include "opt/verify/motion_boxes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/oracle2.h"
#include "tests/support/test_trajectory.h"

namespace sopt {
namespace {

using oracle::Random;
using oracle::TestTrajectory;

std::vector<Vec2> random_walk(Random& random, int horizon) {
  std::vector<Vec2> states = {Vec2::Zero()};
  for (int t = 0; t < horizon; ++t) {
    states.push_back(states.back() + random.point({Vec2::Constant(-1.0), Vec2::Constant(1.0)}));
  }
  return states;
}

TEST(MotionBoxes, VisitsEveryMotionOnceInOrder) {
  Random random(1);
  for (const int horizon : {1, 2, 15, 16, 17, 31, 32, 33, 100, 255, 4095, 4096, 4097, 20000}) {
    const TestTrajectory test(random_walk(random, horizon));
    const MotionBoxes boxes(test.trajectory);
    int next = 0;
    boxes.for_each_run([](int /*first*/, const Aabb2& /*box*/) { return true; },
                       [&](int first, int last) {
                         EXPECT_EQ(first, next) << horizon;
                         EXPECT_LT(first, last) << horizon;
                         next = last;
                       });
    EXPECT_EQ(next, horizon);
  }
}

TEST(MotionBoxes, HoldTheMotionsTheyStandFor) {
  Random random(2);
  for (int k = 0; k < 200; ++k) {
    const int horizon = 1 + random.index(600);
    const std::vector<Vec2> states = random_walk(random, horizon);
    const TestTrajectory test(states);
    const MotionBoxes boxes(test.trajectory);
    std::vector<bool> is_held(states.size(), false);
    Aabb2 asked;
    boxes.for_each_run(
        [&](int /*first*/, const Aabb2& box) {
          asked = box;
          return true;
        },
        [&](int first, int last) {
          for (int t = first; t <= last; ++t) {
            const auto i = static_cast<std::size_t>(t);
            EXPECT_TRUE((states[i].array() >= asked.lower.array()).all());
            EXPECT_TRUE((states[i].array() <= asked.upper.array()).all());
            is_held[i] = true;
          }
        });
    EXPECT_EQ(std::count(is_held.begin(), is_held.end(), false), 0);
  }
}

TEST(MotionBoxes, PassesByWhatIsRefused) {
  Random random(3);
  const int horizon = 1000;
  const TestTrajectory test(random_walk(random, horizon));
  const MotionBoxes boxes(test.trajectory);
  int num_asked = 0;
  boxes.for_each_run(
      [&](int /*first*/, const Aabb2& /*box*/) {
        ++num_asked;
        return false;
      },
      [](int /*first*/, int /*last*/) { ADD_FAILURE(); });
  EXPECT_EQ(num_asked, 1) << "the box around everything";
  // A refused box takes all that is below it along.
  int end = 0;
  boxes.for_each_run([](int first, const Aabb2& /*box*/) { return first == 0 || first >= 500; },
                     [&](int first, int last) {
                       EXPECT_TRUE(first == 0 || first >= 500) << first;
                       end = last;
                     });
  EXPECT_EQ(end, horizon);
}

}  // namespace
}  // namespace sopt
