#include "models/space/world3.h"

#include <cmath>

namespace sopt {
namespace {

double min_of(const V8f& v) noexcept {
  float low = v[0];
  for (int i = 1; i < kLanesFloat; ++i) low = v[i] < low ? v[i] : low;
  return static_cast<double>(low);
}

}  // namespace

World3::World3(Arena& arena, const World3Capacity& capacity) noexcept
    : obstacles_(arena, capacity.max_obstacles),
      boxes_(arena, capacity.max_obstacles),
      hulls_(arena, capacity.max_hulls),
      broad_phase_(arena, capacity.max_obstacles),
      lanes_(arena, capacity.max_obstacles, capacity.max_hulls) {}

std::size_t World3::required_bytes(const World3Capacity& capacity) noexcept {
  Arena arena = Arena::measuring();
  const World3 world(arena, capacity);
  return arena.used_B();
}

void World3::reset() noexcept {
  obstacles_.clear();
  boxes_.clear();
  hulls_.clear();
  max_own_margin_m_ = kDefaultMargin;
  min_own_margin_m_ = kDefaultMargin;
  has_default_margin_ = false;
  build();
}

WorldStatus World3::try_add(const Sphere3& sphere, double margin_m) noexcept {
  return try_add_shape(sphere, margin_m);
}

WorldStatus World3::try_add(const Capsule3& capsule, double margin_m) noexcept {
  return try_add_shape(capsule, margin_m);
}

WorldStatus World3::try_add(const Box3& box, double margin_m) noexcept {
  return try_add_shape(box, margin_m);
}

WorldStatus World3::try_add(const Cylinder3& cylinder, double margin_m) noexcept {
  return try_add_shape(cylinder, margin_m);
}

WorldStatus World3::try_add(const Hull3& hull, double margin_m) noexcept {
  const WorldStatus room = check_room(margin_m);
  if (room != WorldStatus::kOk) return room;
  const int i_hull = hulls_.size();
  if (!hulls_.try_resize(i_hull + 1)) return WorldStatus::kTooManyVertices;
  Convex3 stored;
  const WorldStatus status = try_make_convex(hull, hulls_[i_hull], stored);
  if (status == WorldStatus::kOk) {
    add(stored, margin_m);
  } else {
    (void)hulls_.try_resize(i_hull);
  }
  return status;
}

template <class Shape>
WorldStatus World3::try_add_shape(const Shape& shape, double margin_m) noexcept {
  const WorldStatus room = check_room(margin_m);
  if (room != WorldStatus::kOk) return room;
  Convex3 stored;
  const WorldStatus status = try_make_convex(shape, stored);
  if (status == WorldStatus::kOk) add(stored, margin_m);
  return status;
}

WorldStatus World3::check_room(double margin_m) const noexcept {
  if (!std::isfinite(margin_m)) return WorldStatus::kNotFinite;
  if (margin_m < 0.0 && margin_m != kDefaultMargin) return WorldStatus::kBadSize;
  return obstacles_.size() < obstacles_.capacity() ? WorldStatus::kOk
                                                   : WorldStatus::kTooManyObstacles;
}

void World3::add(const Convex3& shape, double margin_m) noexcept {
  if (!obstacles_.try_push_back({shape, margin_m})) return;  // cannot happen: check_room
  (void)boxes_.try_push_back(bounding_box(shape));
  if (margin_m < 0.0) {
    has_default_margin_ = true;
    return;
  }
  max_own_margin_m_ = std::max(max_own_margin_m_, margin_m);
  min_own_margin_m_ = min_own_margin_m_ < 0.0 ? margin_m : std::min(min_own_margin_m_, margin_m);
}

void World3::build() noexcept {
  (void)broad_phase_.build(boxes_.span());
  lanes_.clear();
  for (int i = 0; i < num_obstacles(); ++i)
    lanes_.add(obstacle(i), boxes_[i], obstacle_margin_m(i));
}

NearestObstacle World3::nearest(const Capsule3& body, double limit_m) const SOPT_RT {
  NearestObstacle best{limit_m, kNoObstacle};
  (void)for_each_near(grown(bounding_box(body), std::max(limit_m, 0.0)), [&](int i) {
    Clearance3 c;
    if (compute_clearance_within(obstacle(i), body, best.distance_m, c) &&
        c.distance_m < best.distance_m) {
      best = {c.distance_m, i};
    }
    return true;
  });
  return best;
}

bool World3::is_clear(const Capsule3& body, const ClearanceRule& rule) const SOPT_RT {
  if (!std::isfinite((body.p0 + body.p1).sum() + body.radius_m)) return false;
  return for_each_near(grown(bounding_box(body), max_required_m(rule)),
                       [&](int i) { return !is_within(obstacle(i), body, required_m(i, rule)); });
}

Aabb3 World3::area_of(const PaddedLanes& lanes, const ClearanceRule& rule) const SOPT_RT {
  const SphereLanes& s = lanes.spheres;
  const Vec3 lower(min_of(s.x), min_of(s.y), min_of(s.z));
  const Vec3 upper(-min_of(-s.x), -min_of(-s.y), -min_of(-s.z));
  return grown({lower, upper}, max_required_m(rule) - min_of(-lanes.padded_radius_m));
}

unsigned World3::lanes_near(const SphereLanes& spheres, const ClearanceRule& rule) const SOPT_RT {
  const PaddedLanes lanes(spheres);
  const V8f infinity = splat8(std::numeric_limits<float>::infinity());
  if (lane_mask8(lanes.padded_radius_m < infinity) != kAllLanes) return kAllLanes;
  if (num_obstacles() <= kMaxScan) return lanes_.lanes_near(lanes, rule);
  unsigned near = 0;
  (void)for_each_near(lanes, kAllLanes, rule, [&](int /*i*/, unsigned found) {
    near |= found;
    return near != kAllLanes;
  });
  return near;
}

}  // namespace sopt
