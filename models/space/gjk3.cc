#include "models/space/gjk3.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace sopt {
namespace {

constexpr double kRelativeGap = 1e-14;
constexpr double kProven_m = 1e-10;
constexpr double kNearlyTouching_m = 1e-6;
constexpr double kRelativeBound = 1e-10;
constexpr double kStalledGap = 1e-12;
constexpr int kMaxStalls = 8;
constexpr double kFlat = 1e-14;  // volume of a tetrahedron relative to its edges: no inside

// A point w = b - a of the Minkowski difference and the points it came from, each relative to its
// shape's center.
struct Vertex {
  Vec3 w, a, b;
};

// Part of a simplex: its vertices that matter, their weights, and the point nearest to the origin.
struct Nearest {
  int index[3] = {0, 0, 0};
  double weight[3] = {1.0, 0.0, 0.0};
  int size = 1;
  Vec3 v = Vec3::Zero();
  double v2 = std::numeric_limits<double>::infinity();
};

Nearest nearest_on_edge(const Vertex* s, int i, int j) noexcept {
  const Vec3 edge = s[j].w - s[i].w;
  const double length2 = edge.squaredNorm();
  const double t = -s[i].w.dot(edge);
  Nearest n;
  n.index[0] = i;
  if (t <= 0.0) {
    n.v = s[i].w;
  } else if (t >= length2) {
    n.index[0] = j;
    n.v = s[j].w;
  } else {
    n.index[1] = j;
    n.weight[1] = t / length2;
    n.weight[0] = 1.0 - n.weight[1];
    n.size = 2;
    n.v = s[i].w + n.weight[1] * edge;
  }
  n.v2 = n.v.squaredNorm();
  return n;
}

void keep_nearer(const Nearest& candidate, Nearest& best) noexcept {
  if (candidate.v2 < best.v2) best = candidate;
}

// From the two shorter edges: of a sliver, the cross of others is rounding noise.
Vec3 normal_of(const Vec3& i, const Vec3& j, const Vec3& k) noexcept {
  const Vec3 ij = j - i;
  const Vec3 jk = k - j;
  const Vec3 ki = i - k;
  const double ij2 = ij.squaredNorm();
  const double jk2 = jk.squaredNorm();
  const double ki2 = ki.squaredNorm();
  if (ij2 >= jk2 && ij2 >= ki2) return jk.cross(ki);
  return jk2 >= ki2 ? ki.cross(ij) : ij.cross(jk);
}

Nearest nearest_on_triangle(const Vertex* s, int i, int j, int k) noexcept {
  const Vec3 normal = normal_of(s[i].w, s[j].w, s[k].w);
  const double normal2 = normal.squaredNorm();
  Nearest n;
  double area[3] = {0.0, 0.0, 0.0};
  if (normal2 > 0.0) {
    // Projected first, so that the areas are of the triangle's size, whatever its distance.
    n.v = (s[i].w.dot(normal) / normal2) * normal;
    const Vec3 to_i = s[i].w - n.v;
    const Vec3 to_j = s[j].w - n.v;
    const Vec3 to_k = s[k].w - n.v;
    area[0] = normal.dot(to_j.cross(to_k));
    area[1] = normal.dot(to_k.cross(to_i));
    area[2] = normal.dot(to_i.cross(to_j));
    if (area[0] > 0.0 && area[1] > 0.0 && area[2] > 0.0) {
      const double all = area[0] + area[1] + area[2];
      const int index[3] = {i, j, k};
      for (int m = 0; m < 3; ++m) {
        n.index[m] = index[m];
        n.weight[m] = area[m] / all;
      }
      n.size = 3;
      n.v2 = n.v.squaredNorm();
      return n;
    }
  }
  // On an edge that the projection lies beyond.
  if (area[0] <= 0.0) keep_nearer(nearest_on_edge(s, j, k), n);
  if (area[1] <= 0.0) keep_nearer(nearest_on_edge(s, k, i), n);
  if (area[2] <= 0.0) keep_nearer(nearest_on_edge(s, i, j), n);
  return n;
}

// The faces at the newest vertex, 3; the old face has the origin on its inner side by construction.
// v2 = 0 when the origin is inside.
Nearest nearest_on_tetrahedron(const Vertex* s) noexcept {
  constexpr int kFace[3][3] = {{3, 0, 1}, {3, 1, 2}, {3, 2, 0}};
  constexpr int kOpposite[3] = {2, 0, 1};
  Nearest best;
  bool is_inside = true;
  for (int f = 0; f < 3; ++f) {
    const Vec3& at = s[kFace[f][0]].w;
    const Vec3 ab = s[kFace[f][1]].w - at;
    const Vec3 ac = s[kFace[f][2]].w - at;
    const Vec3 ad = s[kOpposite[f]].w - at;
    const Vec3 normal = ab.cross(ac);
    const double to_opposite = normal.dot(ad);
    const double to_origin = -normal.dot(at);
    const bool is_flat =
        to_opposite * to_opposite <= kFlat * kFlat * normal.squaredNorm() * ad.squaredNorm();
    if (!is_flat && to_opposite * to_origin >= 0.0) continue;
    is_inside = false;
    keep_nearer(nearest_on_triangle(s, kFace[f][0], kFace[f][1], kFace[f][2]), best);
  }
  if (is_inside) best.v2 = 0.0;
  return best;
}

Nearest nearest_on_simplex(const Vertex* s, int size) noexcept {
  if (size == 2) return nearest_on_edge(s, 0, 1);
  if (size == 3) return nearest_on_triangle(s, 0, 1, 2);
  if (size == 4) return nearest_on_tetrahedron(s);
  Nearest n;
  n.v = s[0].w;
  n.v2 = n.v.squaredNorm();
  return n;
}

class Gjk {
 public:
  Gjk(const Convex3& a, const Convex3& b) noexcept : a_(a), b_(b), offset_(b.center - a.center) {}

  [[nodiscard]] GjkResult run(double limit_m, const Vec3& first) noexcept {
    Vec3 v = first.squaredNorm() > 0.0 ? first : offset_;
    if (v.squaredNorm() == 0.0) v = Vec3::UnitX();
    add(support(v));
    GjkResult result;
    Nearest best = nearest_on_simplex(simplex_, size_);
    reduce_to(best);
    double lower_m = -std::numeric_limits<double>::infinity();
    int num_stalls = 0;
    for (int i = 0; i < kMaxGjkIterations; ++i) {
      result.num_iterations = i + 1;
      if (best.v2 <= kTouching_m * kTouching_m) return result;
      const Vertex next = support(best.v);
      const double length = std::sqrt(best.v2);
      const double bound_m = best.v.dot(next.w) / length;
      if (bound_m > lower_m) {
        lower_m = bound_m;
        result.normal = best.v / length;
      }
      if (lower_m > limit_m) {
        result.status = GjkStatus::kBeyondLimit;
        result.distance_m = lower_m;
        return result;
      }
      if (length - bound_m <= kRelativeGap * length || is_known(next)) {
        return finish(result, best, bound_m, lower_m);
      }
      add(next);
      const Nearest nearer = nearest_on_simplex(simplex_, size_);
      // Flat directions of a curved core turn v long after its length has stopped changing.
      const bool stalls = nearer.v2 >= best.v2;
      if (stalls && (length - lower_m <= kStalledGap * length || ++num_stalls > kMaxStalls)) {
        --size_;
        return finish(result, best, bound_m, lower_m);
      }
      best = nearer;
      reduce_to(best);
    }
    return finish(result, best, lower_m, lower_m);
  }

 private:
  // The vertex of the difference farthest against v.
  [[nodiscard]] Vertex support(const Vec3& v) const noexcept {
    Vertex vertex;
    vertex.a = core_support(a_, v);
    vertex.b = core_support(b_, -v);
    vertex.w = offset_ + (vertex.b - vertex.a);
    return vertex;
  }

  void add(const Vertex& vertex) noexcept { simplex_[size_++] = vertex; }

  [[nodiscard]] bool is_known(const Vertex& vertex) const noexcept {
    return std::any_of(simplex_, simplex_ + size_,
                       [&](const Vertex& s) { return s.w == vertex.w; });
  }

  // Keeps the vertices that carry the nearest point.
  void reduce_to(Nearest& nearest) noexcept {
    if (nearest.v2 <= 0.0) return;
    Vertex kept[3];
    for (int i = 0; i < nearest.size; ++i) kept[i] = simplex_[nearest.index[i]];
    for (int i = 0; i < nearest.size; ++i) {
      simplex_[i] = kept[i];
      weight_[i] = nearest.weight[i];
    }
    size_ = nearest.size;
  }

  void set_points(GjkResult& result) const noexcept {
    result.on_a = a_.center;
    for (int i = 0; i < size_; ++i) result.on_a += weight_[i] * simplex_[i].a;
    result.on_b = result.on_a + result.distance_m * result.normal;
  }

  // Curved cores may prove less with the last v than with an earlier one, whose normal then stays,
  // or less than the length of v, which then is no distance.
  [[nodiscard]] GjkResult finish(GjkResult& result, const Nearest& best, double bound_m,
                                 double lower_m) const noexcept {
    const double length = std::sqrt(best.v2);
    if (lower_m <= kTouching_m && length <= kNearlyTouching_m) return result;
    const bool is_proven = length - lower_m <= kProven_m;
    result.status = is_proven ? GjkStatus::kApart : GjkStatus::kBounded;
    result.distance_m = is_proven ? length : lower_m;
    if (is_proven && bound_m >= lower_m - kRelativeBound * length) result.normal = best.v / length;
    set_points(result);
    return result;
  }

  const Convex3& a_;
  const Convex3& b_;
  Vec3 offset_;
  Vertex simplex_[4];
  double weight_[4] = {1.0, 0.0, 0.0, 0.0};
  int size_ = 0;
};

}  // namespace

GjkResult compute_core_distance(const Convex3& a, const Convex3& b, double limit_m,
                                const Vec3& first) SOPT_RT {
  return Gjk(a, b).run(limit_m, first);
}

}  // namespace sopt
