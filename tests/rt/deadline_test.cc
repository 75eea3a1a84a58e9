#include "rt/deadline.h"

#include <gtest/gtest.h>

#include <limits>

namespace sopt {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::int64_t kLast = std::numeric_limits<std::int64_t>::max();

class DeadlineOnManualClock : public testing::Test {
 protected:
  ManualClock manual_;
};

TEST(Deadline, NeverExpiresByDefault) { EXPECT_FALSE(Deadline().expired()); }

TEST_F(DeadlineOnManualClock, NeverExpiresWhenInfinite) {
  const Deadline deadline(manual_.clock(), 0, kInfinity);
  manual_.advance(kLast);
  EXPECT_FALSE(deadline.expired());
}

TEST_F(DeadlineOnManualClock, ReadsNoClockWhenInfinite) {
  const Deadline deadline(manual_.clock(), 0, kInfinity);
  EXPECT_FALSE(deadline.expired());
  EXPECT_FALSE(deadline.earlier_by(3.0).expired());
  EXPECT_EQ(manual_.num_reads(), 0);
}

TEST_F(DeadlineOnManualClock, NeverExpiresBeyondTheRangeOfTheClock) {
  for (const double duration_s : {9.3e9, 1e12, 1e200, std::numeric_limits<double>::max()}) {
    const Deadline deadline(manual_.clock(), 0, duration_s);
    EXPECT_FALSE(deadline.expired()) << duration_s;
  }
  manual_.advance(kLast);
  EXPECT_FALSE(Deadline(manual_.clock(), 0, 1e12).expired());
}

TEST_F(DeadlineOnManualClock, ExpiresWithinTheRangeOfTheClock) {
  const Deadline deadline(manual_.clock(), 0, 9.2e9);  // 291.7 years
  EXPECT_FALSE(deadline.expired());
  manual_.advance(kLast);
  EXPECT_TRUE(deadline.expired());
}

TEST_F(DeadlineOnManualClock, DoesNotOverflowWhenItStartsLate) {
  manual_.advance(kLast - 1000);
  EXPECT_FALSE(Deadline(manual_.clock(), kLast - 1000, 3600.0).expired());
}

TEST_F(DeadlineOnManualClock, ExpiresAtOnceWhenZero) {
  manual_.advance(5);
  EXPECT_TRUE(Deadline(manual_.clock(), 5, 0.0).expired());
}

TEST_F(DeadlineOnManualClock, ExpiresAtOnceWhenNegative) {
  manual_.advance(5);
  EXPECT_TRUE(Deadline(manual_.clock(), 5, -1.0).expired());
}

TEST_F(DeadlineOnManualClock, ExpiresExactlyWhenItsTimeIsReached) {
  manual_.advance(1000);
  const Deadline deadline(manual_.clock(), 1000, 2e-6);
  EXPECT_FALSE(deadline.expired());
  manual_.advance(1999);
  EXPECT_FALSE(deadline.expired());
  manual_.advance(1);
  EXPECT_TRUE(deadline.expired());
  manual_.advance(1'000'000);
  EXPECT_TRUE(deadline.expired());
}

TEST_F(DeadlineOnManualClock, IsEarlierByTheReserve) {
  const Deadline deadline(manual_.clock(), 0, 3e-6);
  const Deadline earlier = deadline.earlier_by(1e-6);
  manual_.advance(1999);
  EXPECT_FALSE(earlier.expired());
  manual_.advance(1);
  EXPECT_TRUE(earlier.expired());
  EXPECT_FALSE(deadline.expired());
  manual_.advance(1000);
  EXPECT_TRUE(deadline.expired());
}

TEST_F(DeadlineOnManualClock, HasExpiredWhenTheReserveExceedsWhatIsLeft) {
  const Deadline deadline(manual_.clock(), 0, 1e-3);
  EXPECT_TRUE(deadline.earlier_by(2e-3).expired());
  EXPECT_FALSE(deadline.expired());
}

TEST_F(DeadlineOnManualClock, IsUnchangedByAnEmptyReserve) {
  const Deadline same = Deadline(manual_.clock(), 0, 1e-6).earlier_by(0.0);
  manual_.advance(999);
  EXPECT_FALSE(same.expired());
  manual_.advance(1);
  EXPECT_TRUE(same.expired());
}

TEST_F(DeadlineOnManualClock, TheEarliestOfTwoExpiresWithTheFirstOfThem) {
  const Deadline soon(manual_.clock(), 0, 1e-6);
  const Deadline late(manual_.clock(), 0, 2e-6);
  const Deadline either = Deadline::earliest(soon, late);
  const Deadline swapped = Deadline::earliest(late, soon);
  manual_.advance(999);
  EXPECT_FALSE(either.expired());
  EXPECT_FALSE(swapped.expired());
  manual_.advance(1);
  EXPECT_TRUE(either.expired());
  EXPECT_TRUE(swapped.expired());
  EXPECT_FALSE(late.expired());
}

TEST_F(DeadlineOnManualClock, TheEarliestOfOneThatNeverExpiresIsTheOther) {
  const Deadline soon(manual_.clock(), 0, 1e-6);
  const Deadline first = Deadline::earliest(Deadline(), soon);
  const Deadline second = Deadline::earliest(soon, Deadline());
  EXPECT_FALSE(first.expired());
  EXPECT_FALSE(second.expired());
  manual_.advance(1000);
  EXPECT_TRUE(first.expired());
  EXPECT_TRUE(second.expired());
}

TEST_F(DeadlineOnManualClock, TheEarliestOfTwoThatNeverExpireReadsNoClock) {
  const Deadline infinite(manual_.clock(), 0, kInfinity);
  EXPECT_FALSE(Deadline::earliest(infinite, Deadline()).expired());
  EXPECT_FALSE(Deadline::earliest(Deadline(), infinite).expired());
  EXPECT_FALSE(Deadline::earliest(Deadline(), Deadline()).expired());
  EXPECT_EQ(manual_.num_reads(), 0);
}

}  // namespace
}  // namespace sopt
