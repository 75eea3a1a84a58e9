// What of an arm's picture is shown, and from which corner.
#pragma once

#include <vector>

#include "tools/io/arm_picture.h"
#include "tools/io/space_view.h"

namespace sopt {

// Around the arm's motion, and around the obstacles as far from it as it is large.
[[nodiscard]] std::vector<Aabb3> shown_boxes(const ArmPicture& picture);

// From where the least is hidden or seen end on; from +x -y when that is as good as any.
[[nodiscard]] SpaceView best_view(const ArmPicture& picture);

}  // namespace sopt
