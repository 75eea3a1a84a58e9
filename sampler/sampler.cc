#include "sampler/sampler.h"

#include <algorithm>
#include <limits>

#include "sampler/shortcut.h"

namespace sopt {
namespace {

// Share of a batch's samples that each rung of the ladder may use: the wide ones fail fast.
constexpr std::array<double, kMarginRungs.size()> kRungShare = {0.25, 0.25, 0.25, 0.25};

// Samples that streams without a path may still take, relative to those until the first path.
constexpr double kCompanyShare = 3.0;

constexpr std::uint64_t kShortcutKey = 0x73686F7274ULL;

}  // namespace

template <class Robot>
Sampler<Robot>::Sampler(Arena& arena, const PlannerSettings& settings, Executor& executor,
                        Clock clock) noexcept
    : max_streams_(std::clamp(settings.num_streams, 1, kMaxStreams)),
      graph_(arena),
      combined_(arena, settings.max_path_vertices),
      executor_(&executor),
      clock_(clock) {
  for (int i = 0; i < max_streams_; ++i) {
    streams_[static_cast<std::size_t>(i)] = SamplerStream<Robot>(arena, settings);
  }
}

template <class Robot>
SamplerResult<Robot> Sampler<Robot>::find_path(const SamplerProblem<Robot>& problem,
                                               const Deadline& deadline) SOPT_RT {
  const PlanOptions& options = *problem.options;
  num_streams_ =
      options.num_streams == 0 ? max_streams_ : std::min(options.num_streams, max_streams_);
  SamplerResult<Robot> result;
  for (int i_batch = 0; i_batch < options.num_batches; ++i_batch) {
    for (int i_rung = 0; i_rung < static_cast<int>(kMarginRungs.size()); ++i_rung) {
      result.status = search_rung(problem, i_batch, i_rung, deadline, result);
      if (result.status != SamplerStatus::kNoPath) return result;
    }
  }
  return result;
}

template <class Robot>
SamplerStatus Sampler<Robot>::search_rung(const SamplerProblem<Robot>& problem, int i_batch,
                                          int i_rung, const Deadline& deadline,
                                          SamplerResult<Robot>& result) SOPT_RT {
  const std::int64_t begin_ns = clock_.now_ns();
  const auto rung = static_cast<std::size_t>(i_rung);
  const MarginProfile& profile = (*problem.ladder)[rung];
  const StreamProblem<Robot> stream_problem{problem.robot, problem.world, profile,
                                            problem.start, problem.goal,  problem.options->sampler};
  auto reset_stream = [&](int /*i_worker*/, int i) {
    streams_[static_cast<std::size_t>(i)].reset(
        stream_problem,
        CounterRng(problem.seed, static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(i_batch),
                   static_cast<std::uint64_t>(i_rung)));
  };
  auto run_stream = [&](int /*i_worker*/, int i) {
    streams_[static_cast<std::size_t>(i)].run(kRoundSamples, deadline);
  };
  executor_->run(Task(reset_stream), num_streams_);

  const auto active = std::span(streams_).first(static_cast<std::size_t>(num_streams_));
  const int share = static_cast<int>(kRungShare[rung] * problem.options->num_samples);
  const auto has_path = [](const auto& stream) { return stream.has_path(); };
  const auto is_done = [](const auto& stream) { return stream.has_path() || stream.exhausted(); };
  bool found = false;
  // Once there is a path the others may use as many samples again as the first one did.
  for (int used = 0, limit = share; used < limit && !deadline.expired(); used += kRoundSamples) {
    if (std::all_of(active.begin(), active.end(), is_done)) break;
    executor_->run(Task(run_stream), num_streams_);
    ++result.counts.rounds;
    if (!found && std::any_of(active.begin(), active.end(), has_path)) {
      found = true;
      limit = used + kRoundSamples + static_cast<int>(kCompanyShare * (used + kRoundSamples));
    }
  }
  result.counts.nodes = 0;
  for (const auto& stream : active) {
    result.counts.nodes += stream.num_nodes();
    result.counts.edges += stream.num_checks();
  }
  result.sample_ns += clock_.now_ns() - begin_ns;
  if (found) {
    result.i_rung = i_rung;
    shorten_paths(problem, profile, deadline, result);
    return SamplerStatus::kOk;
  }
  if (deadline.expired()) return SamplerStatus::kDeadline;
  const bool overflow = std::any_of(active.begin(), active.end(),
                                    [](const auto& stream) { return stream.path_overflow(); });
  return overflow ? SamplerStatus::kCapacity : SamplerStatus::kNoPath;
}

// Shortens every path found and picks the winner.
template <class Robot>
void Sampler<Robot>::shorten_paths(const SamplerProblem<Robot>& problem,
                                   const MarginProfile& profile, const Deadline& deadline,
                                   SamplerResult<Robot>& result) SOPT_RT {
  const std::int64_t begin_ns = clock_.now_ns();
  auto shorten = [&](int /*i_worker*/, int i_stream) {
    const auto i = static_cast<std::size_t>(i_stream);
    Path<Robot>& path = streams_[i].path();
    shortcut_checks_[i] = 0;
    if (path.vertices.empty()) return;
    raw_length_[i] = path.length();
    if (!problem.options->shortcut) return;
    MotionChecker<Robot> checker(*problem.robot, *problem.world, profile);
    CounterRng rng(problem.seed, static_cast<std::uint64_t>(i_stream), kShortcutKey);
    shortcut_path(checker, rng, deadline, path);
    shortcut_checks_[i] = checker.num_checks();
  };
  executor_->run(Task(shorten), num_streams_);

  double best_length = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < static_cast<std::size_t>(num_streams_); ++i) {
    result.counts.edges += shortcut_checks_[i];
    const Path<Robot>& path = streams_[i].path();
    if (path.vertices.empty()) continue;
    const double length = path.length();
    if (length >= best_length) continue;
    best_length = length;
    result.path = &path;
    result.raw_length = raw_length_[i];
  }
  if (problem.options->shortcut) combine_paths(problem, profile, deadline, result);
  result.shortcut_ns += clock_.now_ns() - begin_ns;
}

template <class Robot>
void Sampler<Robot>::combine_paths(const SamplerProblem<Robot>& problem,
                                   const MarginProfile& profile, const Deadline& deadline,
                                   SamplerResult<Robot>& result) SOPT_RT {
  if (result.path->vertices.size() == 2) return;  // straight: nothing is shorter
  graph_.clear();
  for (int i = 0; i < num_streams_; ++i) {
    const Path<Robot>& path = streams_[static_cast<std::size_t>(i)].path();
    if (!path.vertices.empty()) graph_.add(path);
  }
  MotionChecker<Robot> checker(*problem.robot, *problem.world, profile);
  if (graph_.find_shorter(checker, deadline, result.path->length(), combined_)) {
    CounterRng rng(problem.seed, static_cast<std::uint64_t>(kMaxStreams), kShortcutKey);
    shortcut_path(checker, rng, deadline, combined_);
    result.path = &combined_;
  }
  result.counts.edges += checker.num_checks();
}

template class Sampler<Point2>;

}  // namespace sopt
