// Plans of arms judged from their numbers alone, for tests only: frames by products of homogeneous
// matrices, distances by closed forms for two segments and by a search along the capsule's axis for
// everything else, limits at the vertices of the parabolas. Shares no geometry with the library; of
// it only the description of arm and obstacles is used. Where shapes overlap, the distance is minus
// what is known of the depth: the radii.
#pragma once

#include <limits>
#include <utility>
#include <vector>

#include "models/arm/arm.h"
#include "models/space/world3.h"
#include "models/trajectory.h"
#include "tests/support/arm_oracle.h"

namespace sopt::oracle {

[[nodiscard]] double distance_between(const Capsule3& a, const Capsule3& b);
[[nodiscard]] double distance_between(const Convex3& obstacle, const Capsule3& body);

// An arm put together again from its description.
template <int N>
class PlainArm {
 public:
  using Config = typename Arm<N>::Config;

  explicit PlainArm(const Arm<N>& arm);

  // In the arm's order.
  [[nodiscard]] std::vector<Capsule3> capsules_at(const Config& q) const;
  // Infinite when there is nothing to be near to.
  [[nodiscard]] double clearance_m(const World3& world, const Config& q) const;
  [[nodiscard]] double self_clearance_m(const Config& q) const;

 private:
  ArmDescription<N> description_;
  std::vector<LinkCapsule> capsules_;
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;  // of capsules
};

struct PlanFacts {
  bool is_whole = false;  // has a step, inputs that fit, a dt, and only finite numbers
  bool starts = false;    // at the start, to the bit
  double goal_error = 0.0;
  double end_speed = 0.0;
  double defect = 0.0;
  double limit_excess = -std::numeric_limits<double>::infinity();  // of any limit, own unit
  double length = 0.0;
  double clearance_m = std::numeric_limits<double>::infinity();  // over the whole motion
  double self_clearance_m = std::numeric_limits<double>::infinity();
};

// The clearances are the least of `samples` instants per step and of a search around the lowest.
template <int N>
[[nodiscard]] PlanFacts examine_plan(const Arm<N>& arm, const World3& world,
                                     const Trajectory<Arm<N>>& plan,
                                     const typename Arm<N>::Config& start,
                                     const typename Arm<N>::Config& goal, int samples = 10);

// What is wrong with a plan that must keep `min_clearance_m`; empty: nothing.
[[nodiscard]] const char* find_fault(const PlanFacts& facts, double min_clearance_m);

}  // namespace sopt::oracle
