#include "opt/point_rows.h"

#include <algorithm>
#include <limits>

namespace sopt {
namespace {

constexpr double kAlwaysHolds = -1e300;  // bound of padding rows
constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

PointRows::PointRows(Arena& arena, int max_window, int max_rows) noexcept
    : groups_(arena, max_rows / kLanesDouble + max_window),
      group_time_(arena, max_rows / kLanesDouble + max_window),
      z_x_(arena, max_window + 1),
      z_y_(arena, max_window + 1),
      force_x_(arena, max_window + 1),
      force_y_(arena, max_window + 1) {}

void PointRows::reset(int num_steps, const Vec2& first, const Vec2& last) SOPT_RT {
  num_steps_ = num_steps;
  num_padded_ = 0;
  num_in_group_ = kLanesDouble;
  groups_.clear();
  group_time_.clear();
  for (auto* array : {&z_x_, &z_y_, &force_x_, &force_y_}) (void)array->try_resize(num_steps + 1);
  std::fill(force_x_.begin(), force_x_.end(), 0.0);
  std::fill(force_y_.begin(), force_y_.end(), 0.0);
  z_x_[0] = first.x();
  z_y_[0] = first.y();
  z_x_[num_steps] = last.x();
  z_y_[num_steps] = last.y();
  update_primal({}, {});
}

bool PointRows::try_add(int t, const Vec2& normal, double bound) SOPT_RT {
  if (num_in_group_ == kLanesDouble || group_time_.back() != t) {
    if (!groups_.try_push_back({}) || !group_time_.try_push_back(t)) return false;
    std::fill_n(groups_.back().bound, kLanesDouble, kAlwaysHolds);
    num_in_group_ = 0;
    num_padded_ += kLanesDouble;
  }
  Group& group = groups_.back();
  group.normal_x[num_in_group_] = normal.x();
  group.normal_y[num_in_group_] = normal.y();
  group.bound[num_in_group_] = bound;
  ++num_in_group_;
  return true;
}

double PointRows::gram(int i, int k) const SOPT_RT {
  const int ti = group_time_[i / kLanesDouble];
  const int tk = group_time_[k / kLanesDouble];
  const Group& gi = groups_[i / kLanesDouble];
  const Group& gk = groups_[k / kLanesDouble];
  const int li = i % kLanesDouble;
  const int lk = k % kLanesDouble;
  const double green = static_cast<double>(std::min(ti, tk)) *
                       static_cast<double>(num_steps_ - std::max(ti, tk)) / num_steps_;
  return green * (gi.normal_x[li] * gk.normal_x[lk] + gi.normal_y[li] * gk.normal_y[lk]);
}

void PointRows::update_primal(std::span<const int> active, std::span<const double> lambda) SOPT_RT {
  const int n = num_steps_;
  // Slope of the first step: the polyline has to end at z(n).
  double slope_x = z_x_[n] - z_x_[0];
  double slope_y = z_y_[n] - z_y_[0];
  for (std::size_t j = 0; j < active.size(); ++j) {
    const int t = group_time_[active[j] / kLanesDouble];
    const Group& group = groups_[active[j] / kLanesDouble];
    const double force_x = lambda[j] * group.normal_x[active[j] % kLanesDouble];
    const double force_y = lambda[j] * group.normal_y[active[j] % kLanesDouble];
    force_x_[t] += force_x;
    force_y_[t] += force_y;
    slope_x += force_x * (n - t);
    slope_y += force_y * (n - t);
  }
  slope_x /= n;
  slope_y /= n;
  double x = z_x_[0];
  double y = z_y_[0];
  for (int t = 1; t < n; ++t) {
    z_x_[t] = x += slope_x;
    z_y_[t] = y += slope_y;
    slope_x -= force_x_[t];
    slope_y -= force_y_[t];
    force_x_[t] = force_y_[t] = 0.0;
  }
}

double PointRows::violation(int i) const SOPT_RT {
  const Group& group = groups_[i / kLanesDouble];
  const int t = group_time_[i / kLanesDouble];
  const int lane = i % kLanesDouble;
  return group.bound[lane] - group.normal_x[lane] * z_x_[t] - group.normal_y[lane] * z_y_[t];
}

int PointRows::most_violated() const SOPT_RT {
  if (groups_.empty()) return -1;
  V4d worst = splat4(-kInfinity);
  V4d worst_group = splat4(-1.0);
  for (int g = 0; g < groups_.size(); ++g) {
    const Group& group = groups_[g];
    const int t = group_time_[g];
    const V4d value =
        load4(group.bound) - load4(group.normal_x) * z_x_[t] - load4(group.normal_y) * z_y_[t];
    worst_group = value > worst ? splat4(g) : worst_group;
    worst = max4(value, worst);
  }
  int best = -1;
  double best_value = -kInfinity;
  for (int lane = 0; lane < kLanesDouble; ++lane) {
    const int i = static_cast<int>(worst_group[lane]) * kLanesDouble + lane;
    if (worst[lane] > best_value || (worst[lane] == best_value && i < best)) {
      best_value = worst[lane];
      best = i;
    }
  }
  return best;
}

void PointRows::shorten_step(const Vec2* reference, double step) SOPT_RT {
  for (int t = 1; t < num_steps_; ++t) {
    z_x_[t] = reference[t].x() + step * (z_x_[t] - reference[t].x());
    z_y_[t] = reference[t].y() + step * (z_y_[t] - reference[t].y());
  }
}

}  // namespace sopt
