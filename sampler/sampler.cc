#include "sampler/sampler.h"

#include <algorithm>
#include <limits>

#include "sampler/shortcut.h"

namespace sopt {
namespace {

// Once there is a path the other streams may use this many times as many samples as that one did.
constexpr int kCompany = 3;
// They stop earlier when two paths are this close in length, relative, after shortening.
constexpr double kAgreement = 0.01;

constexpr std::uint64_t kShortcutKey = 0x73686F7274ULL;

}  // namespace

template <class Robot>
Sampler<Robot>::Sampler(Arena& arena, const PlannerSettings& settings, Executor& executor,
                        Clock clock) noexcept
    : max_streams_(std::clamp(settings.num_streams, 1, kMaxStreams)),
      lattice_(arena, settings.max_lattice_points),
      lattice_path_(arena, settings.max_path_vertices),
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
  choose_streams(options);
  SamplerResult<Robot> result;
  for (int i_batch = 0; i_batch < options.num_batches; ++i_batch) {
    for (int i_rung = 0; i_rung < static_cast<int>(kMarginRungs.size()); ++i_rung) {
      Search search{&problem, &deadline, &result, i_batch, i_rung};
      result.status = run(search);
      if (result.status != SamplerStatus::kNoPath) return result;
    }
  }
  return result;
}

template <class Robot>
SamplerResult<Robot> Sampler<Robot>::improve_path(const SamplerProblem<Robot>& problem, int i_rung,
                                                  int i_round, const Path<Robot>& known,
                                                  const Deadline& deadline) SOPT_RT {
  choose_streams(*problem.options);
  SamplerResult<Robot> result;
  Search search{&problem, &deadline, &result, std::int64_t{problem.options->num_batches} + i_round,
                i_rung,   &known};
  if (i_round < kLatticeLevels) {
    graph_.reset(*problem.robot);
    graph_.add(known);
    if (try_lattice(search, i_round)) {
      combine_paths(search);
      result.i_rung = i_rung;
      result.status = SamplerStatus::kOk;
      return result;
    }
  }
  result.status = run(search);
  return result;
}

template <class Robot>
void Sampler<Robot>::choose_streams(const PlanOptions& options) SOPT_RT {
  num_streams_ =
      options.num_streams == 0 ? max_streams_ : std::min(options.num_streams, max_streams_);
}

template <class Robot>
SamplerStatus Sampler<Robot>::run(Search& search) SOPT_RT {
  const Deadline& deadline = *search.deadline;
  SamplerResult<Robot>& result = *search.result;
  reset_streams(search);
  auto run_stream = [&](int /*i_worker*/, int i) {
    streams_[static_cast<std::size_t>(i)].run(kRoundSamples, deadline);
  };
  const auto is_done = [](const auto& stream) { return stream.has_path() || stream.exhausted(); };
  const int share = search.problem->options->num_samples / static_cast<int>(kMarginRungs.size());
  for (int used = 0, limit = share; used < limit && !deadline.expired(); used += kRoundSamples) {
    if (std::all_of(active_streams().begin(), active_streams().end(), is_done)) break;
    const std::int64_t begin_ns = clock_.now_ns();
    executor_->run(Task(run_stream), num_streams_);
    ++result.counts.rounds;
    result.sample_ns += clock_.now_ns() - begin_ns;
    const bool is_first = result.path == nullptr;
    if (!take_new_paths(search)) {
      if (used == 0 && try_lattice(search, 0)) break;
      continue;
    }
    if (is_first) limit = used + kRoundSamples + kCompany * (used + kRoundSamples);
    if (search.num_agreeing >= 2) break;
  }
  return conclude(search);
}

template <class Robot>
void Sampler<Robot>::reset_streams(const Search& search) SOPT_RT {
  const SamplerProblem<Robot>& problem = *search.problem;
  StreamProblem<Robot> stream_problem{problem.robot, problem.world, profile_of(search),
                                      problem.start, problem.goal,  problem.options->sampler};
  stream_problem.patience = SamplerTuning<Robot>::kPatience
                            << 2 * std::min<std::int64_t>(search.i_batch, kMaxPatienceBatches);
  if (search.known != nullptr) stream_problem.max_length = search.known->length(*problem.robot);
  auto reset_stream = [&](int /*i_worker*/, int i) {
    streams_[static_cast<std::size_t>(i)].reset(
        stream_problem, CounterRng(problem.seed, static_cast<std::uint64_t>(i),
                                   static_cast<std::uint64_t>(search.i_batch),
                                   static_cast<std::uint64_t>(search.i_rung)));
  };
  const std::int64_t begin_ns = clock_.now_ns();
  executor_->run(Task(reset_stream), num_streams_);
  search.result->sample_ns += clock_.now_ns() - begin_ns;
  raw_length_.fill(0.0);
  graph_.reset(*problem.robot);
  if (search.known != nullptr) graph_.add(*search.known);
}

// Shortens the paths that the last round found and brings them in; false when there were none.
template <class Robot>
bool Sampler<Robot>::take_new_paths(Search& search) SOPT_RT {
  const std::int64_t begin_ns = clock_.now_ns();
  std::array<bool, kMaxStreams> is_new{};
  for (std::size_t i = 0; i < active_streams().size(); ++i) {
    is_new[i] = streams_[i].has_path() && raw_length_[i] == 0.0;
  }
  if (std::none_of(is_new.begin(), is_new.end(), [](bool b) { return b; })) return false;
  if (search.result->path == nullptr) search.result->first_path_ns = search.result->sample_ns;
  auto shorten = [&](int /*i_worker*/, int i_stream) {
    const auto i = static_cast<std::size_t>(i_stream);
    if (is_new[i]) shorten_path(search, i_stream);
  };
  executor_->run(Task(shorten), num_streams_);

  SamplerResult<Robot>& result = *search.result;
  for (std::size_t i = 0; i < active_streams().size(); ++i) {
    if (!is_new[i]) continue;
    const Path<Robot>& path = streams_[i].path();
    result.counts.edges += shortcut_checks_[i];
    graph_.add(path);
    const double length = path.length(*search.problem->robot);
    if (length < search.best_length * (1.0 - kAgreement)) search.num_agreeing = 0;
    if (length <= search.best_length * (1.0 + kAgreement)) ++search.num_agreeing;
    if (length >= search.best_length) continue;
    search.best_length = length;
    result.path = &path;
    result.raw_length = raw_length_[i];
  }
  combine_paths(search);
  result.shortcut_ns += clock_.now_ns() - begin_ns;
  return true;
}

template <class Robot>
void Sampler<Robot>::shorten_path(const Search& search, int i_stream) SOPT_RT {
  const auto i = static_cast<std::size_t>(i_stream);
  const SamplerProblem<Robot>& problem = *search.problem;
  Path<Robot>& path = streams_[i].path();
  raw_length_[i] = std::max(path.length(*problem.robot),
                            std::numeric_limits<double>::min());  // 0: not taken yet
  shortcut_checks_[i] = 0;
  if (!problem.options->shortcut) return;
  MotionChecker<Robot> checker(*problem.robot, *problem.world, profile_of(search));
  CounterRng rng(problem.seed, static_cast<std::uint64_t>(i_stream), kShortcutKey,
                 static_cast<std::uint64_t>(search.i_batch));
  shortcut_path(checker, rng, *search.deadline, path);
  shortcut_checks_[i] = checker.num_checks();
}

// Takes the way over the lattice if it is shorter than the best path; false when it is not.
template <class Robot>
bool Sampler<Robot>::try_lattice(Search& search, int first_level) SOPT_RT {
  const SamplerProblem<Robot>& problem = *search.problem;
  SamplerResult<Robot>& result = *search.result;
  if (!problem.options->lattice) return false;
  const std::int64_t begin_ns = clock_.now_ns();
  MotionChecker<Robot> checker(*problem.robot, *problem.world, profile_of(search));
  bool is_found = lattice_.find_path(checker, problem.start, problem.goal, first_level,
                                     *search.deadline, lattice_path_);
  const std::int64_t found_ns = clock_.now_ns();
  const double raw_length = lattice_path_.length(*problem.robot);
  if (is_found && problem.options->shortcut) {
    CounterRng rng(problem.seed, static_cast<std::uint64_t>(kMaxStreams) + 1, kShortcutKey,
                   static_cast<std::uint64_t>(search.i_batch));
    shortcut_path(checker, rng, *search.deadline, lattice_path_);
  }
  result.sample_ns += found_ns - begin_ns;
  if (is_found && result.path == nullptr) result.first_path_ns = result.sample_ns;
  result.shortcut_ns += clock_.now_ns() - found_ns;
  result.counts.edges += checker.num_checks();
  is_found = is_found && lattice_path_.length(*problem.robot) < search.best_length;
  if (is_found) {
    graph_.add(lattice_path_);
    search.best_length = lattice_path_.length(*problem.robot);
    result.path = &lattice_path_;
    result.raw_length = raw_length;
  }
  return is_found;
}

// A path that beats the best one by more than the agreement puts the count back: the streams had
// agreed on something worse.
template <class Robot>
void Sampler<Robot>::combine_paths(Search& search) SOPT_RT {
  const SamplerProblem<Robot>& problem = *search.problem;
  SamplerResult<Robot>& result = *search.result;
  // A straight path is the shortest there is.
  if (!problem.options->shortcut || result.path->vertices.size() == 2) return;
  MotionChecker<Robot> checker(*problem.robot, *problem.world, profile_of(search));
  if (graph_.find_shorter(checker, *search.deadline, search.best_length, combined_)) {
    CounterRng rng(problem.seed, static_cast<std::uint64_t>(kMaxStreams), kShortcutKey,
                   static_cast<std::uint64_t>(search.i_batch));
    shortcut_path(checker, rng, *search.deadline, combined_);
    const double length = combined_.length(*problem.robot);
    if (length < search.best_length * (1.0 - kAgreement)) search.num_agreeing = 1;
    search.best_length = length;
    result.path = &combined_;
  }
  result.counts.edges += checker.num_checks();
}

template <class Robot>
SamplerStatus Sampler<Robot>::conclude(const Search& search) SOPT_RT {
  SamplerResult<Robot>& result = *search.result;
  bool path_overflow = false;
  result.counts.nodes = 0;
  for (const SamplerStream<Robot>& stream : active_streams()) {
    result.counts.nodes += stream.num_nodes();
    result.counts.edges += stream.num_checks();
    path_overflow = path_overflow || stream.path_overflow();
  }
  if (result.path != nullptr) {
    result.i_rung = search.i_rung;
    return SamplerStatus::kOk;
  }
  if (search.deadline->expired()) return SamplerStatus::kDeadline;
  return path_overflow ? SamplerStatus::kCapacity : SamplerStatus::kNoPath;
}

template class Sampler<Point2>;
template class Sampler<Arm<4>>;
template class Sampler<Arm<5>>;
template class Sampler<Arm<6>>;
template class Sampler<Arm<7>>;
template class Sampler<Arm<8>>;

}  // namespace sopt
