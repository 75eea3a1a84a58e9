// What an arm keeps at one configuration, as far as a window's check needs it: per link the
// distance to the nearest obstacle and what it has above the least that the waypoint must keep, per
// pair of links their distance. Lower bounds: `find` gives exact ones up to its radius, `lower`
// what is left of known ones after a move, by the arm's displacement bounds and without geometry.
// Motions are proven clear by the gaps at both ends and a bound on the way between them.
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "models/arm/arm.h"
#include "models/arm/arm_clearance.h"
#include "models/margin.h"
#include "models/space/world3.h"
#include "rt/annotations.h"

namespace sopt {

// Between links no margin is wanted beyond kSelfClearance_m; rows keep a little more, so that what
// they lose to linearisation does not refuse the step.
inline constexpr double kSelfRow_m = 1e-3;
template <int N>
struct ArmGaps {
  static constexpr int kNumPairs = N * (N + 1) / 2;
  // Of link i_link with a lower one.
  [[nodiscard]] static constexpr std::size_t pair(int i_link, int i_lower) noexcept {
    return static_cast<std::size_t>(i_link * (i_link - 1) / 2 + i_lower);
  }
  std::array<double, N + 1> world_m{};      // link to obstacles
  std::array<double, N + 1> slack_m{};      // likewise, above what the waypoint must keep
  std::array<double, kNumPairs> links_m{};  // link to link, by `pair`

  // The better of two lower bounds.
  void raise_to(const ArmGaps& other) SOPT_RT {
    for (std::size_t i = 0; i <= N; ++i) {
      world_m[i] = std::max(world_m[i], other.world_m[i]);
      slack_m[i] = std::max(slack_m[i], other.slack_m[i]);
    }
    for (std::size_t i = 0; i < links_m.size(); ++i) {
      links_m[i] = std::max(links_m[i], other.links_m[i]);
    }
  }
};

// How far links move at most, in the world and against each other.
template <int N>
struct ArmMove {
  std::array<double, N + 1> world_m{};
  std::array<double, ArmGaps<N>::kNumPairs> links_m{};
};

template <int N>
class ArmGapFinder {
 public:
  using Config = typename Arm<N>::Config;

  void reset(const Arm<N>& arm, const World3& world, double min_clearance_m) SOPT_RT;

  // Exact up to radius_m of the link (self_radius_m between links), which stands for anything
  // farther away.
  // visit(pose, contact) sees every contact.
  template <class Visit>
  void find(const Config& q, const ClearanceRule& rule, const LinkRadii<N>& radius_m,
            double self_radius_m, ArmGaps<N>& out, Visit&& visit);
  void find(const Config& q, const ClearanceRule& rule, double radius_m, double self_radius_m,
            ArmGaps<N>& out) {
    LinkRadii<N> radii_m;
    radii_m.fill(radius_m);
    find(q, rule, radii_m, self_radius_m, out, [](const ArmPose<N>&, const ArmContact&) {});
  }

  // Displacement bounds when joint j moves by at most abs_dq[j].
  void bound_move(const Config& abs_dq, ArmMove<N>& out) const SOPT_RT;
  // gaps - move.
  static void lower(const ArmGaps<N>& gaps, const ArmMove<N>& move, ArmGaps<N>& out) SOPT_RT;

  // Nothing is closer than the waypoint must keep, or than it was.
  [[nodiscard]] static bool keeps(const ArmGaps<N>& gaps, const ArmGaps<N>& before) SOPT_RT;
  // Nothing is closer than the waypoint must keep, and links no closer than rows have them.
  [[nodiscard]] static bool keeps_all(const ArmGaps<N>& gaps) SOPT_RT;
  // True when a motion between two configurations, over which links move by at most `move`, keeps
  // the hard clearance.
  [[nodiscard]] bool motion_is_clear(const ArmGaps<N>& from, const ArmGaps<N>& to,
                                     const ArmMove<N>& move) const SOPT_RT;

  [[nodiscard]] const Arm<N>& arm() const SOPT_RT { return *arm_; }
  [[nodiscard]] std::int64_t num_queries() const SOPT_RT { return num_queries_; }

 private:
  // Losing less than this is rounding.
  static constexpr double kRounding_m = 1e-9;

  const Arm<N>* arm_ = nullptr;
  const World3* world_ = nullptr;
  double min_clearance_m_ = 0.0;
  std::int64_t num_queries_ = 0;
  ArmPose<N> pose_;
  ArmGaps<N> farthest_;  // 0 where something may come near, else infinite
};

template <int N>
template <class Visit>
void ArmGapFinder<N>::find(const Config& q, const ClearanceRule& rule, const LinkRadii<N>& radius_m,
                           double self_radius_m, ArmGaps<N>& out, Visit&& visit) {
  const double required_m = world_->max_required_m(rule);
  for (std::size_t i = 0; i <= N; ++i) {
    out.world_m[i] = farthest_.world_m[i] + radius_m[i];
    out.slack_m[i] = farthest_.world_m[i] + radius_m[i] - required_m;
  }
  for (std::size_t i = 0; i < out.links_m.size(); ++i) {
    out.links_m[i] = farthest_.links_m[i] + self_radius_m;
  }
  arm_->forward(q, pose_);
  (void)for_each_contact(*arm_, *world_, pose_, radius_m, [&](const ArmContact& contact) {
    ++num_queries_;
    const auto i = static_cast<std::size_t>(contact.i_link);
    const double distance_m = contact.clearance.distance_m;
    out.world_m[i] = std::min(out.world_m[i], distance_m);
    out.slack_m[i] =
        std::min(out.slack_m[i], distance_m - world_->required_m(contact.i_obstacle, rule));
    visit(pose_, contact);
    return true;
  });
  (void)for_each_self_contact(*arm_, pose_, self_radius_m, [&](const ArmContact& contact) {
    ++num_queries_;
    double& gap_m = out.links_m[ArmGaps<N>::pair(contact.i_link, contact.i_other_link)];
    gap_m = std::min(gap_m, contact.clearance.distance_m);
    visit(pose_, contact);
    return true;
  });
}

extern template class ArmGapFinder<4>;
extern template class ArmGapFinder<5>;
extern template class ArmGapFinder<6>;
extern template class ArmGapFinder<7>;
extern template class ArmGapFinder<8>;

}  // namespace sopt
