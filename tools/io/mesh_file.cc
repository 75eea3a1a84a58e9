#include "tools/io/mesh_file.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <locale>
#include <map>
#include <sstream>
#include <string>

#include "tools/io/input_error.h"
#include "tools/io/input_text.h"
#include "tools/io/json_fields.h"

namespace sopt {
namespace {

constexpr std::size_t kStlHeader_B = 84;
constexpr std::size_t kStlTriangle_B = 50;  // normal, three vertices, two bytes of attributes
constexpr double kFarthest = 1e6;

class MeshReader {
 public:
  explicit MeshReader(const std::filesystem::path& file)
      : shown_(printable(file.string(), 400)), text_(read_input(file, "a mesh file")) {}

  Mesh read_stl() {
    std::uint32_t num_triangles = 0;
    if (text_.size() >= kStlHeader_B) {
      std::memcpy(&num_triangles, text_.data() + kStlHeader_B - 4, sizeof num_triangles);
    }
    const std::size_t size_B = kStlHeader_B + kStlTriangle_B * num_triangles;
    if (text_.size() >= kStlHeader_B && text_.size() == size_B) return read_binary(num_triangles);
    if (!text_.starts_with("solid")) fail("is neither binary STL of its size nor text STL");
    return read_words();
  }

  Mesh read_obj() {
    Mesh mesh;
    std::istringstream lines(text_);
    std::string line;
    while (std::getline(lines, line)) {
      std::istringstream words(line);
      words.imbue(std::locale::classic());
      std::string kind;
      words >> kind;
      if (kind == "v") mesh.vertices.push_back(read_vertex(words));
      if (kind == "f") read_face(words, mesh);
    }
    return finish(mesh);
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const {
    throw InputError(shown_ + ": " + problem + "; it must be an STL or OBJ mesh");
  }

  Mesh read_binary(std::uint32_t num_triangles) const {
    Mesh mesh;
    for (std::uint32_t i = 0; i < num_triangles; ++i) {
      float xyz[9];
      std::memcpy(xyz, text_.data() + kStlHeader_B + kStlTriangle_B * i + 12, sizeof xyz);
      for (int k = 0; k < 3; ++k) {
        mesh.vertices.push_back(
            Eigen::Vector3f(xyz[3 * k], xyz[3 * k + 1], xyz[3 * k + 2]).cast<double>());
      }
    }
    join_in_threes(mesh);
    return finish(mesh);
  }

  Mesh read_words() const {
    Mesh mesh;
    std::istringstream words(text_);
    words.imbue(std::locale::classic());
    std::string word;
    while (words >> word) {
      if (word == "vertex") mesh.vertices.push_back(read_vertex(words));
    }
    if (mesh.vertices.size() % 3 != 0) fail("has a facet without three vertices");
    join_in_threes(mesh);
    return finish(mesh);
  }

  Vec3 read_vertex(std::istream& words) const {
    Vec3 v = Vec3::Zero();
    if (!(words >> v.x() >> v.y() >> v.z())) fail("has a vertex without three numbers");
    return v;
  }

  // "f 1/2/3 4//5 -1 ...": a fan of triangles; indices count from 1, or back from the last vertex.
  void read_face(std::istream& words, Mesh& mesh) const {
    const auto num_vertices = static_cast<long>(mesh.vertices.size());
    std::vector<int> corners;
    std::string word;
    while (words >> word) {
      const long index = std::strtol(word.c_str(), nullptr, 10);
      const long i = index > 0 ? index - 1 : num_vertices + index;
      if (index == 0 || i < 0 || i >= num_vertices) fail("has a face with a vertex it lacks");
      corners.push_back(static_cast<int>(i));
    }
    for (std::size_t i = 2; i < corners.size(); ++i) {
      mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
    }
  }

  // STL lists every triangle's own vertices, OBJ often those along seams twice; the same point
  // becomes one vertex.
  static Mesh merge_vertices(const Mesh& soup) {
    Mesh mesh;
    std::map<std::array<double, 3>, int> known;
    std::vector<int> merged;
    for (const Vec3& v : soup.vertices) {
      const auto [it, is_new] =
          known.try_emplace({v.x(), v.y(), v.z()}, static_cast<int>(mesh.vertices.size()));
      if (is_new) mesh.vertices.push_back(v);
      merged.push_back(it->second);
    }
    for (const auto& [a, b, c] : soup.triangles) {
      const auto at = [&](int k) { return merged[static_cast<std::size_t>(k)]; };
      mesh.triangles.push_back({at(a), at(b), at(c)});
    }
    return mesh;
  }

  static void join_in_threes(Mesh& mesh) {
    const auto num_vertices = static_cast<int>(mesh.vertices.size());
    for (int k = 0; k + 2 < num_vertices; k += 3) mesh.triangles.push_back({k, k + 1, k + 2});
  }

  Mesh finish(const Mesh& mesh) const {
    if (mesh.vertices.empty()) fail("has no vertices");
    for (const Vec3& v : mesh.vertices) {
      if (!(v.cwiseAbs().maxCoeff() <= kFarthest)) {
        fail("has a vertex that is not finite or beyond 1e6");
      }
    }
    return merge_vertices(mesh);
  }

  std::string shown_;
  std::string text_;
};

}  // namespace

Mesh load_mesh(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".stl") return MeshReader(file).read_stl();
  if (extension == ".obj") return MeshReader(file).read_obj();
  throw InputError(printable(file.string(), 400) + ": is a mesh of type \"" + printable(extension) +
                   "\"; it must be .stl or .obj");
}

// A closed surface has every edge once in each direction.
double mesh_volume_m3(const Mesh& mesh) {
  std::map<std::pair<int, int>, int> edges;
  double volume_m3 = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    ++edges[{a, b}];
    ++edges[{b, c}];
    ++edges[{c, a}];
    const auto at = [&](int i) { return mesh.vertices[static_cast<std::size_t>(i)]; };
    volume_m3 += at(a).cross(at(b)).dot(at(c)) / 6.0;
  }
  for (const auto& [edge, count] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    if (back == edges.end() || back->second != count) return 0.0;
  }
  return std::abs(volume_m3);
}

}  // namespace sopt
