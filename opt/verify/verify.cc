#include "opt/verify/verify.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "opt/verify/motion_boxes.h"

namespace sopt {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Closest approach of one straight motion to one obstacle, signed, without the robot's radius.
struct Approach {
  double distance_m = kInfinity;
  double share = 0.0;  // of the motion
};

double cross(const Vec2& a, const Vec2& b) noexcept { return a.x() * b.y() - a.y() * b.x(); }

Vec2 vertex(const ConvexView& o, int i) noexcept {
  const int wrapped = i == o.num_vertices ? 0 : i;
  return {o.x[wrapped], o.y[wrapped]};
}

// Share of [a, b] closest to `point`.
double nearest_share(const Vec2& a, const Vec2& b, const Vec2& point) noexcept {
  const Vec2 d = b - a;
  const double length2 = d.dot(d);
  if (length2 == 0.0) return 0.0;
  return std::min(1.0, std::max(0.0, d.dot(point - a) / length2));
}

void keep_nearer(double distance_m, double share, Approach& best) noexcept {
  if (distance_m < best.distance_m) best = {distance_m, share};
}

// Distance of the motion to the outline of the obstacle: to each vertex, and of its ends to each
// edge. Exact when the motion does not cross the outline.
Approach outline_distance(const ConvexView& o, const Vec2& p, const Vec2& q) noexcept {
  Approach best;
  for (int i = 0; i < o.num_vertices; ++i) {
    const Vec2 v = vertex(o, i);
    const double share = nearest_share(p, q, v);
    keep_nearer((p + share * (q - p) - v).norm(), share, best);
    if (o.num_vertices == 1) continue;
    const Vec2 w = vertex(o, i + 1);
    keep_nearer((v + nearest_share(v, w, p) * (w - v) - p).norm(), 0.0, best);
    keep_nearer((v + nearest_share(v, w, q) * (w - v) - q).norm(), 1.0, best);
  }
  return best;
}

// Depth of a point below the nearest edge line; negative inside the polygon.
double signed_point_distance(const ConvexView& o, const Vec2& point) noexcept {
  double worst = -kInfinity;
  for (int i = 0; i < o.num_vertices; ++i) {
    const Vec2 edge = vertex(o, i + 1) - vertex(o, i);
    worst = std::max(worst, -cross(edge, point - vertex(o, i)) / edge.norm());
  }
  return worst;
}

// The part of the motion inside the polygon [Cyrus, Beck 1978]; empty when from > to.
struct InsidePart {
  double from = 0.0;
  double to = 1.0;
};

InsidePart clip(const ConvexView& o, const Vec2& p, const Vec2& q) noexcept {
  InsidePart part;
  for (int i = 0; i < o.num_vertices; ++i) {
    const Vec2 edge = vertex(o, i + 1) - vertex(o, i);
    const double at_p = cross(edge, p - vertex(o, i));  // > 0: inside of this edge
    const double at_q = cross(edge, q - vertex(o, i));
    if (at_p < 0.0 && at_q < 0.0) return {1.0, 0.0};
    if (at_p < 0.0) part.from = std::max(part.from, at_p / (at_p - at_q));
    if (at_q < 0.0) part.to = std::min(part.to, at_p / (at_p - at_q));
  }
  return part;
}

// Deepest point of the part of the motion inside: the depth is convex along it.
Approach deepest_point(const ConvexView& o, const Vec2& p, const Vec2& q,
                       InsidePart part) noexcept {
  constexpr int kTernarySteps = 80;
  for (int i = 0; i < kTernarySteps; ++i) {
    const double third = (part.to - part.from) / 3.0;
    const double left = part.from + third;
    const double right = part.to - third;
    const bool go_left = signed_point_distance(o, p + left * (q - p)) <=
                         signed_point_distance(o, p + right * (q - p));
    (go_left ? part.to : part.from) = go_left ? right : left;
  }
  const double share = 0.5 * (part.from + part.to);
  return {signed_point_distance(o, p + share * (q - p)), share};
}

Approach closest_approach(const ConvexView& o, const Vec2& p, const Vec2& q) noexcept {
  Approach approach;
  const InsidePart inside = o.num_vertices >= 3 ? clip(o, p, q) : InsidePart{1.0, 0.0};
  approach = inside.from <= inside.to ? deepest_point(o, p, q, inside) : outline_distance(o, p, q);
  approach.distance_m -= o.radius_m;
  return approach;
}

Aabb2 box_of(const ConvexView& o) noexcept {
  Aabb2 box{vertex(o, 0), vertex(o, 0)};
  for (int i = 1; i < o.num_vertices; ++i) {
    box.lower = box.lower.cwiseMin(vertex(o, i));
    box.upper = box.upper.cwiseMax(vertex(o, i));
  }
  box.lower.array() -= o.radius_m;
  box.upper.array() += o.radius_m;
  return box;
}

double box_distance(const Aabb2& a, const Aabb2& b) noexcept {
  const double dx = std::max({a.lower.x() - b.upper.x(), b.lower.x() - a.upper.x(), 0.0});
  const double dy = std::max({a.lower.y() - b.upper.y(), b.lower.y() - a.upper.y(), 0.0});
  return std::sqrt(dx * dx + dy * dy);
}

// Collects the certificate and the earliest violation.
class Check {
 public:
  Check(const Point2& robot, const Trajectory<Point2>& trajectory,
        const VerifyProblem<Point2>& problem) noexcept
      : robot_(robot), trajectory_(trajectory), problem_(problem) {
    certificate_.min_clearance_m = kInfinity;
    certificate_.worst_limit_margin = 1.0;
    violation_.kind = ViolationKind::kNone;
  }

  // Each returns false when there is no point in looking further.
  [[nodiscard]] bool shape() noexcept {
    const int horizon = trajectory_.horizon();
    const bool fits = horizon >= 1 && trajectory_.inputs.size() == horizon;
    if (fits && trajectory_.dt_s > 0.0 && std::isfinite(trajectory_.dt_s)) return true;
    report(ViolationKind::kShape, 0, 0.0, trajectory_.dt_s);
    return false;
  }

  [[nodiscard]] bool finite() noexcept {
    for (int t = 0; t <= trajectory_.horizon(); ++t) {
      const bool input_ok = t == trajectory_.horizon() || trajectory_.inputs[t].allFinite();
      if (trajectory_.states[t].allFinite() && input_ok) continue;
      report(ViolationKind::kNotFinite, t, 0.0, 0.0);
      return false;
    }
    return true;
  }

  void ends() noexcept {
    const int horizon = trajectory_.horizon();
    const double start_error = (trajectory_.states[0] - problem_.start).norm();
    const double goal_error = (trajectory_.states[horizon] - problem_.goal).norm();
    certificate_.goal_error = goal_error;
    if (start_error != 0.0) report(ViolationKind::kStart, 0, 0.0, start_error);
    if (goal_error != 0.0) report(ViolationKind::kGoal, horizon - 1, 1.0, goal_error);
  }

  void motion() noexcept {
    const double dt_s = trajectory_.dt_s;
    for (int t = 0; t < trajectory_.horizon(); ++t) {
      const Vec2& u = trajectory_.inputs[t];
      const double defect = (trajectory_.states[t] + dt_s * u - trajectory_.states[t + 1]).norm();
      certificate_.dynamics_defect = std::max(certificate_.dynamics_defect, defect);
      if (!(defect <= kMaxDynamicsDefect)) report(ViolationKind::kDynamics, t, 1.0, defect);
      if (robot_.v_max_mps == kInfinity) continue;
      const double excess_mps = u.norm() - robot_.v_max_mps;
      certificate_.worst_limit_margin =
          std::min(certificate_.worst_limit_margin, -excess_mps / robot_.v_max_mps);
      if (!(excess_mps <= 0.0)) report(ViolationKind::kSpeed, t, 0.0, excess_mps);
    }
  }

  void clearance() noexcept {
    for (int t = 0; t < trajectory_.horizon(); ++t) bounds_clearance(t);
    const MotionBoxes boxes(trajectory_);
    for (int i = 0; i < problem_.world->num_obstacles(); ++i) obstacle_clearance(i, boxes);
  }

  [[nodiscard]] const Certificate& certificate() const noexcept { return certificate_; }
  [[nodiscard]] const Violation& violation() const noexcept { return violation_; }

 private:
  void bounds_clearance(int t) noexcept {
    const Aabb2& bounds = problem_.world->bounds();
    for (int end = 0; end < 2; ++end) {
      const Vec2& z = trajectory_.states[t + end];
      const double inside = std::min({z.x() - bounds.lower.x(), bounds.upper.x() - z.x(),
                                      z.y() - bounds.lower.y(), bounds.upper.y() - z.y()});
      note_clearance(t, end, inside - robot_.radius_m, kBoundsObstacle);
    }
  }

  void obstacle_clearance(int i_obstacle, const MotionBoxes& boxes) noexcept {
    const ConvexView obstacle = problem_.world->obstacle(i_obstacle);
    const Aabb2 obstacle_box = box_of(obstacle);
    boxes.for_each_run(
        [&](int first, const Aabb2& box) {
          return is_relevant(first, box_distance(box, obstacle_box));
        },
        [&](int first, int last) {
          for (int t = first; t < last; ++t)
            motion_clearance(t, i_obstacle, obstacle, obstacle_box);
        });
  }

  void motion_clearance(int t, int i_obstacle, const ConvexView& obstacle,
                        const Aabb2& obstacle_box) noexcept {
    const Vec2& p = trajectory_.states[t];
    const Vec2& q = trajectory_.states[t + 1];
    if (!is_relevant(t, box_distance({p.cwiseMin(q), p.cwiseMax(q)}, obstacle_box))) return;
    const Approach approach = closest_approach(obstacle, p, q);
    note_clearance(t, approach.share, approach.distance_m - robot_.radius_m, i_obstacle);
  }

  // Whether something at least `distance_m` away at step t or later can change the outcome.
  [[nodiscard]] bool is_relevant(int t, double distance_m) const noexcept {
    if (distance_m <= 0.0) return true;  // boxes overlap: that bounds nothing
    const double clearance_m = distance_m - robot_.radius_m;
    if (clearance_m < certificate_.min_clearance_m) return true;
    return clearance_m < problem_.min_clearance_m && t <= violation_.step;
  }

  void note_clearance(int t, double share, double clearance_m, int i_obstacle) noexcept {
    if (clearance_m < certificate_.min_clearance_m) {
      certificate_.min_clearance_m = clearance_m;
      certificate_.where_t_s = (t + share) * trajectory_.dt_s;
      certificate_.i_obstacle = i_obstacle;
    }
    if (!(clearance_m >= problem_.min_clearance_m)) {
      report(ViolationKind::kCollision, t, share, clearance_m, i_obstacle);
    }
  }

  void report(ViolationKind kind, int step, double share, double amount,
              int i_obstacle = kNoObstacle) noexcept {
    const double t_s = (step + share) * trajectory_.dt_s;
    const bool is_first = violation_.kind == ViolationKind::kNone || t_s < violation_.t_s;
    if (is_first) violation_ = {kind, step, t_s, 0, i_obstacle, amount, kNoLink, kNoJoint};
  }

  const Point2& robot_;
  const Trajectory<Point2>& trajectory_;
  const VerifyProblem<Point2>& problem_;
  Certificate certificate_;
  Violation violation_;
};

}  // namespace

Violation find_violation(const Point2& robot, const Trajectory<Point2>& trajectory,
                         const VerifyProblem<Point2>& problem, Certificate& certificate) SOPT_RT {
  Check check(robot, trajectory, problem);
  if (check.shape() && check.finite()) {
    check.ends();
    check.motion();
    check.clearance();
  }
  certificate = check.certificate();
  return check.violation();
}

}  // namespace sopt
