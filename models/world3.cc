#include "models/world3.h"

#include <cmath>

namespace sopt {
namespace {

Aabb3 grown(const Aabb3& box, double by_m) noexcept {
  return {box.lower - Vec3::Constant(by_m), box.upper + Vec3::Constant(by_m)};
}

}  // namespace

World3::World3(Arena& arena, const World3Capacity& capacity) noexcept
    : obstacles_(arena, capacity.max_obstacles),
      boxes_(arena, capacity.max_obstacles),
      hulls_(arena, capacity.max_hulls),
      broad_phase_(arena, capacity.max_obstacles) {}

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
  (void)broad_phase_.build({});
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
  max_own_margin_m_ = std::max(max_own_margin_m_, margin_m);
}

void World3::build() noexcept { (void)broad_phase_.build(boxes_.span()); }

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
  return for_each_near(grown(bounding_box(body), max_required_m(rule)),
                       [&](int i) { return !is_within(obstacle(i), body, required_m(i, rule)); });
}

}  // namespace sopt
