// Triangle meshes from STL (binary or text) and OBJ files: vertices and faces, nothing else.
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "models/space/shape3.h"

namespace sopt {

struct Mesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<int, 3>> triangles;
};

// By the file's extension; throws InputError.
[[nodiscard]] Mesh load_mesh(const std::filesystem::path& file);

// Of a closed surface; 0 when the triangles do not enclose one.
[[nodiscard]] double mesh_volume_m3(const Mesh& mesh);

}  // namespace sopt
