#include "opt/arm/arm_gaps.h"

namespace sopt {

template <int N>
void ArmGapFinder<N>::reset(const Arm<N>& arm, const World3& world,
                            double min_clearance_m) SOPT_RT {
  arm_ = &arm;
  world_ = &world;
  min_clearance_m_ = min_clearance_m;
  num_queries_ = 0;
  farthest_.links_m.fill(std::numeric_limits<double>::infinity());
  for (const auto& pair : arm.self_collision_pairs()) {
    farthest_
        .links_m[ArmGaps<N>::pair(arm.body(pair.i_body_b).i_link, arm.body(pair.i_body_a).i_link)] =
        0.0;
  }
  // The base does not move, whatever it touches.
  farthest_.world_m.fill(std::numeric_limits<double>::infinity());
  for (int i = 1; i <= N; ++i) {
    const bool has_capsules = arm.first_capsule(i + 1) > arm.first_capsule(i);
    if (has_capsules) farthest_.world_m[static_cast<std::size_t>(i)] = 0.0;
  }
}

template <int N>
void ArmGapFinder<N>::bound_move(const Config& abs_dq, ArmMove<N>& out) const SOPT_RT {
  constexpr double kRoundingGuard = 1.0 + 1e-14;
  out.world_m[0] = 0.0;
  for (int i = 1; i <= N; ++i) {
    double sum_m = 0.0;
    for (int j = i - 1; j >= 0; --j) {
      sum_m += arm_->max_reach(j, i) * abs_dq[j];
      out.links_m[ArmGaps<N>::pair(i, j)] = sum_m * kRoundingGuard;
    }
    out.world_m[static_cast<std::size_t>(i)] = sum_m * kRoundingGuard;
  }
}

template <int N>
void ArmGapFinder<N>::lower(const ArmGaps<N>& gaps, const ArmMove<N>& move,
                            ArmGaps<N>& out) SOPT_RT {
  for (std::size_t i = 0; i <= N; ++i) {
    out.world_m[i] = gaps.world_m[i] - move.world_m[i];
    out.slack_m[i] = gaps.slack_m[i] - move.world_m[i];
  }
  for (std::size_t i = 0; i < out.links_m.size(); ++i) {
    out.links_m[i] = gaps.links_m[i] - move.links_m[i];
  }
}

template <int N>
bool ArmGapFinder<N>::keeps(const ArmGaps<N>& gaps, const ArmGaps<N>& before) SOPT_RT {
  bool holds = true;
  for (std::size_t i = 0; i <= N; ++i) {
    holds = holds && gaps.slack_m[i] >= std::min(0.0, before.slack_m[i] - kRounding_m);
  }
  return holds;
}

template <int N>
bool ArmGapFinder<N>::keeps_all(const ArmGaps<N>& gaps) SOPT_RT {
  bool holds = true;
  for (const double slack_m : gaps.slack_m) holds = holds && slack_m >= 0.0;
  for (const double gap_m : gaps.links_m) holds = holds && gap_m >= kSelfRow_m;
  return holds;
}

// At any moment the distances left behind and still to go add up to `move`, so one of the two ends
// is within half of it.
template <int N>
bool ArmGapFinder<N>::motion_is_clear(const ArmGaps<N>& from, const ArmGaps<N>& to,
                                      const ArmMove<N>& move) const SOPT_RT {
  bool holds = true;
  for (std::size_t i = 0; i <= N; ++i) {
    holds = holds && from.world_m[i] + to.world_m[i] - move.world_m[i] >= 2.0 * min_clearance_m_;
  }
  for (std::size_t i = 0; i < from.links_m.size(); ++i) {
    holds = holds && from.links_m[i] + to.links_m[i] - move.links_m[i] >= 2.0 * kSelfClearance_m;
  }
  return holds;
}

template class ArmGapFinder<4>;
template class ArmGapFinder<5>;
template class ArmGapFinder<6>;
template class ArmGapFinder<7>;
template class ArmGapFinder<8>;

}  // namespace sopt
