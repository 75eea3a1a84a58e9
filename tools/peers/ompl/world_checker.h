// World2 as OMPL asks for it: clearance of a state, and of a straight motion, exact.
#pragma once

#include <ompl/base/MotionValidator.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/StateValidityChecker.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>

#include <utility>

#include "tools/peers/peer.h"

namespace sopt {

[[nodiscard]] inline Vec2 point_of(const ompl::base::State* state) {
  const double* const values = state->as<ompl::base::RealVectorStateSpace::StateType>()->values;
  return {values[0], values[1]};
}

[[nodiscard]] inline bool keeps_margin(const PeerProblem& problem, const Vec2& a, const Vec2& b) {
  return problem.scene->robot.motion_is_clear(*problem.scene->world, problem.rule, a, b);
}

class WorldStateChecker final : public ompl::base::StateValidityChecker {
 public:
  WorldStateChecker(const ompl::base::SpaceInformationPtr& space, const PeerProblem& problem)
      : StateValidityChecker(space), problem_(&problem) {}

  [[nodiscard]] bool isValid(const ompl::base::State* state) const override {
    const Vec2 point = point_of(state);
    return keeps_margin(*problem_, point, point);
  }

 private:
  const PeerProblem* problem_;
};

class WorldMotionChecker final : public ompl::base::MotionValidator {
 public:
  WorldMotionChecker(const ompl::base::SpaceInformationPtr& space, const PeerProblem& problem)
      : MotionValidator(space), problem_(&problem) {}

  [[nodiscard]] bool checkMotion(const ompl::base::State* a,
                                 const ompl::base::State* b) const override {
    return keeps_margin(*problem_, point_of(a), point_of(b));
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
  const PeerProblem* problem_;
};

}  // namespace sopt
