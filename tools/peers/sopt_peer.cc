#include "tools/peers/sopt_peer.h"

#include <utility>

#include "tools/cli/planner_host.h"

namespace sopt {
namespace {

class SoptPeer final : public Peer {
 public:
  SoptPeer(std::string name, SoptStage stage, SamplerMode mode, int num_streams)
      : Peer(std::move(name)), stage_(stage), mode_(mode), num_streams_(num_streams) {}

  void prepare(const PeerProblem& problem) override {
    request_ = problem.request;
    request_.options.sampler = mode_;
    request_.options.num_streams = num_streams_;
    host_ = std::make_unique<PlannerHost>(*problem.scene, request_.options, thread_cpu_clock());
  }

  PeerResult run(std::uint64_t seed) override {
    PeerResult result;
    PlanResult<Point2> planned;
    request_.seed = seed;
    measure(result, [&] { planned = host_->planner().plan(request_); });
    result.failure = planned.status < PlanStatus::kOk ? planned.failure.reason : "";
    if (stage_ == SoptStage::kFirstPath) {
      result.time_ns = planned.times.sample_ns;
      result.is_solved = planned.path != nullptr;
      result.length_m = planned.sampler_path_length;
    } else if (planned.plan) {
      result.is_solved = true;
      result.length_m = planned.path_length;
      const FixedVector<Vec2>& states = planned.plan->trajectory().states;
      result.path.assign(states.begin(), states.end());
    }
    return result;
  }

 private:
  SoptStage stage_;
  SamplerMode mode_;
  int num_streams_;
  PlanRequest<Point2> request_;
  std::unique_ptr<PlannerHost> host_;
};

}  // namespace

std::unique_ptr<Peer> make_sopt_peer(std::string name, SoptStage stage, SamplerMode mode,
                                     int num_streams) {
  return std::make_unique<SoptPeer>(std::move(name), stage, mode, num_streams);
}

}  // namespace sopt
