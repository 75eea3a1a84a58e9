// The command-line options that say how to plan, shared by the subcommands that plan.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "models/config.h"
#include "models/plane/point2.h"

namespace sopt {

// Steps of the longest window that may be asked for: one over the whole horizon of a shipped scene.
inline constexpr int kLongestWindow = 320;

// What was given on the command line; everything else keeps the scene's value or the default.
struct AlgorithmOptions {
  std::optional<int> num_samples;
  std::optional<int> num_streams;
  std::string segments = "auto";
  std::optional<int> max_window;
  bool paper = false;
  bool no_merge = false;
  bool no_shortcut = false;
  bool no_lattice = false;
  bool no_accept = false;
  std::optional<std::string> sampler, rows, resample, merge_rule, qp, start;
  std::optional<double> improve_ms;
  std::optional<double> margin_m;
  std::optional<double> speed_mps;
  std::optional<double> dt_s;
};

// Registers the options; `options` must live as long as `command`.
void add_algorithm_options(CLI::App& command, AlgorithmOptions& options);

// What --paper chooses.
template <class Robot>
[[nodiscard]] constexpr PlanOptions paper_options() {
  return PlanOptions::paper_arm();
}
template <>
[[nodiscard]] constexpr PlanOptions paper_options<Point2>() {
  return PlanOptions::paper();
}

// Puts what was given over `plan`; each option also over what --paper chooses.
void apply(const AlgorithmOptions& options, PlanOptions& plan,
           const PlanOptions& paper = paper_options<Point2>());

// Everything that they choose over `defaults`, for reports; null where the scene's value or the
// default holds.
[[nodiscard]] nlohmann::ordered_json to_json(const AlgorithmOptions& options,
                                             const PlanOptions& defaults = {},
                                             const PlanOptions& paper = paper_options<Point2>());

}  // namespace sopt
