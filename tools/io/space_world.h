// Obstacles in space, from the JSON of a scene to a World3 with its memory.
#pragma once

#include <memory>

#include "alloc/memory_block.h"
#include "models/space/world3.h"
#include "tools/io/json_fields.h"

namespace sopt {

struct SpaceWorld {
  std::unique_ptr<MemoryBlock> memory;
  std::unique_ptr<World3> world;  // built
};

// From the field `obstacles` of a scene. Throws InputError, and HostError when there is no memory.
[[nodiscard]] SpaceWorld read_space_world(const JsonField& root);

// `position` and `quaternion_xyzw`; absent: not turned.
[[nodiscard]] Pose3 read_pose(const JsonField& object);

}  // namespace sopt
