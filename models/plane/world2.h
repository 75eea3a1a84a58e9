// The known world of a planar robot: rectangular bounds and convex obstacles, immutable while a
// request is planned. Filled at setup or between requests (`reset`, `try_add`, `build`), no heap.
// All distances are those of a point or segment; the robot's radius is added by the caller. Bounds
// count as walls: leaving them is a penetration.
#pragma once

#include <span>

#include "alloc/fixed_vector.h"
#include "models/config.h"
#include "models/margin.h"
#include "models/plane/broad_phase2.h"
#include "models/plane/clearance2.h"
#include "models/plane/convex2.h"
#include "models/world_status.h"
#include "rt/annotations.h"

namespace sopt {

class World2 {
 public:
  World2(Arena& arena, const WorldCapacity& capacity) noexcept;
  [[nodiscard]] static std::size_t required_bytes(const WorldCapacity& capacity) noexcept;

  // Empties the world and sets its bounds.
  [[nodiscard]] WorldStatus reset(const Aabb2& bounds) noexcept;

  // Adds one obstacle; on a status other than kOk nothing was added. `margin_m` replaces the
  // request's margin for this obstacle; kDefaultMargin keeps it.
  [[nodiscard]] WorldStatus try_add(const Disc& disc, double margin_m = kDefaultMargin) noexcept;
  [[nodiscard]] WorldStatus try_add(const Box2& box, double margin_m = kDefaultMargin) noexcept;
  [[nodiscard]] WorldStatus try_add(const Polygon2& polygon,
                                    double margin_m = kDefaultMargin) noexcept;

  // Builds the broad phase; call once after the last obstacle and before the first query.
  void build() noexcept;

  [[nodiscard]] int num_obstacles() const SOPT_RT { return obstacles_.size(); }
  [[nodiscard]] const Aabb2& bounds() const SOPT_RT { return bounds_; }
  [[nodiscard]] ConvexView obstacle(int i) const SOPT_RT;
  // Own margin of obstacle i, or kDefaultMargin.
  [[nodiscard]] double obstacle_margin_m(int i) const SOPT_RT { return obstacles_[i].margin_m; }
  // Box around obstacle i, radius included.
  [[nodiscard]] const Aabb2& obstacle_box(int i) const SOPT_RT { return boxes_[i]; }

  // Clearance wanted from obstacle i (kBoundsObstacle: from the bounds) under `rule`.
  [[nodiscard]] double required_m(int i, const ClearanceRule& rule) const SOPT_RT {
    return rule.required_m(i == kBoundsObstacle ? kDefaultMargin : obstacles_[i].margin_m);
  }
  // The largest clearance any obstacle asks for under `rule`.
  [[nodiscard]] double max_required_m(const ClearanceRule& rule) const SOPT_RT {
    return std::max(rule.required_m(kDefaultMargin), rule.required_m(max_own_margin_m_));
  }

  // Signed distance of segment [p, q] to the bounds: positive inside.
  [[nodiscard]] double bounds_distance(const Vec2& p, const Vec2& q) const SOPT_RT;

  // The nearest obstacle or bound within `limit_m` of segment [p, q]; kNoObstacle and limit_m if
  // there is none.
  [[nodiscard]] NearestObstacle nearest(const Vec2& p, const Vec2& q, double limit_m) const SOPT_RT;

  // True when a disc of `radius_m` that moves from p to q keeps the clearance that `rule` asks for
  // from every obstacle and from the bounds. Exact. False for a disc or motion that is not finite.
  [[nodiscard]] bool is_clear(const Vec2& p, const Vec2& q, double radius_m,
                              const ClearanceRule& rule) const SOPT_RT;

  // See BroadPhase2::for_each_near; visits obstacle indices.
  template <class Visit>
  bool for_each_near(const Vec2& p, const Vec2& q, double radius_m, Visit&& visit) const {
    return broad_phase_.for_each_near(p, q, radius_m, static_cast<Visit&&>(visit));
  }

 private:
  struct Obstacle {
    int first_vertex = 0;  // in the vertex arrays
    int num_vertices = 0;
    int num_padded = 0;
    double radius_m = 0.0;
    double margin_m = kDefaultMargin;
  };

  [[nodiscard]] WorldStatus try_add_core(std::span<const Vec2> vertices, double radius_m,
                                         double margin_m) noexcept;

  Aabb2 bounds_;
  FixedVector<Obstacle> obstacles_;
  FixedVector<Aabb2> boxes_;
  // Per vertex, see ConvexView.
  FixedVector<double> x_, y_, edge_x_, edge_y_, inv_edge2_, normal_x_, normal_y_, offset_;
  BroadPhase2 broad_phase_;
  double max_own_margin_m_ = kDefaultMargin;
  bool is_reset_ = false;
};

}  // namespace sopt
