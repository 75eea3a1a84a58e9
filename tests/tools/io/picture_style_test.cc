#include "tools/io/picture_style.h"

#include <gtest/gtest.h>

namespace sopt {
namespace {

TEST(TextWidth, CountsLettersNotBytes) {
  EXPECT_EQ(text_width_px("10⁻⁵", 14), text_width_px("1045", 14));
  EXPECT_EQ(text_width_px("", 14), 0.0);
  EXPECT_GT(text_width_px("a", 14, true), text_width_px("a", 14));
}

TEST(LegendGrid, FillsRowsWithAsManyColumnsAsFit) {
  const double column_px = LegendGrid::column_px(50.0);
  LegendGrid grid(Vec2(10, 20), 2.5 * column_px, 50.0, 3);
  Svg svg(100.0, 100.0);
  const Vec2 first = grid.add("a", svg);
  const Vec2 second = grid.add("b", svg);
  const Vec2 third = grid.add("c", svg);
  EXPECT_EQ(second - first, Vec2(column_px, 0.0));
  EXPECT_EQ(third - first, Vec2(0.0, LegendGrid::kRow_px));
  EXPECT_EQ(grid.height_px(), 2.0 * LegendGrid::kRow_px);
}

TEST(LegendGrid, HasAColumnHoweverNarrowThePage) {
  EXPECT_EQ(LegendGrid(Vec2::Zero(), 5.0, 500.0, 3).height_px(), 3.0 * LegendGrid::kRow_px);
  EXPECT_EQ(LegendGrid(Vec2::Zero(), 500.0, 0.0, 0).height_px(), 0.0);
}

}  // namespace
}  // namespace sopt
