#include "tests/support/arm_plan_oracle.h"

#include <algorithm>
#include <cmath>

namespace sopt::oracle {
namespace {

double distance_to_segment(const Vec3& z, const Vec3& p, const Vec3& q) {
  const Vec3 d = q - p;
  const double length2 = d.squaredNorm();
  const double s = length2 > 0.0 ? std::clamp((z - p).dot(d) / length2, 0.0, 1.0) : 0.0;
  return (z - p - s * d).norm();
}

// The common perpendicular if it meets both segments, else one of them ends there.
double distance_of_segments(const Vec3& p0, const Vec3& p1, const Vec3& q0, const Vec3& q1) {
  double least = std::min({distance_to_segment(p0, q0, q1), distance_to_segment(p1, q0, q1),
                           distance_to_segment(q0, p0, p1), distance_to_segment(q1, p0, p1)});
  const Vec3 u = p1 - p0;
  const Vec3 v = q1 - q0;
  const Vec3 normal = u.cross(v);
  if (normal.norm() < 1e-9 * u.norm() * v.norm()) return least;
  const double s = (q0 - p0).cross(v).dot(normal) / normal.squaredNorm();
  const double t = (q0 - p0).cross(u).dot(normal) / normal.squaredNorm();
  if (s >= 0.0 && s <= 1.0 && t >= 0.0 && t <= 1.0) {
    least = std::min(least, std::abs((q0 - p0).dot(normal.normalized())));
  }
  return least;
}

double distance_to_triangle(const Vec3& z, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  const bool is_above = normal.norm() > 1e-12 && (b - a).cross(z - a).dot(normal) >= 0.0 &&
                        (c - b).cross(z - b).dot(normal) >= 0.0 &&
                        (a - c).cross(z - c).dot(normal) >= 0.0;
  if (is_above) return std::abs((z - a).dot(normal.normalized()));
  return std::min(
      {distance_to_segment(z, a, b), distance_to_segment(z, b, c), distance_to_segment(z, c, a)});
}

// Three vertices whose plane has all others on one side.
struct Facet {
  Vec3 a, b, c;
  Vec3 outward;
};

// All of them: they cover the surface, some parts several times.
std::vector<Facet> facets_of(const Convex3& shape) {
  std::vector<Facet> facets;
  if (shape.kind != CoreKind::kHull) return facets;
  const HullData& hull = *shape.hull;
  std::vector<Vec3> v;
  for (int i = 0; i < hull.num_vertices; ++i) v.emplace_back(hull.x[i], hull.y[i], hull.z[i]);
  for (std::size_t i = 0; i < v.size(); ++i) {
    for (std::size_t j = i + 1; j < v.size(); ++j) {
      for (std::size_t k = j + 1; k < v.size(); ++k) {
        const Vec3 cross = (v[j] - v[i]).cross(v[k] - v[i]);
        if (cross.norm() < 1e-12) continue;
        const Vec3 normal = cross.normalized();
        double low = 0.0;
        double high = 0.0;
        for (const Vec3& w : v) {
          low = std::min(low, (w - v[i]).dot(normal));
          high = std::max(high, (w - v[i]).dot(normal));
        }
        if (high < 1e-12) facets.push_back({v[i], v[j], v[k], normal});
        if (low > -1e-12) facets.push_back({v[i], v[j], v[k], -normal});
      }
    }
  }
  return facets;
}

double distance_to_hull(const std::vector<Facet>& facets, const Vec3& z) {
  double least = std::numeric_limits<double>::infinity();
  bool is_inside = true;
  for (const Facet& f : facets) {
    if ((z - f.a).dot(f.outward) < 0.0) continue;  // its other side is nearer to another one
    is_inside = false;
    least = std::min(least, distance_to_triangle(z, f.a, f.b, f.c));
  }
  return is_inside ? 0.0 : least;
}

// Of a point to the core, 0 inside.
double distance_to_core(const Convex3& shape, const std::vector<Facet>& facets, const Vec3& z) {
  const Vec3 local = shape.axes.transpose() * (z - shape.center);
  switch (shape.kind) {
    case CoreKind::kPoint:
      return local.norm();
    case CoreKind::kSegment:
      return distance_to_segment(local, -shape.half_m.z() * Vec3::UnitZ(),
                                 shape.half_m.z() * Vec3::UnitZ());
    case CoreKind::kBox:
      return (local.cwiseAbs() - shape.half_m).cwiseMax(0.0).norm();
    case CoreKind::kCylinder:
      return std::hypot(std::max(local.head<2>().norm() - shape.half_m.x(), 0.0),
                        std::max(std::abs(local.z()) - shape.half_m.z(), 0.0));
    case CoreKind::kHull:
      break;
  }
  return distance_to_hull(facets, z - shape.center);
}

// Of a ball around everything.
double reach_of(const Convex3& shape) {
  if (shape.kind != CoreKind::kHull) return shape.half_m.norm() + shape.radius_m;
  double reach = 0.0;
  for (int i = 0; i < shape.hull->num_vertices; ++i) {
    reach = std::max(reach, Vec3(shape.hull->x[i], shape.hull->y[i], shape.hull->z[i]).norm());
  }
  return reach + shape.radius_m;
}

// The lowest value of a function in [low, high], where it has one minimum.
template <class F>
double search_minimum(double low, double high, int rounds, F&& f) {
  double least = std::min(f(low), f(high));
  for (int i = 0; i < rounds; ++i) {
    const double third = (high - low) / 3.0;
    const double left = f(low + third);
    const double right = f(high - third);
    least = std::min({least, left, right});
    (left < right ? high : low) = left < right ? high - third : low + third;
  }
  return least;
}

// Positions at time s into a step.
template <int N>
typename Arm<N>::Config parabola(const typename Arm<N>::State& z, const typename Arm<N>::Input& u,
                                 double s) {
  return z.template head<N>() + s * z.template tail<N>() + 0.5 * s * s * u;
}

// Outside the limits somewhere within a step.
template <int N>
double step_excess(const Arm<N>& arm, const typename Arm<N>::State& z,
                   const typename Arm<N>::Input& u, double dt_s) {
  double excess = (u.cwiseAbs() - arm.a_max()).maxCoeff();
  for (int j = 0; j < N; ++j) {
    const double w = z[N + j];
    const double turn_s = u[j] == 0.0 ? 0.0 : std::clamp(-w / u[j], 0.0, dt_s);
    for (const double s : {0.0, turn_s, dt_s}) {
      const double q = z[j] + s * w + 0.5 * s * s * u[j];
      excess = std::max({excess, q - arm.upper()[j], arm.lower()[j] - q,
                         std::abs(w + s * u[j]) - arm.v_max()[j]});
    }
  }
  return excess;
}

template <int N>
bool is_whole(const Trajectory<Arm<N>>& plan) {
  if (plan.horizon() < 1 || plan.inputs.size() != plan.horizon()) return false;
  for (const auto& z : plan.states) {
    if (!z.allFinite()) return false;
  }
  for (const auto& u : plan.inputs) {
    if (!u.allFinite()) return false;
  }
  return plan.dt_s > 0.0 && std::isfinite(plan.dt_s);
}

// The least value over the motion.
template <int N, class F>
double least_over(const Trajectory<Arm<N>>& plan, int samples, F&& value) {
  const auto at = [&](double t) {
    const int step = std::clamp(static_cast<int>(t), 0, plan.horizon() - 1);
    return value(parabola<N>(plan.states[step], plan.inputs[step], (t - step) * plan.dt_s));
  };
  double least = std::numeric_limits<double>::infinity();
  double where = 0.0;
  for (int i = 0; i <= plan.horizon() * samples; ++i) {
    const double t = static_cast<double>(i) / samples;
    const double found = at(t);
    if (found < least) where = t;
    least = std::min(least, found);
  }
  const double apart = 1.0 / samples;
  return std::min(least, search_minimum(std::max(where - apart, 0.0),
                                        std::min(where + apart, 1.0 * plan.horizon()), 20, at));
}

}  // namespace

double distance_between(const Capsule3& a, const Capsule3& b) {
  return distance_of_segments(a.p0, a.p1, b.p0, b.p1) - a.radius_m - b.radius_m;
}

double distance_between(const Convex3& obstacle, const Capsule3& body) {
  if (obstacle.is_round()) {
    const Vec3 half = obstacle.half_m.z() * obstacle.axes.col(2);
    const Vec3 middle = obstacle.center;
    return distance_between({middle - half, middle + half, obstacle.radius_m}, body);
  }
  const std::vector<Facet> facets = facets_of(obstacle);
  const double core_m = search_minimum(0.0, 1.0, 40, [&](double s) {
    return distance_to_core(obstacle, facets, body.p0 + s * (body.p1 - body.p0));
  });
  return core_m - obstacle.radius_m - body.radius_m;
}

template <int N>
PlainArm<N>::PlainArm(const Arm<N>& arm) {
  description_.X_WB = arm.kinematics().X_WB;
  for (int j = 0; j < N; ++j) description_.joints[static_cast<std::size_t>(j)] = arm.joint(j);
  const Config zero = Config::Zero();
  ArmPose<N> pose;
  arm.forward(zero, pose);
  const std::vector<Mat4> frames = link_frames<N>(description_, zero);
  for (int i = 0; i < arm.num_capsules(); ++i) {
    const Capsule3 capsule = arm.capsule_W(pose, i);
    const int i_link = arm.capsule_link(i);
    const Mat4 back = frames[static_cast<std::size_t>(i_link)].inverse();
    capsules_.push_back(
        {i_link, transform(back, capsule.p0), transform(back, capsule.p1), capsule.radius_m});
  }
  for (const auto& pair : arm.self_collision_pairs()) {
    const ArmBody& a = arm.body(pair.i_body_a);
    const ArmBody& b = arm.body(pair.i_body_b);
    for (int i = a.first; i < a.last; ++i) {
      for (int k = b.first; k < b.last; ++k) pairs_.emplace_back(i, k);
    }
  }
}

template <int N>
std::vector<Capsule3> PlainArm<N>::capsules_at(const Config& q) const {
  const std::vector<Mat4> frames = link_frames<N>(description_, q);
  std::vector<Capsule3> capsules;
  for (const LinkCapsule& c : capsules_) {
    const Mat4& frame = frames[static_cast<std::size_t>(c.i_link)];
    capsules.push_back({transform(frame, c.p0), transform(frame, c.p1), c.radius_m});
  }
  return capsules;
}

template <int N>
double PlainArm<N>::clearance_m(const World3& world, const Config& q) const {
  const std::vector<Capsule3> capsules = capsules_at(q);
  double least_m = std::numeric_limits<double>::infinity();
  for (int i = 0; i < world.num_obstacles(); ++i) {
    const Convex3& obstacle = world.obstacle(i);
    const double reach_m = reach_of(obstacle);
    for (const Capsule3& c : capsules) {
      const double apart_m = distance_to_segment(obstacle.center, c.p0, c.p1);
      if (apart_m - reach_m - c.radius_m > least_m) continue;
      least_m = std::min(least_m, distance_between(obstacle, c));
    }
  }
  return least_m;
}

template <int N>
double PlainArm<N>::self_clearance_m(const Config& q) const {
  const std::vector<Capsule3> capsules = capsules_at(q);
  double least_m = std::numeric_limits<double>::infinity();
  for (const auto& [i, k] : pairs_) {
    least_m = std::min(least_m, distance_between(capsules[i], capsules[k]));
  }
  return least_m;
}

template <int N>
PlanFacts examine_plan(const Arm<N>& arm, const World3& world, const Trajectory<Arm<N>>& plan,
                       const typename Arm<N>::Config& start, const typename Arm<N>::Config& goal,
                       int samples) {
  PlanFacts facts;
  facts.is_whole = is_whole(plan);
  if (!facts.is_whole) return facts;
  const PlainArm<N> plain(arm);
  const auto& last = plan.states[plan.horizon()];
  facts.starts = plan.states[0].template head<N>() == start;
  facts.end_speed =
      std::max(plan.states[0].template tail<N>().norm(), last.template tail<N>().norm());
  for (int j = 0; j < N; ++j) {
    const double off = last[j] - goal[j];
    const double turn = 2.0 * std::numbers::pi;
    const bool is_endless = arm.joint(j).kind == JointKind::kContinuous;
    facts.goal_error =
        std::max(facts.goal_error, std::abs(is_endless ? std::remainder(off, turn) : off));
  }
  for (int t = 0; t < plan.horizon(); ++t) {
    const auto& z = plan.states[t];
    const auto& next = plan.states[t + 1];
    const auto& u = plan.inputs[t];
    const auto end = parabola<N>(z, u, plan.dt_s);
    facts.defect =
        std::max({facts.defect, (end - next.template head<N>()).norm(),
                  (z.template tail<N>() + plan.dt_s * u - next.template tail<N>()).norm()});
    facts.limit_excess = std::max(facts.limit_excess, step_excess(arm, z, u, plan.dt_s));
    facts.length += weighted_length<N>(arm, (next - z).template head<N>());
  }
  facts.clearance_m =
      least_over<N>(plan, samples, [&](const auto& q) { return plain.clearance_m(world, q); });
  facts.self_clearance_m =
      least_over<N>(plan, samples, [&](const auto& q) { return plain.self_clearance_m(q); });
  return facts;
}

const char* find_fault(const PlanFacts& facts, double min_clearance_m) {
  constexpr double kTolerance = 1e-9;
  if (!facts.is_whole) return "is no trajectory";
  if (!facts.starts) return "begins elsewhere";
  if (!(facts.goal_error <= kTolerance)) return "ends elsewhere";
  if (facts.end_speed != 0.0) return "is not at rest at its ends";
  if (!(facts.defect <= kTolerance)) return "breaks its dynamics";
  if (!(facts.limit_excess <= kTolerance)) return "breaks a limit";
  if (!(facts.clearance_m >= min_clearance_m - kTolerance)) return "comes too close";
  return facts.self_clearance_m >= -kTolerance ? "" : "hits itself";
}

#define SOPT_INSTANTIATE(N)                                                                \
  template class PlainArm<N>;                                                              \
  template PlanFacts examine_plan(const Arm<N>&, const World3&, const Trajectory<Arm<N>>&, \
                                  const Arm<N>::Config&, const Arm<N>::Config&, int)
SOPT_INSTANTIATE(4);
SOPT_INSTANTIATE(5);
SOPT_INSTANTIATE(6);
SOPT_INSTANTIATE(7);
SOPT_INSTANTIATE(8);
#undef SOPT_INSTANTIATE

}  // namespace sopt::oracle
