// Scalable vector graphics as text: the few elements the program draws with, coordinates in pixels
// (x right, y down) with two decimals, texts escaped. Attributes are passed through as written.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "models/plane/convex2.h"

namespace sopt {

class Svg {
 public:
  Svg(double width_px, double height_px);

  void rectangle(const Vec2& corner, const Vec2& size, std::string_view attributes);
  void circle(const Vec2& center, double radius_px, std::string_view attributes);
  void line(const Vec2& from, const Vec2& to, std::string_view attributes);
  // One element whatever the number of points. `closed` joins the last point to the first.
  void polyline(std::span<const Vec2> points, bool closed, std::string_view attributes);
  // Many separate lines as one element: from[i] to to[i].
  void lines(std::span<const Vec2> from, std::span<const Vec2> to, std::string_view attributes);
  void text(const Vec2& at, std::string_view text, std::string_view attributes);
  // Until `end_group`, nothing outside the rectangle is painted.
  void begin_clip(const Vec2& corner, const Vec2& size);
  void begin_group(std::string_view attributes);
  void end_group();

  // The whole document.
  [[nodiscard]] std::string finish() const;

 private:
  void append(double coordinate);
  void append(const Vec2& point);

  std::string text_;
  int num_clips_ = 0;
};

}  // namespace sopt
