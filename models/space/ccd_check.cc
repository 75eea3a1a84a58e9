#include "models/space/ccd_check.h"

#include <ccd/ccd.h>

namespace sopt {
namespace {

static_assert(sizeof(ccd_real_t) == sizeof(double), "libccd built for double");

struct Inflated {
  const Convex3& shape;
  Vec3 offset;         // of the center from the other shape's: keeps coordinates small
  double radius_m;     // of shape and inflation
  double reach = 0.0;  // last direction . farthest point
};

void find_support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) noexcept {
  // libccd passes on, as const, the pointer it was given.
  auto& inflated = *static_cast<Inflated*>(const_cast<void*>(object));
  const Vec3 d(direction->v[0], direction->v[1], direction->v[2]);
  const double length = d.norm();
  Vec3 farthest = inflated.offset + core_support(inflated.shape, d);
  if (length > 0.0) farthest += inflated.radius_m / length * d;
  inflated.reach = d.dot(farthest);
  ccdVec3Set(out, farthest.x(), farthest.y(), farthest.z());
}

// Libccd begins with the points of the two that face each other.
void find_first_direction(const void* first, const void* second, ccd_vec3_t* out) noexcept {
  const Vec3 d =
      static_cast<const Inflated*>(second)->offset - static_cast<const Inflated*>(first)->offset;
  ccdVec3Set(out, d.x(), d.y(), d.z());
}

}  // namespace

bool may_overlap(const Convex3& a, const Convex3& b, double inflate_m) SOPT_RT {
  Inflated first{a, Vec3::Zero(), a.radius_m};
  Inflated second{b, b.center - a.center, b.radius_m + inflate_m + kCcdPad_m};
  ccd_t ccd;
  CCD_INIT(&ccd);
  ccd.first_dir = find_first_direction;
  ccd.support1 = find_support;
  ccd.support2 = find_support;
  ccd.max_iterations = kMaxCcdIterations;
  if (ccdGJKIntersect(&first, &second, &ccd) != 0) return true;
  return !(first.reach + second.reach < 0.0);  // the two were asked in opposite directions
}

bool may_overlap(const Convex3& a, const Capsule3& b, double inflate_m) SOPT_RT {
  return may_overlap(a, to_convex(b), inflate_m);
}

}  // namespace sopt
