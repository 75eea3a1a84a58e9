#include "tools/io/svg.h"

#include <algorithm>
#include <cstdio>

namespace sopt {
namespace {

// For element content and attribute values; XML has no control characters.
std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += static_cast<unsigned char>(c) < 0x20U ? '?' : c;
    }
  }
  return result;
}

}  // namespace

Svg::Svg(double width_px, double height_px) {
  text_ = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"";
  append(width_px);
  text_ += "\" height=\"";
  append(height_px);
  text_ += "\" viewBox=\"0 0 ";
  append(width_px);
  text_ += ' ';
  append(height_px);
  text_ += "\" font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\">\n";
}

void Svg::append(double coordinate) {
  constexpr double kFar_px = 1e6;  // no viewer needs more, and the buffer always suffices
  char buffer[32];
  const int length =
      std::snprintf(buffer, sizeof buffer, "%.2f", std::clamp(coordinate, -kFar_px, kFar_px));
  std::string_view digits(buffer, static_cast<std::size_t>(length));
  while (digits.back() == '0') digits.remove_suffix(1);
  if (digits.back() == '.') digits.remove_suffix(1);
  text_ += digits;
}

void Svg::append(const Vec2& point) {
  append(point.x());
  text_ += ' ';
  append(point.y());
}

void Svg::rectangle(const Vec2& corner, const Vec2& size, std::string_view attributes) {
  text_ += "<rect x=\"";
  append(corner.x());
  text_ += "\" y=\"";
  append(corner.y());
  text_ += "\" width=\"";
  append(size.x());
  text_ += "\" height=\"";
  append(size.y());
  text_.append("\" ").append(attributes).append("/>\n");
}

void Svg::circle(const Vec2& center, double radius_px, std::string_view attributes) {
  text_ += "<circle cx=\"";
  append(center.x());
  text_ += "\" cy=\"";
  append(center.y());
  text_ += "\" r=\"";
  append(radius_px);
  text_.append("\" ").append(attributes).append("/>\n");
}

void Svg::line(const Vec2& from, const Vec2& to, std::string_view attributes) {
  lines({&from, 1}, {&to, 1}, attributes);
}

void Svg::polyline(std::span<const Vec2> points, bool closed, std::string_view attributes) {
  if (points.empty()) return;
  text_ += "<path d=\"M";
  append(points[0]);
  for (const Vec2& point : points.subspan(1)) {
    text_ += 'L';
    append(point);
  }
  text_.append(closed ? "Z\" " : "\" ").append(attributes).append("/>\n");
}

void Svg::lines(std::span<const Vec2> from, std::span<const Vec2> to, std::string_view attributes) {
  if (from.empty()) return;
  text_ += "<path d=\"";
  for (std::size_t i = 0; i < from.size(); ++i) {
    text_ += 'M';
    append(from[i]);
    text_ += 'L';
    append(to[i]);
  }
  text_.append("\" ").append(attributes).append("/>\n");
}

void Svg::text(const Vec2& at, std::string_view text, std::string_view attributes) {
  text_ += "<text x=\"";
  append(at.x());
  text_ += "\" y=\"";
  append(at.y());
  text_.append("\" ").append(attributes).append(">").append(escaped(text)).append("</text>\n");
}

void Svg::begin_clip(const Vec2& corner, const Vec2& size) {
  const std::string id = "clip" + std::to_string(num_clips_++);
  text_ += "<clipPath id=\"" + id + "\">";
  rectangle(corner, size, "");
  text_ += "</clipPath>\n";
  begin_group("clip-path=\"url(#" + id + ")\"");
}

void Svg::begin_group(std::string_view attributes) {
  text_.append("<g ").append(attributes).append(">\n");
}

void Svg::end_group() { text_ += "</g>\n"; }

std::string Svg::finish() const { return text_ + "</svg>\n"; }

}  // namespace sopt
