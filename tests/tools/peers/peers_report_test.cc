#include "tools/peers/peers_report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tools/peers/peer_names.h"

namespace sopt {
namespace {

PeerCase solved(std::uint64_t seed, std::int64_t time_ns, double length) {
  PeerCase c;
  c.scene = "plane";
  c.seed = seed;
  c.is_solved = true;
  c.time_ns = time_ns;
  c.length = length;
  c.verdict = PathVerdict::kKeepsMargin;
  return c;
}

PeerCase failed(std::uint64_t seed) {
  PeerCase c = solved(seed, 1, 0.0);
  c.is_solved = false;
  c.failure = "Timeout";
  c.verdict = PathVerdict::kNotChecked;
  return c;
}

PeerRatio ratio_of(const std::vector<PeerRun>& runs, const std::string& ours,
                   const std::string& theirs, PeerFigure figure) {
  for (const PeerRatio& ratio : compare(runs, SceneKind::kPlane)) {
    if (ratio.ours == ours && ratio.theirs == theirs && ratio.figure == figure) return ratio;
  }
  ADD_FAILURE() << "no ratio " << ours << " / " << theirs;
  return {};
}

TEST(CompareTest, TimesByTheirMediansLengthsByTheirMeans) {
  const std::vector<PeerRun> runs = {
      {kSoptPlan, {solved(1, 100, 10.0), solved(2, 300, 20.0), solved(3, 900, 60.0)}},
      {kOmplSimplified, {solved(1, 200, 30.0), solved(2, 600, 30.0), solved(3, 700, 30.0)}}};
  EXPECT_DOUBLE_EQ(ratio_of(runs, kSoptPlan, kOmplSimplified, PeerFigure::kMedianTime).value, 0.5);
  EXPECT_DOUBLE_EQ(ratio_of(runs, kSoptPlan, kOmplSimplified, PeerFigure::kMeanLength).value, 1.0);
}

TEST(CompareTest, OnlyCasesThatBothSolvedCount) {
  const std::vector<PeerRun> runs = {
      {kSoptPlan, {solved(1, 1, 10.0), solved(2, 1, 99.0), failed(3), solved(4, 1, 10.0)}},
      {kOmplRrtStarLong, {solved(4, 1, 5.0), solved(1, 1, 5.0), failed(2), solved(3, 1, 70.0)}}};
  const PeerRatio ratio = ratio_of(runs, kSoptPlan, kOmplRrtStarLong, PeerFigure::kMeanLength);
  EXPECT_EQ(ratio.num_cases, 2);
  EXPECT_DOUBLE_EQ(ratio.value, 2.0);
}

TEST(CompareTest, ScenesWithTheSameSeedAreDifferentCases) {
  PeerCase elsewhere = solved(1, 1, 8.0);
  elsewhere.scene = "elsewhere";
  const std::vector<PeerRun> runs = {{kSoptPlan, {solved(1, 1, 2.0)}},
                                     {kOmplRrtStarLong, {elsewhere}}};
  EXPECT_EQ(ratio_of(runs, kSoptPlan, kOmplRrtStarLong, PeerFigure::kMeanLength).num_cases, 0);
}

TEST(CompareTest, ATargetIsMetUpToItsValueAndNotWithoutCases) {
  const auto met = [](std::int64_t our_time_ns) {
    const std::vector<PeerRun> runs = {{kSoptFirstPath, {solved(1, our_time_ns, 1.0)}},
                                       {kOmplRrtStar, {solved(1, 1000, 1.0)}}};
    return ratio_of(runs, kSoptFirstPath, kOmplRrtStar, PeerFigure::kMedianTime).is_met();
  };
  EXPECT_TRUE(met(100));
  EXPECT_FALSE(met(101));
  EXPECT_FALSE(ratio_of({}, kSoptFirstPath, kOmplRrtStar, PeerFigure::kMedianTime).is_met());
}

TEST(CompareTest, ArmsHaveTargetsOfTheirOwn) {
  const auto target_of = [](SceneKind kind, const std::string& theirs) {
    for (const PeerRatio& ratio : compare({}, kind)) {
      if (ratio.ours == kSoptFirstPath && ratio.theirs == theirs) return ratio.target;
    }
    return -1.0;
  };
  EXPECT_EQ(target_of(SceneKind::kPlane, kOmplRrtStar), 0.10);
  EXPECT_EQ(target_of(SceneKind::kArm, kOmplRrtStar), 0.0);
  EXPECT_EQ(target_of(SceneKind::kPlane, kOmplRrtConnect), 0.0);
  EXPECT_EQ(target_of(SceneKind::kArm, kOmplRrtConnect), 1.0);
}

TEST(DescribePeersTest, LengthsHaveTheUnitOfTheirScenes) {
  const std::vector<PeerRun> runs = {{"p", {solved(1, 4000, 1.0)}}};
  EXPECT_NE(describe_peers(runs, SceneKind::kPlane).find("len [m]"), std::string::npos);
  EXPECT_NE(describe_peers(runs, SceneKind::kArm).find("len [rad]"), std::string::npos);
  EXPECT_EQ(to_json(runs, SceneKind::kArm, PeersOptions{}).at("length_unit"), "rad");
}

TEST(DescribeRatiosTest, SayMetOrMissedOnlyWhereThereIsATarget) {
  const std::vector<PeerRatio> ratios = {
      {.ours = "a", .theirs = "b", .target = 1.0, .value = 0.5, .num_cases = 1},
      {.ours = "c", .theirs = "d", .target = 1.0, .value = 1.5, .num_cases = 1},
      {.ours = "e", .theirs = "f", .value = 2.5, .num_cases = 1}};
  const std::string text = describe_ratios(ratios);
  const std::string line_c = text.substr(text.find("c "));
  EXPECT_NE(text.find("0.500  over    1 cases  target 1.00 met\n"), std::string::npos) << text;
  EXPECT_NE(line_c.find("1.500  over    1 cases  target 1.00 MISSED\n"), std::string::npos) << text;
  EXPECT_NE(text.find("2.500  over    1 cases\n"), std::string::npos) << text;
}

TEST(DescribeRatiosTest, GiveNoVerdictWithoutCases) {
  const std::string text = describe_ratios({{.ours = "a", .theirs = "b", .target = 1.0}});
  EXPECT_NE(text.find("no case that both solved\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("target"), std::string::npos) << text;
}

TEST(PeersJsonTest, CountsWhatCollidesAsBelowTheMarginToo) {
  PeerCase below = solved(2, 1, 1.0);
  below.verdict = PathVerdict::kBelowMargin;
  PeerCase collides = solved(3, 1, 1.0);
  collides.verdict = PathVerdict::kCollides;
  const auto document =
      to_json(std::vector<PeerRun>{{kOmplRrtStar, {solved(1, 1, 1.0), below, collides, failed(4)}}},
              SceneKind::kPlane, PeersOptions{});
  const auto& peer = document.at("peers").at(0);
  EXPECT_EQ(peer.at("cases"), 4);
  EXPECT_EQ(peer.at("solved"), 3);
  EXPECT_EQ(peer.at("paths_checked"), 3);
  EXPECT_EQ(peer.at("paths_below_margin"), 2);
  EXPECT_EQ(peer.at("paths_colliding"), 1);
  EXPECT_EQ(document.at("cases").size(), 4U);
}

TEST(DescribePeersTest, FailuresCountInTheSuccessNotInTheTimesAndAreNamed) {
  const std::string text =
      describe_peers({{"p", {solved(1, 4000, 1.0), failed(2), failed(3)}}}, SceneKind::kPlane);
  EXPECT_NE(text.find("1/3 "), std::string::npos) << text;
  EXPECT_NE(text.find("not solved by p: plane, 2 x Timeout\n"), std::string::npos) << text;
  EXPECT_NE(text.find("4.0 "), std::string::npos) << text;
}

}  // namespace
}  // namespace sopt
