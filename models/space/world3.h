// The known world of a robot in space: convex obstacles, immutable while a request is planned.
// Filled at setup or between requests (`reset`, `try_add`, `build`), no heap. Unbounded: the
// robot's joint limits bound its reach. Bodies are capsules that bring their own radius.
#pragma once

#include <algorithm>

#include "alloc/fixed_vector.h"
#include "models/config.h"
#include "models/margin.h"
#include "models/space/broad_phase3.h"
#include "models/space/clearance3.h"
#include "models/space/shape3.h"
#include "models/space/sphere_lanes3.h"
#include "models/world_status.h"
#include "rt/annotations.h"

namespace sopt {

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

  // Builds the broad phase and what the lanes need; call once after the last obstacle and before
  // the first query.
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

  // The smallest one; of an empty world the rule's own.
  [[nodiscard]] double min_required_m(const ClearanceRule& rule) const SOPT_RT {
    const double least_m = rule.required_m(min_own_margin_m_);
    return has_default_margin_ ? std::min(rule.required_m(kDefaultMargin), least_m) : least_m;
  }

  // The nearest obstacle within `limit_m` of the body; kNoObstacle and limit_m if there is none.
  [[nodiscard]] NearestObstacle nearest(const Capsule3& body, double limit_m) const SOPT_RT;

  // True when the body keeps the clearance that `rule` asks for from every obstacle. Exact. False
  // for a body that is not finite.
  [[nodiscard]] bool is_clear(const Capsule3& body, const ClearanceRule& rule) const SOPT_RT;

  // Bit i is set when sphere i may be closer to an obstacle than `rule` asks for (sphere_lanes3.h).
  // If a sphere is not finite, all lanes are near.
  [[nodiscard]] unsigned lanes_near(const SphereLanes& spheres,
                                    const ClearanceRule& rule) const SOPT_RT;

  // Calls visit(i_obstacle, lanes) -> bool for every obstacle with the lanes, of those in
  // `among`, that are near it; stops when visit returns false. The spheres must be finite.
  template <class Visit>
  bool for_each_near(const PaddedLanes& lanes, unsigned among, const ClearanceRule& rule,
                     Visit&& visit) const {
    const auto look = [&](int i) {
      const unsigned near = lanes_.lanes_near(i, lanes, rule) & among;
      return near == 0 || visit(i, near);
    };
    if (num_obstacles() > kMaxScan) return for_each_near(area_of(lanes, rule), look);
    for (int i = 0; i < num_obstacles(); ++i) {
      if (!look(i)) return false;
    }
    return true;
  }
  // Of one obstacle.
  [[nodiscard]] NestedNear lanes_near(int i_obstacle, const NestedLanes& lanes,
                                      const ClearanceRule& rule) const SOPT_RT {
    return lanes_.lanes_near(i_obstacle, lanes, rule);
  }
  // No more than the distance of each sphere from the obstacle.
  [[nodiscard]] V8f distance_bounds(int i_obstacle, const PaddedLanes& lanes) const SOPT_RT {
    return lanes_.distance_bounds(i_obstacle, lanes);
  }

  // See BroadPhase3::for_each_near; visits obstacle indices.
  template <class Visit>
  bool for_each_near(const Aabb3& area, Visit&& visit) const {
    return broad_phase_.for_each_near(area, static_cast<Visit&&>(visit));
  }

 private:
  // Up to this many obstacles are all tested in lanes, more go through the broad phase.
  static constexpr int kMaxScan = 16;

  struct Obstacle {
    Convex3 shape;
    double margin_m = kDefaultMargin;
  };

  template <class Shape>
  [[nodiscard]] WorldStatus try_add_shape(const Shape& shape, double margin_m) noexcept;
  [[nodiscard]] WorldStatus check_room(double margin_m) const noexcept;
  void add(const Convex3& shape, double margin_m) noexcept;
  // Box around everything that can be near one of the spheres.
  [[nodiscard]] Aabb3 area_of(const PaddedLanes& lanes, const ClearanceRule& rule) const SOPT_RT;

  FixedVector<Obstacle> obstacles_;
  FixedVector<Aabb3> boxes_;
  FixedVector<HullData> hulls_;
  BroadPhase3 broad_phase_;
  ObstacleLanes3 lanes_;
  double max_own_margin_m_ = kDefaultMargin;
  double min_own_margin_m_ = kDefaultMargin;  // of those that have one; kDefaultMargin: none has
  bool has_default_margin_ = false;
};

}  // namespace sopt
