// Random references for, and what docs/convergence.md claims of them, computed from the raw shapes
// and the split points alone: planes that separate an edge from an obstacle, optimality of a whole
// trajectory within the convex feasible set around itself, and the exact contraction of alternating
// windows without obstacles. Dense and slow, for tests. Units m; f = sum |z(t+1) - z(t)|^2 / ds.
#pragma once

#include <Eigen/Dense>
#include <span>
#include <string>
#include <vector>

#include "models/margin.h"
#include "models/plane/point2.h"
#include "tests/support/oracle2.h"

namespace sopt::oracle {

// --- what the optimiser starts from

struct ClearReference {
  Scene scene;
  Point2 robot;
  MarginProfile profile;
  double ds_m = 0.1;
  std::vector<Vec2> states;  // keep the profile

  [[nodiscard]] int horizon() const { return static_cast<int>(states.size()) - 1; }
};

// Up to 30 obstacles in 10 m x 10 m that the states keep clear of, many by next to nothing, some
// along a wall; straight pieces or noise; ends with or without relaxed rules.
[[nodiscard]] ClearReference random_clear_reference(Random& random);
[[nodiscard]] std::string to_text(const ClearReference& c);

// --- energy and planes

// sum |v(t+1) - v(t)|^2 of v = a - b: the square of the energy norm when both agree at the ends.
[[nodiscard]] double energy_distance2(std::span<const Vec2> a, std::span<const Vec2> b);

// Cost of the straight line at uniform speed between the ends: no trajectory costs less.
[[nodiscard]] double line_cost(std::span<const Vec2> states, double ds_m);

// Largest n . y over the outline.
[[nodiscard]] double support_of(const Outline& outline, const Vec2& n);

struct Plane {
  Vec2 normal = Vec2::UnitX();
  double offset = 0.0;      // the obstacle lies in normal . y <= offset
  double distance_m = 0.0;  // of the segment
};
// From the closest points of [p, q] and the outline, whose core must be apart from it.
[[nodiscard]] Plane separating_plane(const Outline& outline, const Vec2& p, const Vec2& q);

// --- optimality of a trajectory within the convex feasible set around it

struct Optimality {
  double cost_gap = 0.0;    // f is at most this far above its minimum over the set
  double regularity = 1.0;  // least over t of max over |v| = 1 of min n . v, n active at t
};
// Rows count as active within `active_m` of their bound. The gap is certified for any trajectory
// that keeps its rows: by weak duality it is at most ds/4 r' A^-1 r + sum lambda slack, where
// df/dz(t) = sum lambda n + r, lambda >= 0 and A is the second difference.
[[nodiscard]] Optimality optimality_of(const Scene& scene, std::span<const Vec2> states,
                                       double radius_m, const MarginProfile& profile, double ds_m,
                                       double active_m);

// --- alternating windows without obstacles

// One double sweep in terms of what the odd windows hold fixed, at w(2), w(4), ..
struct Contraction {
  Eigen::MatrixXd map;        // values before -> after, either coordinate
  double factor = 0.0;        // its largest eigenvalue
  Eigen::VectorXd slow_mode;  // and eigenvector, largest entry 1
};
// `splits` from 0 to the horizon, strictly increasing.
[[nodiscard]] Contraction contraction_of(std::span<const int> splits);

// The piecewise linear function on 0..horizon with `values` at w(2), w(4), .. and 0 at the ends.
[[nodiscard]] std::vector<double> interpolate(std::span<const int> splits,
                                              const Eigen::VectorXd& values);

}  // namespace sopt::oracle
