// How long a process takes that rebuilds its world: emptied, obstacles added, broad phase.
#pragma once

#include "models/plane/world2.h"
#include "models/space/world3.h"
#include "rt/clock.h"

namespace sopt {

// Of a world with the obstacles of `like`, which are known as shapes; once on cold memory, then
// timed. Throws HostError.
[[nodiscard]] double measure_world_build_us(const World2& like, const Clock& clock);
[[nodiscard]] double measure_world_build_us(const World3& like, const Clock& clock);

}  // namespace sopt
