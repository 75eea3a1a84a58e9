#include "tools/qp/unicycle_base.h"

#include <cmath>
#include <cstddef>

namespace sopt {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace

UnicycleBase::UnicycleBase(const UnicycleReference& reference, const UnicycleCost& cost,
                           const UnicycleLimits& limits) {
  const int n = static_cast<int>(reference.v.size());
  const int num_variables = 2 * n;
  linearise(reference);
  part_.num_inputs = 2;
  part_.hessian.assign(at(num_variables * num_variables), 0.0);
  for (int t = 0; t < n; ++t) {
    const double v = reference.v[at(t)];
    const double w = reference.w[at(t)];
    part_.gradient.insert(part_.gradient.end(), {v, w});
    part_.lower.insert(part_.lower.end(), {-v, -limits.w_max - w});
    part_.upper.insert(part_.upper.end(), {limits.v_max - v, limits.w_max - w});
  }
  for (int i = 0; i < num_variables; ++i) part_.hessian[at(i * num_variables + i)] = 1.0;
  for (int t = 1; t <= n; ++t) {
    add_cost(t, 0, cost.position_weight);
    add_cost(t, 1, cost.position_weight);
    add_cost(t, 2, cost.heading_weight);
  }
  part_.equality_rows.assign(maps_.end() - kNumPose, maps_.end());
  part_.equality_values.assign(kNumPose, 0.0);
}

// Rows of one time follow from those of the time before.
void UnicycleBase::linearise(const UnicycleReference& reference) {
  const int n = static_cast<int>(reference.v.size());
  poses_.assign(1, std::vector<double>(kNumPose, 0.0));
  maps_.assign(kNumPose, std::vector<double>(at(2 * n), 0.0));
  for (int t = 0; t < n; ++t) {
    const std::vector<double> pose = poses_.back();
    const double v = reference.v[at(t)];
    const double sine = std::sin(pose[2]);
    const double cosine = std::cos(pose[2]);
    poses_.push_back({pose[0] + v * cosine, pose[1] + v * sine, pose[2] + reference.w[at(t)]});
    std::vector<double> x = maps_[at(kNumPose * t)];
    std::vector<double> y = maps_[at(kNumPose * t + 1)];
    std::vector<double> heading = maps_[at(kNumPose * t + 2)];
    for (int i = 0; i < 2 * t; ++i) {
      x[at(i)] -= v * sine * heading[at(i)];
      y[at(i)] += v * cosine * heading[at(i)];
    }
    x[at(2 * t)] = cosine;
    y[at(2 * t)] = sine;
    heading[at(2 * t + 1)] = 1.0;
    maps_.insert(maps_.end(), {x, y, heading});
  }
}

// 1/2 weight (coordinate(t) - last)^2
void UnicycleBase::add_cost(int t, int coordinate, double weight) {
  const std::vector<double>& map = maps_[at(kNumPose * t + coordinate)];
  const double distance = poses_[at(t)][at(coordinate)] - poses_.back()[at(coordinate)];
  const std::size_t n = map.size();
  for (std::size_t i = 0; i < n; ++i) {
    part_.gradient[i] += weight * distance * map[i];
    for (std::size_t k = 0; k < n; ++k) part_.hessian[i * n + k] += weight * map[i] * map[k];
  }
}

std::vector<double> UnicycleBase::row(int t, const double* direction) const {
  std::vector<double> row(part_.gradient.size(), 0.0);
  for (int coordinate = 0; coordinate < kNumPose; ++coordinate) {
    const std::vector<double>& map = maps_[at(kNumPose * t + coordinate)];
    for (std::size_t i = 0; i < row.size(); ++i) row[i] += direction[coordinate] * map[i];
  }
  return row;
}

}  // namespace sopt
