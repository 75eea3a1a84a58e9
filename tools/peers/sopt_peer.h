// This project's planner as a peer, on memory and trees that are built once per scene.
#pragma once

#include <memory>
#include <string>

#include "models/config.h"
#include "tools/peers/peer.h"

namespace sopt {

enum class SoptStage {
  kFirstPath,     // the sampler alone: its time, and the winning path before it is shortened
  kVerifiedPlan,  // the whole of plan()
};

// What is asked of it; the rest is as in the scene's request.
struct SoptVariant {
  SoptStage stage = SoptStage::kVerifiedPlan;
  SamplerMode sampler = PlanOptions{}.sampler;
  int num_streams = 0;  // 0: the request's; one ends with its first path, as a single tree does
  bool lattice = true;  // false: samples alone, to be held against planners that only sample
};

[[nodiscard]] std::unique_ptr<Peer> make_sopt_peer(std::string name, const SoptVariant& variant);

}  // namespace sopt
