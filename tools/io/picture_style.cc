#include "tools/io/picture_style.h"

#include <algorithm>
#include <cstdio>

namespace sopt {
namespace {

constexpr int kFont_px = 14;  // of legends

}  // namespace

std::string attribute(const char* name, std::string_view value) {
  return std::string(name) + "=\"" + std::string(value) + "\" ";
}

std::string fill(std::string_view color) { return attribute("fill", color); }

std::string stroke(std::string_view color, double width_px) {
  char width[32];
  (void)std::snprintf(width, sizeof width, "%.2f", width_px);
  return "fill=\"none\" stroke-linejoin=\"round\" stroke-linecap=\"round\" " +
         attribute("stroke", color) + attribute("stroke-width", width);
}

std::string font(int size_px, std::string_view color, bool bold) {
  return attribute("font-size", std::to_string(size_px)) + fill(color) +
         (bold ? "font-weight=\"bold\"" : "");
}

double text_width_px(std::string_view text, int size_px, bool bold) {
  const auto num_letters = std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xc0U) != 0x80U;
  });
  return (bold ? 0.68 : 0.59) * size_px * static_cast<double>(num_letters);
}

LegendGrid::LegendGrid(const Vec2& corner, double width_px, double widest_label_px, int num_entries)
    : corner_(corner),
      column_px_(column_px(widest_label_px)),
      num_columns_(
          std::clamp(static_cast<int>(width_px / column_px_), 1, std::max(1, num_entries))),
      num_entries_(num_entries) {}

double LegendGrid::label_px(std::string_view label) { return text_width_px(label, kFont_px); }

double LegendGrid::column_px(double widest_label_px) { return kSample_px + 32.0 + widest_label_px; }

Vec2 LegendGrid::add(std::string_view label, Svg& svg) {
  const int i_row = num_added_ / num_columns_;
  const Vec2 row = corner_ + Vec2(column_px_ * (num_added_ % num_columns_), kRow_px * i_row);
  ++num_added_;
  svg.text(row + Vec2(kSample_px + 10.0, 14.0), label, font(kFont_px, kInkColor));
  return row + Vec2(0.0, 9.5);
}

double LegendGrid::height_px() const {
  const int num_rows = (num_entries_ + num_columns_ - 1) / num_columns_;
  return kRow_px * num_rows;
}

}  // namespace sopt
