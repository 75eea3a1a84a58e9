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

// `num_streams` as in PlanOptions; one ends with its first path, as a single tree does.
[[nodiscard]] std::unique_ptr<Peer> make_sopt_peer(std::string name, SoptStage stage,
                                                   SamplerMode mode, int num_streams = 0);

}  // namespace sopt
