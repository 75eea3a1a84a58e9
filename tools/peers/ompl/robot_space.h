// A robot's configurations as OMPL holds them: its RealVectorStateSpace, over the box in which a
// configuration can be clear. Joints that turn without end go the short way round, as in
// SO2StateSpace, but lengths stay 2-norms over all joints, which those of compound spaces are not.
#pragma once

#include <ompl/base/spaces/RealVectorStateSpace.h>

#include <memory>
#include <utility>

#include "models/arm/arm.h"
#include "models/plane/point2.h"
#include "tools/peers/peer.h"

namespace sopt {

template <class Robot>
[[nodiscard]] typename Robot::Config config_of(const ompl::base::State* state) {
  return Eigen::Map<const typename Robot::Config>(
      state->as<ompl::base::RealVectorStateSpace::StateType>()->values);
}

template <class Robot>
void put(const typename Robot::Config& q, ompl::base::State* state) {
  Eigen::Map<typename Robot::Config>(
      state->as<ompl::base::RealVectorStateSpace::StateType>()->values) = q;
}

// Whole turns taken out.
template <class Robot>
[[nodiscard]] typename Robot::Config within_one_turn(const Robot& robot,
                                                     const typename Robot::Config& q) {
  return robot.unwrapped(Robot::Config::Zero(), q);
}

template <int N>
class TurningSpace final : public ompl::base::RealVectorStateSpace {
 public:
  using Robot = Arm<N>;
  explicit TurningSpace(const Robot& arm) : RealVectorStateSpace(N), arm_(&arm) {}

  [[nodiscard]] double distance(const ompl::base::State* a,
                                const ompl::base::State* b) const override {
    return arm_->path_distance(config_of<Robot>(a), config_of<Robot>(b));
  }
  void interpolate(const ompl::base::State* from, const ompl::base::State* to, double share,
                   ompl::base::State* state) const override {
    const typename Robot::Config q =
        arm_->interpolate(config_of<Robot>(from), config_of<Robot>(to), share);
    put<Robot>(within_one_turn(*arm_, q), state);
  }

 private:
  const Robot* arm_;
};

template <class Robot>
[[nodiscard]] bool turns_without_end(const Robot& robot) {
  for (int i = 0; i < Robot::kDof; ++i) {
    if (robot.is_continuous(i)) return true;
  }
  return false;
}

[[nodiscard]] inline std::shared_ptr<ompl::base::RealVectorStateSpace> make_unbounded_space(
    const Point2& /*robot*/) {
  return std::make_shared<ompl::base::RealVectorStateSpace>(Point2::kDof);
}
template <int N>
[[nodiscard]] std::shared_ptr<ompl::base::RealVectorStateSpace> make_unbounded_space(
    const Arm<N>& arm) {
  if (turns_without_end(arm)) return std::make_shared<TurningSpace<N>>(arm);
  return std::make_shared<ompl::base::RealVectorStateSpace>(N);
}

template <class Robot>
[[nodiscard]] std::shared_ptr<ompl::base::RealVectorStateSpace> make_robot_space(
    const PeerProblem<Robot>& problem) {
  const Robot& robot = robot_of(*problem.scene);
  const auto box = robot.sampling_box(*problem.scene->world, problem.rule);
  ompl::base::RealVectorBounds bounds(Robot::kDof);
  for (int i = 0; i < Robot::kDof; ++i) {
    bounds.setLow(static_cast<unsigned>(i), box.lower[i]);
    bounds.setHigh(static_cast<unsigned>(i), box.upper[i]);
  }
  auto space = make_unbounded_space(robot);
  space->setBounds(bounds);
  return space;
}

}  // namespace sopt
