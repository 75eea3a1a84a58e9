#include "tools/scenes/arm_scene_check.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "models/space/clearance3.h"
#include "sampler/rng.h"

namespace sopt {
namespace {

using Config = ArmSceneCheck::Config;

constexpr double kResolution_rad = 0.02;  // of the 2-norm along a motion

int num_steps(const Config& a, const Config& b) {
  return std::max(1, static_cast<int>(std::ceil((b - a).norm() / kResolution_rad)));
}

// Smallest distance of two bodies of the arm.
double pair_distance_m(const Arm<5>& arm, const ArmPose<5>& pose, const ArmBody& a,
                       const ArmBody& b) {
  double distance_m = 1.0;
  for (int i = a.first; i < a.last; ++i) {
    const Convex3 one = to_convex(arm.capsule_W(pose, i));
    for (int j = b.first; j < b.last; ++j) {
      distance_m = std::min(distance_m, compute_clearance(one, arm.capsule_W(pose, j)).distance_m);
    }
  }
  return distance_m;
}

using Tree = std::vector<Config>;

const Config& nearest_node(const Tree& tree, const Config& target) {
  return *std::min_element(tree.begin(), tree.end(), [&](const Config& a, const Config& b) {
    return (a - target).squaredNorm() < (b - target).squaredNorm();
  });
}

// Grows `tree` towards `target` by steps until it is reached (true) or something is in the way.
bool grow(const ArmSceneCheck& check, Tree& tree, const Config& target, double margin_m,
          bool only_once) {
  constexpr double kStep_rad = 0.3;
  Config from = nearest_node(tree, target);
  for (;;) {
    const Config way = target - from;
    const bool reaches = way.norm() <= kStep_rad;
    const Config to = reaches ? target : Config(from + kStep_rad / way.norm() * way);
    if (!check.motion_is_clear(from, to, margin_m)) return false;
    tree.push_back(to);
    if (reaches || only_once) return reaches;
    from = to;
  }
}

}  // namespace

double ArmSceneCheck::clearance_m(const Config& q) const {
  ArmPose<5> pose;
  arm_->forward(q, pose);
  double distance_m = 1.0;
  for (int i = 0; i < arm_->num_capsules(); ++i) {
    distance_m =
        std::min(distance_m, world_->nearest(arm_->capsule_W(pose, i), distance_m).distance_m);
  }
  for (const auto& [a, b] : arm_->self_collision_pairs()) {
    distance_m = std::min(distance_m, pair_distance_m(*arm_, pose, arm_->body(a), arm_->body(b)));
  }
  return distance_m;
}

bool ArmSceneCheck::is_clear_around(const Config& q, const Config& abs_dq, double margin_m) const {
  ArmPose<5> pose;
  arm_->forward(q, pose);
  for (int i = 0; i < arm_->num_capsules(); ++i) {
    const double wanted_m = margin_m + arm_->displacement_bound(arm_->capsule_link(i), abs_dq);
    if (world_->nearest(arm_->capsule_W(pose, i), wanted_m).distance_m < wanted_m) return false;
  }
  for (const auto& [i_a, i_b] : arm_->self_collision_pairs()) {
    const ArmBody& a = arm_->body(i_a);
    const ArmBody& b = arm_->body(i_b);
    const double wanted_m = margin_m + arm_->displacement_bound(b.i_link, abs_dq, a.i_link);
    if (pair_distance_m(*arm_, pose, a, b) < wanted_m) return false;
  }
  return true;
}

bool ArmSceneCheck::motion_is_clear(const Config& a, const Config& b, double margin_m) const {
  const int steps = num_steps(a, b);
  const Config half_step = (b - a).cwiseAbs() / (2.0 * steps);
  for (int i = 0; i <= steps; ++i) {
    const double share = static_cast<double>(i) / steps;
    if (!is_clear_around(a + share * (b - a), half_step, margin_m)) return false;
  }
  return true;
}

bool ArmSceneCheck::motion_is_blocked(const Config& a, const Config& b) const {
  const int steps = num_steps(a, b);
  for (int i = 0; i <= steps; ++i) {
    ArmPose<5> pose;
    arm_->forward(a + static_cast<double>(i) / steps * (b - a), pose);
    for (int j = 0; j < arm_->num_capsules(); ++j) {
      if (world_->nearest(arm_->capsule_W(pose, j), 0.0).distance_m < 0.0) return true;
    }
  }
  return false;
}

bool ArmSceneCheck::is_solvable(const Config& start, const Config& goal, double margin_m,
                                std::uint64_t seed) const {
  constexpr int kMaxSamples = 3000;
  CounterRng rng(seed);
  Tree trees[2] = {{start}, {goal}};
  for (int i = 0; i < kMaxSamples; ++i) {
    Tree& grown = trees[i % 2];
    Tree& other = trees[1 - i % 2];
    Config sample;
    for (int j = 0; j < 5; ++j) {
      sample[j] = arm_->lower()[j] + (arm_->upper()[j] - arm_->lower()[j]) * rng.next_uniform();
    }
    const std::size_t before = grown.size();
    (void)grow(*this, grown, sample, margin_m, true);
    if (grown.size() == before) continue;
    const Config added = grown.back();
    if (grow(*this, other, added, margin_m, false)) return true;
  }
  return false;
}

}  // namespace sopt
