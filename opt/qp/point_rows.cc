#include "opt/qp/point_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sopt {
namespace {

constexpr double kAlwaysHolds = -1e300;  // bound of padding rows

}  // namespace

PointRows::PointRows(Arena& arena, int max_window, int max_rows) noexcept
    : groups_(arena, max_rows / kLanesDouble + max_window),
      group_time_(arena, max_rows / kLanesDouble + max_window),
      bound_(arena, max_rows + kLanesDouble * max_window),
      price_(arena, max_window + 1),
      z_{{arena, max_window + 1}, {arena, max_window + 1}},
      step_{{arena, max_window + 1}, {arena, max_window + 1}},
      force_{{arena, max_window + 1}, {arena, max_window + 1}} {}

void PointRows::reset(int num_steps, const Vec2& first, const Vec2& last) SOPT_RT {
  num_steps_ = num_steps;
  num_in_group_ = kLanesDouble;
  groups_.clear();
  group_time_.clear();
  bound_.clear();
  for (Points* points : {&z_, &step_, &force_}) {
    (void)points->x.try_resize(num_steps + 1);
    (void)points->y.try_resize(num_steps + 1);
  }
  for (Points* points : {&step_, &force_}) {
    std::fill(points->x.begin(), points->x.end(), 0.0);
    std::fill(points->y.begin(), points->y.end(), 0.0);
  }
  (void)price_.try_resize(num_steps + 1);
  for (int t = 1; t < num_steps; ++t) {
    price_[t] = std::sqrt(num_steps / (static_cast<double>(t) * (num_steps - t)));
  }
  z_.x[0] = first.x();
  z_.y[0] = first.y();
  z_.x[num_steps] = last.x();
  z_.y[num_steps] = last.y();
  not_finite_ = 0.0 * (first.sum() + last.sum());
}

bool PointRows::try_add(int t, const Vec2& normal, double bound) SOPT_RT {
  if (num_in_group_ == kLanesDouble || group_time_.back() != t) {
    if (groups_.size() == groups_.capacity()) return false;
    (void)groups_.try_push_back({});
    (void)group_time_.try_push_back(t);
    (void)bound_.try_resize(bound_.size() + kLanesDouble);
    std::fill_n(groups_.back().priced_bound, kLanesDouble, kAlwaysHolds);
    std::fill(bound_.end() - kLanesDouble, bound_.end(), kAlwaysHolds);
    num_in_group_ = 0;
  }
  Group& group = groups_.back();
  group.normal_x[num_in_group_] = normal.x();
  group.normal_y[num_in_group_] = normal.y();
  group.priced_bound[num_in_group_] = bound;
  bound_[bound_.size() - kLanesDouble + num_in_group_] = bound;
  not_finite_ += 0.0 * (normal.sum() + bound);
  ++num_in_group_;
  return true;
}

void PointRows::shift_bounds(const Vec2* offsets) SOPT_RT {
  for (int id = 0; id < num_ids(); ++id) {
    if (!is_free(id)) continue;
    bound_[id] += normal(id).dot(offsets[time(id)]);
    groups_[id / kLanesDouble].priced_bound[id % kLanesDouble] = bound_[id];
  }
}

void PointRows::set_positions(const Vec2* points) SOPT_RT {
  for (int t = 1; t < num_steps_; ++t) {
    z_.x[t] = points[t].x();
    z_.y[t] = points[t].y();
  }
}

bool PointRows::is_free(int id) const SOPT_RT {
  return groups_[id / kLanesDouble].priced_bound[id % kLanesDouble] > kAlwaysHolds;
}

void PointRows::enter(int id) SOPT_RT {
  groups_[id / kLanesDouble].priced_bound[id % kLanesDouble] = kAlwaysHolds;
}

void PointRows::leave(int id) SOPT_RT {
  groups_[id / kLanesDouble].priced_bound[id % kLanesDouble] = bound_[id];
}

void PointRows::gram(std::span<const int> ids, int id, double* out) const SOPT_RT {
  const int t = time(id);
  const Vec2 a = normal(id);
  for (std::size_t j = 0; j < ids.size(); ++j) {
    const int tj = time(ids[j]);
    const double green = static_cast<double>(std::min(tj, t)) *
                         static_cast<double>(num_steps_ - std::max(tj, t)) / num_steps_;
    out[j] = green * a.dot(normal(ids[j]));
  }
}

void PointRows::update_primal(std::span<const int> ids, std::span<const double> weights) SOPT_RT {
  add_forces(ids, weights);
  integrate_forces(z_);
}

void PointRows::update_step(std::span<const int> ids, std::span<const double> weights) SOPT_RT {
  add_forces(ids, weights);
  integrate_forces(step_);
}

void PointRows::add_forces(std::span<const int> ids, std::span<const double> weights) SOPT_RT {
  for (std::size_t j = 0; j < ids.size(); ++j) {
    const int t = time(ids[j]);
    const Vec2 force = weights[j] * normal(ids[j]);
    force_.x[t] += force.x();
    force_.y[t] += force.y();
  }
}

// Fills in the polyline between the ends of `points` and takes the forces off again.
void PointRows::integrate_forces(Points& points) SOPT_RT {
  const int n = num_steps_;
  // Slope of the first step: the polyline has to end at z(n).
  double slope_x = points.x[n] - points.x[0];
  double slope_y = points.y[n] - points.y[0];
  for (int t = 1; t < n; ++t) {
    slope_x += force_.x[t] * (n - t);
    slope_y += force_.y[t] * (n - t);
  }
  slope_x /= n;
  slope_y /= n;
  double x = points.x[0];
  double y = points.y[0];
  for (int t = 1; t < n; ++t) {
    points.x[t] = x += slope_x;
    points.y[t] = y += slope_y;
    slope_x -= force_.x[t];
    slope_y -= force_.y[t];
    force_.x[t] = force_.y[t] = 0.0;
  }
}

double PointRows::step_value(int id) const SOPT_RT {
  return normal(id).dot(Vec2(step_.x[time(id)], step_.y[time(id)]));
}

double PointRows::step_energy() const SOPT_RT {
  double sum = 0.0;
  for (int t = 0; t < num_steps_; ++t) {
    const double dx = step_.x[t + 1] - step_.x[t];
    const double dy = step_.y[t + 1] - step_.y[t];
    sum += dx * dx + dy * dy;
  }
  return sum;
}

void PointRows::add_step() SOPT_RT {
  for (int t = 1; t < num_steps_; ++t) {
    z_.x[t] += step_.x[t];
    z_.y[t] += step_.y[t];
  }
}

double PointRows::violation(int id) const SOPT_RT {
  return bound_[id] - normal(id).dot(position(time(id)));
}

double PointRows::size_of_terms(int id) const SOPT_RT {
  return std::abs(bound_[id]) + normal(id).cwiseAbs().dot(position(time(id)).cwiseAbs());
}

int PointRows::most_violated(double tolerance) const SOPT_RT {
  V4d worst = splat4(0.0);
  V4d worst_group = splat4(-1.0);
  for (int g = 0; g < groups_.size(); ++g) {
    const Group& group = groups_[g];
    const int t = group_time_[g];
    const V4d excess = load4(group.priced_bound) - tolerance - load4(group.normal_x) * z_.x[t] -
                       load4(group.normal_y) * z_.y[t];
    const V4d value = excess * price_[t];
    worst_group = value > worst ? splat4(g) : worst_group;
    worst = max4(value, worst);
  }
  int best = -1;
  double best_value = 0.0;
  for (int lane = 0; lane < kLanesDouble; ++lane) {
    const int i = static_cast<int>(worst_group[lane]) * kLanesDouble + lane;
    if (worst[lane] > best_value || (worst[lane] == best_value && best_value > 0.0 && i < best)) {
      best_value = worst[lane];
      best = i;
    }
  }
  return best;
}

void PointRows::shorten_step(const Vec2* reference, double step) SOPT_RT {
  for (int t = 1; t < num_steps_; ++t) {
    z_.x[t] = reference[t].x() + step * (z_.x[t] - reference[t].x());
    z_.y[t] = reference[t].y() + step * (z_.y[t] - reference[t].y());
  }
}

}  // namespace sopt
