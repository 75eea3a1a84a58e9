#include "tools/tables/paper_claims.h"

#include <gtest/gtest.h>

namespace sopt {
namespace {

// Positions in kPlaneColumns.
constexpr std::size_t kOne = 0, kThree = 1, kFive = 2, kSeven = 3, kNine = 4;
constexpr std::size_t kNumFixed = 5, kSevenMerging = 5, kNineMerging = 6;

class PaperClaimsTest : public ::testing::Test {
 protected:
  // Figures that meet every claim.
  void SetUp() override {
    figures_.source = "A";
    figures_.clock = "serial";
    figures_.table = &kPlaneTable;
    figures_.rrt_star_length = 38.0;
    figures_.columns = {{100.0, 40.0, 31.0, 14.0, 100.0}, {20.0, 8.0, 31.1, 6.5, 100.0},
                        {15.0, 6.0, 30.9, 6.0, 100.0},    {10.0, 4.0, 31.0, 5.0, 100.0},
                        {14.0, 5.0, 31.2, 7.5, 100.0},    {9.0, 3.0, 31.0, 5.0, 100.0},
                        {12.0, 4.0, 31.0, 7.0, 100.0}};
  }
  // The same with the merging columns of 5, 7 and 9, and one segment that fails.
  void make_arm() {
    figures_.table = &kArmManyTable;
    figures_.columns.insert(figures_.columns.begin() + kNumFixed, {13.0, 5.0, 31.0, 6.0, 100.0});
    column(kOne).success_percent = 50.0;
  }

  [[nodiscard]] Evidence judge(const std::string& part_of_statement) const {
    for (const Claim& claim : judge_claims({figures_})) {
      if (claim.statement.find(part_of_statement) != std::string::npos) {
        return claim.evidence.front();
      }
    }
    ADD_FAILURE() << "no statement with " << part_of_statement;
    return {};
  }
  ClaimColumn& column(std::size_t i) { return figures_.columns[i]; }

  ClaimFigures figures_;
};

TEST_F(PaperClaimsTest, FiguresThatSayItMeetEveryClaim) {
  const std::vector<Claim> claims = judge_claims({figures_});
  EXPECT_EQ(claims.size(), 9U);
  for (const Claim& claim : claims) {
    ASSERT_EQ(claim.evidence.size(), 1U);
    EXPECT_TRUE(claim.evidence[0].is_met) << claim.statement << ": " << claim.evidence[0].text;
  }
}

TEST_F(PaperClaimsTest, SplittingCutsNoTimeWhenOneSegmentIsAsFast) {
  EXPECT_EQ(judge("splitting cuts").text,
            "N = 1 takes 10 x the best, N = 7 (100 us against 10 us)");
  column(kOne).optimize_time = 10.4;
  EXPECT_FALSE(judge("splitting cuts").is_met);
  column(kNine).optimize_time = 5.0;
  EXPECT_TRUE(judge("splitting cuts").is_met);
  EXPECT_NE(judge("splitting cuts").text.find("2.08 x the best, N = 9"), std::string::npos);
}

TEST_F(PaperClaimsTest, SevenIsNotTheFastestWhenAnotherIsNearInTimeOrIterations) {
  column(kFive).optimize_time = 10.2;
  EXPECT_FALSE(judge("7 segments").is_met);
  column(kFive).optimize_time = 15.0;
  column(kThree).iterations = 5.1;
  EXPECT_FALSE(judge("7 segments").is_met);
}

TEST_F(PaperClaimsTest, MergingHelpsOnlyWhenItHelpsFromBothNumbers) {
  column(kSevenMerging).optimize_time = 9.9;
  EXPECT_FALSE(judge("merging").is_met);
  column(kSevenMerging).optimize_time = 9.0;
  column(kNineMerging).optimize_time = 20.0;
  EXPECT_FALSE(judge("merging").is_met);
}

TEST_F(PaperClaimsTest, ADeviationAsLargeAsThatOfOneSegmentIsNotSmall) {
  column(kNineMerging).optimize_deviation = 39.0;
  EXPECT_FALSE(judge("vary less").is_met);
}

TEST_F(PaperClaimsTest, CostsMoreThanTwoPercentApartAreNotEqual) {
  column(kThree).length = 31.6;
  EXPECT_FALSE(judge("costs are equal").is_met);
  EXPECT_EQ(judge("costs are equal").text, "30.90 to 31.60 m, 2.3 % apart");
}

TEST_F(PaperClaimsTest, CostsNearThoseOfTheSamplerAreNotNoticeablyBelow) {
  figures_.rrt_star_length = 32.0;
  EXPECT_FALSE(judge("noticeably below").is_met);
}

TEST_F(PaperClaimsTest, WithoutCommonCasesNothingIsSaidAboutCosts) {
  for (ClaimColumn& c : figures_.columns) c.length = 0.0;
  figures_.rrt_star_length = 0.0;
  EXPECT_FALSE(judge("costs are equal").is_met);
  EXPECT_FALSE(judge("noticeably below").is_met);
  EXPECT_EQ(judge("costs are equal").text, "no case that every column solved");
}

TEST_F(PaperClaimsTest, WithoutTimesNothingIsSaidAboutTime) {
  column(kFive).optimize_time = 0.0;
  for (const char* const part : {"splitting cuts", "7 segments", "merging", "vary less"}) {
    EXPECT_FALSE(judge(part).is_met);
    EXPECT_EQ(judge(part).text, "a column in which nothing was optimised");
  }
}

TEST_F(PaperClaimsTest, IterationsAreFewUpToEightAndFewerThanWithOneSegment) {
  column(kNineMerging).iterations = 8.1;
  EXPECT_FALSE(judge("few iterations").is_met);
  EXPECT_TRUE(judge("fewer iterations").is_met);
  column(kOne).iterations = 8.0;
  EXPECT_FALSE(judge("fewer iterations").is_met);
}

TEST_F(PaperClaimsTest, OneFailureBreaksSuccess) {
  column(kSeven).success_percent = 99.5;
  EXPECT_FALSE(judge("every case succeeds").is_met);
  EXPECT_EQ(judge("every case succeeds").text, "99.5 to 100 %");
}

TEST_F(PaperClaimsTest, WhatIsNotAboutTimeIsSaidOncePerSource) {
  ClaimFigures critical_path = figures_;
  critical_path.clock = "critical path";
  ClaimFigures other = figures_;
  other.source = "B";
  for (const Claim& claim : judge_claims({figures_, critical_path, other})) {
    const bool is_about_time = !claim.evidence.front().clock.empty();
    EXPECT_EQ(claim.evidence.size(), is_about_time ? 3U : 2U) << claim.statement;
    EXPECT_EQ(claim.evidence.back().source, "B");
  }
}

// What its Table I says under these conditions: all but a material gain by merging.
TEST_F(PaperClaimsTest, ThePaperMeetsItsClaimsButMergingFromSevenGainsLessThanOnePercent) {
  for (const Claim& claim : judge_claims({figures_of(kPlaneTable)})) {
    const bool is_merging = claim.statement.find("merging") != std::string::npos;
    EXPECT_EQ(claim.evidence.front().is_met, !is_merging) << claim.statement;
    if (is_merging) {
      EXPECT_EQ(claim.evidence.front().text, "0.994 x the time of 7 that stay, 0.909 x that of 9");
    }
  }
}

TEST_F(PaperClaimsTest, AModesFiguresAreItsOptimisationSerialOrOnTheCriticalPath) {
  ModeSummary mode;
  mode.letter = 'B';
  mode.rrt_star.common_length.mean = 35.0;
  mode.columns.resize(kPlaneColumns.size());
  mode.columns[kNine].optimize.serial_us = {4, 20.0, 2.0, 19.0};
  mode.columns[kNine].optimize.critical_us = {4, 8.0, 1.0, 7.0};
  mode.columns[kNine].common_length.mean = 31.0;
  mode.columns[kNine].iterations.mean = 6.0;
  mode.columns[kNine].num_cases = 4;
  mode.columns[kNine].num_succeeded = 3;
  const ClaimFigures serial = figures_of(kPlaneTable, mode, false);
  EXPECT_EQ(serial.source, "B");
  EXPECT_EQ(serial.clock, "serial");
  EXPECT_DOUBLE_EQ(serial.rrt_star_length, 35.0);
  EXPECT_DOUBLE_EQ(serial.columns[kNine].optimize_time, 20.0);
  EXPECT_DOUBLE_EQ(serial.columns[kNine].optimize_deviation, 2.0);
  EXPECT_DOUBLE_EQ(serial.columns[kNine].length, 31.0);
  EXPECT_DOUBLE_EQ(serial.columns[kNine].iterations, 6.0);
  EXPECT_DOUBLE_EQ(serial.columns[kNine].success_percent, 75.0);
  EXPECT_DOUBLE_EQ(figures_of(kPlaneTable, mode, true).columns[kNine].optimize_time, 8.0);
  EXPECT_DOUBLE_EQ(figures_of(kPlaneTable, mode, true).columns[kNine].optimize_deviation, 1.0);
}

TEST_F(PaperClaimsTest, StatementsOfArmsGoThroughTheSameConditions) {
  make_arm();
  const std::vector<Claim> claims = judge_claims({figures_});
  EXPECT_EQ(claims.size(), 9U);
  for (const Claim& claim : claims) {
    EXPECT_TRUE(claim.evidence.front().is_met)
        << claim.statement << ": " << claim.evidence.front().text;
  }
  EXPECT_EQ(judge("merging cuts it further").text,
            "0.867 x the time of 5 that stay, 0.9 x that of 7, 0.857 x that of 9");
  EXPECT_EQ(judge("costs are equal").text, "30.90 to 31.20 rad, 0.97 % apart");
  column(kOne).length = 50.0;  // of few cases
  EXPECT_TRUE(judge("costs are equal").is_met);
  EXPECT_TRUE(judge("noticeably below").is_met);
  column(kFive).optimize_time = 9.0;
  EXPECT_FALSE(judge("below that of any number").is_met);
}

TEST_F(PaperClaimsTest, OneSegmentThatSucceedsAsOftenAsOthersFailsTheStatementOfArms) {
  make_arm();
  EXPECT_EQ(judge("one segment alone").text, "50 % at N = 1, 100 % at N >= 3");
  column(kThree).success_percent = 52.0;
  EXPECT_FALSE(judge("one segment alone").is_met);
  EXPECT_FALSE(judge("with N >= 3 every case succeeds").is_met);
  EXPECT_EQ(judge("with N >= 3 every case succeeds").text, "52 to 100 %");
}

// What its Table II says: more obstacles make merging pay, and N = 3 and 5 as dear as N = 1.
TEST_F(PaperClaimsTest, ThePapersArmsMeetMergingOnlyAmongManyObstacles) {
  const auto met = [](const PaperTable& table, const std::string& part) {
    for (const Claim& claim : judge_claims({figures_of(table)})) {
      if (claim.statement.find(part) != std::string::npos) return claim.evidence.front().is_met;
    }
    ADD_FAILURE() << part;
    return false;
  };
  for (const PaperTable* const table : {&kArmFewTable, &kArmManyTable}) {
    for (const char* const part : {"splitting cuts", "vary less", "noticeably below",
                                   "few iterations", "every case", "one segment alone"}) {
      EXPECT_TRUE(met(*table, part)) << part;
    }
    EXPECT_EQ(met(*table, "merging cuts it further"), table == &kArmManyTable);
    EXPECT_EQ(met(*table, "costs are equal"), table == &kArmFewTable);
  }
  const Claim both = judge_more_obstacles({figures_of(kArmFewTable)}, {figures_of(kArmManyTable)});
  ASSERT_EQ(both.evidence.size(), 1U);
  EXPECT_EQ(both.evidence[0].source, "paper");
  EXPECT_EQ(both.evidence[0].text, "1.51 x the time at N = 1, 0.947 to 1.63 x at N >= 3");
  EXPECT_FALSE(both.evidence[0].is_met);
}

TEST_F(PaperClaimsTest, MoreObstaclesAreComparedColumnByColumn) {
  make_arm();
  ClaimFigures many = figures_;
  for (ClaimColumn& c : many.columns) c.optimize_time *= 2.0;
  many.columns[kOne].optimize_time *= 2.0;
  const Claim claim = judge_more_obstacles({figures_}, {many});
  EXPECT_TRUE(claim.evidence.front().is_met);
  EXPECT_EQ(claim.evidence.front().text, "4 x the time at N = 1, 2 to 2 x at N >= 3");
  many.columns[kNineMerging].optimize_time = 0.0;
  EXPECT_EQ(judge_more_obstacles({figures_}, {many}).evidence.front().text,
            "a column in which nothing was optimised");
}

}  // namespace
}  // namespace sopt
