// The base of a mobile robot's segment QP: a unicycle linearised about a reference,
//     pose = (x, y, heading),   inputs v, w per step,   x+ = x + v cos, y+ = y + v sin, heading+ =
//     + w
// with the differences to the reference's inputs as variables, two per step in time order, and the
// last pose fixed. Cost: 1/2 sum position_weight |(x, y) - last|^2 + heading_weight (..)^2 + v^2 +
// w^2.
#pragma once

#include <vector>

#include "tools/qp/segment_qp.h"

namespace sopt {

struct UnicycleReference {
  std::vector<double> v, w;  // of every step
};

struct UnicycleCost {
  double position_weight = 0.0;
  double heading_weight = 0.0;
};

// 0 <= v <= v_max, |w| <= w_max
struct UnicycleLimits {
  double v_max = 0.0;
  double w_max = 0.0;
};

class UnicycleBase {
 public:
  static constexpr int kNumPose = 3;

  UnicycleBase(const UnicycleReference& reference, const UnicycleCost& cost,
               const UnicycleLimits& limits);

  [[nodiscard]] const BasePart& part() const { return part_; }
  // Of the reference at t = 0 .. n.
  [[nodiscard]] const std::vector<std::vector<double>>& poses() const { return poses_; }
  // How direction . (pose(t) - reference) follows the variables; direction has kNumPose entries.
  [[nodiscard]] std::vector<double> row(int t, const double* direction) const;

 private:
  void linearise(const UnicycleReference& reference);
  void add_cost(int t, int coordinate, double weight);

  BasePart part_;
  std::vector<std::vector<double>> poses_;
  std::vector<std::vector<double>> maps_;  // kNumPose t + coordinate: how it follows the variables
};

}  // namespace sopt
