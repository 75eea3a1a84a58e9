#include "tools/peers/ompl/ompl_peer.h"

#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/objectives/PathLengthOptimizationObjective.h>
#include <ompl/config.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/geometric/planners/informedtrees/BITstar.h>
#include <ompl/geometric/planners/rrt/InformedRRTstar.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include <optional>
#include <utility>

#include "tools/io/plan_report.h"
#include "tools/peers/ompl/world_checker.h"

namespace sopt {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

// Without a solution by then a run has failed.
constexpr double kFirstSolutionLimit_s = 10.0;

ob::SpaceInformationPtr make_space(const PeerProblem& problem, OmplMotionTest test) {
  const auto space = std::make_shared<ob::RealVectorStateSpace>(2);
  const Aabb2 box = problem.scene->robot.sampling_box(*problem.scene->world, problem.rule);
  ob::RealVectorBounds bounds(2);
  for (int axis = 0; axis < 2; ++axis) {
    bounds.setLow(static_cast<unsigned>(axis), box.lower[axis]);
    bounds.setHigh(static_cast<unsigned>(axis), box.upper[axis]);
  }
  space->setBounds(bounds);
  auto information = std::make_shared<ob::SpaceInformation>(space);
  information->setStateValidityChecker(std::make_shared<WorldStateChecker>(information, problem));
  information->setStateValidityCheckingResolution(kResolution_m / space->getMaximumExtent());
  if (test == OmplMotionTest::kExact) {
    information->setMotionValidator(std::make_shared<WorldMotionChecker>(information, problem));
  }
  information->setup();
  return information;
}

ob::ProblemDefinitionPtr make_definition(const ob::SpaceInformationPtr& space,
                                         const PeerProblem& problem, bool stops_at_first) {
  ob::ScopedState<ob::RealVectorStateSpace> start(space);
  ob::ScopedState<ob::RealVectorStateSpace> goal(space);
  for (int axis = 0; axis < 2; ++axis) {
    start[static_cast<unsigned>(axis)] = problem.request.start[axis];
    goal[static_cast<unsigned>(axis)] = problem.request.goal[axis];
  }
  auto definition = std::make_shared<ob::ProblemDefinition>(space);
  definition->setStartAndGoalStates(start, goal);
  const auto objective = std::make_shared<ob::PathLengthOptimizationObjective>(space);
  objective->setCostThreshold(stops_at_first ? objective->infiniteCost() : ob::Cost(0.0));
  definition->setOptimizationObjective(objective);
  return definition;
}

ob::PlannerPtr make_planner(OmplPlanner planner, const ob::SpaceInformationPtr& space) {
  switch (planner) {
    case OmplPlanner::kRrtStar:
      return std::make_shared<og::RRTstar>(space);
    case OmplPlanner::kInformedRrtStar:
      return std::make_shared<og::InformedRRTstar>(space);
    case OmplPlanner::kBitStar:
      return std::make_shared<og::BITstar>(space);
    case OmplPlanner::kRrtConnect:
    case OmplPlanner::kRrtConnectSimplify:
      return std::make_shared<og::RRTConnect>(space);
  }
  return nullptr;
}

// True `budget_s` of the thread's CPU time after this call. Reading that clock costs as much as a
// step of a planner, so only every 16th question reads it.
ob::PlannerTerminationCondition cpu_limit(double budget_s) {
  const Clock clock = thread_cpu_clock();
  const std::int64_t end_ns = clock.now_ns() + static_cast<std::int64_t>(1e9 * budget_s);
  return ob::PlannerTerminationCondition([clock, end_ns, num_questions = 0]() mutable {
    return ++num_questions % 16 == 0 && clock.now_ns() >= end_ns;
  });
}

std::vector<Vec2> points_of(og::PathGeometric& path) {
  std::vector<Vec2> points;
  for (const ob::State* state : path.getStates()) points.push_back(point_of(state));
  return points;
}

class OmplPeer final : public Peer {
 public:
  // No budget: stops at the first solution.
  OmplPeer(std::string name, OmplPlanner planner, OmplMotionTest test,
           std::optional<double> budget_s)
      : Peer(std::move(name), budget_s.has_value()),
        planner_(planner),
        test_(test),
        budget_s_(budget_s) {
    ompl::msg::noOutputHandler();
  }

  void prepare(const PeerProblem& problem) override { problem_ = problem; }

  PeerResult run(std::uint64_t seed) override {
    ompl::RNG::setSeed(static_cast<std::uint_fast32_t>(seed));  // of generators made from here on
    const ob::SpaceInformationPtr space = make_space(problem_, test_);
    const ob::ProblemDefinitionPtr definition = make_definition(space, problem_, !budget_s_);
    const ob::PlannerPtr planner = make_planner(planner_, space);
    planner->setProblemDefinition(definition);
    planner->setup();
    og::PathSimplifier simplifier(space, definition->getGoal());
    const ob::PlannerTerminationCondition limit =
        cpu_limit(budget_s_.value_or(kFirstSolutionLimit_s));

    PeerResult result;
    ob::PlannerStatus status;
    measure(result, [&] {
      status = planner->solve(limit);
      result.is_solved = status == ob::PlannerStatus::EXACT_SOLUTION;
      if (result.is_solved && planner_ == OmplPlanner::kRrtConnectSimplify) {
        simplifier.simplifyMax(*definition->getSolutionPath()->as<og::PathGeometric>());
      }
    });
    if (!result.is_solved) {
      result.failure = status.asString();
      return result;
    }
    auto& path = *definition->getSolutionPath()->as<og::PathGeometric>();
    result.length_m = path.length();
    result.path = points_of(path);
    return result;
  }

 private:
  OmplPlanner planner_;
  OmplMotionTest test_;
  std::optional<double> budget_s_;
  PeerProblem problem_;
};

}  // namespace

std::string ompl_version() {
  return format("%d.%d.%d", OMPL_MAJOR_VERSION, OMPL_MINOR_VERSION, OMPL_PATCH_VERSION);
}

std::unique_ptr<Peer> make_ompl_peer(std::string name, OmplPlanner planner, OmplMotionTest test) {
  return std::make_unique<OmplPeer>(std::move(name), planner, test, std::nullopt);
}

std::unique_ptr<Peer> make_ompl_rrt_star_for(std::string name, double budget_s) {
  return std::make_unique<OmplPeer>(std::move(name), OmplPlanner::kRrtStar,
                                    OmplMotionTest::kDiscrete, budget_s);
}

}  // namespace sopt
