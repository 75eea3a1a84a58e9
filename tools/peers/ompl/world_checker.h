// A robot among obstacles as OMPL asks for it: whether a configuration is clear, exactly, and
// whether a straight motion is, as this project's sampler finds out.
#pragma once

#include <ompl/base/MotionValidator.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/StateValidityChecker.h>

#include <utility>

#include "tools/peers/ompl/robot_space.h"
#include "tools/peers/peer.h"

namespace sopt {

template <class Robot>
class WorldStateChecker final : public ompl::base::StateValidityChecker {
 public:
  WorldStateChecker(const ompl::base::SpaceInformationPtr& space, const PeerProblem<Robot>& problem)
      : StateValidityChecker(space), problem_(&problem) {}

  [[nodiscard]] bool isValid(const ompl::base::State* state) const override {
    return is_clear(robot_of(*problem_->scene), *problem_->scene->world, config_of<Robot>(state),
                    problem_->rule);
  }

 private:
  const PeerProblem<Robot>* problem_;
};

template <class Robot>
class WorldMotionChecker final : public ompl::base::MotionValidator {
 public:
  WorldMotionChecker(const ompl::base::SpaceInformationPtr& space,
                     const PeerProblem<Robot>& problem)
      : MotionValidator(space), problem_(&problem) {}

  [[nodiscard]] bool checkMotion(const ompl::base::State* a,
                                 const ompl::base::State* b) const override {
    return robot_of(*problem_->scene)
        .motion_is_clear(*problem_->scene->world, problem_->rule, config_of<Robot>(a),
                         config_of<Robot>(b));
  }

  // Only planners that go as far as they can call this one; none here does.
  [[nodiscard]] bool checkMotion(const ompl::base::State* a, const ompl::base::State* b,
                                 std::pair<ompl::base::State*, double>& last_valid) const override {
    if (checkMotion(a, b)) return true;
    if (last_valid.first != nullptr) si_->copyState(last_valid.first, a);
    last_valid.second = 0.0;
    return false;
  }

 private:
  const PeerProblem<Robot>* problem_;
};

}  // namespace sopt
