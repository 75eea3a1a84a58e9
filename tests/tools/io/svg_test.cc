#include "tools/io/svg.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>

namespace sopt {
namespace {

TEST(Svg, WritesShortNumbers) {
  Svg svg(100.0, 50.5);
  svg.circle(Vec2(1.0, 2.345), 0.125, "");
  EXPECT_NE(svg.finish().find("viewBox=\"0 0 100 50.5\""), std::string::npos);
  EXPECT_NE(svg.finish().find("cx=\"1\" cy=\"2.35\" r=\"0.12\""), std::string::npos)
      << svg.finish();
}

TEST(Svg, KeepsCoordinatesWithinWhatViewersRead) {
  Svg svg(10.0, 10.0);
  svg.circle(Vec2(1e300, -std::numeric_limits<double>::infinity()), 1.0, "");
  EXPECT_NE(svg.finish().find("cx=\"1000000\" cy=\"-1000000\""), std::string::npos);
}

TEST(Svg, EscapesTexts) {
  Svg svg(10.0, 10.0);
  svg.text(Vec2(0, 0), "a<b> & \"c\"\x01", "");
  EXPECT_NE(svg.finish().find(">a&lt;b&gt; &amp; &quot;c&quot;?</text>"), std::string::npos)
      << svg.finish();
}

TEST(Svg, DrawsManyLinesAsOneElement) {
  Svg svg(10.0, 10.0);
  const std::array<Vec2, 2> from = {Vec2(0, 0), Vec2(1, 1)};
  const std::array<Vec2, 2> to = {Vec2(2, 0), Vec2(3, 1)};
  svg.lines(from, to, "stroke=\"red\"");
  svg.polyline(from, true, "");
  EXPECT_NE(svg.finish().find("<path d=\"M0 0L2 0M1 1L3 1\" stroke=\"red\"/>"), std::string::npos);
  EXPECT_NE(svg.finish().find("<path d=\"M0 0L1 1Z\" />"), std::string::npos) << svg.finish();
}

TEST(Svg, DrawsNothingForNoPoints) {
  Svg svg(10.0, 10.0);
  const std::string empty = svg.finish();
  svg.polyline({}, false, "");
  svg.lines({}, {}, "");
  EXPECT_EQ(svg.finish(), empty);
}

}  // namespace
}  // namespace sopt
