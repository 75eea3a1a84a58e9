// The files of this folder, embedded by viewer.cmake.
#pragma once

#include <string_view>

namespace sopt {

extern const std::string_view kViewerPage;    // page.html, with @DATA@, @THREE@ and @VIEWER@
extern const std::string_view kViewerScript;  // data.js, scene.js, plots.js, viewer.js
extern const std::string_view kThreeScript;   // three.min.js

}  // namespace sopt
