// The known world of a robot in space: convex obstacles, immutable while a request is planned.
// Filled at setup or between requests (`reset`, `try_add`, `build`), no heap. Unbounded: the
// robot's joint limits bound its reach. Bodies are capsules that bring their own radius.
#pragma once

#include <algorithm>

#include "alloc/fixed_vector.h"
#include "models/broad_phase3.h"
#include "models/clearance3.h"
#include "models/margin.h"
#include "models/shape3.h"
#include "models/world_status.h"
#include "rt/annotations.h"

namespace sopt {

struct World3Capacity {
  int max_obstacles = 1024;
  int max_hulls = 128;  // among them
};

class World3 {
 public:
  World3(Arena& arena, const World3Capacity& capacity) noexcept;
  [[nodiscard]] static std::size_t required_bytes(const World3Capacity& capacity) noexcept;

  // Empties the world.
  void reset() noexcept;

  // Adds one obstacle; on a status other than kOk nothing was added. `margin_m` replaces the
  // request's margin for this obstacle; kDefaultMargin keeps it.
  [[nodiscard]] WorldStatus try_add(const Sphere3& sphere,
                                    double margin_m = kDefaultMargin) noexcept;
  [[nodiscard]] WorldStatus try_add(const Capsule3& capsule,
                                    double margin_m = kDefaultMargin) noexcept;
  [[nodiscard]] WorldStatus try_add(const Box3& box, double margin_m = kDefaultMargin) noexcept;
  [[nodiscard]] WorldStatus try_add(const Cylinder3& cylinder,
                                    double margin_m = kDefaultMargin) noexcept;
  [[nodiscard]] WorldStatus try_add(const Hull3& hull, double margin_m = kDefaultMargin) noexcept;

  // Builds the broad phase; call once after the last obstacle and before the first query.
  void build() noexcept;

  [[nodiscard]] int num_obstacles() const SOPT_RT { return obstacles_.size(); }
  [[nodiscard]] const Convex3& obstacle(int i) const SOPT_RT { return obstacles_[i].shape; }
  // Own margin of obstacle i, or kDefaultMargin.
  [[nodiscard]] double obstacle_margin_m(int i) const SOPT_RT { return obstacles_[i].margin_m; }
  // Box around obstacle i, radius included.
  [[nodiscard]] const Aabb3& obstacle_box(int i) const SOPT_RT { return boxes_[i]; }

  // Clearance wanted from obstacle i under `rule`.
  [[nodiscard]] double required_m(int i, const ClearanceRule& rule) const SOPT_RT {
    return rule.required_m(obstacles_[i].margin_m);
  }
  // The largest clearance any obstacle asks for under `rule`.
  [[nodiscard]] double max_required_m(const ClearanceRule& rule) const SOPT_RT {
    return std::max(rule.required_m(kDefaultMargin), rule.required_m(max_own_margin_m_));
  }

  // The nearest obstacle within `limit_m` of the body; kNoObstacle and limit_m if there is none.
  [[nodiscard]] NearestObstacle nearest(const Capsule3& body, double limit_m) const SOPT_RT;

  // True when the body keeps the clearance that `rule` asks for from every obstacle. Exact.
  [[nodiscard]] bool is_clear(const Capsule3& body, const ClearanceRule& rule) const SOPT_RT;

  // See BroadPhase3::for_each_near; visits obstacle indices.
  template <class Visit>
  bool for_each_near(const Aabb3& area, Visit&& visit) const {
    return broad_phase_.for_each_near(area, static_cast<Visit&&>(visit));
  }

 private:
  struct Obstacle {
    Convex3 shape;
    double margin_m = kDefaultMargin;
  };

  template <class Shape>
  [[nodiscard]] WorldStatus try_add_shape(const Shape& shape, double margin_m) noexcept;
  [[nodiscard]] WorldStatus check_room(double margin_m) const noexcept;
  void add(const Convex3& shape, double margin_m) noexcept;

  FixedVector<Obstacle> obstacles_;
  FixedVector<Aabb3> boxes_;
  FixedVector<HullData> hulls_;
  BroadPhase3 broad_phase_;
  double max_own_margin_m_ = kDefaultMargin;
};

}  // namespace sopt
