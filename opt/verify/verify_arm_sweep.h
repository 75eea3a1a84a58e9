// Clearance of an arm's whole continuous motion, for verify: every link and obstacle, every pair of
// bodies that may collide. Begins with the whole motion as one stretch and halves it, in the order
// of time, as long as a pair's bound is not enough; pairs that are done with a stretch are not
// looked at in its parts. Places in between, some at the beginning and one per split, show how low
// clearance really gets: a bound is enough when it is above the hard minimum and as near to that as
// the certificate promises. A pair that cannot be proven clear in a stretch of kLeastStretch steps,
// or within the work bound, is a collision. Frames are found once per split for all pairs.
#pragma once

#include <algorithm>
#include <array>

#include "opt/verify/verify.h"
#include "opt/verify/verify_arm_pairs.h"

namespace sopt {

template <int N>
class ArmSweep {
 public:
  // Looks no further than x_stop, in steps.
  ArmSweep(const Arm<N>& arm, const VerifyProblem<Arm<N>>& problem, const ArmMotion<N>& motion,
           double dt_s, double x_stop) noexcept;

  // Fills in the certificate's clearances. Returns the first violation before x_stop, or kNone.
  [[nodiscard]] Violation run(Certificate& certificate) noexcept;
  // Of the violation that `run` found: nothing after it matters.
  [[nodiscard]] double x_stop() const noexcept { return x_stop_; }

 private:
  static constexpr int kMaxPairs = 192;  // looked at together
  static constexpr int kMaxLevels = 30;
  static constexpr double kLeastStretch = 1.0 / 4096.0;  // steps
  static constexpr int kNumSurveys = 16;

  // Of obstacles, or of the arm itself.
  struct Nearest {
    double required_m = 0.0;
    double lower_m = std::numeric_limits<double>::infinity();  // proven
    double upper_m = std::numeric_limits<double>::infinity();  // reached at x by the pair
    double x = 0.0;
    ArmPair pair;

    [[nodiscard]] double wanted_m() const noexcept;  // a lower bound that is enough
  };
  struct Level {
    double x = 0.0;  // end of the stretch
    int num_pairs = 0;
    LinkFrames<N> frames;
  };
  struct Finding {
    bool is_found = false;
    double lower_m = 0.0;
    ArmPair pair;
  };

  void survey_motion() noexcept;
  void sweep_self() noexcept;
  void sweep_obstacles() noexcept;
  void sweep() noexcept;  // pairs_ as they are, then empties them
  void add_pair(const ArmPair& pair) noexcept;

  // Pairs for which keep(pair, stretch, can_split) holds go on to the halves of a stretch, after
  // split(x, frames, num_pairs) in their midst. No stretch is shorter than `least` steps.
  template <class Keep, class Split>
  void walk(double least, Keep&& keep, Split&& split) noexcept;
  template <class Keep>
  [[nodiscard]] int partition(const ArmStretch<N>& stretch, int num_pairs, bool can_split,
                              Keep& keep) noexcept;

  [[nodiscard]] bool is_open(ArmPair& pair, const ArmStretch<N>& stretch, bool can_split) noexcept;
  void look_at(double x, const LinkFrames<N>& frames, int num_pairs) noexcept;

  [[nodiscard]] Nearest& nearest(const ArmPair& pair) noexcept {
    return nearest_[pair.is_self() ? 1 : 0];
  }
  void note(double x, double lower_m, const ArmPair& pair) noexcept;
  [[nodiscard]] Violation describe() noexcept;
  [[nodiscard]] int lower_link(const ArmPair& pair) const noexcept;
  void certify(Certificate& certificate) const noexcept;
  [[nodiscard]] double survey_x(int i) const noexcept {
    return std::floor(static_cast<double>(motion_.horizon()) * i / kNumSurveys);
  }

  const Arm<N>& arm_;
  const VerifyProblem<Arm<N>>& problem_;
  const ArmMotion<N>& motion_;
  ArmPairs<N> bounds_;
  double dt_s_;
  double x_stop_;
  int num_stretches_ = 0;
  int max_stretches_;
  std::array<Nearest, 2> nearest_;
  Finding finding_;
  LinkFrames<N> left_;
  std::array<Aabb3, N + 1> areas_;  // in which a link is all the time
  int num_pairs_ = 0;
  std::array<ArmPair, kMaxPairs> pairs_;
  std::array<Level, kMaxLevels> levels_;
};

extern template class ArmSweep<4>;
extern template class ArmSweep<5>;
extern template class ArmSweep<6>;
extern template class ArmSweep<7>;
extern template class ArmSweep<8>;

}  // namespace sopt
