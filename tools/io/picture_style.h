// What the pictures have in common: colours, attributes of Svg elements, widths of texts, legends.
// Colours are Okabe and Ito's palette, which colour-blind people can tell apart. Texts are measured
// with the letters of DejaVu Sans, the widest of the fonts a viewer may take.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "tools/io/svg.h"

namespace sopt {

inline constexpr double kPad_px = 24.0;

inline constexpr const char* kInkColor = "#1f2933";
inline constexpr const char* kFaintInkColor = "#52606d";
inline constexpr const char* kObstacleColor = "#a3acb8";
inline constexpr const char* kFailureColor = "#c62828";
inline constexpr std::array<const char*, 3> kSegmentColors = {"#0072b2", "#e69f00", "#cc79a7"};

[[nodiscard]] std::string attribute(const char* name, std::string_view value);
[[nodiscard]] std::string fill(std::string_view color);
[[nodiscard]] std::string stroke(std::string_view color, double width_px);
[[nodiscard]] std::string font(int size_px, std::string_view color, bool bold = false);

// UTF-8; not less than any of the fonts needs.
[[nodiscard]] double text_width_px(std::string_view text, int size_px, bool bold = false);

// Entries row by row in columns as wide as the widest label: a 34 px wide sample, the label beside.
class LegendGrid {
 public:
  static constexpr double kSample_px = 34.0;
  static constexpr double kRow_px = 24.0;

  [[nodiscard]] static double label_px(std::string_view label);
  // Width of one column.
  [[nodiscard]] static double column_px(double widest_label_px);

  LegendGrid() = default;  // no entries
  // At least one column, whatever the width.
  LegendGrid(const Vec2& corner, double width_px, double widest_label_px, int num_entries);

  // Left end of the next entry's sample, at mid height of its row.
  Vec2 add(std::string_view label, Svg& svg);
  [[nodiscard]] double height_px() const;

 private:
  Vec2 corner_ = Vec2::Zero();
  double column_px_ = 0.0;
  int num_columns_ = 1;
  int num_entries_ = 0;
  int num_added_ = 0;
};

}  // namespace sopt
