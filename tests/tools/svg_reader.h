// Elements of an SVG document for tests: names, attributes, texts, points of paths. Reports what is
// not well-formed XML as a test failure.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "models/plane/convex2.h"

namespace sopt {

struct SvgElement {
  std::string name;
  std::map<std::string, std::string> attributes;
  std::string text;  // entities resolved

  [[nodiscard]] bool has(const std::string& attribute) const {
    return attributes.contains(attribute);
  }
  // Empty, or 0, when it is absent.
  [[nodiscard]] std::string get(const std::string& attribute) const {
    const auto found = attributes.find(attribute);
    return found == attributes.end() ? "" : found->second;
  }
  [[nodiscard]] double number(const std::string& attribute) const {
    return has(attribute) ? std::stod(get(attribute)) : 0.0;
  }
  [[nodiscard]] Vec2 vector(const std::string& x, const std::string& y) const {
    return {number(x), number(y)};
  }
  // Of a path.
  [[nodiscard]] std::vector<Vec2> points() const {
    std::string numbers = get("d");
    for (char& c : numbers) {
      if (c == 'M' || c == 'L' || c == 'Z') c = ' ';
    }
    std::istringstream stream(numbers);
    std::vector<Vec2> result;
    for (Vec2 point; stream >> point.x() >> point.y();) result.push_back(point);
    return result;
  }
};

namespace svg_reader {

inline std::string resolved(std::string text) {
  for (const auto& [entity, letter] : {std::pair{"&lt;", "<"}, std::pair{"&gt;", ">"},
                                       std::pair{"&quot;", "\""}, std::pair{"&amp;", "&"}}) {
    for (std::size_t at = 0; (at = text.find(entity, at)) != std::string::npos; ++at) {
      text.replace(at, std::string(entity).size(), letter);
    }
  }
  return text;
}

// The inside of a start tag: name, then attributes in double quotes, each only once.
inline SvgElement read_tag(const std::string& tag) {
  SvgElement element;
  std::size_t at = tag.find_first_of(" /");
  element.name = tag.substr(0, at);
  while (at != std::string::npos) {
    at = tag.find_first_not_of(" /", at);
    if (at == std::string::npos) break;
    const std::size_t equals = tag.find("=\"", at);
    const std::size_t quote = equals == std::string::npos ? equals : tag.find('"', equals + 2);
    if (quote == std::string::npos) {
      ADD_FAILURE() << "attributes of <" << tag << ">";
      break;
    }
    const std::string name = tag.substr(at, equals - at);
    EXPECT_FALSE(element.has(name)) << name << " twice in <" << tag << ">";
    element.attributes[name] = resolved(tag.substr(equals + 2, quote - equals - 2));
    at = quote + 1;
  }
  return element;
}

}  // namespace svg_reader

// In the order of the document.
inline std::vector<SvgElement> read_svg(const std::string& svg) {
  std::vector<SvgElement> elements;
  std::vector<std::string> open;
  for (std::size_t at = 0; (at = svg.find('<', at)) != std::string::npos;) {
    const std::size_t end = svg.find('>', at);
    if (end == std::string::npos) {
      ADD_FAILURE() << "a tag without end";
      return elements;
    }
    const std::string tag = svg.substr(at + 1, end - at - 1);
    at = svg.find('<', end);
    if (tag.starts_with('/')) {
      if (open.empty() || open.back() != tag.substr(1)) {
        ADD_FAILURE() << "<" << tag << "> closes what is not open";
        return elements;
      }
      open.pop_back();
      continue;
    }
    EXPECT_TRUE(elements.empty() || !open.empty()) << "<" << tag << "> after the root's end";
    elements.push_back(svg_reader::read_tag(tag));
    if (tag.ends_with('/')) continue;
    open.push_back(elements.back().name);
    elements.back().text = svg_reader::resolved(svg.substr(end + 1, at - end - 1));
  }
  EXPECT_TRUE(open.empty()) << "<" << (open.empty() ? "" : open.back()) << "> is never closed";
  return elements;
}

}  // namespace sopt
