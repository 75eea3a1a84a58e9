#include "models/margin.h"

#include <gtest/gtest.h>

#include <limits>

namespace sopt {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(MarginRungs, StepDownFromTheWholeMargin) {
  EXPECT_EQ(kMarginRungs.front(), 1.0);
  for (std::size_t i = 1; i < kMarginRungs.size(); ++i) {
    EXPECT_LT(kMarginRungs[i], kMarginRungs[i - 1]);
    EXPECT_GT(kMarginRungs[i], 0.0);
  }
}

ClearanceRule rule_of(double margin_m, double rung, double floor_m, double cap_m) {
  return {.margin_m = margin_m, .rung = rung, .floor_m = floor_m, .cap_m = cap_m};
}

TEST(ClearanceRule, ScalesTheRequestsMarginByTheRung) {
  const ClearanceRule rule = rule_of(0.25, 0.5, 0.0, kInfinity);
  EXPECT_EQ(rule.required_m(kDefaultMargin), 0.125);
}

TEST(ClearanceRule, ScalesAnObstaclesOwnMarginByTheRung) {
  const ClearanceRule rule = rule_of(0.25, 0.5, 0.0, kInfinity);
  EXPECT_EQ(rule.required_m(1.0), 0.5);
  EXPECT_EQ(rule.required_m(0.0), 0.0);
}

TEST(ClearanceRule, NeverAsksForMoreThanItsCap) {
  const ClearanceRule rule = rule_of(0.25, 1.0, 0.0, 0.0625);
  EXPECT_EQ(rule.required_m(kDefaultMargin), 0.0625);
  EXPECT_EQ(rule.required_m(1.0), 0.0625);
  EXPECT_EQ(rule.required_m(0.03125), 0.03125);
}

TEST(ClearanceRule, NeverAsksForLessThanItsFloor) {
  const ClearanceRule rule = rule_of(0.25, 0.25, 0.125, kInfinity);
  EXPECT_EQ(rule.required_m(kDefaultMargin), 0.125);
  EXPECT_EQ(rule.required_m(0.0), 0.125);
  EXPECT_EQ(rule.required_m(1.0), 0.25);
}

TEST(ClearanceRule, KeepsTheCapBelowTheFloor) {
  const ClearanceRule rule = rule_of(0.25, 1.0, 0.125, 0.0625);
  EXPECT_EQ(rule.required_m(kDefaultMargin), 0.0625);
  EXPECT_EQ(rule.required_m(0.0), 0.0625);
}

MarginProfile profile_with(int num_start_steps, int num_goal_steps) {
  MarginProfile profile;
  profile.rule = rule_of(0.5, 1.0, 0.0, kInfinity);
  profile.start_cap_m = 0.125;
  profile.goal_cap_m = 0.25;
  profile.num_start_steps = num_start_steps;
  profile.num_goal_steps = num_goal_steps;
  profile.step_length = 0.2;
  return profile;
}

double required_at(const MarginProfile& profile, int i, int horizon) {
  return profile.at_step(i, horizon).required_m(kDefaultMargin);
}

TEST(MarginProfile, CapsOnlyTheStepsNextToTheEnds) {
  const MarginProfile profile = profile_with(1, 2);
  EXPECT_EQ(required_at(profile, 0, 10), 0.125);
  for (int i = 1; i < 8; ++i) EXPECT_EQ(required_at(profile, i, 10), 0.5);
  EXPECT_EQ(required_at(profile, 8, 10), 0.25);
  EXPECT_EQ(required_at(profile, 9, 10), 0.25);
}

TEST(MarginProfile, TakesTheLowerCapWhereBothHold) {
  const MarginProfile profile = profile_with(2, 2);
  EXPECT_EQ(required_at(profile, 0, 3), 0.125);
  EXPECT_EQ(required_at(profile, 1, 3), 0.125);
  EXPECT_EQ(required_at(profile, 2, 3), 0.25);
}

TEST(MarginProfile, CapsNothingWithoutSteps) {
  const MarginProfile profile = profile_with(0, 0);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(required_at(profile, i, 5), 0.5);
  EXPECT_EQ(profile.at_start().required_m(kDefaultMargin), 0.5);
  EXPECT_EQ(profile.at_goal().required_m(kDefaultMargin), 0.5);
  EXPECT_EQ(profile.start_reach(), 0.0);
  EXPECT_EQ(profile.goal_reach(), 0.0);
}

TEST(MarginProfile, KeepsTheEndsApartBeforeThereAreSteps) {
  const MarginProfile profile = profile_with(1, 1);
  EXPECT_EQ(profile.at_start().required_m(kDefaultMargin), 0.125);
  EXPECT_EQ(profile.at_goal().required_m(kDefaultMargin), 0.25);
  const MarginProfile only_goal = profile_with(0, 3);
  EXPECT_EQ(only_goal.at_start().required_m(kDefaultMargin), 0.5);
  EXPECT_EQ(only_goal.at_goal().required_m(kDefaultMargin), 0.25);
}

TEST(MarginProfile, ReachesHalfOfItsCappedSteps) {
  const MarginProfile profile = profile_with(1, 3);
  EXPECT_DOUBLE_EQ(profile.start_reach(), 0.1);
  EXPECT_DOUBLE_EQ(profile.goal_reach(), 0.3);
}

TEST(MarginProfile, HoldsAnObstaclesOwnMarginBelowTheCap) {
  const MarginProfile profile = profile_with(1, 1);
  EXPECT_EQ(profile.at_step(0, 9).required_m(0.0625), 0.0625);
  EXPECT_EQ(profile.at_step(4, 9).required_m(0.75), 0.75);
}

}  // namespace
}  // namespace sopt
