// Request -> path: the parallel RRT* of [Leu22, III-A] as independent streams in rounds of a fixed
// number of samples, on however many workers there are. Paths are shortened when they appear and
// combined (sampler/path_graph.h); the shortest wins, ties by stream id: the answer depends on the
// request alone. Without a path the next round follows; a rung of the margin ladder that used its
// share of samples gives way to the next rung, a batch to the next batch, up to the budget. Where
// samples find nothing in the first round a lattice is searched (sampler/lattice_search.h).
// Deviation: the paper takes the shortest of the first paths as sampled. Here paths are compared by
// what is left of them after shortening; and streams without a path go on until two paths agree in
// length or three times the samples of the first path are used (measured: docs/RESULTS.md).
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "models/config.h"
#include "models/trajectory.h"
#include "rt/clock.h"
#include "rt/deadline.h"
#include "rt/executor.h"
#include "sampler/lattice_search.h"
#include "sampler/path_graph.h"
#include "sampler/sampler_stream.h"
#include "sampler/tuning.h"

namespace sopt {

enum class SamplerStatus : std::int8_t {
  kOk = 0,
  kNoPath = -1,  // the budget of samples ended
  kDeadline = -2,
  kCapacity = -3,  // a path exists but has more vertices than the settings allow
};

struct SamplerCounts {
  std::int64_t nodes = 0;  // in the trees when the search ended
  std::int64_t edges = 0;  // motions checked
  std::int64_t rounds = 0;
};

template <class Robot>
struct SamplerProblem {
  const Robot* robot = nullptr;
  const typename Robot::World* world = nullptr;
  typename Robot::Config start{};
  typename Robot::Config goal{};
  const MarginLadder* ladder = nullptr;
  std::uint64_t seed = 1;
  const PlanOptions* options = nullptr;
};

template <class Robot>
struct SamplerResult {
  SamplerStatus status = SamplerStatus::kNoPath;
  const Path<Robot>* path = nullptr;  // the winner, shortened; valid until the next find_path
  int i_rung = 0;                     // of the ladder that gave it
  double raw_length = 0.0;            // of the winner before shortening
  SamplerCounts counts;
  std::int64_t sample_ns = 0;
  std::int64_t first_path_ns = 0;  // of that, until there was a path
  std::int64_t shortcut_ns = 0;
};

template <class Robot>
class Sampler {
 public:
  Sampler(Arena& arena, const PlannerSettings& settings, Executor& executor, Clock clock) noexcept;

  [[nodiscard]] SamplerResult<Robot> find_path(const SamplerProblem<Robot>& problem,
                                               const Deadline& deadline) SOPT_RT;

  // Looks for a way shorter than `known`, a path that is clear under rung i_rung, and combines it
  // with `known`: over lattice level i_round if that finds one, otherwise by one more batch of
  // streams with random numbers of round i_round >= 0, of samples through which a path can be
  // shorter. The answer may be `known` itself, shortened anew, and kNoPath
  // when no stream finds a path. `known` must not be a path of this sampler.
  [[nodiscard]] SamplerResult<Robot> improve_path(const SamplerProblem<Robot>& problem, int i_rung,
                                                  int i_round, const Path<Robot>& known,
                                                  const Deadline& deadline) SOPT_RT;

  // Streams of the last call, for pictures.
  [[nodiscard]] int num_streams() const noexcept { return num_streams_; }
  [[nodiscard]] const SamplerStream<Robot>& stream(int i) const noexcept {
    return streams_[static_cast<std::size_t>(i)];
  }

 private:
  static constexpr int kRoundSamples = SamplerTuning<Robot>::kRoundSamples;

  // One rung of one batch.
  struct Search {
    const SamplerProblem<Robot>* problem = nullptr;
    const Deadline* deadline = nullptr;
    SamplerResult<Robot>* result = nullptr;
    std::int64_t i_batch = 0;
    int i_rung = 0;
    const Path<Robot>* known = nullptr;  // to be improved
    double best_length = std::numeric_limits<double>::infinity();
    int num_agreeing = 0;  // paths about as short as the best
  };

  [[nodiscard]] static const MarginProfile& profile_of(const Search& search) SOPT_RT {
    return (*search.problem->ladder)[static_cast<std::size_t>(search.i_rung)];
  }
  void choose_streams(const PlanOptions& options) SOPT_RT;
  [[nodiscard]] SamplerStatus run(Search& search) SOPT_RT;
  [[nodiscard]] std::span<const SamplerStream<Robot>> active_streams() const SOPT_RT {
    return std::span(streams_).first(static_cast<std::size_t>(num_streams_));
  }
  void reset_streams(const Search& search) SOPT_RT;
  [[nodiscard]] bool take_new_paths(Search& search) SOPT_RT;
  void shorten_path(const Search& search, int i_stream) SOPT_RT;
  void combine_paths(Search& search) SOPT_RT;
  [[nodiscard]] bool try_lattice(Search& search, int first_level) SOPT_RT;
  [[nodiscard]] SamplerStatus conclude(const Search& search) SOPT_RT;

  int max_streams_ = 0;
  int num_streams_ = 0;
  std::array<SamplerStream<Robot>, kMaxStreams> streams_;
  std::array<double, kMaxStreams> raw_length_{};
  std::array<std::int64_t, kMaxStreams> shortcut_checks_{};
  LatticeSearch<Robot> lattice_;
  Path<Robot> lattice_path_;
  PathGraph<Robot> graph_;
  Path<Robot> combined_;
  Executor* executor_;
  Clock clock_;
};

extern template class Sampler<Point2>;
extern template class Sampler<Arm<4>>;
extern template class Sampler<Arm<5>>;
extern template class Sampler<Arm<6>>;
extern template class Sampler<Arm<7>>;
extern template class Sampler<Arm<8>>;

}  // namespace sopt
