#include "tools/cli/algorithm_options.h"

#include <utility>
#include <vector>

#include "models/capacity.h"
#include "tools/cli/option_checks.h"
#include "tools/io/json_fields.h"

namespace sopt {
namespace {

// The words an option may have, with what they mean.
template <class Value>
using Words = std::vector<std::pair<const char*, Value>>;

const Words<SamplerMode>& samplers() {
  static const Words<SamplerMode> words = {{"rrt_star", SamplerMode::kRrtStar},
                                           {"rrt_star_connect", SamplerMode::kRrtStarConnect}};
  return words;
}

const Words<RowMode>& row_modes() {
  static const Words<RowMode> words = {{"edge", RowMode::kEdge},
                                       {"waypoint", RowMode::kWaypoint},
                                       {"label_map", RowMode::kLabelMap}};
  return words;
}

const Words<Resampling>& resamplings() {
  static const Words<Resampling> words = {{"scale", Resampling::kScale},
                                          {"rediscretise", Resampling::kRediscretize},
                                          {"off", Resampling::kOff}};
  return words;
}

const Words<MergeRule>& merge_rules() {
  static const Words<MergeRule> words = {{"paired", MergeRule::kPaired},
                                         {"eager", MergeRule::kEager},
                                         {"printed", MergeRule::kPrinted}};
  return words;
}

const Words<WindowSolver>& solvers() {
  static const Words<WindowSolver> words = {{"kernel", WindowSolver::kClosedForm},
                                            {"dense", WindowSolver::kDense}};
  return words;
}

const Words<bool>& starts() {
  static const Words<bool> words = {{"reference", false}, {"zero_input", true}};
  return words;
}

template <class Value>
void add_words(CLI::App& command, const char* option, std::optional<std::string>& given,
               const Words<Value>& words, const char* help) {
  std::vector<std::string> names;
  for (const auto& word : words) names.emplace_back(word.first);
  command.add_option(option, given, help)->type_name("MODE")->check(word_check(names));
}

template <class Value>
void put(const std::optional<std::string>& given, const Words<Value>& words, Value& value) {
  if (!given) return;
  for (const auto& word : words) {
    if (*given == word.first) value = word.second;
  }
}

void add_sampler_options(CLI::App& command, AlgorithmOptions& options) {
  command.add_option("--samples", options.num_samples, "Samples per stream and batch [20000]")
      ->type_name("N")
      ->check(integer_check(1, 1000000));
  command.add_option("--streams", options.num_streams, "Independent sampler streams [4, arms 2]")
      ->type_name("K")
      ->check(integer_check(1, kMaxStreams));
  add_words(command, "--sampler", options.sampler, samplers(),
            "rrt_star or rrt_star_connect [the latter]");
  command.add_flag("--no-shortcut", options.no_shortcut, "Optimise the sampled path as it is");
  command.add_flag("--no-lattice", options.no_lattice,
                   "Only sample, where otherwise a lattice is searched after a round in vain");
}

void add_optimizer_options(CLI::App& command, AlgorithmOptions& options) {
  command.add_option("--segments", options.segments, "Segments to begin with [auto]")
      ->type_name("N|auto")
      ->check(integer_or_word_check(1, kMaxSegments, "auto"));
  command.add_option("--max-window", options.max_window, "Longest window in steps [60; arms 160]")
      ->type_name("N")
      ->check(integer_check(4, kLongestWindow));
  command.add_flag("--no-merge", options.no_merge, "Do not merge segments");
  add_words(
      command, "--merge-rule", options.merge_rule, merge_rules(),
      "paired: other windows keep their parity; eager: the same after any whole step; printed: "
      "as in the paper [paired; arms eager]");
  add_words(command, "--rows", options.rows, row_modes(),
            "Obstacles that a window keeps clear of: near its edges, near its waypoints, or the "
            "nearest one of each waypoint [edge]");
  add_words(command, "--qp", options.qp, solvers(),
            "kernel: inverse Hessian in closed form; dense: condensed and factorised [kernel]");
  add_words(command, "--start", options.start, starts(),
            "First linearisation: about the reference, or zero_input as in the paper [reference]");
  command.add_flag("--no-accept", options.no_accept, "Take windows' solutions without a check");
  add_words(command, "--resample", options.resample, resamplings(),
            "scale: shorten the steps with the path; rediscretise: fewer steps after every sweep; "
            "off: keep dt [scale]");
  command.add_flag("--paper", options.paper,
                   "The paper's choices, in windows of 30 steps: --sampler rrt_star --no-shortcut "
                   "--no-lattice --rows label_map --qp dense --start zero_input --no-accept "
                   "--merge-rule printed --resample "
                   "rediscretise; for arms --rows waypoint --resample off; options given beside it "
                   "win");
}

template <class Value>
const char* word_of(const Words<Value>& words, const Value& value) {
  for (const auto& word : words) {
    if (word.second == value) return word.first;
  }
  return "off";
}

template <class T>
nlohmann::ordered_json to_json(const std::optional<T>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
}

// Keeps what the scene says: times and clearances.
void take_choices(const PlanOptions& from, PlanOptions& plan) {
  PlanOptions chosen = from;
  chosen.speed_mps = plan.speed_mps;
  chosen.dt_s = plan.dt_s;
  chosen.margin_m = plan.margin_m;
  chosen.min_clearance_m = plan.min_clearance_m;
  chosen.num_batches = plan.num_batches;
  plan = chosen;
}

}  // namespace

void add_algorithm_options(CLI::App& command, AlgorithmOptions& options) {
  add_sampler_options(command, options);
  add_optimizer_options(command, options);
  command
      .add_option("--improve-ms", options.improve_ms,
                  "After the first plan, search for shorter ones this long [0]")
      ->type_name("T")
      ->check(number_check({0.0, 1e9, "a number from 0 to 1e9"}));
  command.add_option("--margin", options.margin_m, "Clearance wanted, m [0.05; arms 0.02]")
      ->type_name("M")
      ->check(number_check(kNotNegative));
  command
      .add_option("--speed", options.speed_mps,
                  "Operating speed, m/s [from the bounds]; of arms, rad/s [1]")
      ->type_name("V")
      ->check(number_check(kPositive));
  command.add_option("--dt", options.dt_s, "Time step, s [0.1; arms 0.05]")
      ->type_name("T")
      ->check(number_check(kPositive));
}

void apply(const AlgorithmOptions& options, PlanOptions& plan, const PlanOptions& paper) {
  if (options.paper) take_choices(paper, plan);
  plan.num_samples = options.num_samples.value_or(plan.num_samples);
  plan.num_streams = options.num_streams.value_or(plan.num_streams);
  if (options.segments != "auto") plan.num_segments = std::stoi(options.segments);
  plan.max_window = options.max_window.value_or(plan.max_window);
  put(options.sampler, samplers(), plan.sampler);
  put(options.rows, row_modes(), plan.rows);
  put(options.resample, resamplings(), plan.resampling);
  put(options.merge_rule, merge_rules(), plan.merge);
  put(options.qp, solvers(), plan.solver);
  put(options.start, starts(), plan.zero_input_start);
  if (options.no_merge) plan.merge = MergeRule::kOff;
  if (options.no_shortcut) plan.shortcut = false;
  if (options.no_lattice) plan.lattice = false;
  if (options.no_accept) plan.accept = false;
  if (options.improve_ms) plan.improve_s = *options.improve_ms / 1000.0;
  plan.margin_m = options.margin_m.value_or(plan.margin_m);
  plan.speed_mps = options.speed_mps.value_or(plan.speed_mps);
  plan.dt_s = options.dt_s.value_or(plan.dt_s);
}

nlohmann::ordered_json to_json(const AlgorithmOptions& options, const PlanOptions& defaults,
                               const PlanOptions& paper) {
  PlanOptions plan = defaults;
  apply(options, plan, paper);
  return {{"samples", to_json(options.num_samples)},
          {"streams", to_json(options.num_streams)},
          {"sampler", word_of(samplers(), plan.sampler)},
          {"shortcut", plan.shortcut},
          {"lattice", plan.lattice},
          {"segments", options.segments},
          {"max_window", to_json(options.max_window)},
          {"rows", word_of(row_modes(), plan.rows)},
          {"qp", word_of(solvers(), plan.solver)},
          {"start", word_of(starts(), plan.zero_input_start)},
          {"accept", plan.accept},
          {"merge", word_of(merge_rules(), plan.merge)},
          {"resample", word_of(resamplings(), plan.resampling)},
          {"improve_ms", to_json(options.improve_ms)},
          {"margin", to_json(options.margin_m)},
          {"speed", to_json(options.speed_mps)},
          {"dt", to_json(options.dt_s)}};
}

}  // namespace sopt
