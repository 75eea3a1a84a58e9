#include "tools/cli/algorithm_options.h"

#include "models/capacity.h"
#include "tools/cli/option_checks.h"
#include "tools/io/json_fields.h"

namespace sopt {
namespace {

void add_sampler_options(CLI::App& command, AlgorithmOptions& options) {
  command.add_option("--samples", options.num_samples, "Samples per stream and batch [20000]")
      ->type_name("N")
      ->check(integer_check(1, 1000000));
  command.add_option("--streams", options.num_streams, "Independent sampler streams [4]")
      ->type_name("K")
      ->check(integer_check(1, kMaxStreams));
  command.add_option("--sampler", options.sampler, "rrt_star or rrt_star_connect [the latter]")
      ->type_name("MODE")
      ->check(word_check({"rrt_star", "rrt_star_connect"}));
  command.add_flag("--no-shortcut", options.no_shortcut, "Optimise the sampled path as it is");
}

void add_optimizer_options(CLI::App& command, AlgorithmOptions& options) {
  command.add_option("--segments", options.segments, "Segments to begin with [auto]")
      ->type_name("N|auto")
      ->check(integer_or_word_check(1, kMaxSegments, "auto"));
  command.add_option("--max-window", options.max_window, "Longest window in steps [60]")
      ->type_name("N")
      ->check(integer_check(4, 320));
  command.add_flag("--no-merge", options.no_merge, "Keep the segments as they are");
  command
      .add_option("--resample", options.resample,
                  "scale: shorten the steps with the path; off: keep dt [scale]")
      ->type_name("MODE")
      ->check(word_check({"scale", "off"}));
}

}  // namespace

void add_algorithm_options(CLI::App& command, AlgorithmOptions& options) {
  add_sampler_options(command, options);
  add_optimizer_options(command, options);
  command.add_option("--margin", options.margin_m, "Clearance wanted, m [0.05]")
      ->type_name("M")
      ->check(number_check(kNotNegative));
  command.add_option("--speed", options.speed_mps, "Operating speed, m/s [from the bounds]")
      ->type_name("V")
      ->check(number_check(kPositive));
  command.add_option("--dt", options.dt_s, "Time step, s [0.1]")
      ->type_name("T")
      ->check(number_check(kPositive));
}

void apply(const AlgorithmOptions& options, PlanOptions& plan) {
  plan.num_samples = options.num_samples.value_or(plan.num_samples);
  plan.num_streams = options.num_streams.value_or(plan.num_streams);
  plan.num_segments = options.segments == "auto" ? 0 : std::stoi(options.segments);
  plan.max_window = options.max_window.value_or(plan.max_window);
  plan.merge = !options.no_merge;
  plan.shortcut = !options.no_shortcut;
  plan.sampler =
      options.sampler == "rrt_star" ? SamplerMode::kRrtStar : SamplerMode::kRrtStarConnect;
  plan.time_scaling = options.resample == "scale";
  plan.margin_m = options.margin_m.value_or(plan.margin_m);
  plan.speed_mps = options.speed_mps.value_or(plan.speed_mps);
  plan.dt_s = options.dt_s.value_or(plan.dt_s);
}

}  // namespace sopt
