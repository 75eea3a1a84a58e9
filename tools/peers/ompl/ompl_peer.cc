#include "tools/peers/ompl/ompl_peer.h"

#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/goals/GoalState.h>
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

template <class Robot>
ob::SpaceInformationPtr make_space(const PeerProblem<Robot>& problem, OmplMotionTest test) {
  const auto space = make_robot_space(problem);
  auto information = std::make_shared<ob::SpaceInformation>(space);
  information->setStateValidityChecker(
      std::make_shared<WorldStateChecker<Robot>>(information, problem));
  information->setStateValidityCheckingResolution(kResolution / space->getMaximumExtent());
  if (test == OmplMotionTest::kExact) {
    information->setMotionValidator(
        std::make_shared<WorldMotionChecker<Robot>>(information, problem));
  }
  information->setup();
  return information;
}

template <class Robot>
ob::ProblemDefinitionPtr make_definition(const ob::SpaceInformationPtr& space,
                                         const PeerProblem<Robot>& problem, bool stops_at_first) {
  const Robot& robot = robot_of(*problem.scene);
  ob::ScopedState<ob::RealVectorStateSpace> start(space);
  ob::ScopedState<ob::RealVectorStateSpace> goal(space);
  put<Robot>(within_one_turn(robot, problem.request.start), start.get());
  put<Robot>(within_one_turn(robot, problem.request.goal), goal.get());
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

template <class Robot>
std::vector<Eigen::VectorXd> points_of(og::PathGeometric& path) {
  std::vector<Eigen::VectorXd> points;
  for (const ob::State* state : path.getStates()) points.emplace_back(config_of<Robot>(state));
  return points;
}

// Why a problem cannot be solved; empty: nothing known. BIT* waits for another goal, asleep, when
// the only one is not valid.
std::string refusal_of(const ob::SpaceInformation& space, const ob::ProblemDefinition& definition) {
  if (!space.isValid(definition.getStartState(0))) return "Invalid start";
  const auto* const goal = definition.getGoal()->as<ob::GoalState>();
  return space.isValid(goal->getState()) ? "" : "Invalid goal";
}

struct OmplVariant {
  OmplPlanner planner;
  OmplMotionTest test;
  std::optional<double> budget_s;  // none: stops at the first solution
};

template <class Robot>
class OmplSolver final : public PeerSolver {
 public:
  OmplSolver(const PeerProblem<Robot>& problem, const OmplVariant& variant)
      : problem_(problem), variant_(variant) {}

  PeerResult run(std::uint64_t seed) override {
    ompl::RNG::setSeed(static_cast<std::uint_fast32_t>(seed));  // of generators made from here on
    const ob::SpaceInformationPtr space = make_space(problem_, variant_.test);
    const ob::ProblemDefinitionPtr definition =
        make_definition(space, problem_, !variant_.budget_s);
    const ob::PlannerPtr planner = make_planner(variant_.planner, space);
    planner->setProblemDefinition(definition);
    planner->setup();
    og::PathSimplifier simplifier(space, definition->getGoal());
    const ob::PlannerTerminationCondition limit =
        cpu_limit(variant_.budget_s.value_or(kFirstSolutionLimit_s));

    PeerResult result;
    result.failure = refusal_of(*space, *definition);
    if (!result.failure.empty()) return result;
    ob::PlannerStatus status;
    measure(result, [&] {
      status = planner->solve(limit);
      result.is_solved = status == ob::PlannerStatus::EXACT_SOLUTION;
      if (result.is_solved && variant_.planner == OmplPlanner::kRrtConnectSimplify) {
        simplifier.simplifyMax(*definition->getSolutionPath()->as<og::PathGeometric>());
      }
    });
    if (!result.is_solved) {
      result.failure = status.asString();
      return result;
    }
    auto& path = *definition->getSolutionPath()->as<og::PathGeometric>();
    result.length = path.length();
    result.path = points_of<Robot>(path);
    return result;
  }

 private:
  PeerProblem<Robot> problem_;
  OmplVariant variant_;
};

class OmplPeer final : public Peer {
 public:
  OmplPeer(std::string name, const OmplVariant& variant)
      : Peer(std::move(name), variant.budget_s.has_value()), variant_(variant) {
    ompl::msg::noOutputHandler();
  }

  [[nodiscard]] std::unique_ptr<PeerSolver> prepare(const AnyScene& scene) const override {
    return make_solver<OmplSolver>(scene, variant_);
  }

 private:
  OmplVariant variant_;
};

}  // namespace

std::string ompl_version() {
  return format("%d.%d.%d", OMPL_MAJOR_VERSION, OMPL_MINOR_VERSION, OMPL_PATCH_VERSION);
}

std::unique_ptr<Peer> make_ompl_peer(std::string name, OmplPlanner planner, OmplMotionTest test) {
  return std::make_unique<OmplPeer>(std::move(name), OmplVariant{planner, test, std::nullopt});
}

std::unique_ptr<Peer> make_ompl_rrt_star_for(std::string name, double budget_s) {
  return std::make_unique<OmplPeer>(
      std::move(name), OmplVariant{OmplPlanner::kRrtStar, OmplMotionTest::kDiscrete, budget_s});
}

}  // namespace sopt
