// The `sopt_peers` program: this planner and those of OMPL on the same scenes in one run. Exit
// codes: 0 compared, whatever the targets say; 2 input invalid or wrong usage; 3 host problem.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tools/bench/bench_report.h"
#include "tools/cli/option_checks.h"
#include "tools/io/input_error.h"
#include "tools/io/json_text.h"
#include "tools/io/output_file.h"
#include "tools/peers/ompl/ompl_peer.h"
#include "tools/peers/peer_names.h"
#include "tools/peers/peers_report.h"
#include "tools/peers/peers_run.h"
#include "tools/peers/sopt_peer.h"
#include "tools/scenes/shipped_scenes.h"

namespace sopt {
namespace {

struct Arguments {
  std::vector<std::string> scenes;
  PeersOptions options;
  std::string json_file;
};

// What is compared stands together; between two runs of sopt the caches belong to others. OMPL's
// planners only sample, so single trees of ours do too.
std::vector<std::unique_ptr<Peer>> make_peers(double long_budget_s) {
  using enum OmplPlanner;
  using enum OmplMotionTest;
  using enum SoptStage;
  constexpr SamplerMode kDefault = PlanOptions{}.sampler;
  constexpr SamplerMode kOneTree = SamplerMode::kRrtStar;
  std::vector<std::unique_ptr<Peer>> peers;
  const auto add = [&peers](std::unique_ptr<Peer> peer) { peers.push_back(std::move(peer)); };
  add(make_sopt_peer(kSoptRrtStar, {kFirstPath, kOneTree, 0, false}));
  add(make_ompl_peer(kOmplRrtStar, kRrtStar, kDiscrete));
  add(make_sopt_peer(kSoptRrtStarOneStream, {kFirstPath, kOneTree, 1, false}));
  add(make_ompl_peer(kOmplRrtStarExact, kRrtStar, kExact));
  add(make_ompl_peer(kOmplInformedRrtStar, kInformedRrtStar, kDiscrete));
  add(make_ompl_peer(kOmplBitStar, kBitStar, kDiscrete));
  add(make_sopt_peer(kSoptFirstPath, {kFirstPath, kDefault}));
  add(make_ompl_peer(kOmplRrtConnect, kRrtConnect, kDiscrete));
  add(make_sopt_peer(kSoptFirstPathOneStream, {kFirstPath, kDefault, 1, false}));
  add(make_ompl_peer(kOmplRrtConnectExact, kRrtConnect, kExact));
  add(make_sopt_peer(kSoptPlan, {kVerifiedPlan, kDefault}));
  add(make_ompl_peer(kOmplSimplified, kRrtConnectSimplify, kDiscrete));
  add(make_ompl_peer(kOmplSimplifiedExact, kRrtConnectSimplify, kExact));
  add(make_ompl_rrt_star_for(kOmplRrtStarLong, long_budget_s));
  return peers;
}

void add_options(CLI::App& app, Arguments& arguments) {
  app.add_option("SCENE", arguments.scenes,
                 std::string("Scene files or folders of them [") + kShippedScenes + ']')
      ->type_name("FILE|DIR");
  app.add_option("--seeds", arguments.options.num_seeds, "Seeds per scene, from 1 [16]")
      ->type_name("N")
      ->check(integer_check(1, 1000000));
  app.add_option("--long-seeds", arguments.options.num_slow_seeds,
                 "Seeds of RRT* with its whole budget, at most those above [2]")
      ->type_name("N")
      ->check(integer_check(0, 1000000));
  app.add_option("--long-seconds", arguments.options.long_budget_s,
                 "That budget, s of CPU time [1]")
      ->type_name("T")
      ->check(number_check(kPositive));
  app.add_option("--json", arguments.json_file, "Write all figures and cases")
      ->type_name("FILE")
      ->check(file_check());
}

void run(const Arguments& arguments) {
  const std::vector<std::filesystem::path> files = given_or_shipped_scenes(arguments.scenes);
  std::vector<std::filesystem::path> outputs;
  if (!arguments.json_file.empty()) outputs.emplace_back(arguments.json_file);
  check_outputs(outputs, files);
  const PeersOptions& options = arguments.options;
  const auto [kind, scenes] = load_bench_scenes(files);
  (void)std::printf(
      "%s, OMPL %s\n%zu scenes x %d seeds, RRT* for %g s x %d seeds; CPU time of the one thread, "
      "inside the solve call\nstates of a motion at most %g %s apart; \"exact\": this project's "
      "motion test, which needs no resolution\n",
      describe_machine().c_str(), ompl_version().c_str(), scenes.size(), options.num_seeds,
      options.long_budget_s, options.num_slow_seeds, kResolution, length_unit(kind));
  (void)std::fflush(stdout);
  const std::vector<PeerRun> runs = run_peers(scenes, options, make_peers(options.long_budget_s));
  if (!outputs.empty()) write_files({{arguments.json_file, to_text(to_json(runs, kind, options))}});
  (void)std::fputs((describe_peers(runs, kind) + describe_ratios(compare(runs, kind))).c_str(),
                   stdout);
}

int report(const std::string& line, int exit_code) {
  (void)std::fprintf(stderr, "sopt_peers: %s\n", line.c_str());
  return exit_code;
}

}  // namespace
}  // namespace sopt

int main(int argc, char** argv) {
  using sopt::report;
  try {
    CLI::App app("RRT*-sOpt and OMPL's planners on the same scenes in one run", "sopt_peers");
    sopt::Arguments arguments;
    sopt::add_options(app, arguments);
    try {
      app.parse(argc, argv);
    } catch (const CLI::Success& help) {
      return app.exit(help);
    } catch (const CLI::ParseError& error) {
      return report(sopt::printable(error.what(), 400) + " (see sopt_peers --help)", 2);
    }
    sopt::run(arguments);
    return std::fflush(stdout) == 0 ? 0 : report("stdout cannot be written", 3);
  } catch (const sopt::InputError& error) {
    return report(error.what(), 2);
  } catch (const std::exception& error) {
    return report(error.what(), 3);
  }
}
