#include "models/space/hull3.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "models/simd.h"

namespace sopt {
namespace {

using VertexSet = std::uint32_t;  // bit i: vertex i
static_assert(kMaxHullVertices <= 32);

// Relative to the hull's extent.
constexpr double kCoplanar = 1e-10;   // distance to a plane
constexpr double kMinWidth = 1e-6;    // of a triple, to define a plane
constexpr double kMinInside = 1e-8;   // of the center from every plane
constexpr double kSameEdge2 = 1e-24;  // squared sine between edges that count as parallel

class HullBuilder {
 public:
  HullBuilder(HullData& out, double extent) noexcept : h_(out), extent_(extent) {}

  // False when there are more planes or edges than a hull can have.
  [[nodiscard]] bool build() noexcept {
    for (int i = 0; i < h_.num_vertices; ++i) {
      for (int j = i + 1; j < h_.num_vertices; ++j) {
        for (int k = j + 1; k < h_.num_vertices; ++k) {
          if (!is_known(bit(i) | bit(j) | bit(k)) && !add_plane(i, j, k)) return false;
        }
      }
    }
    return add_edges();
  }

 private:
  static VertexSet bit(int i) noexcept { return VertexSet{1} << i; }
  [[nodiscard]] Vec3 vertex(int i) const noexcept { return {h_.x[i], h_.y[i], h_.z[i]}; }
  [[nodiscard]] Vec3 cross_of(int i, int j, int k) const noexcept {
    return (vertex(j) - vertex(i)).cross(vertex(k) - vertex(i));
  }

  [[nodiscard]] bool is_known(VertexSet triple) const noexcept {
    return std::any_of(face_, face_ + h_.num_planes,
                       [&](VertexSet face) { return (face & triple) == triple; });
  }

  // The points on the plane through vertex i, when it has all others on its inner side.
  [[nodiscard]] VertexSet supported_by(const Vec3& normal, int i) const noexcept {
    const double offset = normal.dot(vertex(i));
    VertexSet face = 0;
    for (int m = 0; m < h_.num_vertices; ++m) {
      const double height = normal.dot(vertex(m)) - offset;
      if (height > kCoplanar * extent_) return 0;
      if (height >= -kCoplanar * extent_) face |= bit(m);
    }
    return face;
  }

  [[nodiscard]] Vec3 widest_normal(VertexSet face, const Vec3& outward) const noexcept {
    Vec3 best = Vec3::Zero();
    for (int i = 0; i < h_.num_vertices; ++i) {
      for (int j = i + 1; j < h_.num_vertices; ++j) {
        for (int k = j + 1; k < h_.num_vertices; ++k) {
          const VertexSet triple = bit(i) | bit(j) | bit(k);
          if ((face & triple) != triple) continue;
          const Vec3 normal = cross_of(i, j, k);
          if (normal.squaredNorm() > best.squaredNorm()) best = normal;
        }
      }
    }
    return best.dot(outward) < 0.0 ? -best.normalized() : best.normalized();
  }

  [[nodiscard]] bool add_plane(int i, int j, int k) noexcept {
    const Vec3 cross = cross_of(i, j, k);
    const double length = cross.norm();
    const double longest = std::max({(vertex(j) - vertex(i)).norm(), (vertex(k) - vertex(i)).norm(),
                                     (vertex(k) - vertex(j)).norm()});
    if (length <= kMinWidth * extent_ * longest) return true;
    for (const double side : {1.0, -1.0}) {
      const Vec3 normal = side / length * cross;
      const VertexSet face = supported_by(normal, i);
      if (face == 0) continue;
      if (h_.num_planes == kMaxHullPlanes) return false;
      face_[h_.num_planes] = face;
      const Vec3 widest = widest_normal(face, normal);
      h_.normal[h_.num_planes] = widest;
      h_.offset[h_.num_planes] = upper_along(widest);
      ++h_.num_planes;
    }
    return true;
  }

  [[nodiscard]] double upper_along(const Vec3& normal) const noexcept {
    double upper = normal.dot(vertex(0));
    for (int i = 1; i < h_.num_vertices; ++i) upper = std::max(upper, normal.dot(vertex(i)));
    return upper;
  }

  // Unit direction between the two points of `shared` that are farthest apart.
  [[nodiscard]] Vec3 direction_of(VertexSet shared) const noexcept {
    Vec3 best = Vec3::Zero();
    for (int i = 0; i < h_.num_vertices; ++i) {
      for (int j = i + 1; j < h_.num_vertices; ++j) {
        if ((shared & bit(i)) == 0 || (shared & bit(j)) == 0) continue;
        const Vec3 edge = vertex(j) - vertex(i);
        if (edge.squaredNorm() > best.squaredNorm()) best = edge;
      }
    }
    return best.normalized();
  }

  [[nodiscard]] bool add_edges() noexcept {
    for (int i = 0; i < h_.num_planes; ++i) {
      for (int j = i + 1; j < h_.num_planes; ++j) {
        const VertexSet shared = face_[i] & face_[j];
        if (std::popcount(shared) < 2) continue;
        const Vec3 edge = direction_of(shared);
        if (edge.squaredNorm() == 0.0) continue;  // one point, listed twice
        const bool is_double = std::any_of(h_.edge, h_.edge + h_.num_edges, [&](const Vec3& e) {
          return e.cross(edge).squaredNorm() < kSameEdge2;
        });
        if (is_double) continue;
        if (h_.num_edges == kMaxHullEdges) return false;
        h_.edge[h_.num_edges++] = edge;
      }
    }
    return true;
  }

  HullData& h_;
  double extent_;
  VertexSet face_[kMaxHullPlanes] = {};
};

}  // namespace

WorldStatus build_hull(const Hull3& hull, HullData& out, Vec3& center) noexcept {
  const std::size_t n = hull.vertices.size();
  if (n < static_cast<std::size_t>(kMinHullVertices) ||
      n > static_cast<std::size_t>(kMaxHullVertices)) {
    return WorldStatus::kBadVertexCount;
  }
  Aabb3 box{hull.vertices[0], hull.vertices[0]};
  for (const Vec3& v : hull.vertices) {
    if (!v.allFinite()) return WorldStatus::kNotFinite;
    box.lower = box.lower.cwiseMin(v);
    box.upper = box.upper.cwiseMax(v);
  }
  const double extent = (box.upper - box.lower).maxCoeff();
  if (!std::isfinite(extent)) return WorldStatus::kNotFinite;
  center = 0.5 * (box.lower + box.upper);
  out.num_planes = out.num_edges = 0;
  out.num_vertices = static_cast<int>(n);
  out.num_padded = (out.num_vertices + kLanesDouble - 1) / kLanesDouble * kLanesDouble;
  Vec3 middle = Vec3::Zero();
  for (int i = 0; i < out.num_padded; ++i) {
    const Vec3 v = hull.vertices[std::min(static_cast<std::size_t>(i), n - 1)] - center;
    out.x[i] = v.x();
    out.y[i] = v.y();
    out.z[i] = v.z();
    if (i < out.num_vertices) middle += v / static_cast<double>(n);
  }
  if (!(extent > 0.0) || !HullBuilder(out, extent).build() || out.num_planes < 4) {
    return WorldStatus::kDegenerate;
  }
  for (int i = 0; i < out.num_planes; ++i) {
    if (out.offset[i] - out.normal[i].dot(middle) < kMinInside * extent) {
      return WorldStatus::kDegenerate;
    }
  }
  return WorldStatus::kOk;
}

}  // namespace sopt
