// What a generated arm scene must satisfy, decided without the library's sampler: exact clearance
// at single configurations, proven along straight joint motions by bounding how far links move
// between them, and a plain RRT-Connect [Kuffner, LaValle 2000] that tells whether a path exists.
#pragma once

#include <cstdint>

#include "models/arm/arm.h"
#include "models/space/world3.h"

namespace sopt {

class ArmSceneCheck {
 public:
  using Config = Arm<5>::Config;

  // Both must outlive this.
  ArmSceneCheck(const Arm<5>& arm, const World3& world) : arm_(&arm), world_(&world) {}

  // Smallest signed distance of any link to an obstacle and of any pair of links; at most 1 m.
  [[nodiscard]] double clearance_m(const Config& q) const;

  // True when the straight motion keeps `margin_m` from obstacles and links from each other,
  // everywhere.
  [[nodiscard]] bool motion_is_clear(const Config& a, const Config& b, double margin_m) const;

  // True when a configuration of the straight motion is inside an obstacle.
  [[nodiscard]] bool motion_is_blocked(const Config& a, const Config& b) const;

  // True when RRT-Connect finds a path that keeps `margin_m` everywhere, within a fixed number of
  // samples.
  [[nodiscard]] bool is_solvable(const Config& start, const Config& goal, double margin_m,
                                 std::uint64_t seed) const;

 private:
  // True when every link keeps `margin_m` while joints move by at most abs_dq from q.
  [[nodiscard]] bool is_clear_around(const Config& q, const Config& abs_dq, double margin_m) const;

  const Arm<5>* arm_;
  const World3* world_;
};

}  // namespace sopt
