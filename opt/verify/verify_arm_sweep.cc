#include "opt/verify/verify_arm_sweep.h"

#include <cmath>
#include <utility>

namespace sopt {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Of what the certificate promises; the rest is for the bounds of the place itself.
constexpr double kShareOfPromise = 0.9;

constexpr std::size_t at(int i) noexcept { return static_cast<std::size_t>(i); }

}  // namespace

template <int N>
double ArmSweep<N>::Nearest::wanted_m() const noexcept {
  const double promise_m = std::max(1e-3, 0.01 * std::abs(upper_m));
  return std::max(required_m,
                  upper_m == kInfinity ? kInfinity : upper_m - kShareOfPromise * promise_m);
}

template <int N>
ArmSweep<N>::ArmSweep(const Arm<N>& arm, const VerifyProblem<Arm<N>>& problem,
                      const ArmMotion<N>& motion, double dt_s, double x_stop) noexcept
    : arm_(arm),
      problem_(problem),
      motion_(motion),
      bounds_(arm, *problem.world, motion),
      dt_s_(dt_s),
      x_stop_(x_stop),
      max_stretches_(8192 + 32 * motion.horizon()) {
  nearest_[0].required_m = problem.min_clearance_m;
  nearest_[1].required_m = problem.min_self_clearance_m;
}

template <int N>
Violation ArmSweep<N>::run(Certificate& certificate) noexcept {
  survey_motion();
  sweep_self();
  sweep_obstacles();
  certify(certificate);
  return describe();
}

// Boxes around the whole motion of each link.
template <int N>
void ArmSweep<N>::survey_motion() noexcept {
  std::array<Vec3, N + 1> first_W;
  std::array<double, N + 1> error_m{};
  for (int i = 0; i <= kNumSurveys; ++i) {
    const double x = survey_x(i);
    motion_.find_frames(x, left_);
    const double x_before = survey_x(std::max(i - 1, 0));
    const bool is_stretch = x_before < x;
    const auto change = is_stretch ? motion_.change(x_before, x) : typename ArmMotion<N>::Change();
    for (int l = 0; l <= N; ++l) {
      const Pose3& X = left_.X_WL[at(l)];
      const Vec3 center = X.rotation * motion_.sphere_L(l).center + X.position;
      Aabb3& area = areas_[at(l)];
      if (i == 0) area = {center, center};
      area = {area.lower.cwiseMin(center), area.upper.cwiseMax(center)};
      error_m[at(l)] = std::max(error_m[at(l)], motion_.chord_error_m(change, l, 0));
    }
  }
  for (int l = 0; l <= N; ++l) {
    const Vec3 grow = Vec3::Constant(motion_.sphere_L(l).radius_m + error_m[at(l)] + 1e-12);
    areas_[at(l)] = {areas_[at(l)].lower - grow, areas_[at(l)].upper + grow};
  }
}

template <int N>
void ArmSweep<N>::sweep_self() noexcept {
  for (const auto& bodies : arm_.self_collision_pairs()) {
    ArmPair pair;
    pair.i_body = bodies.i_body_b;
    pair.i_other_body = bodies.i_body_a;
    pair.i_link = arm_.body(pair.i_body).i_link;
    add_pair(pair);
  }
  sweep();
}

template <int N>
void ArmSweep<N>::sweep_obstacles() noexcept {
  const World3& world = *problem_.world;
  Nearest& nearest = nearest_[0];
  for (int i = 0; i < world.num_obstacles(); ++i) {
    const Aabb3 box = box_around(world.obstacle(i));
    for (int l = 0; l <= N; ++l) {
      if (arm_.first_capsule(l) == arm_.first_capsule(l + 1)) continue;
      const double gap_m = box_gap_m(areas_[at(l)], box);
      if (gap_m >= nearest.wanted_m()) {
        nearest.lower_m = std::min(nearest.lower_m, gap_m);
        continue;
      }
      ArmPair pair;
      pair.i_link = l;
      pair.i_obstacle = i;
      pair.obstacle_box = box;
      add_pair(pair);
    }
  }
  sweep();
}

template <int N>
void ArmSweep<N>::add_pair(const ArmPair& pair) noexcept {
  if (num_pairs_ == kMaxPairs) sweep();
  pairs_[at(num_pairs_++)] = pair;
}

template <int N>
void ArmSweep<N>::sweep() noexcept {
  if (num_pairs_ == 0) return;
  num_stretches_ = 0;
  for (int i = 0; i <= kNumSurveys; ++i) {
    const double x = survey_x(i);
    if (i > 0 && x == survey_x(i - 1)) continue;
    motion_.find_frames(x, left_);
    look_at(x, left_, num_pairs_);
  }
  walk(
      kLeastStretch,
      [this](ArmPair& pair, const ArmStretch<N>& stretch, bool can_split) {
        return is_open(pair, stretch, can_split);
      },
      [this](double x, const LinkFrames<N>& frames, int num) { look_at(x, frames, num); });
  num_pairs_ = 0;
}

template <int N>
template <class Keep, class Split>
void ArmSweep<N>::walk(double least, Keep&& keep, Split&& split) noexcept {
  double x_left = 0.0;
  motion_.find_frames(x_left, left_);
  levels_[0].x = motion_.horizon();
  levels_[0].num_pairs = num_pairs_;
  motion_.find_frames(levels_[0].x, levels_[0].frames);
  for (int level = 0; level >= 0 && x_left < x_stop_;) {
    Level& top = levels_[at(level)];
    const double width = top.x - x_left;
    const ArmStretch<N> stretch{&left_, &top.frames, x_left, top.x, motion_.change(x_left, top.x)};
    const bool can_split =
        width > least && level + 1 < kMaxLevels && num_stretches_ < max_stretches_;
    ++num_stretches_;
    top.num_pairs = partition(stretch, top.num_pairs, can_split, keep);
    if (top.num_pairs == 0) {
      x_left = top.x;
      left_ = top.frames;
      --level;
      continue;
    }
    Level& half = levels_[at(++level)];  // `top` becomes the second half
    half.x = x_left + (width > 1.0 ? std::floor(0.5 * width) : 0.5 * width);
    half.num_pairs = top.num_pairs;
    motion_.find_frames(half.x, half.frames);
    split(half.x, half.frames, half.num_pairs);
  }
}

// Brings the pairs that are kept to the front: a part's pairs are a front part of the whole's.
template <int N>
template <class Keep>
int ArmSweep<N>::partition(const ArmStretch<N>& stretch, int num_pairs, bool can_split,
                           Keep& keep) noexcept {
  int num_kept = 0;
  for (int i = 0; i < num_pairs; ++i) {
    if (!keep(pairs_[at(i)], stretch, can_split)) continue;
    if (i != num_kept) std::swap(pairs_[at(i)], pairs_[at(num_kept)]);
    ++num_kept;
  }
  return can_split ? num_kept : 0;
}

// Whether the pair's bound over the stretch is not enough yet.
template <int N>
bool ArmSweep<N>::is_open(ArmPair& pair, const ArmStretch<N>& stretch, bool can_split) noexcept {
  Nearest& nearest = this->nearest(pair);
  const bool is_hurried = !can_split || num_stretches_ > max_stretches_ / 4;
  const double wanted_m = is_hurried ? nearest.required_m : nearest.wanted_m();
  const double lower_m = bounds_.find_bounds(stretch, wanted_m, pair).lower_m;
  if (lower_m >= wanted_m) {
    nearest.lower_m = std::min(nearest.lower_m, lower_m);
    return false;
  }
  if (!can_split) note(stretch.x_from, lower_m, pair);
  return true;
}

template <int N>
void ArmSweep<N>::look_at(double x, const LinkFrames<N>& frames, int num_pairs) noexcept {
  const ArmStretch<N> instant{&frames, &frames, x, x, {}};
  for (int i = 0; i < num_pairs && x < x_stop_; ++i) {
    ArmPair& pair = pairs_[at(i)];
    Nearest& nearest = this->nearest(pair);
    const double enough_m = std::max(nearest.upper_m, nearest.required_m);
    const ClearanceBounds found = bounds_.find_bounds(instant, enough_m, pair);
    if (found.upper_m < nearest.required_m) note(x, found.upper_m, pair);
    if (found.upper_m >= nearest.upper_m) continue;
    nearest.upper_m = found.upper_m;
    nearest.x = x;
    nearest.pair = pair;
  }
}

template <int N>
void ArmSweep<N>::note(double x, double lower_m, const ArmPair& pair) noexcept {
  if (!(x < x_stop_)) return;
  x_stop_ = x;
  finding_ = {true, lower_m, pair};
}

// Of a collision the closest approach within its step.
template <int N>
Violation ArmSweep<N>::describe() noexcept {
  Violation violation;
  violation.kind = ViolationKind::kNone;
  if (!finding_.is_found) return violation;
  constexpr int kNumPlaces = 32;
  const int step = std::min(static_cast<int>(x_stop_), motion_.horizon() - 1);
  double x = x_stop_;
  double amount_m = finding_.lower_m;
  double least_m = nearest(finding_.pair).required_m;
  for (int i = 0; i <= kNumPlaces; ++i) {
    const double x_place = step + static_cast<double>(i) / kNumPlaces;
    motion_.find_frames(x_place, left_);
    const ArmStretch<N> instant{&left_, &left_, x_place, x_place, {}};
    const double found_m = bounds_.find_bounds(instant, least_m, finding_.pair).upper_m;
    if (found_m >= least_m) continue;
    least_m = amount_m = found_m;
    x = x_place;
  }
  const bool is_self = finding_.pair.is_self();
  return {is_self ? ViolationKind::kSelfCollision : ViolationKind::kCollision,
          step,
          x * dt_s_,
          finding_.pair.i_link,
          is_self ? kSelfObstacle : finding_.pair.i_obstacle,
          amount_m,
          is_self ? lower_link(finding_.pair) : kNoLink,
          kNoJoint};
}

template <int N>
int ArmSweep<N>::lower_link(const ArmPair& pair) const noexcept {
  return arm_.body(pair.i_other_body).i_link;
}

template <int N>
void ArmSweep<N>::certify(Certificate& certificate) const noexcept {
  const Nearest& obstacle = nearest_[0];
  certificate.min_clearance_m = obstacle.lower_m;
  certificate.where_t_s = obstacle.x * dt_s_;
  certificate.i_link = obstacle.pair.i_link;
  certificate.i_obstacle = obstacle.pair.i_obstacle;
  const Nearest& self = nearest_[1];
  certificate.min_self_clearance_m = self.lower_m;
  if (self.upper_m == kInfinity) return;
  certificate.self_where_t_s = self.x * dt_s_;
  certificate.i_self_link = self.pair.i_link;
  certificate.i_other_link = lower_link(self.pair);
}

template class ArmSweep<4>;
template class ArmSweep<5>;
template class ArmSweep<6>;
template class ArmSweep<7>;
template class ArmSweep<8>;

}  // namespace sopt
