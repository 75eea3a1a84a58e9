#include "tools/peers/sopt_peer.h"

#include <utility>

#include "tools/cli/planner_host.h"

namespace sopt {
namespace {

template <class Robot>
PlanRequest<Robot> request_of(const PeerProblem<Robot>& problem, const SoptVariant& variant) {
  PlanRequest<Robot> request = problem.request;
  request.options.sampler = variant.sampler;
  if (variant.num_streams > 0) request.options.num_streams = variant.num_streams;
  request.options.lattice = variant.lattice;
  return request;
}

// Points of a trajectory between which the motion is straight, or nearly so.
std::vector<Eigen::VectorXd> points_of(const Trajectory<Point2>& trajectory) {
  return std::vector<Eigen::VectorXd>(trajectory.states.begin(), trajectory.states.end());
}
template <int N>
std::vector<Eigen::VectorXd> points_of(const Trajectory<Arm<N>>& trajectory) {
  constexpr int kPointsPerStep = 8;
  std::vector<Eigen::VectorXd> points;
  for (int i = 0; i < trajectory.horizon(); ++i) {
    for (int k = 0; k < kPointsPerStep; ++k) {
      const double t_s = trajectory.dt_s * k / kPointsPerStep;
      const auto state = Arm<N>::step(trajectory.states[i], trajectory.inputs[i], t_s);
      points.emplace_back(state.template head<N>());
    }
  }
  points.emplace_back(trajectory.states[trajectory.horizon()].template head<N>());
  return points;
}

template <class Robot>
class SoptSolver final : public PeerSolver {
 public:
  SoptSolver(const PeerProblem<Robot>& problem, const SoptVariant& variant)
      : stage_(variant.stage),
        request_(request_of(problem, variant)),
        host_(std::make_unique<PlannerHost<Robot>>(*problem.scene, request_.options,
                                                   thread_cpu_clock())) {}

  PeerResult run(std::uint64_t seed) override {
    PeerResult result;
    PlanResult<Robot> planned;
    request_.seed = seed;
    measure(result, [&] { planned = host_->planner().plan(request_); });
    result.failure = planned.status < PlanStatus::kOk ? planned.failure.reason : "";
    if (stage_ == SoptStage::kFirstPath) {
      result.time_ns = planned.times.first_path_ns;
      result.is_solved = planned.path != nullptr;
      result.length = planned.sampler_path_length;
    } else if (planned.plan) {
      result.is_solved = true;
      result.length = planned.path_length;
      result.path = points_of(planned.plan->trajectory());
    }
    return result;
  }

 private:
  SoptStage stage_;
  PlanRequest<Robot> request_;
  std::unique_ptr<PlannerHost<Robot>> host_;
};

class SoptPeer final : public Peer {
 public:
  SoptPeer(std::string name, const SoptVariant& variant)
      : Peer(std::move(name)), variant_(variant) {}

  [[nodiscard]] std::unique_ptr<PeerSolver> prepare(const AnyScene& scene) const override {
    return make_solver<SoptSolver>(scene, variant_);
  }

 private:
  SoptVariant variant_;
};

}  // namespace

std::unique_ptr<Peer> make_sopt_peer(std::string name, const SoptVariant& variant) {
  return std::make_unique<SoptPeer>(std::move(name), variant);
}

}  // namespace sopt
